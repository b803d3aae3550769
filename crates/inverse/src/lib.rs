#![doc = include_str!("../README.md")]

mod acceleration;
mod allowing;
mod asymmetric;
mod covariance;
mod data;
mod fit;
mod half_width;
mod halton;
mod linalg;
mod mapped;
mod multistart;
mod outcome;
mod problem;
mod profile;
mod quality;
mod random;
mod sloppy;
mod staged;
mod step;
mod step_control;
mod whiten;

pub use asymmetric::Probe;
pub use covariance::{Estimate, Identifiability, Uncertainty, uncertainty};
pub use data::{Block, Data, DataError, NoiseModel, correlation_at};
pub use fit::fit;
pub use half_width::Z95;
pub use halton::halton;
pub use mapped::{Mapped, MappedOptions, fit_mapped};
pub use multistart::{MultiStart, Spread, Starts, multi_start, starts};
pub use outcome::{Fit, FitError, FitOptions, Iterate, Objective, StopReason};
pub use problem::{Free, PredictError, Prediction, Prior, Problem};
pub use profile::{Fixed, ProfilePoint, profile, profile_interval};
pub use quality::{BlockQuality, Quality, aicc, bic, orthonormal, quality, rms};
pub use random::Random;
pub use staged::{Held, held_gain, staged_uncertainty};
pub use whiten::{Noise, Whitened, Whitener};
