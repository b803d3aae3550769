//! Effects of the tissue: decorators around the bulk law, in the order of their rank.

mod fiber_damage;
mod fiber_recruitment;
mod mullins;
mod permanent_set;
mod stiffness_drift;
mod symmetric;
mod tangent;
mod viscoelastic;

pub use fiber_damage::FiberDamage;
pub use fiber_recruitment::FiberRecruitment;
pub use mullins::Mullins;
pub use permanent_set::PermanentSet;
pub use stiffness_drift::StiffnessDrift;
pub use viscoelastic::Viscoelastic;

use crate::numeric::difference;
use constitutive::{FibreFamily, Law, Part, PointLaw, Response, Scalar, part_response};
use model::Bulk;

/// The part of the volume of a law's stress; `None` where the law does not split.
fn volumetric_of(inner: &Bulk) -> Option<Part> {
    inner.offers().bulk.and_then(|b| b.volumetric)
}

/// The fibre families of a law; empty where it has none.
fn fibres_of(inner: &Bulk) -> Vec<FibreFamily> {
    inner.offers().bulk.map(|b| b.fibres).unwrap_or_default()
}

/// What is left of a bulk response without the volumetric part of the base law, MPa.
///
/// The base law's parameters stand first in every composed list, so the part finds its own in it.
fn isochoric<S: Scalar>(
    volumetric: Option<&Part>,
    gradient: &[S; 9],
    base: &[S],
    response: &Response<S, 9>,
) -> Response<S, 9>
where
    dyn PointLaw<9>: Law<S, 9>,
{
    match volumetric {
        Some(part) => difference(response, &part_response(part, gradient, base)),
        None => *response,
    }
}
