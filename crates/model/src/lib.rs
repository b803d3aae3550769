//! Builds the finite-element model of a specimen and predicts its records.
//!
//! [`Model::new`] turns a case (geometry, tests, parameters, effects) into one finite-element
//! problem per test with one common parameter vector; [`Model::run`] runs the tests (bulk history
//! carries over within a piece of tissue), [`Model::series`] gives the channels at the rows of a
//! record with their derivatives; [`effect`] is what an effect implements.

mod build;
pub mod camera;
mod catalogue;
pub mod cost;
pub mod effect;
mod plan;
mod predict;

pub use build::{BuildError, Discretisation, Model, TestModel};
pub use catalogue::{CLAMPED_ENDS, Catalogue, FLAT_SHEET, ONE_AXIS, TEARING};
pub use effect::{
    Action, Bulk, Card, Effect, Interface, Link, Mount, Options, Piece, Reading, Sample, Scales, Screening,
    Sensor, Shape, Sided, Site,
};
pub use plan::{
    Corner, Place, Plan, RunIndex, Stencil, Stepping, corner_rows, corners_of_protocol, corners_of_record,
    encoder_noise, plan, plan_simulation,
};
pub use predict::{Channel, LONG_REST, Request, RunOptions, Series, TestRun};
