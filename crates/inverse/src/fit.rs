//! Bounded Levenberg–Marquardt with a true-objective acceptance test.
//!
//! Marquardt's scaling (a fit does not depend on the units of a parameter), steps as long as the trials
//! before them allow (`step_control`) and accelerated along the valley they follow (`acceleration`), what a
//! large misfit adds to the curvature where that foretells steps better (`curvature`), an active set for the
//! bounds, and a box around each step in the transformed coordinates, so that a direction that the data
//! do not fix (a *sloppy* one, Transtrum, Machta & Sethna 2011) cannot run to infinity.

use crate::acceleration::accelerated_step;
use crate::course::Course;
use crate::linalg::Reduced;
use crate::step::{StepBox, bounded_step, length, moves};
use crate::whiten::{Whitened, Whitener};
use crate::{
    Data, Fit, FitError, FitOptions, Free, Iterate, Objective, PredictError, Prediction, Problem, StopReason,
};
use nalgebra::DVector;
use std::ops::ControlFlow;

/// One evaluated point of the search.
pub(crate) struct State {
    pub z: DVector<f64>,
    pub theta: Vec<f64>,
    pub f: f64,
    prediction: Prediction,
    pub system: Option<System>,
}

/// The linearised problem at a point.
pub(crate) struct System {
    pub whitened: Whitened,
    pub reduced: Reduced,
    /// Marquardt's scale: diagonal of JᵀJ.
    pub scale: DVector<f64>,
    /// The same with what is known of the curvature besides, where that says more.
    pub curved: Option<Reduced>,
}

impl System {
    /// What steps are taken by.
    fn model(&self) -> &Reduced {
        self.curved.as_ref().unwrap_or(&self.reduced)
    }
}

pub(crate) enum Failure {
    Model(PredictError),
    Fatal(FitError),
}

pub(crate) struct Search<'a> {
    problem: &'a dyn Problem,
    pub data: &'a Data,
    pub free: &'a [Free],
    pub options: &'a FitOptions,
    objective_map: Whitener,
    runs: usize,
    history: Vec<Iterate>,
}

/// Minimises the objective from the start values of `free`.
///
/// `observer` sees every model run in order and may end the search with `ControlFlow::Break`.
///
/// # Errors
/// [`FitError`] when the description is faulty or the model cannot be computed at the start. A model
/// that fails later only shortens the step.
pub fn fit(
    problem: &dyn Problem,
    data: &Data,
    free: &[Free],
    options: &FitOptions,
    observer: &mut dyn FnMut(&Iterate) -> ControlFlow<()>,
) -> Result<Fit, FitError> {
    data.check()?;
    if let Some(fault) = free.iter().find_map(Free::fault) {
        return Err(FitError::Parameter(fault));
    }
    let objective_map = Whitener::new(data, None, options.objective.noise());
    let mut search = Search { problem, data, free, options, objective_map, runs: 0, history: Vec::new() };
    search.run(observer)
}

/// All points' misfit and the priors' rows.
fn sum(map: &Whitener, data: &Data, prediction: &Prediction, whitened: &Whitened) -> f64 {
    let priors = whitened.r.rows(whitened.rows.len(), whitened.prior_rows).norm_squared();
    map.apply(&data.misfit(&prediction.values)).norm_squared() + priors
}

/// The objective at a prediction.
pub(crate) fn objective(
    data: &Data,
    free: &[Free],
    theta: &[f64],
    prediction: &Prediction,
    objective: Objective,
) -> f64 {
    let whitened = Whitened::new(data, free, theta, prediction, objective.noise());
    sum(&Whitener::new(data, None, objective.noise()), data, prediction, &whitened)
}

/// Trials of one step whose predicted reduction may be next to nothing.
const FEW_TRIALS: usize = 5;

impl Search<'_> {
    fn run(&mut self, observer: &mut dyn FnMut(&Iterate) -> ControlFlow<()>) -> Result<Fit, FitError> {
        let z0 = DVector::from_iterator(self.free.len(), self.free.iter().map(|f| f.forward(f.start)));
        // The values as given: through their coordinate and back the last bit may be another.
        let start = self.free.iter().map(|f| f.start.clamp(f.lower, f.upper)).collect();
        let mut state = match self.evaluate_at(start, z0, true) {
            Ok(state) => state,
            Err(Failure::Model(e)) => return Err(FitError::Start(e)),
            Err(Failure::Fatal(e)) => return Err(e),
        };
        if self.record(0, Ok(&state), true, 0.0, observer).is_break() {
            return Ok(self.finish(state, 0, StopReason::Stopped));
        }
        if self.free.is_empty() {
            return Ok(self.finish(state, 0, StopReason::NothingFree));
        }
        let mut course = Course::begin(self.options, self.free.len());
        let (arrived, stopped) = self.arrive(state, &mut course, observer)?;
        state = arrived;
        if let Some(reason) = stopped {
            return Ok(self.finish(state, 0, reason));
        }
        let zero = 1e-24 * self.objective_map.apply(&self.data.measured()).norm_squared();
        for iteration in 1..=self.options.max_iterations {
            if state.f <= zero {
                return Ok(self.finish(state, iteration - 1, StopReason::Exact));
            }
            if self.predicted_reduction(&state) <= 1e-3 * self.options.tolerance {
                return Ok(self.finish(state, iteration - 1, StopReason::Stationary));
            }
            let (end, taken) =
                match self.advance(&state, iteration, self.options.max_trials, &mut course, observer)? {
                    Advance::To(next) => (self.take(&mut state, *next, &mut course), iteration),
                    Advance::Stop(None, StopReason::NoDescent) if self.settled(&state) => {
                        (Some(StopReason::Stationary), iteration - 1)
                    }
                    Advance::Stop(None, StopReason::NoDescent) => {
                        (Some(StopReason::NoDescent), iteration - 1)
                    }
                    Advance::Stop(best, reason) => {
                        let taken = iteration - usize::from(best.is_none());
                        return Ok(self.finish(best.map_or(state, |b| *b), taken, reason));
                    }
                };
            let Some(reason) = end else { continue };
            if !self.is_stuck(&state, reason) {
                return Ok(self.finish(state, taken, reason));
            }
            match self.look_around(&state, iteration, observer)? {
                Advance::To(next) => {
                    state = *next;
                    course = Course::begin(self.options, self.free.len());
                }
                Advance::Stop(best, why) => {
                    let reason = if why == StopReason::Stopped { why } else { reason };
                    let taken = if best.is_some() { iteration } else { taken };
                    return Ok(self.finish(best.map_or(state, |b| *b), taken, reason));
                }
            }
        }
        let n = self.options.max_iterations;
        let reason = if state.f <= zero { StopReason::Exact } else { StopReason::MaxIterations };
        Ok(self.finish(state, n, reason))
    }

    /// Predicted relative reduction of an almost undamped step.
    pub(crate) fn predicted_reduction(&self, state: &State) -> f64 {
        state.system.as_ref().map_or(0.0, |own| {
            let (system, d) = (own.model(), &own.scale);
            // In a sloppy valley the undamped step ends on many edges of its box and may predict
            // no reduction; a damped one then still does.
            let space = self.step_box(state);
            let predicted =
                [1e-10, 1e-6, 1e-3, 1.0].map(|lambda| bounded_step(system, d, lambda, &space).predicted);
            let predicted = predicted.into_iter().fold(0.0, f64::max);
            if state.f > 0.0 { predicted / state.f } else { 0.0 }
        })
    }

    /// Tries steps, shorter and shorter, until one lowers the objective.
    pub(crate) fn advance(
        &mut self,
        state: &State,
        iteration: usize,
        trials: usize,
        Course { control, last, .. }: &mut Course,
        observer: &mut dyn FnMut(&Iterate) -> ControlFlow<()>,
    ) -> Result<Advance, FitError> {
        let Some(own) = &state.system else {
            return Err(FitError::Contract("no jacobian although it was asked for".into()));
        };
        let (whitened, system, d) = (&own.whitened, own.model(), &own.scale);
        // The curvature holds what the last step says.
        let last = last.as_ref().filter(|_| own.curved.is_none());
        let space = self.step_box(state);
        for trial in 0..trials {
            let mut step = control.step(system, d, &space);
            let defect = last.and_then(|l| l.defect(whitened, d, &step.dz));
            if let Some(accelerated) =
                defect.and_then(|q| accelerated_step(whitened, d, control.lambda, &space, &step.dz, &q))
            {
                step = accelerated;
            }
            let (lambda, far) = (control.lambda, length(&step.dz, d));
            // Many trials are for steps that predict a reduction.
            let worth = self.options.tolerance * if trial < FEW_TRIALS { 1e-3 } else { 1.0 };
            if step.predicted <= worth * state.f || !moves(&state.z, &step.dz) {
                break;
            }
            match self.evaluate(&state.z + &step.dz, self.options.jacobian_with_trial) {
                Ok(next) if next.f < state.f => {
                    control.learn(step.predicted, Some(state.f - next.f), far);
                    let flow = self.record(iteration, Ok(&next), true, lambda, observer);
                    let next = self.with_jacobian(next)?;
                    return Ok(match (flow, next) {
                        (ControlFlow::Continue(()), Ok(next)) => Advance::To(Box::new(next)),
                        (_, Ok(next)) => Advance::Stop(Some(Box::new(next)), StopReason::Stopped),
                        (_, Err(_)) => Advance::Stop(None, StopReason::NoDescent),
                    });
                }
                Ok(next) => {
                    control.learn(step.predicted, Some(state.f - next.f), far);
                    if self.record(iteration, Ok(&next), false, lambda, observer).is_break() {
                        return Ok(Advance::Stop(None, StopReason::Stopped));
                    }
                }
                Err(Failure::Fatal(e)) => return Err(e),
                Err(Failure::Model(e)) => {
                    control.learn(step.predicted, None, far);
                    let theta = self.physical(&(&state.z + &step.dz));
                    let flow = self.record(iteration, Err(theta), false, lambda, observer);
                    if flow.is_break() || e == PredictError::Interrupted {
                        return Ok(Advance::Stop(None, StopReason::Stopped));
                    }
                }
            }
        }
        Ok(Advance::Stop(None, StopReason::NoDescent))
    }

    /// The jacobian at an accepted point, where the trial was run without.
    fn with_jacobian(&mut self, state: State) -> Result<Result<State, PredictError>, FitError> {
        if state.system.is_some() {
            return Ok(Ok(state));
        }
        match self.evaluate(state.z, true) {
            Ok(state) => Ok(Ok(state)),
            Err(Failure::Model(e)) => Ok(Err(e)),
            Err(Failure::Fatal(e)) => Err(e),
        }
    }

    pub(crate) fn physical(&self, z: &DVector<f64>) -> Vec<f64> {
        self.free.iter().zip(z.iter()).map(|(f, &z)| f.backward(z)).collect()
    }

    fn step_box(&self, state: &State) -> StepBox {
        let p = self.free.len();
        let (mut lower, mut upper) = (DVector::zeros(p), DVector::zeros(p));
        for (k, f) in self.free.iter().enumerate() {
            let (lo, hi) = f.bounds_z();
            let bounded = (f.upper - f.lower).is_finite() || f.transform != params::Transform::Identity;
            let radius =
                if bounded { self.options.max_step * f.natural_scale(state.theta[k]) } else { f64::INFINITY };
            lower[k] = (lo - state.z[k]).max(-radius).min(0.0);
            upper[k] = (hi - state.z[k]).min(radius).max(0.0);
        }
        StepBox { lower, upper }
    }

    pub(crate) fn evaluate(&mut self, z: DVector<f64>, jacobian: bool) -> Result<State, Failure> {
        self.evaluate_at(self.physical(&z), z, jacobian)
    }

    /// At values whose coordinates are `z`.
    fn evaluate_at(&mut self, theta: Vec<f64>, z: DVector<f64>, jacobian: bool) -> Result<State, Failure> {
        self.runs += 1;
        let prediction = self.problem.predict(&theta, jacobian).map_err(Failure::Model)?;
        check_prediction(&prediction, self.data.points(), self.free.len(), jacobian)
            .map_err(Failure::Fatal)?;
        if prediction.values.iter().any(|v| !v.is_finite()) {
            return Err(not_finite("prediction"));
        }
        if prediction.jacobian.as_ref().is_some_and(|j| j.iter().any(|v| !v.is_finite())) {
            return Err(not_finite("jacobian"));
        }
        let whitened =
            Whitened::new(self.data, self.free, &theta, &prediction, self.options.objective.noise());
        let f = sum(&self.objective_map, self.data, &prediction, &whitened);
        let system = prediction.jacobian.is_some().then(|| {
            let d = DVector::from_iterator(
                theta.len(),
                whitened.jacobian.column_iter().map(|c| {
                    let s = c.norm_squared();
                    if s > 0.0 { s } else { 1.0 }
                }),
            );
            let reduced = Reduced::new(&whitened.jacobian, &whitened.r);
            System { reduced, scale: d, whitened, curved: None }
        });
        Ok(State { z, theta, f, prediction, system })
    }

    pub(crate) fn record(
        &mut self,
        iteration: usize,
        state: Result<&State, Vec<f64>>,
        accepted: bool,
        damping: f64,
        observer: &mut dyn FnMut(&Iterate) -> ControlFlow<()>,
    ) -> ControlFlow<()> {
        let (f, theta) = match state {
            Ok(s) => (Some(s.f), s.theta.clone()),
            Err(theta) => (None, theta),
        };
        let iterate = Iterate { iteration, f, theta, accepted, damping };
        let flow = observer(&iterate);
        self.history.push(iterate);
        flow
    }

    fn finish(&mut self, state: State, iterations: usize, stop: StopReason) -> Fit {
        let at_bound = self.free.iter().zip(&state.theta).map(|(f, &x)| f.at_bound(x)).collect();
        Fit {
            theta: state.theta,
            f: state.f,
            prediction: state.prediction,
            at_bound,
            objective: self.options.objective,
            iterations,
            forward_runs: self.runs,
            stop,
            history: std::mem::take(&mut self.history),
        }
    }
}

pub(crate) enum Advance {
    To(Box<State>),
    Stop(Option<Box<State>>, StopReason),
}

fn not_finite(what: &str) -> Failure {
    Failure::Model(PredictError::NotComputable(format!("the {what} holds a number that is not finite")))
}

fn check_prediction(prediction: &Prediction, n: usize, p: usize, jacobian: bool) -> Result<(), FitError> {
    let wrong = |text: String| Err(FitError::Contract(text));
    if prediction.values.len() != n {
        return wrong(format!("{} predicted numbers for {n} points", prediction.values.len()));
    }
    if prediction.valid.as_ref().is_some_and(|v| v.len() != n) {
        return wrong("the mask of valid points has another length than the prediction".into());
    }
    match &prediction.jacobian {
        Some(j) if j.shape() != (n, p) => {
            wrong(format!("a jacobian of {} by {}, expected {n} by {p}", j.nrows(), j.ncols()))
        }
        None if jacobian => wrong("no jacobian although it was asked for".into()),
        _ => Ok(()),
    }
}
