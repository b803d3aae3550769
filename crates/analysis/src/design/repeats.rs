//! The power that a design promises is the share of noisy records on which the screen calls the effect.

use super::engine::{LOOK, Linear};
use super::full::{Full, seen_at};
use super::program::PROGRAMS;
use super::table::Table;
use diagnose::{Foreseen, Policy};
use inverse::{Noise, Random, Whitened};
use std::sync::Arc;

const STRIP: &str = r#"
name = "small"
[geometry]
length_mm = 4.0
width_mm = 3.0
thickness_mm = 0.8
cut_mm = 1.0
[[tests]]
kind = "uniaxial"
protocol = [{ to_mm = 1.0, rate_mm_per_s = 0.05 }]
force_sd_N = 0.0004
[[tests]]
kind = "tearing"
protocol = [{ to_mm = 2.0, rate_mm_per_s = 0.05 }]
force_sd_N = 0.0004
[mesh]
divisions = [10, 16, 1]
[bulk]
mu_kPa = 20.0
k1_kPa = 400.0
k2 = 2.0
gamma_deg = 40.0
kappa = 0.2
[interface]
gc_N_per_mm = 0.05
sigma_c_MPa = 0.1
"#;

/// (promised, found) powers of some effects, each at the size that is seen with these powers; on the strip with these
/// divisions.
fn powers(divisions: &str, effects: &[&str], promised: &[f64], repeats: usize) -> Vec<(String, f64, f64)> {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("c.toml");
    std::fs::write(&file, STRIP.replace("[10, 16, 1]", divisions)).expect("written");
    let catalogue = effects::catalogue();
    let case = Arc::new(input::read_case(&file, &catalogue).expect("a good file"));
    let go = || false;
    let table = Table { case, catalogue: &catalogue, cancelled: &go, policy: Policy::default(), steps: LOOK };
    let (pulls, peaks) = table.pulls().expect("a run");
    let legs = PROGRAMS[3].within(&pulls, 3600.0).expect("within an hour");
    let full = Full::new(&table, &legs, &table.noise(&peaks, None)).expect("a look");
    let foreseen = full.foreseen().expect("a foresight");
    let mut out = Vec::new();
    for &name in effects {
        let f = foreseen.iter().find(|f| f.effect == name).expect("in the catalogue");
        let confirmed = full.confirmed(f).expect("asked");
        println!("{name}: {}", said(f, &confirmed.tried));
        for &power in promised {
            let Some(size) = seen_at(&confirmed.tried, power) else {
                println!("{name}: no size has a power of {power} ({:?})", confirmed.not);
                continue;
            };
            let truth = full.truth(f, size).expect("a run");
            let fitted = full.refitted(&truth, &full.starts(&confirmed.fitted, size)).expect("a fit");
            out.push((name.to_owned(), power, share(&table, &fitted, &truth, name, repeats)));
        }
    }
    out
}

/// What the linear look says of sizes, and what was tried.
fn said(f: &Foreseen, tried: &[(f64, f64)]) -> String {
    let tried: Vec<String> = tried.iter().map(|(s, p)| format!("{s:.3e} ({p:.2})")).collect();
    format!("plausible {:.3e}, linear snr {:.1}; tried {}", f.plausible, f.snr, tried.join(", "))
}

/// Share of noisy records of a truth on which the screen calls the effect significant.
fn share(table: &Table, linear: &Linear, truth: &nalgebra::DVector<f64>, name: &str, repeats: usize) -> f64 {
    let mut random = Random::new(31);
    let mut called = 0;
    for _ in 0..repeats {
        let mut data = linear.measured.data.clone();
        let record = truth + data.simulate_noise(&mut random);
        for block in &mut data.blocks {
            block.measured = record.rows(block.range.start, block.range.len()).iter().copied().collect();
        }
        let (frees, theta) = linear.base();
        let white = Whitened::new(&data, frees, theta, &linear.prediction, Noise::Record);
        let at_bound: Vec<bool> = frees.iter().zip(theta).map(|(f, t)| f.at_bound(*t)).collect();
        let screen = diagnose::screen(&white, &at_bound, &linear.candidates, data.points(), &table.policy)
            .expect("a screen");
        called += usize::from(screen.finding(name).is_some_and(|f| f.significant));
    }
    called as f64 / repeats as f64
}

#[test]
fn noisy_repeats_confirm_the_promised_power() {
    for (name, promised, found) in powers("[4, 6, 1]", &["mullins"], &[0.7], 60) {
        println!("{name}: promised {promised}, found {found}");
        // A share of 60 is known to 6 points.
        assert!((found - promised).abs() < 0.1 + 0.06, "{name}: promised {promised}, found {found}");
    }
}

/// `just design-power`
#[test]
#[ignore = "many repeats: minutes"]
fn noisy_repeats_of_many_effects() {
    let names =
        ["viscoelastic", "mullins", "compliance", "slack", "grip_slip", "drift", "bridging", "prestretch"];
    let found = powers("[10, 16, 1]", &names, &[0.5, 0.8], 300);
    for (name, promised, found) in &found {
        println!("{name}: promised {promised}, found {found:.2}");
    }
    for (name, promised, found) in &found {
        assert!((found - promised).abs() < 0.1, "{name}: promised {promised}, found {found}");
    }
}
