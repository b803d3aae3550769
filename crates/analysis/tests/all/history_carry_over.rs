//! Derivatives through two tests of one piece that remembers: what the first test does not hold costs nothing
//! there, and reaches the second all the same.

use fem::SteppingOptions;
use model::{Discretisation, Model, Request, RunOptions};
use std::sync::Arc;

const CASE: &str = r#"
name = "history"
[geometry]
length_mm = 6.0
width_mm = 4.0
thickness_mm = 0.8
cut_mm = 1.0
[[tests]]
kind = "uniaxial"
protocol = [
  { to_mm = 0.5, rate_mm_per_s = 0.05 },
  { to_mm = 0.0, rate_mm_per_s = 0.05 },
]
[[tests]]
kind = "tearing"
protocol = [
  { to_mm = 1.2, rate_mm_per_s = 0.05 },
  { to_mm = 0.6, rate_mm_per_s = 0.05 },
  { to_mm = 1.6, rate_mm_per_s = 0.05 },
]
[mesh]
divisions = [6, 6, 1]
[bulk]
mu_kPa = 5.0
k1_kPa = 200.0
k2 = 5.0
gamma_deg = 40.0
kappa = 0.2
[interface]
gc_N_per_mm = 0.05
sigma_c_MPa = 0.06
[effects.mullins]
[effects.viscoelastic]
"#;

/// Derivatives of the tearing force by the parameter, with these beside it.
fn slopes(model: &Model, of: &str, beside: &[&str]) -> Vec<f64> {
    let seeds: Vec<usize> =
        beside.iter().chain([&of]).map(|name| model.find(name).expect("parameter")).collect();
    let theta = model.theta();
    let options = RunOptions {
        stepping: SteppingOptions { keep_states: true, ..SteppingOptions::default() },
        tearing_steps: 12,
        uniaxial_steps: 6,
        follow_holds: true,
        follow_turns: false,
    };
    let request = Request {
        theta: &theta,
        options,
        seeds: &seeds,
        wanted: &[true, true],
        warm: &[],
        cancelled: &|| false,
    };
    let runs = model.run(&request).expect("run");
    let tear = runs[1].as_ref().expect("wanted");
    assert!(tear.run.failure.is_none(), "{:?}", tear.run.failure);
    tear.run.steps.iter().map(|s| s.derivatives.force[seeds.len() - 1]).collect()
}

#[test]
fn a_parameter_of_the_tear_needs_no_company_to_be_differentiated_by() {
    let dir = tempfile::tempdir().expect("temporary folder");
    let path = dir.path().join("case.toml");
    std::fs::write(&path, CASE).expect("config");
    let catalogue = effects::catalogue();
    let case = input::read_case(&path, &catalogue).expect("case");
    let model = Model::new(Arc::new(case), &catalogue, Discretisation::default()).expect("model");
    let gc = "interface.area[1].gc";
    // Alone it passes the intact test by; beside μ it is carried through all of it.
    let (alone, beside) = (slopes(&model, gc, &[]), slopes(&model, gc, &["bulk.mu"]));
    let size = beside.iter().fold(0.0f64, |m, x| m.max(x.abs()));
    assert!(size > 0.0);
    let worst = alone.iter().zip(&beside).map(|(a, b)| (a - b).abs() / size).fold(0.0, f64::max);
    println!("alone and in company: {worst:.1e} of the largest derivative");
    assert!(alone.len() == beside.len() && worst < 1e-9, "{worst:e}");
}
