//! The interface element alone: tangent, symmetry, rotations, balance of forces and moments.
#![allow(clippy::needless_range_loop)] // index notation

use cohesive::Cohesive;
use constitutive::{Context, PointLaw, tensor, testing};
use fem::interface::{self, Integration};

type Quad = [[f64; 3]; 4];

struct Case {
    name: &'static str,
    x: Quad,
    u: [[f64; 3]; 8],
    old: Vec<f64>,
    lambda: f64,
}

/// A flat quadrilateral in the x–z plane (normal +y), moved apart by `opening`, tilted and warped.
fn case(name: &'static str, opening: [f64; 3], delta_max: f64, lambda: f64) -> Case {
    let x: Quad = [[0.1, 0.0, 0.0], [0.0, 0.0, 0.9], [1.0, 0.0, 1.0], [1.2, 0.0, -0.1]];
    let wobble = |k: usize, i: usize| 0.03 * ((7 * k + 3 * i) as f64 * 1.7).sin();
    let u = std::array::from_fn(|a| {
        std::array::from_fn(|i| {
            let tilt = [0.2, 0.3, -0.1][i] * x[a % 4][0] + [0.05, -0.2, 0.1][i] * x[a % 4][2];
            let apart = if a >= 4 { opening[i] } else { 0.0 };
            // The jump varies little: every point of a case stays on its branch.
            tilt + wobble(a % 4, i)
                + apart
                + if a >= 4 { 0.1 * opening[i] * wobble(a, i) / 0.03 } else { 0.0 }
        })
    });
    Case { name, x, u, old: vec![delta_max; 4], lambda }
}

fn cases() -> Vec<Case> {
    vec![
        case("opening, loading", [0.05, 0.5, -0.02], 0.0, 1.0),
        case("opening and sliding, loading, lambda 0.7", [0.4, 0.3, 0.3], 0.0, 0.7),
        case("unloading on the secant, lambda 1.3", [0.2, 0.3, 0.1], 2.0, 1.3),
        case("closing and sliding, loading", [0.5, -0.4, 0.1], 0.0, 1.0),
        case("closing and sliding, unloading, lambda 0.7", [0.4, -0.5, 0.2], 3.0, 0.7),
    ]
}

const CTX: [Context; 4] = [Context { dt: 1.0, time: 0.0, path_position: 0.5 }; 4];
const LAW: &(dyn PointLaw<3> + 'static) = &Cohesive;

fn params(lambda: f64) -> [Vec<f64>; 4] {
    std::array::from_fn(|_| vec![0.23, 0.1, lambda, 10.0])
}

fn forces(c: &Case, u: &[[f64; 3]; 8], rule: Integration) -> [[f64; 3]; 8] {
    let lower = std::array::from_fn(|a| u[a]);
    let upper = std::array::from_fn(|a| u[a + 4]);
    let mut new = c.old.clone();
    interface::residual::<f64, f64>(
        LAW,
        &CTX,
        &params(c.lambda),
        &c.x,
        &lower,
        &upper,
        rule,
        &c.old,
        &mut new,
    )
}

fn largest(f: &[[f64; 3]; 8]) -> f64 {
    f.iter().flatten().fold(0.0, |m, v| m.max(v.abs()))
}

#[test]
fn cases_are_on_the_branch_their_name_says() {
    for c in cases() {
        let lower = std::array::from_fn(|a| c.u[a]);
        let upper = std::array::from_fn(|a| c.u[a + 4]);
        for (o, _) in interface::openings(&c.x, &lower, &upper, Integration::Nodal) {
            assert_eq!(o[0] < 0.0, c.name.starts_with("closing"), "{}: {o:?}", c.name);
        }
    }
}

#[test]
fn interface_tangent_is_the_derivative_of_the_residual() {
    for rule in [Integration::Gauss, Integration::Nodal] {
        for c in cases() {
            let mut new = c.old.clone();
            let (r, k) =
                interface::tangent(0, LAW, &CTX, &params(c.lambda), &c.x, &c.u, rule, &c.old, &mut new)
                    .unwrap();
            let scale = k.iter().flatten().fold(0.0f64, |m, v| m.max(v.abs()));
            let plain = forces(&c, &c.u, rule);
            let (mut difference, mut asymmetry) = (0.0f64, 0.0f64);
            for j in 0..24 {
                assert!((r[j] - plain[j / 3][j % 3]).abs() < 1e-13 * largest(&plain));
                let at = |h: f64| {
                    let mut u = c.u;
                    u[j / 3][j % 3] += h;
                    forces(&c, &u, rule)
                };
                let h = 1e-4;
                let (a, b, p, q) = (at(h), at(-h), at(2.0 * h), at(-2.0 * h));
                for i in 0..24 {
                    let [a, b, p, q] = [&a, &b, &p, &q].map(|f| f[i / 3][i % 3]);
                    let fd = (8.0 * (a - b) - (p - q)) / (12.0 * h);
                    difference = difference.max((fd - k[i][j]).abs() / scale);
                    asymmetry = asymmetry.max((k[i][j] - k[j][i]).abs() / scale);
                }
            }
            println!(
                "interface tangent, {rule:?}, {}: against differences {difference:.1e}, asymmetry {asymmetry:.1e}",
                c.name
            );
            assert!(difference < 1e-9 && asymmetry < 1e-10, "{}", c.name);
        }
    }
}

#[test]
fn interface_turns_with_its_frame() {
    for c in cases() {
        let q = testing::rotation(0.7, -1.1, 2.3);
        let turned = std::array::from_fn(|a| {
            let x = c.x[a % 4];
            let now = tensor::apply(&q, &std::array::from_fn(|i| x[i] + c.u[a][i]));
            std::array::from_fn(|i| now[i] - x[i] + 0.2)
        });
        let (f, g) = (forces(&c, &c.u, Integration::Gauss), forces(&c, &turned, Integration::Gauss));
        let worst = (0..24)
            .fold(0.0f64, |m, k| m.max((tensor::apply(&q, &f[k / 3])[k % 3] - g[k / 3][k % 3]).abs()))
            / largest(&f);
        println!("interface, rigid rotation, {}: {worst:.1e}", c.name);
        assert!(worst < 1e-12, "{}", c.name);
    }
}

#[test]
fn interface_balances_forces_and_moments() {
    for rule in [Integration::Gauss, Integration::Nodal] {
        for c in cases() {
            let f = forces(&c, &c.u, rule);
            let (mut sum, mut moment) = ([0.0; 3], [0.0; 3]);
            for a in 0..8 {
                let y: [f64; 3] = std::array::from_fn(|i| c.x[a % 4][i] + c.u[a][i]);
                for i in 0..3 {
                    let (j, k) = ((i + 1) % 3, (i + 2) % 3);
                    sum[i] += f[a][i];
                    moment[i] += y[j] * f[a][k] - y[k] * f[a][j];
                }
            }
            let worst = sum.iter().chain(&moment).fold(0.0f64, |m, v| m.max(v.abs())) / largest(&f);
            println!("interface, force and moment left over, {rule:?}, {}: {worst:.1e}", c.name);
            assert!(worst < 1e-13, "{}", c.name);
        }
    }
}

/// Moved apart symmetrically, the full element is the mirrored one: the same force and stiffness in y.
#[test]
fn mirrored_element_is_the_full_one() {
    let base = case("", [0.0; 3], 0.0, 1.0);
    for (uy, old) in
        [([0.1, 0.2, 0.15, 0.3], 0.0), ([0.1, 0.2, 0.15, 0.3], 1.0), ([-0.1, -0.2, -0.15, -0.1], 0.0)]
    {
        let u: [[f64; 3]; 8] = std::array::from_fn(|a| [0.0, if a < 4 { -uy[a] } else { uy[a - 4] }, 0.0]);
        let history = vec![old; 4];
        let mut new = history.clone();
        let (r, k) = interface::mirrored_tangent(
            0,
            LAW,
            &CTX,
            &params(1.0),
            &base.x,
            &uy,
            Integration::Gauss,
            &history,
            &mut new,
        )
        .unwrap();
        let (full, kf) = interface::tangent(
            0,
            LAW,
            &CTX,
            &params(1.0),
            &base.x,
            &u,
            Integration::Gauss,
            &history,
            &mut new,
        )
        .unwrap();
        let scale = k.iter().flatten().fold(0.0f64, |m, v| m.max(v.abs()));
        for a in 0..4 {
            assert!(
                (r[a] - full[3 * (a + 4) + 1]).abs() < 1e-13 * largest(&[[r[0], r[1], r[2]]; 8]).max(scale)
            );
            for b in 0..4 {
                let (i, upper, lower) = (3 * (a + 4) + 1, 3 * (b + 4) + 1, 3 * b + 1);
                assert!((k[a][b] - (kf[i][upper] - kf[i][lower])).abs() < 1e-12 * scale);
            }
        }
    }
}
