//! Quasi-static finite elements with memory, for strips that are pulled and torn.
//!
//! Mean-dilatation bricks ([`hex8`]), zero-thickness interface elements ([`interface`]), a load
//! train in series, Newton with adaptive steps ([`run_steps`]), exact turning points, jumps at limit
//! points or the equilibrium path through snap-back, an energy ledger, and sensitivities of force
//! and displacements to every parameter by direct differentiation ([`sensitivity`]).
//!
//! The crate sees laws only as [`constitutive::PointLaw`] objects: it knows no material.
// Index loops over small fixed arrays vectorise, and read like the formulas they implement.
#![allow(clippy::needless_range_loop)]

mod energy;
mod equilibrium;
mod error;
pub mod factor;
pub mod hex8;
pub mod interface;
mod newton;
mod opening;
mod path;
mod problem;
pub mod sensitivity;
mod state;
mod stepping;
mod system;
mod warm;

pub use energy::Ledger;
pub use equilibrium::Control;
pub use error::{ElementFault, FemError};
pub use newton::NewtonOptions;
pub use problem::{
    Blend, Body, CohesiveElement, Link, LocalParams, MountField, Path, Prescribed, Problem, Reaction,
    ShapeField, Waypoint,
};
pub use state::{Guess, History, State, gather4, gather8};
pub use stepping::{Jump, Kept, NoObserver, Observer, Run, StepRecord, SteppingOptions, Target, run_steps};
pub use system::{NONE, Pressures, System};
pub use warm::Warm;
