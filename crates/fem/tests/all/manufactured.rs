//! The assembled bricks: manufactured solution, order of Newton's method.
#![allow(clippy::needless_range_loop)] // index notation

use crate::bricks;
use crate::common;

use bricks::{CTX, cube, noise};
use common::{Ends, Tissue, complete, peer_strip, problem, sci, shipped};
use constitutive::{Jet, Law};
use fem::{Problem, System, Target};
use hgo::Hgo;
use std::sync::Arc;

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
        while system.assemble(problem, &local, &CTX, u, fem::Pressures::Own, &old, &mut new).is_err() {
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
fn one_load_step_gains_digits_quadratically() {
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
