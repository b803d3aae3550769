//! Bodies of bricks: patch test, locking of a cantilever, Cook's panel.
#![allow(clippy::needless_range_loop)] // index notation

use crate::bricks;
use crate::common;

use bricks::{CTX, bulks, cube};
use common::{Ends, Tissue, complete, order, peer_strip, plan, problem, ramp, shipped, tight};
use constitutive::{Law, tensor};
use fem::{Body, Prescribed, Problem, hex8};
use hgo::Hgo;
use mesh::{Outline, Sizing, Strip};
use std::sync::Arc;

#[test]
fn patch_test_with_distorted_bricks() {
    for (name, bulk) in
        bulks().into_iter().chain([("neo-Hooke, K0 = 1e5 mu", Tissue::neo_hookean(0.01, 1e3))])
    {
        // Nearly isochoric, so that the stiff volumetric part does not drown the rest.
        let h = [-0.1, 0.08, 0.02, 0.05, 0.18, -0.03, 0.01, 0.04, -0.06];
        let problem = cube(3, 0.3, |x| tensor::apply(&h, x));
        let run = complete(&problem, &bulk, &plan(ramp(0.0, 1.0, 4)), tight());
        let u = &run.last.as_ref().unwrap().u;
        let mut worst = 0.0f64;
        for (k, x) in problem.body.nodes.iter().enumerate() {
            let want = tensor::apply(&h, x);
            worst = (0..3).fold(worst, |m, c| m.max((u[3 * k + c] - want[c]).abs()));
        }
        let mut f = h;
        for d in [0, 4, 8] {
            f[d] += 1.0;
        }
        let p = Hgo::default().respond(&CTX, &f, &bulk[..], &[], &mut []).force;
        let work = tensor::dot(&p, &h); // per unit volume and grip displacement
        let force = run.steps.last().unwrap().force;
        println!(
            "patch test, {name}: worst displacement error {worst:.1e}, force against P:H·V {:.1e}",
            (force / work - 1.0).abs()
        );
        assert!(worst < 1e-10 && (force / work - 1.0).abs() < 1e-9);
    }
}

/// A cantilever of length 10 and height 2, plane strain, bent by a small end displacement; the force
/// over that of beam theory with shear.
fn cantilever(n: usize, ratio: f64) -> (f64, f64) {
    let (length, height, mu) = (10.0, 2.0, 1.0);
    let strip = Strip { sizing: Sizing::Divisions([n, 5 * n, 1]), ..Strip::new(length, height, 1.0) };
    let mesh = mesh::strip(&strip).unwrap();
    let body = Body::of(&mesh);
    let mut supports = vec![None; 3 * body.nodes.len()];
    for (k, x) in body.nodes.iter().enumerate() {
        supports[3 * k + 2] = Some(Prescribed::default());
        if x[1] == 0.0 {
            supports[3 * k + 1] = Some(Prescribed::default());
            supports[3 * k] = Some(Prescribed::default());
        }
        if x[1] == length {
            supports[3 * k] = Some(Prescribed { grip: 1.0, mount: 0.0 });
        }
    }
    let problem =
        Problem { supports: Arc::new(supports), body: Arc::new(body), ..cube(1, 0.0, |_| [0.0; 3]) };
    let theta = Tissue::neo_hookean(mu, ratio * mu);
    let run = complete(&problem, &theta, &plan([1e-3]), tight());
    let k = ratio * mu;
    let nu = (3.0 * k - 2.0 * mu) / (2.0 * (3.0 * k + mu));
    let e = 2.0 * mu * (1.0 + nu) / (1.0 - nu * nu);
    let inertia = height.powi(3) / 12.0;
    let beam = 1.0 / (length.powi(3) / (3.0 * e * inertia) + length / (5.0 / 6.0 * mu * height));
    (run.steps.last().unwrap().force / 1e-3 / beam, displacement_element(&problem, &theta) / beam)
}

/// The same structure with the ordinary displacement brick, linear: what locks.
fn displacement_element(problem: &Problem, theta: &[f64]) -> f64 {
    use nalgebra::{DMatrix, DVector};
    let body = &problem.body;
    let n = 3 * body.nodes.len();
    let mut k = DMatrix::<f64>::zeros(n, n);
    let identity = tensor::identity::<f64>();
    let mut none: [f64; 0] = [];
    let (_, a) =
        constitutive::tangent_by_jets_9(&*problem.bulk, &CTX, &identity, &theta[..7], &[], &mut none);
    for h in &body.hexes {
        let geo = hex8::geometry(&h.map(|m| body.nodes[m]));
        for q in 0..8 {
            let g = &geo.gradients[q];
            for (r, s) in (0..24).flat_map(|r| (0..24).map(move |s| (r, s))) {
                let mut sum = 0.0;
                for (j, l) in (0..3).flat_map(|j| (0..3).map(move |l| (j, l))) {
                    sum += g[j][r / 3] * a[3 * (r % 3) + j][3 * (s % 3) + l] * g[l][s / 3];
                }
                k[(3 * h[r / 3] + r % 3, 3 * h[s / 3] + s % 3)] += geo.volumes[q] * sum;
            }
        }
    }
    let free: Vec<usize> = (0..n).filter(|&d| problem.supports[d].is_none()).collect();
    let moved = DVector::from_iterator(n, problem.supports.iter().map(|s| s.map_or(0.0, |p| p.grip)));
    let column = &k * &moved;
    let kff = DMatrix::from_fn(free.len(), free.len(), |i, j| k[(free[i], free[j])]);
    let rhs = DVector::from_fn(free.len(), |i, _| -column[free[i]]);
    let u = kff.cholesky().expect("positive definite").solve(&rhs);
    moved.dot(&column) + (0..free.len()).map(|i| u[i] * column[free[i]]).sum::<f64>()
}

#[test]
fn no_volumetric_locking_in_bending() {
    println!(
        "cantilever, F/F_beam: K0/mu, bricks over the height: mean dilatation, plain displacement brick"
    );
    let mut finest = Vec::new();
    for ratio in [10.0, 1e2, 1e4] {
        for n in [2, 4, 6] {
            let (ours, plain) = cantilever(n, ratio);
            println!("  K0/mu = {ratio:8}, {n}: {ours:.4}, {plain:.4}");
            if n == 6 {
                finest.push((ours, plain));
            }
        }
    }
    // Mean dilatation: near the beam, whatever the bulk modulus. Plain: locks without bound.
    assert!(finest.iter().all(|f| (f.0 - 1.0).abs() < 0.05), "{finest:?}");
    assert!((finest[2].0 / finest[1].0 - 1.0).abs() < 0.01);
    assert!(finest[2].1 > 3.0);
}

/// Cook's tapered panel in plane strain, its end moved sideways by 4 mm: reaction against mesh.
#[test]
fn cook_panel_converges() {
    for (name, ratio, least) in
        [("compressible K0/mu = 5", 5.0, 1.0), ("nearly incompressible K0/mu = 5000", 5e3, 0.9)]
    {
        let mut reactions = Vec::new();
        for split in [1, 2, 4, 8] {
            let outline = Outline::new(&[[0.0, 0.0, 44.0], [48.0, 44.0, 60.0]]).unwrap();
            let strip = Strip {
                sizing: Sizing::Divisions([3, 4, 1]),
                outline: Some(outline),
                ..Strip::new(48.0, 44.0, 1.0)
            };
            // In the plane only: one layer whatever the split.
            let strip = Strip { sizing: Sizing::Divisions([3 * split, 4 * split, 1]), ..strip };
            let mesh = mesh::strip(&strip).unwrap();
            let body = Body::of(&mesh);
            let mut supports = vec![None; 3 * body.nodes.len()];
            for (k, x) in body.nodes.iter().enumerate() {
                supports[3 * k + 2] = Some(Prescribed::default());
                if x[1] == 0.0 {
                    supports[3 * k] = Some(Prescribed::default());
                    supports[3 * k + 1] = Some(Prescribed::default());
                } else if x[1] == 48.0 {
                    supports[3 * k] = Some(Prescribed { grip: 1.0, mount: 0.0 });
                }
            }
            let problem =
                Problem { supports: Arc::new(supports), body: Arc::new(body), ..cube(1, 0.0, |_| [0.0; 3]) };
            let run = complete(
                &problem,
                &Tissue::neo_hookean(80.2, ratio * 80.2),
                &plan(ramp(0.0, 4.0, 2)),
                tight(),
            );
            reactions.push(run.steps.last().unwrap().force);
        }
        let orders = [
            order([reactions[0], reactions[1], reactions[2]], 2.0),
            order([reactions[1], reactions[2], reactions[3]], 2.0),
        ];
        let limit = reactions[3] + (reactions[3] - reactions[2]) / (2f64.powf(orders[1]) - 1.0);
        println!(
            "Cook panel, {name}: reactions {reactions:.4?}, orders {orders:.2?}, extrapolated {limit:.4}, finest off by {:.2} %",
            100.0 * (reactions[3] / limit - 1.0)
        );
        assert!(orders[1] > least, "{orders:?}");
        assert!((reactions[3] / limit - 1.0).abs() < 0.01);
    }
}

/// A bulk modulus far beyond the matrix's stiffness costs Newton's method little: pressures are carried over from
/// iterate to iterate to first order, not taken from what a linear step leaves in the volumes.
#[test]
fn newton_does_not_mind_a_large_bulk_modulus() {
    let problem = problem(&peer_strip([8, 20, 2], false, true), Ends::Clamped, 1);
    let counts = [1.0, 20.0, 400.0].map(|bulk_modulus| {
        let mut theta = Tissue::peers(bulk_modulus, 0.1).theta(1);
        theta[0] = 0.8e-3;
        let run = complete(&problem, &theta, &plan(ramp(0.0, 2.0, 10)), shipped());
        run.iterations
    });
    println!("iterations with K0 = 1, 20, 400 MPa beside mu = 0.8 kPa: {counts:?}");
    assert!(2 * counts[2] <= 3 * counts[0], "{counts:?}");
}
