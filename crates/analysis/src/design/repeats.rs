//! The power that a design promises is the share of noisy records on which the screen calls the effect.

use super::*;
use crate::columns::{case_with, config_of, transfer};
use diagnose::Foreseen;
use inverse::{Noise, Random, Whitened};

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

/// (promised, found) powers of some effects, each at the size that is seen with these powers.
fn powers(effects: &[&str], promised: &[f64], repeats: usize) -> Vec<(String, f64, f64)> {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("c.toml");
    std::fs::write(&file, STRIP).expect("written");
    let catalogue = effects::catalogue();
    let case = Arc::new(input::read_case(&file, &catalogue).expect("a good file"));
    let go = || false;
    let table = Table { case, catalogue: &catalogue, cancelled: &go, policy: Policy::default() };
    let (pulls, peaks) = table.pulls().expect("a run");
    let legs = PROGRAMS[3].within(&pulls, 3600.0).expect("within an hour");
    let (linear, planned) =
        table.look(table.planned(&legs, &table.noise(&peaks, None), false), &catalogue).expect("a look");
    let foreseen = linear.foresight(&catalogue, &table.policy, false).expect("a foresight").effects;
    let (base, how) = model_of(&planned, &catalogue).expect("a model");
    let mut out = Vec::new();
    for &name in effects {
        let f = foreseen.iter().find(|f| f.effect == name).expect("in the catalogue");
        for &power in promised {
            let truth = with_effect(&table, &base, how, &linear, f, size(f, power));
            let fitted = refitted(&table, &base, how, &linear, &truth);
            out.push((name.to_owned(), power, share(&table, &fitted, &truth, name, repeats)));
        }
    }
    out
}

/// The size that is seen with a power.
fn size(f: &Foreseen, power: f64) -> f64 {
    let ninety = diagnose::tails::normal_isf(0.1);
    f.least.expect("visible") - (ninety - diagnose::tails::normal_isf(1.0 - power)) * f.plausible / f.snr
}

/// What the records would read with the effect, in full.
fn with_effect(
    table: &Table,
    base: &Model,
    how: Discretisation,
    linear: &Linear,
    f: &Foreseen,
    size: f64,
) -> nalgebra::DVector<f64> {
    let effect = table.catalogue.get(&f.effect).expect("in the catalogue");
    let specs = effect.parameters(&model::Options::new());
    let of_shape = |key: &str| f.shape.iter().find(|s| s.0 == key).map(|s| s.1);
    let values: Vec<f64> = specs
        .iter()
        .enumerate()
        .map(
            |(k, s)| {
                if k == 0 { s.neutral.unwrap_or(0.0) + size } else { of_shape(&s.key()).unwrap_or(s.start) }
            },
        )
        .collect();
    let case = case_with(&base.case, &[config_of(effect, &values)]);
    let model = Model::new(Arc::new(case), table.catalogue, how).expect("a model");
    let mut theta = transfer(base, &base.theta(), &model);
    for (s, v) in specs.iter().zip(&values) {
        let at = model.find(&format!("effects.{}.{}", f.effect, s.name)).expect("a parameter");
        theta[at] = *v;
    }
    let problem = FeProblem::new(
        &model,
        theta,
        Vec::new(),
        &linear.measured.slots,
        options(&model.case),
        table.cancelled,
    );
    problem.predict(&[], false).expect("a run").values
}

/// The base fitted to the truth, as it is before a screen.
fn refitted(
    table: &Table,
    base: &Model,
    how: Discretisation,
    linear: &Linear,
    truth: &nalgebra::DVector<f64>,
) -> Linear {
    let mut measured = linear.measured.clone();
    for block in &mut measured.data.blocks {
        block.measured = truth.rows(block.range.start, block.range.len()).iter().copied().collect();
    }
    let (frees, free) = (linear.base().0, base.free());
    let slots = &linear.measured.slots;
    let problem =
        FeProblem::new(base, base.theta(), free.clone(), slots, options(&base.case), table.cancelled);
    let how_far = inverse::FitOptions { objective: inverse::Objective::Record, ..Default::default() };
    let mut watch = |_: &inverse::Iterate| std::ops::ControlFlow::Continue(());
    let fit = inverse::fit(&problem, &measured.data, frees, &how_far, &mut watch).expect("a fit");
    let theta = problem.full(&fit.theta);
    super::linear(base, how, &theta, measured, table.catalogue, table.cancelled).expect("a look")
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
        let none = vec![false; frees.len()];
        let screen = diagnose::screen(&white, &none, &linear.candidates, data.points(), &table.policy)
            .expect("a screen");
        called += usize::from(screen.finding(name).is_some_and(|f| f.significant));
    }
    called as f64 / repeats as f64
}

#[test]
fn noisy_repeats_confirm_the_promised_power() {
    for (name, promised, found) in powers(&["mullins"], &[0.7], 60) {
        println!("{name}: promised {promised}, found {found}");
        // A share of 60 is known to 6 points.
        assert!((found - promised).abs() < 0.1 + 0.06, "{name}: promised {promised}, found {found}");
    }
}

/// `just design-power`. It fails today: the promise is linear, and an effect that the
/// base parameters imitate nearly (compliance, prestretch, grip_slip here) shows by what is not linear in it.
#[test]
#[ignore = "many repeats: minutes"]
fn noisy_repeats_of_many_effects() {
    let names =
        ["viscoelastic", "mullins", "compliance", "slack", "grip_slip", "drift", "bridging", "prestretch"];
    let found = powers(&names, &[0.5, 0.8], 300);
    for (name, promised, found) in &found {
        println!("{name}: promised {promised}, found {found:.2}");
    }
    for (name, promised, found) in &found {
        assert!((found - promised).abs() < 0.1, "{name}: promised {promised}, found {found}");
    }
}
