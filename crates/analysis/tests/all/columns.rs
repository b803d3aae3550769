//! Every effect of the catalogue on a small tear: neutral is the base to the bit, and the screen's
//! column is the derivative that a finite change shows.

use crate::small;

use analysis::{Base, FeProblem, Measured, scales};
use diagnose::Candidate;
use input::Case;
use inverse::Problem;
use model::{Catalogue, Discretisation, Model, RunOptions, Screening};
use nalgebra::DVector;
use std::path::PathBuf;
use std::sync::Arc;

/// Points of a record near a state in which a law switches, so that the derivative has two sides: the virgin strip, in
/// which every fibre is between tension and none, and the old maximum that a reload comes back to, in which every point
/// of the tear is between loading and not. (A hold is made of nothing else: this record has none.)
const SWITCHING: [std::ops::Range<usize>; 2] = [0..5, 31..37];

/// Divisions on which columns are held against differences.
const MESH: &str = "[6, 4, 2]";

/// A folder with a specimen whose records hold a ramp, an unload, a fast reload and, where asked, a hold.
fn specimen(name: &str, hold: bool, divisions: &str) -> PathBuf {
    let dir = std::env::temp_dir().join(format!("fct-columns-{name}-{}", std::process::id()));
    std::fs::create_dir_all(&dir).expect("temporary folder");
    small::write_records(&dir, hold);
    let config = r#"
[mesh]
divisions = DIVISIONS
[bulk]
mu_kPa = 20.0
k1_kPa = 50.0
k2 = 2.0
gamma_deg = 40.0
kappa = 0.2
[interface]
gc_N_per_mm = 0.05
sigma_c_MPa = 0.05
"#;
    let path = dir.join("case.toml");
    std::fs::write(&path, [small::STRIP, &config.replace("DIVISIONS", divisions)].concat()).expect("config");
    path
}

fn options() -> RunOptions {
    let steps = RunOptions { tearing_steps: 16, uniaxial_steps: 10, ..RunOptions::default() };
    RunOptions { follow_holds: true, follow_turns: true, ..steps }
}

fn predict(case: &Case, catalogue: &Catalogue, set: &[(String, f64)]) -> DVector<f64> {
    let model = Model::new(
        Arc::new(case.clone()),
        catalogue,
        Discretisation { neutral_halves: true, ..Default::default() },
    )
    .expect("model");
    let mut theta = model.theta();
    for (path, v) in set {
        theta[model.find(path).expect("parameter")] = *v;
    }
    let measured = Measured::of(&model, &vec![true; model.tests.len()]).expect("data");
    let problem = FeProblem::new(&model, theta, Vec::new(), &measured.slots, options(), &|| false);
    problem.predict(&[], false).expect("run").values
}

/// What the screen gives for every effect, each with the case that holds it at its neutral value.
struct Shown {
    catalogue: Catalogue,
    base: DVector<f64>,
    candidates: Vec<Candidate>,
    with: Vec<Case>,
}

fn screened(case: &Case, catalogue: &Catalogue) -> Vec<Candidate> {
    let model = Model::new(Arc::new(case.clone()), catalogue, Discretisation::default()).expect("model");
    let measured = Measured::of(&model, &[true, true]).expect("data");
    Base {
        model: &model,
        theta: &model.theta(),
        free: &[],
        catalogue,
        how: Discretisation::default(),
        options: options(),
        slots: &measured.slots,
        warm: &[],
        cancelled: &|| false,
    }
    .screen()
    .expect("screen")
    .candidates
}

fn shown(case: &Case) -> Shown {
    let catalogue = effects::catalogue();
    let base = predict(case, &catalogue, &[]);
    let candidates = screened(case, &catalogue);
    let with = candidates.iter().map(|c| with_neutral(case, &catalogue, c)).collect();
    Shown { catalogue, base, candidates, with }
}

/// The case with an effect at its neutral value and the shape parameters of its first column.
fn with_neutral(case: &Case, catalogue: &Catalogue, c: &Candidate) -> Case {
    let effect = catalogue.get(&c.effect).expect("effect");
    let specs = effect.parameters(&model::Options::new());
    let shape = c.shapes.first().unwrap_or_else(|| panic!("{} has no column", c.effect));
    let mut values: Vec<f64> = vec![specs[0].neutral.unwrap_or(0.0)];
    values.extend(shape.parameters.iter().map(|p| p.1));
    let mut with = case.clone();
    with.effects.push(input::EffectConfig {
        name: c.effect.clone(),
        parameters: specs
            .iter()
            .zip(values)
            .map(|(s, v)| (s.name.to_string(), input::Value::new(v)))
            .collect(),
        specs,
        options: effect.options().into_iter().filter_map(|o| o.default.map(|d| (o.name, d))).collect(),
        location: input::Location::default(),
    });
    with
}

impl Shown {
    /// Prediction with the amplitude of the k-th effect this far from neutral.
    fn at(&self, k: usize, away: f64) -> DVector<f64> {
        let name = &self.candidates[k].effect;
        let spec = &self.catalogue.get(name).expect("effect").parameters(&model::Options::new())[0];
        let value = spec.neutral.unwrap_or(0.0) + away;
        predict(&self.with[k], &self.catalogue, &[(format!("effects.{name}.{}", spec.name), value)])
    }

    fn is_refitted(&self, k: usize) -> bool {
        let effect = self.catalogue.get(&self.candidates[k].effect).expect("effect");
        matches!(effect.card().screening, Screening::Refit(_))
    }
}

fn case_of(name: &str, hold: bool, divisions: &str) -> Case {
    let path = specimen(name, hold, divisions);
    let case = input::read_case(&path, &effects::catalogue()).expect("case");
    let _ = std::fs::remove_dir_all(path.parent().expect("folder"));
    case
}

#[test]
fn neutral_is_base_and_columns_are_derivatives() {
    let s = shown(&case_of("ramps", false, MESH));
    let smooth = |v: DVector<f64>| {
        let record = v.len() / 2;
        let switching = |i: &usize| SWITCHING.iter().any(|s| s.contains(&(i % record)));
        DVector::from_vec((0..v.len()).filter(|i| !switching(i)).map(|i| v[i]).collect())
    };
    let mut compared = 0;
    for (k, c) in s.candidates.iter().enumerate() {
        let neutral = s.at(k, 0.0);
        assert!(
            (&neutral - &s.base).amax() <= 1e-9 * s.base.amax(),
            "{}: neutral differs from base by {:e}",
            c.effect,
            (&neutral - &s.base).amax()
        );
        if s.is_refitted(k) {
            continue;
        }
        let step = 1e-5 * c.amplitudes[0].plausible;
        let difference = smooth((s.at(k, step) - &neutral) / step);
        let column = smooth(c.shapes[0].columns.column(0).into_owned());
        if column.amax().max(difference.amax()) == 0.0 {
            continue;
        }
        let error = (&column - &difference).norm() / difference.norm().max(f64::MIN_POSITIVE);
        println!("{:26} column against difference: {error:.1e} (largest {:.2e})", c.effect, column.amax());
        assert!(error < 3e-5, "{}: column off by {error:.2e}", c.effect);
        compared += 1;
    }
    assert!(compared >= 15, "only {compared} effects showed");
}

/// With each effect in force at its ordinary size, misalignment with its whole height among them, the others are screened.
#[test]
fn a_model_with_any_effect_is_screened_for_the_others() {
    let case = case_of("others", false, "[4, 2, 2]");
    let plain = shown(&case);
    let model = Model::new(Arc::new(case), &plain.catalogue, Discretisation::default()).expect("model");
    let sizes = scales(&model, &model.theta());
    for with in &plain.with {
        let (mut with, name) = (with.clone(), with.effects[0].name.clone());
        let effect = plain.catalogue.get(&name).expect("effect");
        let specs = effect.parameters(&model::Options::new());
        for (spec, value) in specs.iter().zip(effect.start(&sizes)) {
            with.effects[0].parameters.insert(spec.name.to_string(), input::Value::new(value));
        }
        let screened = screened(&with, &plain.catalogue);
        let names: Vec<&str> = screened.iter().map(|c| c.effect.as_str()).collect();
        assert!(
            names.len() + 2 >= plain.candidates.len() && !names.contains(&name.as_str()),
            "{name}: {names:?}"
        );
        for c in &screened {
            let finite = c.shapes.iter().all(|s| s.columns.iter().all(|x| x.is_finite()));
            assert!(finite && !c.shapes.is_empty(), "{} beside {name}", c.effect);
        }
    }
}
