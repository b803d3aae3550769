//! Bounded Levenberg–Marquardt with a true-objective acceptance test.
//!
//! Marquardt's scaling (a fit does not depend on the units of a parameter), Nielsen's gain-ratio
//! damping (IMM-REP-1999-05), an active set for the bounds, and a box around each step in the
//! transformed coordinates, so that a direction that the data do not fix (a *sloppy* one, Transtrum,
//! Machta & Sethna 2011) cannot run to infinity.

use crate::linalg::Reduced;
use crate::step::{Step, StepBox, bounded_step};
use crate::whiten::{Noise, Whitened, Whitener};
use crate::{Data, DataError, Free, PredictError, Prediction, Problem};
use nalgebra::DVector;
use serde::Serialize;
use std::ops::ControlFlow;
use thiserror::Error;

/// What is minimised.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub enum Objective {
    /// The paper's f = Σ (Fp − Fe)², every point alike. Priors, where given, count with the mean noise sd.
    PaperSum,
    /// χ² with the noise model: rᵀΣ⁻¹r plus priors.
    Whitened,
}

impl Objective {
    pub(crate) fn noise(self) -> Noise {
        match self {
            Self::PaperSum => Noise::None,
            Self::Whitened => Noise::Total,
        }
    }
}

/// How to fit. [`Default`] is the paper's tolerance and 30 iterations on the whitened objective.
#[derive(Clone, Debug, PartialEq)]
pub struct FitOptions {
    /// What is minimised.
    pub objective: Objective,
    /// Stop when the relative change of f falls below this.
    pub tolerance: f64,
    /// Largest number of accepted steps.
    pub max_iterations: usize,
    /// Largest number of trials for one step.
    pub max_trials: usize,
    /// First damping, relative to the diagonal of JᵀJ.
    pub initial_damping: f64,
    /// Largest change of one transformed coordinate in one step, in natural scales
    /// ([`Free::natural_scale`]); 1.5 is a factor 4.5 for `Log`.
    pub max_step: f64,
    /// Ask for the jacobian with each trial (cheap when sensitivities cost little beside the run);
    /// otherwise a second run follows each accepted trial.
    pub jacobian_with_trial: bool,
}

impl Default for FitOptions {
    fn default() -> Self {
        Self {
            objective: Objective::Whitened,
            tolerance: 1e-6,
            max_iterations: 30,
            max_trials: 20,
            initial_damping: 1e-3,
            max_step: 1.5,
            jacobian_with_trial: true,
        }
    }
}

/// One model run of the search: the start (iteration 0) or a trial step.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Iterate {
    /// Number of the step that was tried, 0 at the start.
    pub iteration: usize,
    /// Objective; `None` where the model could not be computed.
    pub f: Option<f64>,
    /// Parameters, physical units.
    pub theta: Vec<f64>,
    /// Whether the search went there.
    pub accepted: bool,
    /// Damping of the step.
    pub damping: f64,
}

/// Why the search ended.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub enum StopReason {
    /// The relative change of f fell below the tolerance.
    Converged,
    /// The linear model promises no further fall: an optimum within bounds.
    Stationary,
    /// f is zero within rounding.
    Exact,
    /// f creeps: three steps in a row changed it by less than the tolerance, though the linear model
    /// promises more (a sloppy valley).
    Flat,
    /// No trial lowered f, though the linear model promises a fall (an objective rougher than its derivative).
    NoDescent,
    /// The largest number of iterations was reached.
    MaxIterations,
    /// Stopped from outside (callback or interrupted model); the best iterate is returned.
    Stopped,
    /// No parameter is free.
    NothingFree,
}

impl StopReason {
    /// Whether the iterate may be taken for a local optimum.
    pub fn converged(&self) -> bool {
        matches!(self, Self::Converged | Self::Stationary | Self::Exact | Self::Flat | Self::NothingFree)
    }

    /// The reason as a sentence.
    pub fn sentence(&self) -> &'static str {
        match self {
            Self::Converged => "The relative change of f fell below the tolerance.",
            Self::Stationary => "No direction within the bounds lowers f any further.",
            Self::Exact => "The model reproduces the data to rounding.",
            Self::Flat => {
                "f changes by less than the tolerance from step to step along a direction that the data hardly fix."
            }
            Self::NoDescent => {
                "No shorter step lowers f although its derivative promises so: f is rough here (a jump moves, or the model's accuracy is reached)."
            }
            Self::MaxIterations => "The largest number of iterations was reached before f settled.",
            Self::Stopped => "The search was stopped from outside; the best parameters so far are given.",
            Self::NothingFree => "No parameter is free, so there was nothing to search.",
        }
    }
}

/// The end of a search.
#[derive(Clone, Debug)]
pub struct Fit {
    /// Best parameters, physical units.
    pub theta: Vec<f64>,
    /// Objective there.
    pub f: f64,
    /// Prediction there, with its jacobian.
    pub prediction: Prediction,
    /// Parameters that stand at a bound.
    pub at_bound: Vec<bool>,
    /// What was minimised.
    pub objective: Objective,
    /// Accepted steps.
    pub iterations: usize,
    /// Model runs.
    pub forward_runs: usize,
    /// Why it ended.
    pub stop: StopReason,
    /// Every run in order.
    pub history: Vec<Iterate>,
}

/// Why a fit could not begin or go on.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum FitError {
    /// The data are described wrongly.
    #[error(transparent)]
    Data(#[from] DataError),
    /// A parameter is described wrongly.
    #[error("{0}")]
    Parameter(String),
    /// No start: the model cannot be computed at the start values.
    #[error("no fit from these start values: {0}")]
    Start(PredictError),
    /// The model broke its promise (wrong length, no jacobian, numbers that are not finite).
    #[error("the model's answer cannot be used: {0}")]
    Contract(String),
}

/// One evaluated point of the search.
struct State {
    z: DVector<f64>,
    theta: Vec<f64>,
    f: f64,
    prediction: Prediction,
    system: Option<(Reduced, DVector<f64>)>,
}

enum Failure {
    Model(PredictError),
    Fatal(FitError),
}

struct Search<'a, P: Problem + ?Sized> {
    problem: &'a P,
    data: &'a Data,
    free: &'a [Free],
    options: &'a FitOptions,
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
pub fn fit<P: Problem + ?Sized>(
    problem: &P,
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
    let mut search =
        Search { problem, data, free, options, objective_map, runs: 0, history: Vec::new() };
    search.run(observer)
}

impl<P: Problem + ?Sized> Search<'_, P> {
    fn run(&mut self, observer: &mut dyn FnMut(&Iterate) -> ControlFlow<()>) -> Result<Fit, FitError> {
        let z0 = DVector::from_iterator(self.free.len(), self.free.iter().map(|f| f.forward(f.start)));
        let mut state = match self.evaluate(z0, true) {
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
        let zero = 1e-24 * self.objective_map.apply(&self.data.measured()).norm_squared();
        let mut damping = Damping::new(self.options.initial_damping);
        let mut small = 0;
        for iteration in 1..=self.options.max_iterations {
            if state.f <= zero {
                return Ok(self.finish(state, iteration - 1, StopReason::Exact));
            }
            if self.promise(&state) <= 1e-3 * self.options.tolerance {
                return Ok(self.finish(state, iteration - 1, StopReason::Stationary));
            }
            let next = match self.advance(&state, iteration, &mut damping, observer)? {
                Advance::To(next) => *next,
                Advance::Stop(best, reason) => {
                    let taken = iteration - usize::from(best.is_none());
                    return Ok(self.finish(best.map_or(state, |b| *b), taken, reason));
                }
            };
            let change = (state.f - next.f) / state.f;
            state = next;
            if change < self.options.tolerance {
                small += 1;
                if self.promise(&state) < 10.0 * self.options.tolerance {
                    return Ok(self.finish(state, iteration, StopReason::Converged));
                }
                if small >= 3 {
                    return Ok(self.finish(state, iteration, StopReason::Flat));
                }
            } else {
                small = 0;
            }
        }
        let n = self.options.max_iterations;
        let reason = if state.f <= zero { StopReason::Exact } else { StopReason::MaxIterations };
        Ok(self.finish(state, n, reason))
    }

    /// Relative fall that an almost undamped step promises.
    fn promise(&self, state: &State) -> f64 {
        state.system.as_ref().map_or(0.0, |(system, d)| {
            let step = bounded_step(system, d, 1e-10, &self.step_box(state));
            if state.f > 0.0 { step.fall / state.f } else { 0.0 }
        })
    }

    /// Tries steps, shorter and shorter, until one lowers the objective.
    fn advance(
        &mut self,
        state: &State,
        iteration: usize,
        damping: &mut Damping,
        observer: &mut dyn FnMut(&Iterate) -> ControlFlow<()>,
    ) -> Result<Advance, FitError> {
        let Some((system, d)) = &state.system else {
            return Err(FitError::Contract("no jacobian although it was asked for".into()));
        };
        let space = self.step_box(state);
        damping.shorten = (2.0 * damping.shorten).min(1.0);
        for _ in 0..self.options.max_trials {
            let lambda = damping.lambda;
            let step = scaled(bounded_step(system, d, lambda, &space), damping.shorten, system);
            if step.fall <= 0.0 || !moves(&state.z, &step.dz) {
                break;
            }
            let trial = self.evaluate(&state.z + &step.dz, self.options.jacobian_with_trial);
            match trial {
                Ok(next) if next.f < state.f => {
                    damping.accept((state.f - next.f) / step.fall);
                    let flow = self.record(iteration, Ok(&next), true, lambda, observer);
                    let next = self.with_jacobian(next)?;
                    return Ok(match (flow, next) {
                        (ControlFlow::Continue(()), Ok(next)) => Advance::To(Box::new(next)),
                        (_, Ok(next)) => Advance::Stop(Some(Box::new(next)), StopReason::Stopped),
                        (_, Err(_)) => Advance::Stop(None, StopReason::NoDescent),
                    });
                }
                Ok(next) => {
                    damping.reject();
                    if self.record(iteration, Ok(&next), false, lambda, observer).is_break() {
                        return Ok(Advance::Stop(None, StopReason::Stopped));
                    }
                }
                Err(Failure::Fatal(e)) => return Err(e),
                Err(Failure::Model(e)) => {
                    damping.shorten *= 0.25;
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

    fn physical(&self, z: &DVector<f64>) -> Vec<f64> {
        self.free.iter().zip(z.iter()).map(|(f, &z)| f.backward(z)).collect()
    }

    fn step_box(&self, state: &State) -> StepBox {
        let p = self.free.len();
        let (mut lower, mut upper) = (DVector::zeros(p), DVector::zeros(p));
        for (k, f) in self.free.iter().enumerate() {
            let (lo, hi) = f.bounds_z();
            let bounded = (f.upper - f.lower).is_finite() || f.transform != params::Transform::Identity;
            let reach = if bounded {
                self.options.max_step * f.natural_scale(state.theta[k])
            } else {
                f64::INFINITY
            };
            lower[k] = (lo - state.z[k]).max(-reach).min(0.0);
            upper[k] = (hi - state.z[k]).min(reach).max(0.0);
        }
        StepBox { lower, upper }
    }

    fn evaluate(&mut self, z: DVector<f64>, jacobian: bool) -> Result<State, Failure> {
        self.runs += 1;
        let theta = self.physical(&z);
        let prediction = self.problem.predict(&theta, jacobian).map_err(Failure::Model)?;
        check_prediction(&prediction, self.data.points(), self.free.len(), jacobian)
            .map_err(Failure::Fatal)?;
        if prediction.values.iter().any(|v| !v.is_finite()) {
            return Err(not_finite("prediction"));
        }
        if prediction.jacobian.as_ref().is_some_and(|j| j.iter().any(|v| !v.is_finite())) {
            return Err(not_finite("jacobian"));
        }
        let data_part = self.objective_map.apply(&self.data.misfit(&prediction.values)).norm_squared();
        let whitened =
            Whitened::new(self.data, self.free, &theta, &prediction, self.options.objective.noise());
        let m = whitened.rows.len();
        let prior_part = whitened.r.rows(m, whitened.prior_rows).norm_squared();
        let system = prediction.jacobian.is_some().then(|| {
            let d = DVector::from_iterator(
                theta.len(),
                whitened.jacobian.column_iter().map(|c| {
                    let s = c.norm_squared();
                    if s > 0.0 { s } else { 1.0 }
                }),
            );
            (Reduced::new(&whitened.jacobian, &whitened.r), d)
        });
        Ok(State { z, theta, f: data_part + prior_part, prediction, system })
    }

    fn record(
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
        let at_bound = self
            .free
            .iter()
            .zip(&state.theta)
            .map(|(f, &x)| f.at_bound(x))
            .collect();
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

enum Advance {
    To(Box<State>),
    Stop(Option<Box<State>>, StopReason),
}

/// Nielsen's damping, and how far steps are shortened where the model cannot be computed.
struct Damping {
    lambda: f64,
    growth: f64,
    shorten: f64,
}

impl Damping {
    fn new(lambda: f64) -> Self {
        Self { lambda, growth: 2.0, shorten: 1.0 }
    }

    fn accept(&mut self, gain: f64) {
        let factor = (1.0 - (2.0 * gain - 1.0).powi(3)).clamp(1.0 / 10.0, 2.0);
        self.lambda = (self.lambda * factor).max(1e-12);
        self.growth = 2.0;
    }

    fn reject(&mut self) {
        self.lambda *= self.growth;
        self.growth *= 2.0;
    }
}

fn scaled(step: Step, factor: f64, system: &Reduced) -> Step {
    if factor >= 1.0 {
        return step;
    }
    let dz = step.dz * factor;
    let fall = system.fall(&dz);
    Step { dz, fall }
}

fn moves(z: &DVector<f64>, dz: &DVector<f64>) -> bool {
    z.iter().zip(dz.iter()).any(|(z, d)| d.abs() > 1e-14 * z.abs().max(1e-300))
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
