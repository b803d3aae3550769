//! Tears whose strength hangs on their rate: where the rig stands, and where it turns, points of the tear path stand too,
//! and their strength is next to a step.

use crate::small;

use analysis::{SimulateControl, simulate};
use std::sync::Arc;

/// Runs the strip with such a tear through its record; the gap of its energies as a share of the work.
fn run(c: f64, rate0: f64) -> f64 {
    let root = tempfile::tempdir().expect("a folder");
    small::write_records(root.path(), true);
    let text = format!(
        r#"{}
[mesh]
divisions = [12, 8, 1]
[bulk]
mu_kPa = 20.0
k1_kPa = 50.0
k2 = 1.0
gamma_deg = 40.0
kappa = 0.2
[interface]
gc_N_per_mm = 0.05
sigma_c_MPa = 0.05
[effects.rate_dependent_strength]
c = {c}
rate0_mm_per_s = {rate0}
"#,
        small::STRIP
    );
    let path = root.path().join("case.toml");
    std::fs::write(&path, text).expect("a config");
    let catalogue = effects::catalogue();
    let case = input::read_case(&path, &catalogue).unwrap_or_else(|e| panic!("{e}"));
    let control = SimulateControl { progress: &|_, _| {}, cancelled: &|| false };
    let done = simulate(Arc::new(case), &catalogue, &control).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(done.failure(), None, "c {c}, rate0 {rate0}");
    done.tests[1].closure
}

#[test]
fn a_tear_is_followed_through_holds_and_turns() {
    for (c, rate0) in [(0.55, 0.08), (0.2, 1e-3), (0.05, 1e-3), (0.02, 1e-4), (0.6, 1e-5)] {
        let gap = run(c, rate0);
        println!("c {c}, rate0 {rate0} mm/s: energies close to {gap:.1e}");
        assert!(gap.abs() < 2e-3, "{gap}");
    }
}
