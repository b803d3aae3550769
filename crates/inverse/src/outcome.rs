//! How a fit is asked for, and what comes back.

use crate::poll::Poll;
use crate::whiten::Noise;
use crate::{Data, DataError, PredictError, Prediction};
use serde::{Deserialize, Serialize};
use thiserror::Error;

/// What is minimised.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub enum Objective {
    /// The paper's f = Σ (Fp − Fe)², every point alike. Priors, where given, count with the mean noise sd.
    PaperSum,
    /// χ² with the whole noise model, the model's numerical error in it: rᵀΣ⁻¹r plus priors.
    Whitened,
    /// χ² with the record's noise alone, plus priors: numerical error, known only afterwards, counts in the
    /// intervals.
    Record,
}

impl Objective {
    pub(crate) fn noise(self) -> Noise {
        match self {
            Self::PaperSum => Noise::None,
            Self::Whitened => Noise::Total,
            Self::Record => Noise::Record,
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
    /// A step that changes χ² by less than this tells nothing: three in a row end the search. 0: off. Times the reduced χ²
    /// where that is above 1.
    pub insignificant: f64,
    /// Largest number of accepted steps.
    pub max_iterations: usize,
    /// Largest number of trials for one step.
    pub max_trials: usize,
    /// First damping, relative to the diagonal of JᵀJ.
    pub initial_damping: f64,
    /// Largest change of one transformed coordinate in one step, in natural scales
    /// ([`crate::Free::natural_scale`]); 1.5 is a factor 4.5 for `Log`.
    pub max_step: f64,
    /// Ask for the jacobian with each trial (cheap when sensitivities cost little beside the run);
    /// otherwise a second run follows each accepted trial.
    pub jacobian_with_trial: bool,
    /// Where no step lowers f although its derivative says so: whether, and along what, to look around.
    pub poll: Option<Poll>,
}

impl Default for FitOptions {
    fn default() -> Self {
        Self {
            objective: Objective::Whitened,
            tolerance: 1e-6,
            insignificant: 0.02,
            max_iterations: 30,
            max_trials: 20,
            initial_damping: 1e-3,
            max_step: 1.5,
            jacobian_with_trial: true,
            poll: None,
        }
    }
}

impl FitOptions {
    /// The objective that one unit of χ² stands for.
    pub(crate) fn unit(&self, data: &Data) -> f64 {
        match self.objective {
            Objective::Whitened | Objective::Record => 1.0,
            Objective::PaperSum => {
                data.blocks.iter().map(|b| b.noise.sd.powi(2)).fold(f64::INFINITY, f64::min)
            }
        }
    }

    /// What a change of χ² by 1 is at a misfit f: by the noise, or where a model leaves more than noise, by that which would
    /// explain what is left.
    pub(crate) fn worth(&self, data: &Data, f: f64) -> f64 {
        let unit = self.unit(data);
        unit.max(f / data.points().max(1) as f64)
    }
}

/// One model run of the search: the start (iteration 0) or a trial step.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
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
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum StopReason {
    /// The relative change of f fell below the tolerance.
    Converged,
    /// Nothing within bounds lowers f by a share that counts against the tolerance: an optimum.
    Stationary,
    /// f is zero within rounding.
    Exact,
    /// f creeps: three steps in a row changed it by less than the tolerance, though the linear model
    /// predicts more (a sloppy valley).
    Flat,
    /// Three steps in a row changed χ² by less than what noise could ever tell apart.
    Insignificant,
    /// No trial lowered f, though the linear model predicts a reduction (an objective rougher than its derivative).
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
        matches!(
            self,
            Self::Converged
                | Self::Stationary
                | Self::Exact
                | Self::Flat
                | Self::Insignificant
                | Self::NothingFree
        )
    }

    /// The reason as a sentence.
    pub fn sentence(&self) -> &'static str {
        match self {
            Self::Converged => "The relative change of f fell below the tolerance.",
            Self::Stationary => "No direction within the bounds lowers f any further.",
            Self::Exact => "The model reproduces the data to rounding.",
            Self::Insignificant => {
                "Three steps in a row changed χ² by less than any noise could tell apart (a sloppy valley)."
            }
            Self::Flat => {
                "f changes by less than the tolerance from step to step along a direction that the data hardly fix."
            }
            Self::NoDescent => {
                "No shorter step lowers f although its derivative predicts so: f is rough here (a jump moves, or the model's accuracy is reached)."
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

/// Why a fit could not start or go on.
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
    /// The model broke its contract (wrong length, no jacobian, numbers that are not finite).
    #[error("the model's answer cannot be used: {0}")]
    Contract(String),
}
