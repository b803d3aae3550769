//! What can go wrong in an element or a step.

use thiserror::Error;

/// Why an element could not be evaluated.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum ElementFault {
    /// The element is turned inside out.
    #[error("element {element} is inverted (J = {jacobian:.3e})")]
    Inverted {
        /// Element number, from 0.
        element: usize,
        /// Volume ratio at the worst point.
        jacobian: f64,
    },
    /// The law gave a number that is not finite (overflow of the exponential).
    #[error("the bulk law overflows in element {element} (largest stretch {stretch:.3})")]
    Overflow {
        /// Element number, from 0.
        element: usize,
        /// Largest stretch along an axis at the faulty point.
        stretch: f64,
    },
    /// The interface law gave a number that is not finite.
    #[error("the interface law gives no finite traction in cohesive element {element}")]
    Interface {
        /// Cohesive element number, from 0.
        element: usize,
    },
}

/// Why a run could not go on.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum FemError {
    /// An element fault that cutting the step did not cure.
    #[error("{0}")]
    Element(#[from] ElementFault),
    /// Newton's method did not converge at the smallest step.
    #[error(
        "no equilibrium found at displacement {displacement:.6} mm (step cut to {step:.1e} mm): {reason}"
    )]
    NoConvergence {
        /// Actuator displacement, mm.
        displacement: f64,
        /// Smallest step tried, mm.
        step: f64,
        /// What the last attempt ran into.
        reason: String,
    },
    /// The tangent could not be factorised or solved with a small residual.
    #[error("the tangent is singular")]
    Singular,
    /// A problem that was put together wrongly.
    #[error("{0}")]
    Setup(String),
}
