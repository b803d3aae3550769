//! Random deformations and parameters for the tests of the law.
#![allow(dead_code)]

use constitutive::{Context, Jet, Law, Response, Scalar, tensor, testing};
use hgo::{FibreInvariants, Hgo, PARAMETERS};
use proptest::prelude::*;

pub type Params = [f64; PARAMETERS];

/// Rotations.
pub fn rotations() -> impl Strategy<Value = [f64; 9]> {
    (-3.1f64..3.1, -3.1f64..3.1, -3.1f64..3.1).prop_map(|(a, b, c)| testing::rotation(a, b, c))
}

/// F = Q diag(λ) R with principal stretches from 0.7 to 1.6: det F > 0.
pub fn deformations() -> impl Strategy<Value = [f64; 9]> {
    (rotations(), rotations(), [0.7f64..1.6, 0.7..1.6, 0.7..1.6]).prop_map(|(q, r, [a, b, c])| {
        tensor::mul(&q, &tensor::mul(&[a, 0.0, 0.0, 0.0, b, 0.0, 0.0, 0.0, c], &r))
    })
}

/// Parameters whose exponential stays finite over [`deformations`], k2 = 0 among them.
pub fn parameters() -> impl Strategy<Value = Params> {
    (
        1e-3f64..1.0,
        0.0f64..5.0,
        prop_oneof![Just(0.0), 0.0f64..1e-6, 0.0f64..8.0],
        0.0f64..std::f64::consts::FRAC_PI_2,
        prop_oneof![Just(0.0), Just(1.0 / 3.0), 0.0f64..1.0 / 3.0],
        0.01f64..1.0,
        prop_oneof![Just(0.0), 0.0f64..0.2],
    )
        .prop_map(|(mu, k1, k2, gamma, kappa, d, onset)| [mu, k1, k2, gamma, kappa, d, onset])
}

/// All four variants of the law.
pub fn laws() -> impl Strategy<Value = Hgo> {
    (any::<bool>(), any::<bool>()).prop_map(|(tension_only, full)| Hgo {
        tension_only,
        fibre_invariants: if full { FibreInvariants::Full } else { FibreInvariants::Isochoric },
    })
}

/// The response over any scalar.
pub fn respond_over<S: Scalar>(law: &Hgo, f: &[S; 9], params: &[S; PARAMETERS]) -> Response<S, 9> {
    law.respond(&Context::default(), f, params, &[], &mut [])
}

/// The response in plain numbers.
pub fn respond(law: &Hgo, f: &[f64; 9], params: &Params) -> Response<f64, 9> {
    law.respond(&Context::default(), f, params, &[], &mut [])
}

/// The response with derivatives with respect to F.
pub fn respond_in_jets(law: &Hgo, f: &[f64; 9], params: &Params) -> Response<Jet<9>, 9> {
    let mut g = [Jet::constant(0.0); 9];
    for i in 0..9 {
        g[i] = Jet::variable(f[i], i);
    }
    law.respond(&Context::default(), &g, &params.map(Jet::constant), &[], &mut [])
}

/// Force and tangent by jets.
pub fn by_jets(law: &Hgo, f: &[f64; 9], params: &Params) -> ([f64; 9], [[f64; 9]; 9]) {
    let r = respond_in_jets(law, f, params);
    (r.force.map(|p| p.re), r.force.map(|p| p.eps))
}

/// Largest magnitude.
pub fn largest<'a>(x: impl IntoIterator<Item = &'a f64>) -> f64 {
    x.into_iter().fold(0.0, |m, x| m.max(x.abs()))
}

/// Largest difference of two arrays, relative to the larger of the second and `floor`.
pub fn difference<const N: usize>(a: &[f64; N], b: &[f64; N], floor: f64) -> f64 {
    let d = a.iter().zip(b).fold(0.0f64, |m, (a, b)| m.max((a - b).abs()));
    d / largest(b).max(floor).max(1e-300)
}

/// F = diag(λx, λy, λz).
pub fn stretches(x: f64, y: f64, z: f64) -> [f64; 9] {
    [x, 0.0, 0.0, 0.0, y, 0.0, 0.0, 0.0, z]
}
