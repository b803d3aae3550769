//! Runs the tests and predicts what the record holds, with derivatives.

use crate::build::{BuildError, Model, TestModel};
use crate::camera::{self, Camera};
use crate::effect::Sample;
use crate::plan::{Corner, Place, Plan, RunIndex, Stepping, corners_of_protocol, corners_of_record, plan};
use constitutive::WIDTH;
use fem::sensitivity::{Chunk, Columns};
use fem::{FemError, History, MarchOptions, Run, State, Target, Warm, march};
use input::{Record, TestKind};
use rayon::prelude::*;
use std::sync::Arc;

/// Rest between two tests of a piece when the file gives none, s: viscous stresses are gone.
pub const LONG_REST: f64 = 1e9;

/// Which measured channel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Channel {
    /// Load cell, N.
    Force,
    /// Camera: change of distance between the clamped edges, mm.
    GripDisplacement,
    /// Camera: tear front, mm.
    TearFront,
    /// Camera: change of width, mm.
    WidthChange,
}

impl Channel {
    /// All, force first.
    pub const ALL: [Self; 4] = [Self::Force, Self::GripDisplacement, Self::TearFront, Self::WidthChange];

    /// Word in block names.
    pub const fn word(self) -> &'static str {
        match self {
            Self::Force => "force",
            Self::GripDisplacement => "grip_displacement",
            Self::TearFront => "tear_front",
            Self::WidthChange => "width_change",
        }
    }

    /// The channel's numbers in a record: (row, value) where measured.
    pub fn of(self, record: &Record) -> Vec<(usize, f64)> {
        let some = |c: &Option<Vec<Option<f64>>>| -> Vec<(usize, f64)> {
            c.iter().flatten().enumerate().filter_map(|(i, v)| v.map(|v| (i, v))).collect()
        };
        match self {
            Self::Force => record.force.iter().copied().enumerate().collect(),
            Self::GripDisplacement => some(&record.grip_displacement),
            Self::TearFront => some(&record.tear_front),
            Self::WidthChange => some(&record.width_change),
        }
    }
}

/// How tests are run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RunOptions {
    /// Finite-element options.
    pub march: MarchOptions,
    /// Grid lines over the displacement range of a tearing test.
    pub tearing_steps: usize,
    /// Grid lines over the displacement range of a uniaxial test.
    pub uniaxial_steps: usize,
    /// Follow holds even if no law looks at time (the screen's effects may).
    pub follow_holds: bool,
}

impl Default for RunOptions {
    fn default() -> Self {
        Self { march: MarchOptions::default(), tearing_steps: 48, uniaxial_steps: 20, follow_holds: false }
    }
}

/// The result of one test's run.
pub struct TestRun {
    /// Index of the test.
    pub test: usize,
    /// Steps asked for.
    pub plan: Plan,
    /// Steps made.
    pub run: Run,
    /// θ indices of the derivative columns.
    pub columns: Vec<usize>,
    /// History at the end, handed on to the next test of the piece.
    pub history: Vec<f64>,
}

/// Predicted channel values at the rows of a record.
#[derive(Clone, Debug, Default)]
pub struct Series {
    /// Values.
    pub values: Vec<f64>,
    /// Derivatives: `derivatives[row * columns + c]`.
    pub derivatives: Vec<f64>,
    /// False where the value is not differentiable (next to a jump).
    pub smooth: Vec<bool>,
}

/// Something to run a test with: the problem is taken at θ; columns follow `seeds`.
pub struct Request<'a> {
    /// All parameter values.
    pub theta: &'a [f64],
    /// θ indices to differentiate by.
    pub seeds: &'a [usize],
    /// Options.
    pub options: RunOptions,
    /// Which tests are wanted (earlier tests of a piece with memory are run all the same).
    pub wanted: &'a [bool],
    /// First guesses per test from an earlier run.
    pub warm: &'a [Option<Warm>],
    /// Asked between steps.
    pub cancelled: &'a (dyn Fn() -> bool + Sync),
}

impl Model {
    /// Corners of the actuator's motion in a test, from its record or protocol.
    pub fn corners(&self, test: usize) -> Vec<Corner> {
        let t = &self.tests[test].test;
        match (&t.record, &t.protocol) {
            (Some(r), _) => corners_of_record(r),
            (None, Some(legs)) => corners_of_protocol(legs),
            (None, None) => Vec::new(),
        }
    }

    /// The plan of an identification run.
    pub fn plan(&self, test: usize, options: &RunOptions) -> Plan {
        let t = &self.tests[test];
        let steps = match t.test.kind {
            TestKind::Tearing => options.tearing_steps,
            TestKind::Uniaxial => options.uniaxial_steps,
        };
        plan(&self.corners(test), Stepping { steps, holds: options.follow_holds || t.rate_dependent() })
    }

    /// Chains of tests that inherit each other's bulk history.
    pub fn chains(&self) -> Vec<Vec<usize>> {
        let mut chains: Vec<Vec<usize>> = Vec::new();
        for (i, t) in self.tests.iter().enumerate() {
            match chains.last_mut() {
                Some(last) if t.has_memory() && !t.test.fresh_piece => last.push(i),
                _ => chains.push(vec![i]),
            }
        }
        chains
    }

    /// Runs the wanted tests; independent chains in parallel. One entry per test, `None` where not
    /// wanted.
    ///
    /// # Errors
    /// [`BuildError`] from setting up a solver; a run that stops early is no error here.
    pub fn run(&self, request: &Request) -> Result<Vec<Option<TestRun>>, BuildError> {
        let chains = self.chains();
        let results: Vec<Result<Vec<TestRun>, BuildError>> = chains
            .par_iter()
            .map(|chain| {
                let last = chain.iter().rposition(|&t| request.wanted[t]);
                let Some(last) = last else { return Ok(Vec::new()) };
                self.run_chain(&chain[..=last], request)
            })
            .collect();
        let mut out: Vec<Option<TestRun>> = (0..self.tests.len()).map(|_| None).collect();
        for r in results {
            for t in r? {
                let at = t.test;
                out[at] = Some(t);
            }
        }
        Ok(out)
    }

    fn run_chain(&self, chain: &[usize], request: &Request) -> Result<Vec<TestRun>, BuildError> {
        let mut done = Vec::new();
        let mut before: Option<(State, Vec<Chunk<WIDTH>>)> = None;
        for &t in chain {
            let plan = self.plan(t, &request.options);
            let (run, state, chunks) = self.run_test(t, request, &plan, before.take())?;
            done.push(TestRun {
                test: t,
                run,
                plan,
                columns: request.seeds.to_vec(),
                history: state.history.bulk.clone(),
            });
            before = Some((state, chunks));
        }
        Ok(done)
    }

    /// The state a test starts from.
    pub fn initial_state(&self, problem: &fem::Problem, test: &TestModel, before: Option<&State>) -> State {
        let mut state = State::virgin(problem);
        if let Some(b) = before {
            state.history.bulk.clone_from(&b.history.bulk);
            state.time = b.time;
            if !test.test.remount {
                state.history.train.clone_from(&b.history.train);
            }
        }
        state
    }

    #[allow(clippy::type_complexity)]
    fn run_test(
        &self,
        t: usize,
        request: &Request,
        plan: &Plan,
        before: Option<(State, Vec<Chunk<WIDTH>>)>,
    ) -> Result<(Run, State, Vec<Chunk<WIDTH>>), BuildError> {
        let test = &self.tests[t];
        let problem = Arc::new(test.problem(request.theta));
        let mut system = test.take_system(&problem)?;
        let mut chunks = fem::sensitivity::columns_for(&problem, request.theta, request.seeds);
        let initial = self.initial_state(&problem, test, before.as_ref().map(|b| &b.0));
        if let Some((_, old)) = &before {
            for (c, o) in chunks.iter_mut().zip(old) {
                c.carry_bulk_from(o);
            }
        }
        let mut targets = plan.targets.clone();
        if before.is_some()
            && let Some(first) = targets.first_mut()
        {
            *first = Target { dt: test.test.rest_s.unwrap_or(LONG_REST), rest: true, ..*first };
        }
        let camera = self.camera_at(t, request.theta);
        let mut columns: Vec<&mut (dyn Columns + 'static)> =
            chunks.iter_mut().map(|c| c as &mut (dyn Columns + 'static)).collect();
        let run = march(
            &problem,
            request.theta,
            &mut system,
            Some(initial),
            &targets,
            &mut columns,
            &camera,
            request.options.march,
            request.warm.get(t).and_then(Option::as_ref),
            request.cancelled,
        );
        test.give_back(system);
        let state = run
            .last
            .clone()
            .unwrap_or_else(|| State { history: History::virgin(&problem), ..State::virgin(&problem) });
        Ok((run, state, chunks))
    }

    /// The camera with the thresholds of θ.
    pub fn camera_at(&self, t: usize, theta: &[f64]) -> Camera {
        let mut c = self.tests[t].camera(self.areas());
        for (a, threshold) in c.thresholds.iter_mut().enumerate() {
            *threshold = match self.tests[t].test.tear_front_opening {
                Some(x) => x,
                None => self.threshold(a, theta).0,
            };
        }
        c
    }

    /// δc of an area and its derivatives by (Gc, σc).
    fn threshold(&self, area: usize, theta: &[f64]) -> (f64, [f64; 2]) {
        let at = |what: &str| self.find(&format!("interface.area[{}].{what}", area + 1));
        let (Some(g), Some(s)) = (at("gc"), at("sigma_c")) else { return (f64::INFINITY, [0.0; 2]) };
        let e = std::f64::consts::E;
        let (gc, sc) = (theta[g], theta[s]);
        (gc / (e * sc), [1.0 / (e * sc), -gc / (e * sc * sc)])
    }

    /// A channel at the rows of the test's record.
    ///
    /// # Errors
    /// Why the run stopped before it reached a row.
    pub fn series(&self, run: &TestRun, theta: &[f64], channel: Channel) -> Result<Series, FemError> {
        let test = &self.tests[run.test];
        let Some(record) = &test.test.record else { return Ok(Series::default()) };
        let rows = channel.of(record);
        let index = RunIndex::new(&run.plan, &run.run);
        let k = run.columns.len();
        let mut out = Series {
            values: Vec::with_capacity(rows.len()),
            derivatives: Vec::with_capacity(rows.len() * k),
            smooth: Vec::with_capacity(rows.len()),
        };
        let start = record.time.first().copied().unwrap_or(0.0);
        for (row, _) in rows {
            let place = run.plan.place(record.time[row], record.displacement[row]);
            let (value, by, smooth) = match channel {
                Channel::Force => self.force_row(run, &index, theta, record, row, place, start)?,
                _ => self.camera_row(run, &index, theta, channel, place)?,
            };
            out.values.push(value);
            out.derivatives.extend(by);
            out.smooth.push(smooth);
        }
        Ok(out)
    }

    #[allow(clippy::too_many_arguments)]
    fn force_row(
        &self,
        run: &TestRun,
        index: &RunIndex,
        theta: &[f64],
        record: &Record,
        row: usize,
        place: Place,
        start: f64,
    ) -> Result<(f64, Vec<f64>, bool), FemError> {
        let test = &self.tests[run.test];
        let k = run.columns.len();
        let pick = |ids: &[usize]| ids.iter().map(|&i| theta[i]).collect::<Vec<f64>>();
        let mut late = 0.0;
        let mut late_by = vec![0.0; k];
        for (sensor, ids) in &test.sensors {
            let (delay, by) = sensor.delay(&pick(ids));
            late += delay;
            for (id, d) in ids.iter().zip(by) {
                if let Some(c) = run.columns.iter().position(|x| x == id) {
                    late_by[c] += d;
                }
            }
        }
        let delayed = |shift: f64| {
            let time = (place.time - shift).max(start);
            if shift == 0.0 { place } else { run.plan.place(time, run.plan.displacement_at(time)) }
        };
        let at = |p: Place| -> Result<(f64, Vec<f64>, bool), FemError> {
            let s = run.plan.stencil(index, &run.run, &p).ok_or_else(|| missing(&run.run))?;
            let mut value = 0.0;
            let mut by = vec![0.0; k];
            for &(step, w) in &s.terms {
                let record = &run.run.steps[step];
                value += w * record.force;
                for (b, d) in by.iter_mut().zip(&record.derivatives.force) {
                    *b += w * d;
                }
            }
            Ok((value, by, s.smooth))
        };
        let (mut value, mut by, smooth) = at(delayed(late))?;
        if late_by.iter().any(|d| *d != 0.0) {
            let h = 0.05 * (record.time[record.time.len() - 1] - start) / record.time.len() as f64;
            // From the past: a cell can only be late.
            let slope = (value - at(delayed(late + h))?.0) / h;
            for (b, d) in by.iter_mut().zip(&late_by) {
                *b -= slope * d;
            }
        }
        let sample = sample(record, row, test);
        for (sensor, ids) in &test.sensors {
            let reading = sensor.reading(&sample, value, &pick(ids));
            value = reading.value;
            for b in &mut by {
                *b *= reading.slope;
            }
            for (id, d) in ids.iter().zip(reading.by_param) {
                if let Some(c) = run.columns.iter().position(|x| x == id) {
                    by[c] += d;
                }
            }
        }
        Ok((value, by, smooth))
    }

    fn camera_row(
        &self,
        run: &TestRun,
        index: &RunIndex,
        theta: &[f64],
        channel: Channel,
        place: Place,
    ) -> Result<(f64, Vec<f64>, bool), FemError> {
        let k = run.columns.len();
        let s = run.plan.stencil(index, &run.run, &place).ok_or_else(|| missing(&run.run))?;
        // The camera counts from the start of the test.
        let first = run.run.steps.first();
        let mut value = 0.0;
        let mut by = vec![0.0; k];
        for &(step, w) in &s.terms {
            let r = &run.run.steps[step];
            let (v, d): (f64, Vec<f64>) = match channel {
                Channel::GripDisplacement => {
                    let zero = first.map_or(0.0, |f| f.grip);
                    let by_zero = first.map(|f| &f.derivatives.grip);
                    let d = (0..k)
                        .map(|c| {
                            r.derivatives.grip.get(c).unwrap_or(&0.0)
                                - by_zero.and_then(|z| z.get(c)).unwrap_or(&0.0)
                        })
                        .collect();
                    (r.grip - zero, d)
                }
                Channel::TearFront => self.front(run, theta, r),
                _ => {
                    let at = camera::output::WIDTH_CHANGE;
                    let zero = first.map_or(0.0, |f| f.extra[at]);
                    (r.extra[at] - zero, r.derivatives.extra.get(at).cloned().unwrap_or_else(|| vec![0.0; k]))
                }
            };
            value += w * v;
            for (b, d) in by.iter_mut().zip(&d) {
                *b += w * d;
            }
        }
        Ok((value, by, s.smooth))
    }

    /// Tear front with the part of its derivative that comes from the threshold δc.
    fn front(&self, run: &TestRun, theta: &[f64], r: &fem::StepRecord) -> (f64, Vec<f64>) {
        use camera::output::{FRONT_AREA, FRONT_BY_THRESHOLD, TEAR_FRONT};
        let mut by =
            r.derivatives.extra.get(TEAR_FRONT).cloned().unwrap_or_else(|| vec![0.0; run.columns.len()]);
        if self.tests[run.test].test.tear_front_opening.is_none() {
            let area = r.extra[FRONT_AREA] as usize;
            let (_, slopes) = self.threshold(area, theta);
            for (what, slope) in ["gc", "sigma_c"].iter().zip(slopes) {
                let path = format!("interface.area[{}].{what}", area + 1);
                let column = self.find(&path).and_then(|i| run.columns.iter().position(|&c| c == i));
                if let Some(c) = column {
                    by[c] += r.extra[FRONT_BY_THRESHOLD] * slope;
                }
            }
        }
        (r.extra[TEAR_FRONT], by)
    }
}

impl Model {
    /// How late the force of a test is recorded, s: all sensors together.
    pub fn sensor_delay(&self, test: usize, theta: &[f64]) -> f64 {
        self.tests[test].sensors.iter().map(|(sensor, ids)| sensor.delay(&pick(theta, ids)).0).sum()
    }

    /// What is recorded for a true force: through all sensors in order.
    pub fn sensor_reading(&self, test: usize, theta: &[f64], at: &Sample, force: f64) -> f64 {
        let sensors = &self.tests[test].sensors;
        sensors.iter().fold(force, |force, (sensor, ids)| sensor.reading(at, force, &pick(theta, ids)).value)
    }
}

fn pick(theta: &[f64], ids: &[usize]) -> Vec<f64> {
    ids.iter().map(|&i| theta[i]).collect()
}

fn missing(run: &Run) -> FemError {
    run.failure
        .clone()
        .unwrap_or_else(|| FemError::Setup("the run does not reach every point of the record".into()))
}

/// Motion of the actuator at a row, by differences.
fn sample(record: &Record, row: usize, test: &TestModel) -> Sample {
    let (t, u) = (&record.time, &record.displacement);
    let n = t.len();
    let speed = |i: usize, j: usize| if j > i { (u[j] - u[i]) / (t[j] - t[i]) } else { 0.0 };
    let (a, b) = (row.saturating_sub(1), (row + 1).min(n - 1));
    let (before, after) = (speed(a, row), speed(row, b));
    let mut acceleration = if a < row && b > row { (after - before) / (0.5 * (t[b] - t[a])) } else { 0.0 };
    if acceleration.abs() * (t[b] - t[a]) < 1e-3 * (before.abs() + after.abs()) {
        acceleration = 0.0;
    }
    Sample {
        time: t[row] - t[0],
        displacement: u[row],
        speed: speed(a, b),
        acceleration,
        kind: test.test.kind,
        test: test.index,
    }
}
