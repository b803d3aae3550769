//! At its neutral value every effect of the catalogue leaves a simulation as it is, to the last bit.

use analysis::{SimulateControl, Simulated, simulate};
use input::Case;
use model::{Catalogue, Options};
use std::sync::Arc;

const CASE: &str = r#"
name = "neutral"
provenance = "synthetic"
[geometry]
length_mm = 4.0
width_mm = 3.0
thickness_mm = 0.8
cut_mm = 1.0
[[tests]]
kind = "uniaxial"
[[tests.protocol]]
to_mm = 0.5
rate_mm_per_s = 0.02
[[tests.protocol]]
to_mm = 0.2
rate_mm_per_s = 0.02
[[tests]]
kind = "tearing"
[[tests.protocol]]
to_mm = 0.8
rate_mm_per_s = 0.05
[[tests.protocol]]
to_mm = 0.3
rate_mm_per_s = 0.05
[[tests.protocol]]
to_mm = 1.0
rate_mm_per_s = 0.2
[mesh]
divisions = [6, 4, 2]
[bulk]
mu_kPa = 20.0
k1_kPa = 50.0
k2 = 2.0
gamma_deg = 40.0
kappa = 0.2
[interface]
gc_N_per_mm = 0.05
sigma_c_MPa = 0.05
[solver]
step_mm = 0.1
"#;

fn case(catalogue: &Catalogue) -> Case {
    let dir = tempfile::tempdir().expect("temporary folder");
    let path = dir.path().join("case.toml");
    std::fs::write(&path, CASE).expect("config");
    input::read_case(&path, catalogue).expect("case")
}

/// The effect with its first parameter moved off the neutral value by this share of the way to its start.
fn with(case: &Case, catalogue: &Catalogue, name: &str, share: f64) -> Case {
    let effect = catalogue.get(name).expect("effect");
    let specs = effect.parameters(&Options::new());
    let value = |k: usize, s: &params::ParamSpec| match s.neutral {
        Some(n) if k == 0 => n + share * (s.start - n),
        Some(n) => n,
        None => s.start,
    };
    let parameters = specs.iter().enumerate();
    let mut with = case.clone();
    with.effects.push(input::EffectConfig {
        name: name.to_owned(),
        parameters: parameters.map(|(k, s)| (s.name.to_string(), input::Value::new(value(k, s)))).collect(),
        options: effect.options().into_iter().filter_map(|o| o.default.map(|d| (o.name, d))).collect(),
        location: input::Location::default(),
        specs,
    });
    with
}

fn run(case: Case, catalogue: &Catalogue) -> Simulated {
    let control = SimulateControl { progress: &|_, _| {}, cancelled: &|| false };
    simulate(Arc::new(case), catalogue, &control).expect("model")
}

/// All that a test reads, as bits.
fn bits(s: &Simulated) -> Vec<u64> {
    let series =
        s.tests.iter().flat_map(|t| [&t.displacement, &t.force, &t.grip_displacement, &t.tear_front]);
    series.flatten().map(|v| v.to_bits()).collect()
}

#[test]
fn a_neutral_effect_changes_no_bit_of_a_simulation() {
    let catalogue = effects::catalogue();
    let base_case = case(&catalogue);
    let base = bits(&run(base_case.clone(), &catalogue));
    let mut moved = 0;
    for effect in catalogue.iter() {
        let name = effect.card().name;
        let neutral = run(with(&base_case, &catalogue, name, 0.0), &catalogue);
        assert!(bits(&neutral) == base, "{name}: neutral is not the base model to the bit");
        assert_eq!(neutral.model.effects(), [name], "a neutral effect is still shown");
        // The comparison sees an effect that is there.
        moved += usize::from(bits(&run(with(&base_case, &catalogue, name, 0.5), &catalogue)) != base);
    }
    println!("{moved} of {} effects show in this test when they are not neutral", catalogue.iter().count());
    assert!(moved >= 18, "{moved}");
}
