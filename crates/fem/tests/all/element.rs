//! The brick alone: tangent, energy, frame indifference.
#![allow(clippy::needless_range_loop)] // index notation

use crate::bricks;

use bricks::{CTX, bulks, noise};
use constitutive::{Jet, Law, PointLaw, tensor, testing};
use fem::hex8;
use hgo::Hgo;

/// A distorted brick and a displacement of it.
fn brick(seed: usize) -> ([[f64; 3]; 8], [[f64; 3]; 8]) {
    let unit = [
        [0., 0., 0.],
        [1., 0., 0.],
        [1., 1., 0.],
        [0., 1., 0.],
        [0., 0., 1.],
        [1., 0., 1.],
        [1., 1., 1.],
        [0., 1., 1.],
    ];
    let mut r = noise(seed);
    let x = unit.map(|c: [f64; 3]| c.map(|v| v + 0.1 * r()));
    let u = x.map(|c| [-0.1 * c[0] + 0.05 * r(), 0.25 * c[1] + 0.05 * r(), -0.05 * c[2] + 0.05 * r()]);
    (x, u)
}

#[test]
fn brick_tangent_is_the_derivative_of_the_residual() {
    let law: &(dyn PointLaw<9> + 'static) = &Hgo::default();
    let (mut by_jets, mut asymmetry) = (0.0f64, 0.0f64);
    for seed in 0..8 {
        for (_, params) in bulks() {
            let (x, u) = brick(seed);
            let geo = hex8::geometry(&x);
            let mut hand = hex8::Tangent::default();
            let scratch = &mut hex8::Scratch::default();
            hex8::tangent(
                0,
                law,
                &CTX,
                &params,
                &geo,
                &u,
                hex8::Pressure::Own,
                &[],
                &mut [],
                scratch,
                &mut hand,
            )
            .unwrap();
            let mut alone = hand.clone();
            alone.residual = [f64::NAN; 24];
            hex8::forces(0, law, &CTX, &params, &geo, &u, &[], &mut [], &mut alone).unwrap();
            let (r, k) = jet_tangent(law, &params, &x, &u);
            let scale = k.iter().flatten().fold(0.0f64, |m, v| m.max(v.abs()));
            let force = r.iter().fold(0.0f64, |m, v| m.max(v.abs()));
            for i in 0..24 {
                assert!((hand.residual[i] - r[i]).abs() < 1e-12 * force, "residual {i}");
                assert!((alone.residual[i] - r[i]).abs() < 1e-12 * force, "residual {i} without a tangent");
                for j in 0..24 {
                    asymmetry = asymmetry.max((k[i][j] - k[j][i]).abs() / scale);
                    let packed = hand.entry(i, j);
                    by_jets = by_jets.max((packed - k[i][j]).abs() / scale);
                }
            }
        }
    }
    println!("brick tangent: against jets of the residual {by_jets:.1e}, asymmetry of those {asymmetry:.1e}");
    assert!(by_jets < 1e-10 && asymmetry < 1e-10);
}

/// Residual and its derivative by three sweeps of eight jets.
fn jet_tangent(
    law: &(dyn PointLaw<9> + 'static),
    params: &[f64],
    x: &[[f64; 3]; 8],
    u: &[[f64; 3]; 8],
) -> ([f64; 24], [[f64; 24]; 24]) {
    let geo = hex8::geometry(&x.map(|c| c.map(Jet::<8>::constant)));
    let p: Vec<Jet<8>> = params.iter().map(|&v| Jet::constant(v)).collect();
    let (mut r, mut k) = ([0.0; 24], [[0.0; 24]; 24]);
    for sweep in 0..3 {
        let uj: [[Jet<8>; 3]; 8] = std::array::from_fn(|a| {
            std::array::from_fn(|i| {
                let dof = 3 * a + i;
                if dof / 8 == sweep { Jet::variable(u[a][i], dof % 8) } else { Jet::constant(u[a][i]) }
            })
        });
        let f = hex8::residual::<Jet<8>, Jet<8>>(law, &CTX, &p, &geo, &uj, &[], &mut []);
        for row in 0..24 {
            let j = f[row / 3][row % 3];
            r[row] = j.re;
            k[row][8 * sweep..8 * sweep + 8].copy_from_slice(&j.eps);
        }
    }
    (r, k)
}

#[test]
fn brick_residual_is_the_gradient_of_the_energy() {
    let law = Hgo::default();
    let params = bulks()[1].1;
    let (x, u) = brick(3);
    let geo = hex8::geometry(&x);
    let energy = |u: &[[f64; 3]; 8]| -> f64 {
        let f = hex8::mean_dilatation_gradients(&geo, u);
        (0..8).map(|q| geo.volumes[q] * law.respond(&CTX, &f[q], &params[..], &[], &mut []).energy).sum()
    };
    let r = hex8::residual::<f64, f64>(&law, &CTX, &params, &geo, &u, &[], &mut []);
    let scale = r.iter().flatten().fold(0.0f64, |m, v| m.max(v.abs()));
    let mut worst = 0.0f64;
    for a in 0..8 {
        for i in 0..3 {
            let at = |h: f64| {
                let mut v = u;
                v[a][i] += h;
                energy(&v)
            };
            let h = 1e-3;
            let fd = (8.0 * (at(h) - at(-h)) - (at(2.0 * h) - at(-2.0 * h))) / (12.0 * h);
            worst = worst.max((fd - r[a][i]).abs() / scale);
        }
    }
    println!("brick residual against differences of its energy: {worst:.1e}");
    assert!(worst < 1e-7);
}

#[test]
fn brick_turns_with_its_frame() {
    let law: &(dyn PointLaw<9> + 'static) = &Hgo::default();
    let mut worst = 0.0f64;
    for seed in 0..6 {
        for (_, params) in bulks() {
            let (x, u) = brick(seed);
            let mut r = noise(100 + seed);
            let q = testing::rotation(3.0 * r(), 3.0 * r(), 3.0 * r());
            let geo = hex8::geometry(&x);
            let turned: [[f64; 3]; 8] = std::array::from_fn(|a| {
                let now = std::array::from_fn(|i| x[a][i] + u[a][i]);
                let then = tensor::apply(&q, &now);
                std::array::from_fn(|i| then[i] - x[a][i] + 0.3)
            });
            let f = hex8::residual::<f64, f64>(law, &CTX, &params, &geo, &u, &[], &mut []);
            let g = hex8::residual::<f64, f64>(law, &CTX, &params, &geo, &turned, &[], &mut []);
            let scale = f.iter().flatten().fold(0.0f64, |m, v| m.max(v.abs()));
            for a in 0..8 {
                let want = tensor::apply(&q, &f[a]);
                worst = (0..3).fold(worst, |m, i| m.max((want[i] - g[a][i]).abs() / scale));
            }
        }
    }
    println!("frame indifference of the brick: {worst:.1e}");
    assert!(worst < 1e-11);
}
