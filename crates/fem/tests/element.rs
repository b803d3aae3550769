//! The brick alone: tangent, patch test, frame indifference, locking, manufactured solution.
#![allow(clippy::needless_range_loop)] // index notation

mod common;

use common::*;
use constitutive::{Context, Jet, Law, PointLaw, tensor, testing};
use fem::{Body, Prescribed, Problem, System, Target, hex8};
use hgo::Hgo;
use mesh::{Outline, Sizing, Strip};
use std::sync::Arc;

const CTX: Context = Context { dt: 1.0, time: 0.0, path_position: 0.5 };

/// Deterministic numbers in −1 … 1.
fn noise(seed: usize) -> impl FnMut() -> f64 {
    let mut state = 0x9E37_79B9_7F4A_7C15u64.wrapping_mul(seed as u64 + 1);
    move || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }
}

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

fn bulks() -> Vec<(&'static str, [f64; 7])> {
    let peers = Tissue::peers(1.0, 0.1).bulk;
    let mut stiff = peers;
    stiff[5] = 2.0 / 50.0;
    vec![
        ("HGO, K0 = 1 MPa", peers),
        ("HGO, K0 = 50 MPa", stiff),
        ("neo-Hooke", Tissue::neo_hookean(0.01, 0.05)),
    ]
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
            hex8::tangent(0, law, &CTX, &params, &geo, &u, &[], &mut [], scratch, &mut hand).unwrap();
            let (r, k) = jet_tangent(law, &params, &x, &u);
            let scale = k.iter().flatten().fold(0.0f64, |m, v| m.max(v.abs()));
            let force = r.iter().fold(0.0f64, |m, v| m.max(v.abs()));
            for i in 0..24 {
                assert!((hand.residual[i] - r[i]).abs() < 1e-12 * force, "residual {i}");
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

/// A cube of n³ bricks, inner nodes moved by up to `jitter` of the size; boundary displacement
/// `grip` · field(X).
fn cube(n: usize, jitter: f64, field: impl Fn(&[f64; 3]) -> [f64; 3]) -> Problem {
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

/// The manufactured displacement and its gradient at X (jets in X give the body force).
///
/// Isochoric: shears in turn, x by y and z, y by z, so that det F = 1 exactly. A nearly
/// incompressible body needs that: the pressure of any other field dwarfs its shear stress, and a
/// constant-pressure brick answers for it in the displacements (it is not pressure-robust).
fn manufactured(x: &[Jet<3>; 3], isochoric: bool) -> ([Jet<3>; 3], [Jet<3>; 9]) {
    use constitutive::Scalar;
    let a = 0.08;
    let w = [2.0, 1.5, 1.8];
    let arg = |i: usize| x[i] * w[i];
    let (s, c): (Vec<_>, Vec<_>) = (0..3).map(|i| (arg(i).sin(), arg(i).cos())).unzip();
    let zero = Jet::constant(0.0);
    if isochoric {
        let u = [s[1] * c[2] * a, s[2] * a, zero];
        let g = [
            zero,
            c[1] * c[2] * (a * w[1]),
            s[1] * s[2] * (-a * w[2]),
            zero,
            zero,
            c[2] * (a * w[2]),
            zero,
            zero,
            zero,
        ];
        return (u, g);
    }
    let u = [
        s[1] * c[2] * a + s[0] * (0.5 * a),
        s[2] * c[0] * a + s[1] * (2.0 * a),
        s[0] * c[1] * a - s[2] * (0.6 * a),
    ];
    let g = [
        c[0] * (0.5 * a * w[0]),
        c[1] * c[2] * (a * w[1]),
        s[1] * s[2] * (-a * w[2]),
        s[2] * s[0] * (-a * w[0]),
        c[1] * (2.0 * a * w[1]),
        c[2] * c[0] * (a * w[2]),
        c[0] * c[1] * (a * w[0]),
        s[0] * s[1] * (-a * w[1]),
        c[2] * (-0.6 * a * w[2]),
    ];
    (u, g)
}

fn manufactured_at(x: &[f64; 3], isochoric: bool) -> ([f64; 3], [f64; 9]) {
    let (u, g) = manufactured(&std::array::from_fn(|i| Jet::variable(x[i], i)), isochoric);
    (u.map(|j| j.re), g.map(|j| j.re))
}

/// −Div P of the manufactured state, exact by jets in X.
fn body_force(law: &Hgo, x: &[f64; 3], params: &[f64], isochoric: bool) -> [f64; 3] {
    let (_, mut f) = manufactured(&std::array::from_fn(|i| Jet::variable(x[i], i)), isochoric);
    for d in [0, 4, 8] {
        f[d] = f[d] + 1.0;
    }
    let p: Vec<Jet<3>> = params.iter().map(|&v| Jet::constant(v)).collect();
    let stress = Law::<Jet<3>, 9>::respond(law, &CTX, &f, &p, &[], &mut []).force;
    std::array::from_fn(|i| -(0..3).map(|j| stress[3 * i + j].eps[j]).sum::<f64>())
}

const CORNERS: [[f64; 3]; 8] = [
    [-1., -1., -1.],
    [1., -1., -1.],
    [1., 1., -1.],
    [-1., 1., -1.],
    [-1., -1., 1.],
    [1., -1., 1.],
    [1., 1., 1.],
    [-1., 1., 1.],
];

/// Shape values at a point of the reference cube.
fn shape(xi: [f64; 3]) -> [f64; 8] {
    CORNERS.map(|c| (0..3).map(|a| 0.5 * (1.0 + c[a] * xi[a])).product())
}

/// L2 error, error of the gradient, residual norms.
type Solved = (f64, f64, Vec<f64>);

/// Solves with the manufactured body force by a Newton iteration written here on fem's public
/// assembly; returns L2 error, error of the gradient, and the residual norms of the iterations.
fn solve_manufactured(n: usize, law: Hgo, params: &[f64; 7], isochoric: bool, disturbance: f64) -> Solved {
    let mut problem = cube(n, 0.15, |x| manufactured_at(x, isochoric).0);
    problem.bulk = Arc::new(law);
    let body = &problem.body;
    let mut system = System::new(&problem).unwrap();
    let mut load = vec![0.0; 3 * body.nodes.len()];
    let g = 1.0 / 3f64.sqrt();
    for (e, h) in body.hexes.iter().enumerate() {
        for q in 0..8 {
            let shapes = shape(CORNERS[q].map(|c| c * g));
            let x: [f64; 3] = std::array::from_fn(|i| (0..8).map(|a| shapes[a] * body.nodes[h[a]][i]).sum());
            let b = body_force(&law, &x, params, isochoric);
            for a in 0..8 {
                for i in 0..3 {
                    load[3 * h[a] + i] += system.geometry()[e].volumes[q] * shapes[a] * b[i];
                }
            }
        }
    }
    // Start from the interpolation of the exact field, disturbed inside.
    let mut r = noise(11);
    let mut u: Vec<f64> = body.nodes.iter().flat_map(|x| manufactured_at(x, isochoric).0).collect();
    for (dof, &eq) in system.equation.iter().enumerate() {
        if eq != fem::NONE {
            u[dof] += disturbance / n as f64 * r();
        }
    }
    let mut norms;
    // A nearly incompressible body is approached through softer ones: the pressure of the
    // interpolated field would make the first tangents indefinite.
    let mut d = params[5].max(40.0);
    loop {
        d = params[5].max(d / 3.0);
        let mut stage = *params;
        stage[5] = d;
        norms = newton(&problem, &mut system, &stage, &load, &mut u);
        if d == params[5] {
            break;
        }
    }
    let relative = norms.last().unwrap() / norms[0];
    assert!(relative < 1e-9 || *norms.last().unwrap() < 1e-13, "Newton stopped at {}", sci(&norms));
    let (mut l2, mut h1) = (0.0, 0.0);
    for (e, h) in body.hexes.iter().enumerate() {
        let geo = &system.geometry()[e];
        for q in 0..8 {
            let shapes = shape(CORNERS[q].map(|c| c * g));
            let at = |v: &dyn Fn(usize, usize) -> f64, i: usize| -> f64 {
                (0..8).map(|a| shapes[a] * v(h[a], i)).sum()
            };
            let x: [f64; 3] = std::array::from_fn(|i| at(&|m, i| body.nodes[m][i], i));
            let (want, gradient) = manufactured_at(&x, isochoric);
            for i in 0..3 {
                l2 += geo.volumes[q] * (at(&|m, i| u[3 * m + i], i) - want[i]).powi(2);
                for j in 0..3 {
                    let slope: f64 = (0..8).map(|a| u[3 * h[a] + i] * geo.gradients[q][j][a]).sum();
                    h1 += geo.volumes[q] * (slope - gradient[3 * i + j]).powi(2);
                }
            }
        }
    }
    (l2.sqrt(), h1.sqrt(), norms)
}

/// Newton's method on the public assembly; residual norms of the iterations.
fn newton(
    problem: &Problem,
    system: &mut System,
    params: &[f64; 7],
    load: &[f64],
    u: &mut Vec<f64>,
) -> Vec<f64> {
    let local = problem.local(&params[..]);
    let mut new = fem::History::virgin(problem);
    let old = new.clone();
    let (mut norms, mut last): (Vec<f64>, Vec<f64>) = (Vec::new(), u.clone());
    for _ in 0..20 {
        // A step that turns an element inside out is halved.
        while system.assemble(problem, &local, &CTX, u, &old, &mut new).is_err() {
            u.iter_mut().zip(&last).for_each(|(a, b)| *a = 0.5 * (*a + b));
        }
        let mut rhs = vec![0.0; system.unknowns];
        for (dof, &eq) in system.equation.iter().enumerate() {
            if eq != fem::NONE {
                rhs[eq] = load[dof] - system.residual[eq];
            }
        }
        let norm = rhs.iter().map(|v| v * v).sum::<f64>().sqrt();
        norms.push(norm);
        if norm < 1e-11 * norms[0] || norm < 1e-13 {
            break;
        }
        let values = system.values.clone();
        system.factor.factorise(&values);
        system.factor.solve(&mut rhs, 1).unwrap();
        last.clone_from(u);
        for (dof, &eq) in system.equation.iter().enumerate() {
            if eq != fem::NONE {
                u[dof] += rhs[eq];
            }
        }
    }
    norms
}

#[test]
fn manufactured_solution_converges_at_full_order() {
    let mut soft = Tissue::peers(1.0, 0.1).bulk;
    (soft[1], soft[2], soft[5]) = (0.02, 2.0, 2.0 / 0.1);
    let mut stiff = soft;
    stiff[5] = 2.0 / 2.0;
    // Without the fibres' switch the solution is smooth, as the orders ask.
    let (smooth, switch) = (Hgo { tension_only: false, ..Hgo::default() }, Hgo::default());
    let cases = [
        ("neo-Hooke, K0 = 5 mu", switch, Tissue::neo_hookean(0.01, 0.05), false, [1.8, 0.9]),
        ("neo-Hooke, K0 = 200 mu, isochoric field", switch, Tissue::neo_hookean(0.01, 2.0), true, [1.8, 0.9]),
        ("HGO without switch, K0 = 0.1 MPa", smooth, soft, false, [1.8, 0.9]),
        ("HGO without switch, K0 = 2 MPa, isochoric field", smooth, stiff, true, [1.8, 0.9]),
        ("HGO with tension switch, K0 = 0.1 MPa", switch, soft, false, [1.7, 0.8]),
    ];
    let mut bad = Vec::new();
    for (name, law, params, isochoric, least) in cases {
        let solved: Vec<Solved> =
            [4, 8, 16].map(|n| solve_manufactured(n, law, &params, isochoric, 0.0)).into();
        let rate = |f: fn(&Solved) -> f64, k: usize| (f(&solved[k]) / f(&solved[k + 1])).log2();
        let (l2, h1) = ([0, 1].map(|k| rate(|s| s.0, k)), [0, 1].map(|k| rate(|s| s.1, k)));
        println!(
            "manufactured, {name}: L2 {} orders {l2:.2?}; gradient {} orders {h1:.2?}",
            sci(&solved.iter().map(|s| s.0).collect::<Vec<_>>()),
            sci(&solved.iter().map(|s| s.1).collect::<Vec<_>>())
        );
        if !(l2[1] > least[0] && h1[1] > least[1]) {
            bad.push(name);
        }
    }
    assert!(bad.is_empty(), "{bad:?}");
}

#[test]
fn newton_is_quadratic_on_the_assembled_tangent() {
    // Neo-Hooke: smooth everywhere (the fibre switch makes the HGO residual only once differentiable).
    let (_, _, norms) = solve_manufactured(4, Hgo::default(), &Tissue::neo_hookean(0.01, 0.05), false, 0.1);
    let relative: Vec<f64> = norms.iter().map(|n| n / norms[0]).collect();
    println!("Newton, neo-Hooke: relative residuals {}", sci(&relative));
    let reduced: Vec<f64> =
        relative.windows(2).filter(|w| w[0] < 2e-2 && w[1] > 1e-12).map(|w| w[1].ln() / w[0].ln()).collect();
    println!("  exponents {reduced:.2?}");
    assert!(relative.last().unwrap() < &1e-10 && norms.len() <= 7);
    assert!(reduced.iter().all(|&p| p > 1.7), "{reduced:?}");
}

#[test]
fn one_step_of_the_march_gains_digits_quadratically() {
    let problem = problem(&peer_strip([8, 20, 2], false, true), Ends::Clamped, 1);
    let theta = Tissue::peers(1.0, 0.1).theta(1);
    let mut counts = Vec::new();
    for tolerance in [1e-2, 1e-4, 1e-6, 1e-8, 1e-10] {
        let mut options = shipped();
        options.newton.tolerance = tolerance;
        let run = complete(&problem, &theta, &[Target::new(0.0, 0.0), Target::new(0.4, 1.0)], options);
        counts.push(run.steps.last().unwrap().iterations);
    }
    println!("iterations of one tension step to 1e-2, 1e-4, 1e-6, 1e-8, 1e-10: {counts:?}");
    assert!(counts[4] - counts[1] <= 3, "six more digits cost at most three iterations: {counts:?}");
}
