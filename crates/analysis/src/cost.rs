//! What an analysis costs: runs, load steps, Newton iterations and CPU time of each of its phases.

use cpu_time::ProcessTime;
use model::TestRun;
use serde::{Deserialize, Serialize};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Who watches an analysis: may ask it to stop, and hears what it costs. Phases of one analysis follow each other.
pub trait Watch: Sync {
    /// Whether the user wants to stop; asked between steps.
    fn stops(&self) -> bool;

    /// What is done from here on.
    fn phase(&self, _phase: Phase) {}

    /// A run of the model ended.
    fn ran(&self, _tests: &[Option<TestRun>]) {}
}

impl<F: Fn() -> bool + Sync> Watch for F {
    fn stops(&self) -> bool {
        self()
    }
}

/// Stops when asked to, and counts with a meter.
pub struct Metered<'a> {
    stops: &'a (dyn Fn() -> bool + Sync),
    meter: &'a Meter,
}

impl<'a> Metered<'a> {
    /// Asks `stops`, counts with `meter`.
    pub const fn new(stops: &'a (dyn Fn() -> bool + Sync), meter: &'a Meter) -> Self {
        Self { stops, meter }
    }
}

impl Watch for Metered<'_> {
    fn stops(&self) -> bool {
        (self.stops)()
    }

    fn phase(&self, phase: Phase) {
        self.meter.begin(phase);
    }

    fn ran(&self, tests: &[Option<TestRun>]) {
        self.meter.count(tests);
    }
}

/// A part of an analysis that is an analysis of its own: all it does belongs to one phase.
pub struct Within<'a>(pub &'a dyn Watch);

impl Watch for Within<'_> {
    fn stops(&self) -> bool {
        self.0.stops()
    }

    fn ran(&self, tests: &[Option<TestRun>]) {
        self.0.ran(tests);
    }
}

/// A part of an analysis.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Phase {
    /// Initial guesses of tissue and tear.
    Start,
    /// The base model's fit.
    Base,
    /// Columns of the catalogue at a fitted model.
    Screen,
    /// Fits of models with effects.
    Candidates,
    /// Fits of an identification.
    Fit,
    /// Standard errors and what the mesh contributes.
    Intervals,
    /// What to measure next.
    NextTest,
    /// One strength along the path, for comparison.
    OneStrength,
    /// The answer's curves, energies and fields, on the file's mesh.
    Replay,
}

/// What a phase took.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PhaseCost {
    /// Phase.
    pub phase: Phase,
    /// Runs of the model, all tests of a piece together.
    pub runs: usize,
    /// Converged load steps.
    pub load_steps: usize,
    /// Newton iterations, those of rejected steps included.
    pub newton_iterations: usize,
    /// CPU time of the process, s; `None` where other analyses ran beside this one.
    pub cpu_seconds: Option<f64>,
}

/// Adds up what an analysis costs.
pub struct Meter {
    alone: bool,
    sums: Mutex<Sums>,
}

struct Sums {
    phases: Vec<PhaseCost>,
    since: ProcessTime,
}

impl Meter {
    /// A meter; `alone`: nothing else is computed in this process meanwhile, so that its CPU time is that of the analysis.
    pub fn new(alone: bool) -> Self {
        Self { alone, sums: Mutex::new(Sums { phases: Vec::new(), since: ProcessTime::now() }) }
    }

    fn sums(&self) -> MutexGuard<'_, Sums> {
        self.sums.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// A phase begins; the CPU time so far was the last one's.
    pub fn begin(&self, phase: Phase) {
        let sums = &mut *self.sums();
        sums.clock(self.alone);
        // The last one is the present one.
        let known = sums.phases.iter().position(|p| p.phase == phase);
        let entry = match known {
            Some(at) => sums.phases.remove(at),
            None => PhaseCost {
                phase,
                runs: 0,
                load_steps: 0,
                newton_iterations: 0,
                cpu_seconds: self.alone.then_some(0.0),
            },
        };
        sums.phases.push(entry);
    }

    /// Counts a run to the present phase.
    pub fn count(&self, tests: &[Option<TestRun>]) {
        if let Some(p) = self.sums().phases.last_mut() {
            p.runs += 1;
            for run in tests.iter().flatten() {
                p.load_steps += run.run.steps.iter().filter(|s| !s.revisited).count();
                p.newton_iterations += run.run.iterations;
            }
        }
    }

    /// What was spent so far, in the order of [`Phase`].
    pub fn spent(&self) -> Vec<PhaseCost> {
        let mut sums = self.sums();
        sums.clock(self.alone);
        let mut phases = sums.phases.clone();
        phases.sort_by_key(|p| p.phase as usize);
        phases
    }
}

impl Sums {
    fn clock(&mut self, alone: bool) {
        if let Some(p) = self.phases.last_mut().filter(|_| alone) {
            let spent = self.since.elapsed().as_secs_f64();
            p.cpu_seconds = p.cpu_seconds.map(|s| s + spent);
        }
        self.since = ProcessTime::now();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn time_belongs_to_the_phase_in_which_it_is_spent() {
        let meter = Meter::new(true);
        meter.begin(Phase::Base);
        let from = ProcessTime::now();
        let mut x = 0.5f64;
        while from.elapsed().as_secs_f64() < 0.02 {
            x = (x + 1.0).sqrt();
        }
        meter.begin(Phase::Start);
        meter.begin(Phase::Base);
        let spent = meter.spent();
        assert!(x > 0.0);
        assert_eq!(spent.iter().map(|p| p.phase).collect::<Vec<_>>(), [Phase::Start, Phase::Base]);
        assert!(spent[1].cpu_seconds.is_some_and(|s| s >= 0.02), "{spent:?}");
    }

    #[test]
    fn beside_other_analyses_no_time_is_told() {
        let meter = Meter::new(false);
        meter.begin(Phase::Fit);
        assert_eq!(meter.spent()[0].cpu_seconds, None);
    }
}
