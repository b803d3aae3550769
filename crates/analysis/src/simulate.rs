//! Forward runs at given values: what the load cell and the camera would read, with energies,
//! jumps and states.

use crate::cost::Phase;
use crate::identify::{AnalysisError, Identified, run_options};
use crate::problem::Cancelled;
use fem::{FemError, History, Run, State, SteppingOptions, Target, run_steps};
use input::{Case, Control, Test};
use inverse::PredictError;
use model::cost::Purpose;
use model::{
    BuildError, Catalogue, Discretisation, LONG_REST, Model, Plan, RunIndex, RunOptions, Sample, camera,
    plan_simulation,
};
use rayon::prelude::*;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Answers over the range of displacement when the file gives no step.
const DEFAULT_STEPS: f64 = 100.0;

/// Who watches a simulation, and who may stop it.
pub struct SimulateControl<'a> {
    /// Called between steps with (planned answers reached, planned answers).
    pub progress: &'a (dyn Fn(usize, usize) + Sync),
    /// Asked between steps.
    pub cancelled: Cancelled<'a>,
}

/// Forward runs of all tests.
pub struct Simulated {
    /// The model.
    pub model: Model,
    /// Parameter values.
    pub theta: Vec<f64>,
    /// The tests, in the order of the case. A test that was never reached has no steps.
    pub tests: Vec<SimulatedTest>,
}

/// One test's forward run. All series have one entry per step of `run`.
pub struct SimulatedTest {
    /// Name of the test.
    pub name: String,
    /// Steps asked for.
    pub plan: Plan,
    /// Steps made, with states and energies.
    pub run: Run,
    /// Time since the start of the test, s.
    pub time: Vec<f64>,
    /// Actuator displacement, mm.
    pub displacement: Vec<f64>,
    /// What the load cell reads, N.
    pub force: Vec<f64>,
    /// Second actuator's displacement, mm, and what its load cell reads, N; empty for a test with one axis.
    pub across: [Vec<f64>; 2],
    /// Camera: change of distance between the clamped edges, mm.
    pub grip_displacement: Vec<f64>,
    /// Camera: tear front, mm; empty for an intact strip.
    pub tear_front: Vec<f64>,
    /// Camera: change of width, mm.
    pub width_change: Vec<f64>,
    /// Fewest elements of the path in the softening zone while there was a whole one.
    pub softening_elements: Option<f64>,
    /// Energy ledger at the end closes to this share of the external work.
    pub closure: f64,
    /// Why the run ended before its plan did.
    pub failure: Option<String>,
}

impl Simulated {
    /// The first reason why a test could not go on, with the test's name.
    pub fn failure(&self) -> Option<String> {
        self.tests.iter().find_map(|t| t.failure.as_ref().map(|why| format!("test {}: {why}", t.name)))
    }

    /// Steps of all tests.
    pub fn steps(&self) -> usize {
        self.tests.iter().map(|t| t.run.steps.len()).sum()
    }

    /// Newton iterations of all tests.
    pub fn iterations(&self) -> usize {
        self.tests.iter().map(|t| t.run.iterations).sum()
    }
}

/// Runs every test of a case at the case's values. Effects at their neutral value change no bit of it.
///
/// A run that cannot go on is no error: it holds everything up to there, and the reason.
///
/// # Errors
/// [`AnalysisError::Build`] when no model can be made of the case.
pub fn simulate(
    case: Arc<Case>,
    catalogue: &Catalogue,
    control: &SimulateControl,
) -> Result<Simulated, AnalysisError> {
    let how = Discretisation { idle_neutral: true, ..Discretisation::default() };
    let model = Model::checked(case.clone(), catalogue, how, Purpose::Simulation)?;
    let mut stepping = run_options(&case).stepping;
    stepping.ledger = true;
    stepping.keep_states = true;
    let tests: Vec<(Plan, SteppingOptions)> =
        (0..model.tests.len()).map(|t| planned(&model, t, stepping)).collect();
    let theta = model.theta();
    let tests = run_all(&model, &theta, &tests, control)?;
    Ok(Simulated { model, theta, tests })
}

/// The identified model once more with energies and states, on the steps of the identification:
/// for fields, energy ledger and figures.
///
/// # Errors
/// [`AnalysisError::Build`] when a solver cannot be set up; [`PredictError::Interrupted`] when the user stopped it: energies
/// of a part of the record are none of the model's.
pub fn replay(
    identified: &Identified,
    control: &SimulateControl,
) -> Result<Vec<SimulatedTest>, AnalysisError> {
    control.cancelled.phase(Phase::Replay);
    let model = &identified.model;
    let options: RunOptions = identified.options;
    let stepping = SteppingOptions { ledger: true, keep_states: true, ..options.stepping };
    let tests: Vec<(Plan, SteppingOptions)> =
        (0..model.tests.len()).map(|t| (model.plan(t, &options), stepping)).collect();
    let replayed = run_all(model, &identified.theta, &tests, control)?;
    if control.cancelled.stops() && replayed.iter().any(|t| t.failure.is_some()) {
        return Err(PredictError::Interrupted.into());
    }
    Ok(replayed)
}

/// Steps of one test as the contract asks for them.
fn planned(model: &Model, t: usize, mut stepping: SteppingOptions) -> (Plan, SteppingOptions) {
    let corners = model.corners(t);
    let solver = &model.case.solver;
    let range = corners.iter().fold(f64::MIN, |m, c| m.max(c.displacement))
        - corners.iter().fold(f64::MAX, |m, c| m.min(c.displacement));
    let step = solver.step_mm.unwrap_or((range / DEFAULT_STEPS).max(1e-9));
    // An intact strip has no snap-back to follow.
    let path = solver.control == Control::Path && model.tests[t].test.kind.tears;
    stepping.follow_path = path;
    if path {
        stepping.arc_step = step;
    }
    (plan_simulation(&corners, step, model.tests[t].rate_dependent(), path), stepping)
}

/// Runs independent chains of tests in parallel, the tests of a chain one after the other.
fn run_all(
    model: &Model,
    theta: &[f64],
    tests: &[(Plan, SteppingOptions)],
    control: &SimulateControl,
) -> Result<Vec<SimulatedTest>, AnalysisError> {
    let total: usize = tests.iter().map(|t| t.0.targets.len()).sum();
    let done = AtomicUsize::new(0);
    let asked = || {
        (control.progress)(done.fetch_add(1, Ordering::Relaxed).min(total), total);
        control.cancelled.stops()
    };
    let chains: Vec<Result<Vec<SimulatedTest>, BuildError>> =
        model.chains().par_iter().map(|chain| run_chain(model, theta, chain, tests, &asked)).collect();
    let mut out = Vec::new();
    for chain in chains {
        out.extend(chain?);
    }
    Ok(out)
}

fn run_chain(
    model: &Model,
    theta: &[f64],
    chain: &[usize],
    tests: &[(Plan, SteppingOptions)],
    asked: &(dyn Fn() -> bool + Sync),
) -> Result<Vec<SimulatedTest>, BuildError> {
    let mut out: Vec<SimulatedTest> = Vec::new();
    let mut before: Option<State> = None;
    for &t in chain {
        let (plan, options) = &tests[t];
        // The history that this test would start from is not known.
        let blocked = out.iter().find(|o| o.failure.is_some()).map(|o| o.name.clone());
        let run = match blocked {
            Some(name) => Run {
                failure: Some(FemError::Setup(format!(
                    "test {name}, whose history this one inherits, ended early"
                ))),
                ..Run::default()
            },
            None => run_test(model, theta, t, plan, *options, before.as_ref(), asked)?,
        };
        before.clone_from(&run.last);
        out.push(answer(model, theta, t, plan.clone(), run));
    }
    Ok(out)
}

fn run_test(
    model: &Model,
    theta: &[f64],
    t: usize,
    plan: &Plan,
    options: SteppingOptions,
    before: Option<&State>,
    asked: &(dyn Fn() -> bool + Sync),
) -> Result<Run, BuildError> {
    let test = &model.tests[t];
    let problem = Arc::new(test.problem(theta));
    let mut system = test.take_system(&problem)?;
    let initial = model.initial_state(&problem, test, before);
    let mut targets = plan.targets.clone();
    if let (Some(first), Some(_)) = (targets.first_mut(), before) {
        *first = Target { dt: test.test.rest_s.unwrap_or(LONG_REST), rest: true, ..*first };
    }
    let camera = model.camera_at(t, theta);
    let mut run = run_steps(
        &problem,
        theta,
        &mut system,
        Some(initial),
        &targets,
        &mut [],
        &camera,
        options,
        None,
        &asked,
    );
    test.give_back(system);
    if run.last.is_none() {
        run.last = Some(State { history: History::virgin(&problem), ..State::virgin(&problem) });
    }
    Ok(run)
}

/// What instruments read at the steps of a run.
fn answer(model: &Model, theta: &[f64], t: usize, plan: Plan, run: Run) -> SimulatedTest {
    let test = &model.tests[t].test;
    let start = run.steps.first().map_or(0.0, |s| s.time);
    let offset = plan.times.first().copied().unwrap_or(0.0);
    let time: Vec<f64> = run.steps.iter().map(|s| s.time - start + offset).collect();
    let displacement: Vec<f64> = run.steps.iter().map(|s| s.actuator).collect();
    let zero = run.steps.first().map_or((0.0, 0.0), |s| (s.grip, width(s)));
    let tear_front = if test.kind.tears {
        run.steps.iter().map(|s| output(s, camera::output::TEAR_FRONT)).collect()
    } else {
        Vec::new()
    };
    SimulatedTest {
        name: test.name.clone(),
        across: across(test, &run),
        force: readings(model, theta, t, &plan, &run, &time),
        grip_displacement: run.steps.iter().map(|s| s.grip - zero.0).collect(),
        tear_front,
        softening_elements: run
            .steps
            .iter()
            .filter_map(|s| s.extra.get(camera::output::SOFTENING).copied().filter(|n| n.is_finite()))
            .min_by(f64::total_cmp),
        width_change: run.steps.iter().map(|s| width(s) - zero.1).collect(),
        closure: closure(&run),
        failure: run.failure.as_ref().map(ToString::to_string),
        time,
        displacement,
        plan,
        run,
    }
}

/// Displacement and force of the second axis, where there is one.
fn across(test: &Test, run: &Run) -> [Vec<f64>; 2] {
    if !test.kind.two_axes {
        return Default::default();
    }
    let force = |s: &fem::StepRecord| s.reactions.get(1).copied().unwrap_or_default();
    [run.steps.iter().map(|s| test.ratio_x * s.grip).collect(), run.steps.iter().map(force).collect()]
}

fn output(step: &fem::StepRecord, at: usize) -> f64 {
    step.extra.get(at).copied().unwrap_or(0.0)
}

fn width(step: &fem::StepRecord) -> f64 {
    output(step, camera::output::WIDTH_CHANGE)
}

/// Largest departure of the ledger from closing, as a share of the largest external work.
fn closure(run: &Run) -> f64 {
    let most = run.steps.iter().fold(0.0f64, |m, s| m.max(s.ledger.external_work.abs()));
    let start = run.steps.first().map_or(0.0, |s| s.ledger.gap());
    let gap = run.steps.iter().fold(0.0f64, |m, s| m.max((s.ledger.gap() - start).abs()));
    if most > 0.0 { gap / most } else { 0.0 }
}

/// True forces seen through the sensors of the model.
fn readings(model: &Model, theta: &[f64], t: usize, plan: &Plan, run: &Run, time: &[f64]) -> Vec<f64> {
    let late = model.sensor_delay(t, theta);
    let index = RunIndex::new(plan, run);
    let mut out = Vec::with_capacity(run.steps.len());
    for (i, step) in run.steps.iter().enumerate() {
        let force = if late == 0.0 { step.along() } else { earlier(plan, &index, run, time[i] - late) };
        out.push(model.sensor_reading(t, theta, &sample(model, t, run, time, i), force));
    }
    out
}

/// The force at an earlier time of the same run.
fn earlier(plan: &Plan, index: &RunIndex, run: &Run, time: f64) -> f64 {
    let time = time.max(plan.times.first().copied().unwrap_or(0.0));
    let place = plan.place(time, plan.displacement_at(time));
    match plan.stencil(index, run, &place) {
        Some(s) => s.terms.iter().map(|&(step, w)| w * run.steps[step].along()).sum(),
        None => run.steps.first().map_or(0.0, fem::StepRecord::along),
    }
}

/// Motion of the actuator at a step.
fn sample(model: &Model, t: usize, run: &Run, time: &[f64], i: usize) -> Sample {
    let u = |i: usize| run.steps[i].actuator;
    let speed = |a: usize, b: usize| {
        let dt = time[b] - time[a];
        if dt > 0.0 { (u(b) - u(a)) / dt } else { 0.0 }
    };
    let (a, b) = (i.saturating_sub(1), (i + 1).min(run.steps.len() - 1));
    let (before, after) = (speed(a, i), speed(i, b));
    let dt = time[b] - time[a];
    let mut acceleration = if a < i && b > i && dt > 0.0 { 2.0 * (after - before) / dt } else { 0.0 };
    if acceleration.abs() * dt < 1e-3 * (before.abs() + after.abs()) {
        acceleration = 0.0;
    }
    Sample {
        time: time[i] - time[0],
        displacement: u(i),
        speed: speed(a, b),
        acceleration,
        kind: model.tests[t].test.kind,
        test: model.tests[t].index,
    }
}
