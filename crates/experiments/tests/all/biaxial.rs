//! Biaxial stretch: the incompressible HGO sheet in plane stress, P_i = ∂W/∂λ_i; derivatives of both forces against
//! differences.

use crate::common::{case_of, fault, run};
use model::{Discretisation, Model, Request, RunOptions};
use std::sync::Arc;

/// μ and k1 (MPa), k2, γ (°), κ.
const TISSUE: [f64; 5] = [5.1e-3, 0.0388, 8.0, 30.0, 0.15];
/// Length, width, thickness, mm.
const SHEET: [f64; 3] = [10.0, 8.0, 1.2];

/// MPa; the closed form's is infinite, and what is missing to that is in inverse proportion.
const NEARLY_INCOMPRESSIBLE: f64 = 2000.0;

fn text(test: &str, rest: &str) -> String {
    let ([mu, k1, k2, gamma, kappa], [length, width, thickness]) = (TISSUE, SHEET);
    format!(
        "name = \"sheet\"\n[geometry]\nlength_mm = {length}\nwidth_mm = {width}\nthickness_mm = {thickness}\n\
         [[tests]]\nkind = \"biaxial\"\n{test}\n\
         [bulk]\nmu_MPa = {mu}\nk1_MPa = {k1}\nk2 = {k2}\ngamma_deg = {gamma}\nkappa = {kappa}\n\
         bulk_modulus_MPa = {NEARLY_INCOMPRESSIBLE}\n{rest}\n"
    )
}

fn protocol(to: f64, ratio: f64) -> String {
    format!("protocol = [{{ to_mm = {to}, rate_mm_per_s = 0.05 }}]\nratio_x = {ratio}")
}

/// Forces along y and x of the homogeneous sheet, N.
fn closed_form([along, across]: [f64; 2]) -> [f64; 2] {
    let ([mu, k1, k2, gamma, kappa], [length, width, thickness]) = (TISSUE, SHEET);
    let (y, x) = (1.0 + along / length, 1.0 + across / width);
    let (sin, cos) = gamma.to_radians().sin_cos();
    let i1 = x * x + y * y + 1.0 / (x * y).powi(2);
    let i4 = (y * cos).powi(2) + (x * sin).powi(2);
    let e = (kappa * (i1 - 3.0) + (1.0 - 3.0 * kappa) * (i4 - 1.0)).max(0.0);
    // Two families.
    let fibres = 2.0 * k1 * e * (k2 * e * e).exp();
    let stress = |own: f64, other: f64, part: f64| {
        let di1 = 2.0 * own - 2.0 / (own.powi(3) * other * other);
        0.5 * mu * di1 + fibres * (kappa * di1 + (1.0 - 3.0 * kappa) * 2.0 * own * part)
    };
    [stress(y, x, cos * cos) * width * thickness, stress(x, y, sin * sin) * length * thickness]
}

#[test]
fn both_forces_are_those_of_the_closed_form() {
    for ratio in [1.0, 0.4, 1.6, 0.0] {
        let test = run(&text(&protocol(2.0, ratio), ""));
        let [across, force_x] = &test.across;
        let largest = closed_form([2.0, 2.0 * ratio]);
        let mut worst = [0.0f64; 2];
        for k in 0..test.force.len() {
            let [fy, fx] = closed_form([test.displacement[k], across[k]]);
            worst[0] = worst[0].max((test.force[k] - fy).abs() / largest[0]);
            worst[1] = worst[1].max((force_x[k] - fx).abs() / largest[1]);
        }
        println!(
            "ratio {ratio}: largest forces {largest:.4?} N, off by {:.1e} {:.1e} of them, closure {:.1e}",
            worst[0], worst[1], test.closure
        );
        assert!(worst.iter().all(|w| *w < 1e-3), "{worst:?}");
        assert!(test.closure < 1e-5, "{}", test.closure);
    }
}

/// Both forces at the end of a test with a hold and an unloading, and their derivatives by every seed.
fn forces(text: &str, seeds: &[&str], change: Option<(&str, f64)>) -> (Vec<[f64; 2]>, Vec<Vec<[f64; 2]>>) {
    let (case, catalogue) = case_of(text);
    let model = Model::new(Arc::new(case), &catalogue, Discretisation::default()).expect("a model");
    let mut theta = model.theta();
    let at = |path: &str| model.find(path).unwrap_or_else(|| panic!("{path}"));
    if let Some((path, by)) = change {
        theta[at(path)] += by;
    }
    let columns: Vec<usize> = seeds.iter().map(|s| at(s)).collect();
    let mut options = RunOptions::default();
    options.stepping.newton.tolerance = 1e-11;
    let runs = model
        .run(&Request {
            theta: &theta,
            seeds: &columns,
            options,
            wanted: &[true],
            warm: &[],
            cancelled: &|| false,
        })
        .expect("a run");
    let run = &runs[0].as_ref().expect("the test").run;
    assert_eq!(run.failure, None);
    let values = run.steps.iter().map(|s| [s.reactions[0], s.reactions[1]]).collect();
    let by = |c: usize| {
        let one = |s: &fem::StepRecord| [0, 1].map(|r| s.derivatives.reactions[r][c]);
        run.steps.iter().map(one).collect()
    };
    (values, (0..columns.len()).map(by).collect())
}

#[test]
fn derivatives_of_both_forces_agree_with_differences() {
    let legs = "protocol = [{ to_mm = 1.5, rate_mm_per_s = 0.05 }, { hold_s = 20.0 }, { to_mm = 0.5, rate_mm_per_s = 0.05 }, \
                { to_mm = 2.0, rate_mm_per_s = 0.1 }]\nratio_x = 0.7";
    let rest = "[mesh]\ndivisions = [4, 4, 2]\n[effects.viscoelastic]\ng = 0.3\ntau_s = 8.0\n[effects.mullins]\na = 0.3\n";
    for ends in ["sliding", "clamped"] {
        // As stiff as tissue is usually taken: differences of a stiffer one are of rounding.
        let text = text(&format!("{legs}\nends = \"{ends}\""), rest).replace("_MPa = 2000", "_MPa = 20");
        let paths = [
            "bulk.mu",
            "bulk.k1",
            "bulk.k2",
            "bulk.gamma",
            "bulk.kappa",
            "effects.viscoelastic.g",
            "effects.viscoelastic.tau",
            "effects.mullins.a",
        ];
        let (values, exact) = forces(&text, &paths, None);
        let peak = |v: &[[f64; 2]], axis: usize| v.iter().fold(0.0f64, |m, f| m.max(f[axis].abs()));
        assert!(peak(&values, 0) > 0.0 && peak(&values, 1) > 0.0);
        let start = {
            let (case, catalogue) = case_of(&text);
            let model = Model::new(Arc::new(case), &catalogue, Discretisation::default()).expect("a model");
            paths.map(|p| model.theta()[model.find(p).expect("found")])
        };
        for (c, path) in paths.iter().enumerate() {
            let h = 1e-5 * start[c];
            let (up, down) = (forces(&text, &[], Some((path, h))).0, forces(&text, &[], Some((path, -h))).0);
            for axis in [0, 1] {
                let scale = peak(&exact[c], axis);
                let error = (0..up.len())
                    .map(|k| ((up[k][axis] - down[k][axis]) / (2.0 * h) - exact[c][k][axis]).abs());
                let worst = error.fold(0.0f64, f64::max) / scale;
                println!("{ends}, {path}, force {}: {worst:.1e}", ["y", "x"][axis]);
                assert!(worst < 1e-5, "{ends} {path} {axis}: {worst}");
            }
        }
    }
}

#[test]
fn what_has_one_axis_has_no_second() {
    let message = fault(&text("protocol = [{ to_mm = 2.0, rate_mm_per_s = 0.05 }]\nratio_x = 40.0", ""));
    assert!(message.contains("ratio_x") && message.contains("10"), "{message}");
    let one = text(&protocol(2.0, 0.5), "").replace("biaxial", "uniaxial");
    let message = fault(&one);
    assert!(message.contains("`ratio_x`: a `uniaxial` test has one axis"), "{message}");
}
