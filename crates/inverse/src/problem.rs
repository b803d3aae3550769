//! What is fitted: a model that predicts numbers from parameters, and its free parameters.

use nalgebra::{DMatrix, DVector};
use params::{Parameter, Transform};
use thiserror::Error;

/// A model seen from outside: free parameters in, predicted numbers (and their derivatives) out.
///
/// `theta` holds the values of the free parameters in physical (internal) units, in the order of
/// the [`Free`] list. The same `theta` must always give the same prediction.
pub trait Problem: Sync {
    /// Predicts all `n` numbers of the record and, if asked, the `n × p` jacobian in physical units.
    ///
    /// # Errors
    /// [`PredictError::NotComputable`] where the model has no answer: an optimiser then shortens its
    /// step. [`PredictError::Interrupted`] ends the fit with the best iterate so far.
    fn predict(&self, theta: &[f64], jacobian: bool) -> Result<Prediction, PredictError>;
}

/// A model's answer at one set of parameters.
#[derive(Clone, Debug, PartialEq)]
pub struct Prediction {
    /// Predicted numbers, length n, units of the record.
    pub values: DVector<f64>,
    /// d(values)/d(theta), n × p, physical units; present when it was asked for.
    pub jacobian: Option<DMatrix<f64>>,
    /// `false` marks points that leave the linearisation (between a jump's old and new position):
    /// they count in the objective, but not in the step nor in the covariance.
    pub valid: Option<Vec<bool>>,
}

impl Prediction {
    /// A prediction whose points all belong to the linearisation.
    pub fn new(values: DVector<f64>, jacobian: Option<DMatrix<f64>>) -> Self {
        Self { values, jacobian, valid: None }
    }
}

/// Why a model gave no prediction.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
pub enum PredictError {
    /// The model cannot be computed at these parameters; the reason in words.
    #[error("the model could not be computed: {0}")]
    NotComputable(String),
    /// The user asked to stop (Ctrl-C) while the model ran.
    #[error("interrupted while the model ran")]
    Interrupted,
}

/// A normal prior of one parameter, in the coordinate of its [`Transform`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Prior {
    /// Mean in the transformed coordinate (for `Log`: the logarithm of the median).
    pub mean: f64,
    /// Standard deviation in the transformed coordinate (for `Log`: 0.5 is about 50 %).
    pub sd: f64,
}

/// One free parameter: where it is, its admissible interval and the coordinate it is fitted in.
#[derive(Clone, Debug, PartialEq)]
pub struct Free {
    /// Path in answers: `interface.area[3].gc`.
    pub path: String,
    /// Smallest admissible value, physical unit; may be −∞ with `Transform::Identity`.
    pub lower: f64,
    /// Largest admissible value, physical unit; may be +∞ with `Identity` and `Log`.
    pub upper: f64,
    /// Coordinate z of the optimiser.
    pub transform: Transform,
    /// Start value, physical unit.
    pub start: f64,
    /// Prior knowledge, if any.
    pub prior: Option<Prior>,
}

impl Free {
    /// A free parameter without a prior.
    pub fn new(
        path: impl Into<String>,
        (lower, upper): (f64, f64),
        transform: Transform,
        start: f64,
    ) -> Self {
        Self { path: path.into(), lower, upper, transform, start, prior: None }
    }

    /// The same with a normal prior in the transformed coordinate.
    pub fn prior(mut self, mean: f64, sd: f64) -> Self {
        self.prior = Some(Prior { mean, sd });
        self
    }

    /// The free parameter that a built model's [`Parameter`] describes, starting at its present value.
    pub fn of(parameter: &Parameter) -> Self {
        let spec = &parameter.spec;
        Self::new(parameter.path.clone(), (spec.lower, spec.upper), spec.transform, parameter.value)
    }

    /// Bounds in the transformed coordinate.
    pub fn bounds_z(&self) -> (f64, f64) {
        let end = |x: f64| if x.is_finite() { self.transform.forward(x) } else { x };
        (end(self.lower), end(self.upper))
    }

    /// Transformed coordinate of a value, pulled into the bounds.
    pub fn forward(&self, x: f64) -> f64 {
        let (lo, hi) = self.bounds_z();
        self.transform.forward(x.clamp(self.lower, self.upper)).clamp(lo, hi)
    }

    /// Physical value of a transformed coordinate, pulled into the bounds (exactly onto a bound).
    pub fn backward(&self, z: f64) -> f64 {
        let (lo, hi) = self.bounds_z();
        if z <= lo {
            self.lower
        } else if z >= hi {
            self.upper
        } else {
            self.transform.backward(z).clamp(self.lower, self.upper)
        }
    }

    /// A plausible change of the transformed coordinate: 1 for `Log` and `Logit` (a factor e); for
    /// `Identity` half the admissible interval, else the prior's sd, else the size of `value` (or 1).
    pub fn natural_scale(&self, value: f64) -> f64 {
        match self.transform {
            Transform::Log | Transform::Logit { .. } => 1.0,
            Transform::Identity => {
                let half = 0.5 * (self.upper - self.lower);
                if half.is_finite() && half > 0.0 {
                    half
                } else if let Some(prior) = self.prior {
                    prior.sd
                } else if value != 0.0 {
                    value.abs()
                } else {
                    1.0
                }
            }
        }
    }

    /// Whether a value stands at a bound: exactly for `Identity`, within 0.1 % of the bound for `Log`,
    /// within 0.1 % of the interval for `Logit` (whose coordinate has no slope at its ends).
    pub fn at_bound(&self, x: f64) -> bool {
        match self.transform {
            Transform::Identity => x <= self.lower || x >= self.upper,
            Transform::Log => x <= self.lower * 1.001 || x >= self.upper * 0.999,
            Transform::Logit { lower, upper } => {
                let hair = 1e-3 * (upper - lower);
                x <= self.lower + hair || x >= self.upper - hair
            }
        }
    }

    /// What is wrong with this description, if anything.
    pub(crate) fn fault(&self) -> Option<String> {
        let say = |what: &str| Some(format!("parameter {}: {what}", self.path));
        if self.lower.is_nan() || self.upper.is_nan() || self.lower >= self.upper {
            return say(&format!("lower bound {} is not below upper bound {}", self.lower, self.upper));
        }
        if !self.start.is_finite() {
            return say("start value is not a finite number");
        }
        if matches!(self.transform, Transform::Log) && self.upper <= 0.0 {
            return say("a logarithmic coordinate needs a positive upper bound");
        }
        if self.prior.is_some_and(|p| !(p.mean.is_finite() && p.sd.is_finite() && p.sd > 0.0)) {
            return say("prior needs a finite mean and a positive sd");
        }
        None
    }
}
