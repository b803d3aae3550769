//! Effects of the tissue: decorators around the bulk law, in the order of their rank.

mod base;
mod by_hand;
mod fiber_damage;
mod fiber_recruitment;
mod mullins;
mod permanent_set;
mod stiffness_drift;
mod symmetric;
mod viscoelastic;

pub use fiber_damage::FiberDamage;
pub use fiber_recruitment::FiberRecruitment;
pub use mullins::Mullins;
pub use permanent_set::PermanentSet;
pub use stiffness_drift::StiffnessDrift;
pub use viscoelastic::Viscoelastic;

use crate::numeric::difference;
use constitutive::{Response, Scalar};

/// What is left of a bulk response without the volumetric term of the base law, MPa.
///
/// The base law's parameters stand first in every composed list, so D is where `hgo` says.
fn isochoric<S: Scalar>(gradient: &[S; 9], base: &[S], response: &Response<S, 9>) -> Response<S, 9> {
    difference(response, &hgo::volumetric(gradient, base[hgo::D]))
}
