//! The answers of the commands as they are printed and stored. Field names are the contract's.
#![allow(non_snake_case)]

mod compare;
mod fitted_model;
mod identify;
mod parts;
mod path_mean;
mod remarks;
pub use remarks::{held_at_limits, weighed};
mod simulate;

pub use compare::CompareAnswer;
pub use fitted_model::{Evaluated, Evaluator, fitted_case};
pub use identify::IdentifyAnswer;
pub(crate) use identify::histories;
pub use parts::{ParameterAnswer, PublishedSummary, StageEnd, StageHistory, TestFit, Trial};
pub use path_mean::PathMean;
pub use simulate::{EnergyAnswer, JumpAnswer, SimulateAnswer, SolverAnswer, TestCurve};

/// Version of the answers' layout.
pub const SCHEMA: u32 = 1;

/// A number that JSON can hold.
pub(crate) fn finite(x: f64) -> Option<f64> {
    x.is_finite().then_some(x)
}
