//! Physical quantities, parameter descriptions and the transforms an optimiser works in.
//!
//! The whole workspace computes in **mm, s, N, MPa, rad**; files carry the unit in the key
//! (`mu_kPa = 5.1`). [`Quantity`] knows the internal unit and every key suffix that is accepted.

mod path;
mod quantity;
mod spec;
mod transform;

pub use path::{NoPath, Owner, ParamPath};
pub use quantity::{Quantity, Suffix};
pub use spec::{Expected, ParamSpec, Parameter, Reciprocal};
pub use transform::Transform;
