//! Effects of the tear path: decorators around the cohesive law, in the order of their rank.

mod bridging;
mod crack_friction;
mod fatigue;
mod heterogeneity;
mod law_shape;
mod rate_dependent_strength;
mod residual_opening;

pub use bridging::Bridging;
pub use crack_friction::CrackFriction;
pub use fatigue::Fatigue;
pub use heterogeneity::Heterogeneity;
pub use law_shape::LawShape;
pub use rate_dependent_strength::RateDependentStrength;
pub use residual_opening::ResidualOpening;

use crate::numeric::plus;
use constitutive::{Response, Scalar};

/// Effective traction t of a response: its work on the opening is t dδ.
///
/// The penalty in closing is left out: it is no part of the irreversible law.
fn effective_traction<S: Scalar>(force: &[S; 3], opening: &[S; 3], delta: S) -> S {
    if delta.value() == 0.0 {
        return S::zero();
    }
    let normal = if opening[0].value() > 0.0 { force[0] * opening[0] } else { S::zero() };
    (normal + force[1] * opening[1] + force[2] * opening[2]) / delta
}

/// Multiplies the irreversible traction and its energy; the penalty in closing stays.
fn scale<S: Scalar>(r: &mut Response<S, 3>, opening: &[S; 3], penalty: S, factor: S) {
    let mut closing = S::zero();
    if opening[0].value() < 0.0 {
        closing = penalty * opening[0] * opening[0] * 0.5;
    } else {
        r.force[0] = r.force[0] * factor;
    }
    r.force[1] = r.force[1] * factor;
    r.force[2] = r.force[2] * factor;
    r.energy = plus(r.energy, (r.energy - closing) * (factor - 1.0));
}

/// Adds a traction of secant stiffness `k` in the manner of the base law, T = k (⟨δn⟩ n + λ² δs).
fn add_secant<S: Scalar>(r: &mut Response<S, 3>, opening: &[S; 3], lambda: S, delta: S, k: S) {
    if opening[0].value() >= 0.0 {
        r.force[0] = plus(r.force[0], k * opening[0]);
    }
    let tangential = k * (lambda * lambda);
    r.force[1] = plus(r.force[1], tangential * opening[1]);
    r.force[2] = plus(r.force[2], tangential * opening[2]);
    r.energy = plus(r.energy, k * delta * delta * 0.5);
}
