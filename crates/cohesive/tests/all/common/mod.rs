//! Random openings, paths and parameters for the tests of the law.
#![allow(dead_code)]

use cohesive::{Cohesive, PARAMETERS, delta_c};
use constitutive::{Context, Jet, Law, Response};
use proptest::prelude::*;

pub type Params = [f64; PARAMETERS];
pub type Opening = [f64; 3];

/// Gc, σc, λ, K over the range of the paper's Table 2 and beyond.
pub fn parameters() -> impl Strategy<Value = Params> {
    (0.05f64..2.0, 0.01f64..1.0, prop_oneof![Just(1.0), 0.2f64..3.0], 1.0f64..100.0)
        .prop_map(|(gc, sigma_c, lambda, penalty)| [gc, sigma_c, lambda, penalty])
}

/// Openings in units of δc: mixed mode, closing among them.
pub fn openings() -> impl Strategy<Value = Opening> {
    [-1.0f64..3.0, -2.0..2.0, -2.0..2.0]
}

/// The opening in mm.
pub fn scaled(opening: &Opening, p: &Params) -> Opening {
    opening.map(|x| x * delta_c(p[0], p[1]))
}

/// Response and new δmax.
pub fn respond(opening: &Opening, p: &Params, old: f64) -> (Response<f64, 3>, f64) {
    let mut new = [f64::NAN];
    let r = Cohesive.respond(&Context::default(), opening, p, &[old], &mut new);
    (r, new[0])
}

/// Traction and tangent by jets.
pub fn by_jets(opening: &Opening, p: &Params, old: f64) -> (Opening, [[f64; 3]; 3]) {
    let mut new = [0.0];
    constitutive::tangent_by_jets_3(&Cohesive, &Context::default(), opening, p, &[old], &mut new)
}

/// The response with parameter `k` seeded, after `old`.
pub fn seeded(opening: &Opening, p: &Params, k: usize, old: Jet<1>) -> (Response<Jet<1>, 3>, Jet<1>) {
    let q: [Jet<1>; PARAMETERS] =
        std::array::from_fn(|i| if i == k { Jet::variable(p[i], 0) } else { Jet::constant(p[i]) });
    let mut new = [Jet::constant(f64::NAN)];
    let r = Cohesive.respond(&Context::default(), &opening.map(Jet::constant), &q, &[old], &mut new);
    (r, new[0])
}
