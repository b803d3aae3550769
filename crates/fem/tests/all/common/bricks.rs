//! Bricks for the tests of the element: materials, noise, a distorted cube with moved faces.
#![allow(dead_code)]

use crate::common::Tissue;
use constitutive::Context;
use fem::{Body, Prescribed, Problem};
use hgo::Hgo;
use mesh::{Sizing, Strip};
use std::sync::Arc;

pub const CTX: Context = Context { dt: 1.0, time: 0.0, path_position: 0.5 };

/// Deterministic numbers in −1 … 1.
pub fn noise(seed: usize) -> impl FnMut() -> f64 {
    let mut state = 0x9E37_79B9_7F4A_7C15u64.wrapping_mul(seed as u64 + 1);
    move || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }
}

pub fn bulks() -> Vec<(&'static str, [f64; 7])> {
    let peers = Tissue::peers(1.0, 0.1).bulk;
    let mut stiff = peers;
    stiff[5] = 2.0 / 50.0;
    vec![
        ("HGO, K0 = 1 MPa", peers),
        ("HGO, K0 = 50 MPa", stiff),
        ("neo-Hooke", Tissue::neo_hookean(0.01, 0.05)),
    ]
}

/// A cube of n³ bricks, inner nodes moved by up to `jitter` of the size; boundary displacement
/// `grip` · field(X).
pub fn cube(n: usize, jitter: f64, field: impl Fn(&[f64; 3]) -> [f64; 3]) -> Problem {
    let mesh =
        mesh::strip(&Strip { sizing: Sizing::Divisions([n, n, n]), ..Strip::new(1.0, 1.0, 1.0) }).unwrap();
    let mut body = Body::of(&mesh);
    let mut r = noise(7);
    let mut supports = vec![None; 3 * body.nodes.len()];
    for (k, x) in body.nodes.iter_mut().enumerate() {
        let on = |v: f64, lo: f64| (v - lo).abs() < 1e-12 || (v - lo - 1.0).abs() < 1e-12;
        if on(x[0], 0.0) || on(x[1], 0.0) || on(x[2], -0.5) {
            let u = field(x);
            for c in 0..3 {
                supports[3 * k + c] = Some(Prescribed { grip: u[c], mount: 0.0 });
            }
        } else {
            x.iter_mut().for_each(|v| *v += jitter / n as f64 * r());
        }
    }
    Problem {
        body: Arc::new(body),
        supports: Arc::new(supports),
        waypoints: Arc::default(),
        reactions: Arc::default(),
        multiplicity: 1.0,
        bulk: Arc::new(Hgo::default()),
        bulk_params: (0..7).collect(),
        path: None,
        train: vec![],
        takeup: vec![],
        shape: vec![],
        mount: vec![],
    }
}
