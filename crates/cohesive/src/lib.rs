#![doc = include_str!("../README.md")]

mod envelope;
mod irreversible;
mod law;

pub use envelope::{
    SEPARATION_DAMAGE, damage, delta_c, dissipated, effective_opening, envelope, initial_stiffness,
    secant_stiffness, separated, work,
};
pub use irreversible::{Curve, Irreversible};
pub use law::{Cohesive, DELTA_MAX, GC, LAMBDA, PARAMETERS, PENALTY, SIGMA_C, common_parameters};
