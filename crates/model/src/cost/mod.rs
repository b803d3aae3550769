//! What a case costs, before anything is meshed: memory and time of a run, alone and with derivatives for a fit.
//!
//! Counted exactly: nodes, elements, unknowns, and the fill of the factor ([`mesh::count()`]). Taken from measurement, with
//! the command beside each: bytes and seconds per brick, per entry, per iteration. Upper or lower by a factor of two on
//! another machine, which is enough to tell a minute from a day and a laptop from a cluster.

mod admit;
mod machine;

pub use admit::{MOST_BYTES, MOST_SECONDS, bytes, duration};
pub use machine::available_bytes;

use crate::build::{BuildError, Discretisation, Outlook, outlook};
use crate::catalogue::Catalogue;
use crate::plan::{Corner, corners_of_protocol, corners_of_record};
use crate::predict::RunOptions;
use input::{Case, Test};
use std::sync::Arc;

/// Runs of the model in an identification: FCT1 took 101 to 138 (docs/performance.md,
/// `fct identify configs/FCT1.toml`).
pub const RUNS_OF_A_FIT: usize = 100;
/// The same in runs on the file's mesh: most of them are made on a coarser one (docs/performance.md, the same command: some
/// 15 there, and as much time again on coarser ones).
const FULL_RUNS_OF_A_FIT: f64 = 40.0;

/// Bytes per entry of the lower triangle while it is set up and solved: pattern, maps, values, buffers of the bricks.
/// Largest resident size less the factor: 114 to 123 for `fct simulate` of strips 20 × 50 × 2 to 60 × 150 × 2 (9 450 to
/// 82 350 unknowns; 65, 228, 487 MB in all).
const BYTES_PER_ENTRY: f64 = 120.0;
/// Bytes of the program without a model.
const PROGRAM: f64 = 15e6;
/// Seconds per unknown to set up the pattern and the first factor: a run of `cargo run --release -p fem --example scaling`
/// less its ten iterations, 3 to 11 · 10⁻⁵ from 9 450 to 200 925 unknowns.
const SETTING_UP: f64 = 6e-5;
/// Seconds per brick and iteration, the factorisation apart: two assemblies of 4.0 to 4.3 µs a brick (same command).
const SECONDS_PER_BRICK: f64 = 8e-6;
/// Multiplications and additions per second of a factorisation: 14 to 30 · 10⁹ (same command, GF over its time).
const FLOPS: f64 = 1.8e10;
/// Newton iterations of a step: 2.5 (`just peers`, tear 20 × 50 × 4).
const ITERATIONS: f64 = 2.5;
/// Iterations of a tear's limit point: a jump takes some hundred, a smooth tear none.
const LIMIT_POINT: f64 = 60.0;
/// Time of a run with derivatives over that of one without: 1.4 (`cargo bench -p analysis --bench iteration`).
const WITH_DERIVATIVES: f64 = 1.4;
/// Runs whose states and derivatives are kept as first guesses, and the present one.
const KEPT_RUNS: f64 = 3.0;
/// Answers of a test along a path or a record where no step is given.
const DEFAULT_STEPS: f64 = 100.0;

/// Memory and time.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Need {
    /// Peak memory, bytes.
    pub bytes: f64,
    /// Time of one run of all tests on one core, s.
    pub seconds: f64,
}

/// What a case costs.
#[derive(Clone, Debug, PartialEq)]
pub struct Cost {
    /// Unknowns of each test.
    pub unknowns: Vec<usize>,
    /// Bricks of each test.
    pub elements: Vec<usize>,
    /// Elements along the tear path, the fewest of all tests that have one.
    pub ahead: Option<usize>,
    /// Free parameters.
    pub free: usize,
    /// A simulation, every state kept.
    pub simulation: Need,
    /// A run of an identification, with derivatives by every free parameter.
    pub fit: Need,
}

/// What a run is made for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Purpose {
    /// One run.
    Simulation,
    /// Runs with derivatives.
    Fit,
}

impl Cost {
    /// Counts what a case would need.
    ///
    /// # Errors
    /// What cannot be meshed, named with its place.
    pub fn of(case: &Arc<Case>, catalogue: &Catalogue, how: Discretisation) -> Result<Self, BuildError> {
        let look = outlook(case, catalogue, how)?;
        let mut out = Self {
            unknowns: Vec::new(),
            elements: Vec::new(),
            ahead: None,
            free: look.free,
            simulation: Need { bytes: PROGRAM, seconds: 0.0 },
            fit: Need { bytes: PROGRAM, seconds: 0.0 },
        };
        for (test, count) in case.tests.iter().zip(&look.counts) {
            out.add(case, test, count, &look);
        }
        Ok(out)
    }

    fn add(&mut self, case: &Case, test: &Test, count: &mesh::Count, look: &Outlook) {
        let bricks: usize = count.elements.iter().product();
        let unknowns = 3.0 * count.nodes as f64;
        self.unknowns.push(3 * count.nodes);
        self.elements.push(bricks);
        if test.kind.tears {
            self.ahead = Some(self.ahead.map_or(count.ahead, |a| a.min(count.ahead)));
        }
        // A node meets 27 through the bulk, 18 at a face.
        let layers = (count.elements[2] + 1) as f64;
        let entries = unknowns * 1.5 * 9.0 * (3.0 - 2.0 / layers);
        let system = BYTES_PER_ENTRY * entries + 8.0 * (count.fill.entries + count.fill.front.powi(2));
        let history = 64.0 * (look.bulk_history * bricks) as f64;
        let state = 8.0 * (unknowns + bricks as f64) + history;
        let iteration = SECONDS_PER_BRICK * bricks as f64 + count.fill.flops / FLOPS;
        let tear = if test.kind.tears { LIMIT_POINT } else { 0.0 };
        let time = |steps: f64| SETTING_UP * unknowns + iteration * (ITERATIONS * steps + tear);

        let simulated = simulated_steps(case, test);
        // Each state is kept for the fields, and once more for its own revisit.
        self.simulation.bytes += system + 2.0 * simulated * state;
        self.simulation.seconds += time(simulated);

        let (steps, free) = (fitted_steps(test), look.free as f64);
        let gradients = KEPT_RUNS * steps * 4.0 * unknowns * free;
        let columns = free * (16.0 * unknowns + 2.0 * history);
        self.fit.bytes += system + KEPT_RUNS * steps * state + gradients + columns;
        self.fit.seconds += WITH_DERIVATIVES * time(steps);
    }

    /// Time of an identification on one core, s.
    pub fn seconds_of_a_fit(&self) -> f64 {
        FULL_RUNS_OF_A_FIT * self.fit.seconds
    }

    /// What a purpose needs.
    pub const fn need(&self, purpose: Purpose) -> Need {
        match purpose {
            Purpose::Simulation => self.simulation,
            Purpose::Fit => self.fit,
        }
    }
}

fn corners(test: &Test) -> Vec<Corner> {
    match (&test.record, &test.protocol) {
        (Some(record), _) => corners_of_record(record),
        (None, Some(legs)) => corners_of_protocol(legs),
        (None, None) => Vec::new(),
    }
}

/// Way of the actuator, and the range it goes through, mm.
fn way(test: &Test) -> (f64, f64, f64) {
    let corners = corners(test);
    let way = corners.windows(2).map(|w| (w[1].displacement - w[0].displacement).abs()).sum();
    let (low, high) =
        corners.iter().fold((f64::MAX, f64::MIN), |(l, h), c| (l.min(c.displacement), h.max(c.displacement)));
    (way, (high - low).max(1e-9), corners.len() as f64)
}

fn simulated_steps(case: &Case, test: &Test) -> f64 {
    let (way, range, corners) = way(test);
    way / case.solver.step_mm.unwrap_or(range / DEFAULT_STEPS) + corners
}

fn fitted_steps(test: &Test) -> f64 {
    let (way, range, corners) = way(test);
    let grid = RunOptions::default().steps(test.kind);
    way / range * grid as f64 + corners
}
