//! Limits, invariances, and what is left.

use crate::toys;

use evidence::{
    Belief, Evidence, EvidenceError, ExplainedTo, Kernel, Linear, Place, Record, RestPrior, at_the_mode,
    remains,
};
use inverse::{Data, NoiseModel, Random};
use nalgebra::{DMatrix, DVector};
use toys::*;

const PEAK: f64 = 3.0;

fn base() -> Vec<evidence::Parameter> {
    vec![parameter("a", Belief::normal(0.0, 0.2), false), parameter("b", Belief::normal(0.0, 0.3), false)]
}

fn with_effect() -> Vec<evidence::Parameter> {
    let mut p = base();
    p.push(parameter("effects.bump.size", Belief::above(0.0, 0.1), true));
    p
}

/// Bayes factor of an effect on a record that has it and nothing else.
fn factor(record: &Record, r: &DVector<f64>, rest: &RestPrior) -> f64 {
    let z = |kinds: &[usize], p| {
        Evidence::of(record, &linear(r.clone(), kinds, p, PEAK), rest, Kernel::Plain).expect("evidence").ln_z
    };
    z(&[0, 1, 3], with_effect()) - z(&[0, 1], base())
}

#[test]
fn a_vanishing_rest_gives_the_classical_bayes_factor() {
    let n = 60;
    let r = column(3, n, 0.1) + Random::new(2).normals(n) * 0.05;
    let record = record(&data(&r, NoiseModel::white(0.05)), PEAK);
    let classical = factor(&record, &r, &no_rest());
    let mut last = f64::INFINITY;
    for scale in [1e-2, 1e-3, 1e-4, 1e-5] {
        let rest = RestPrior { smooth: scale, jerk: scale, ..RestPrior::default() };
        let off = (factor(&record, &r, &rest) - classical).abs();
        assert!(off < last, "{scale}: {off}");
        last = off;
    }
    assert!(last < 1e-3, "{last}");
    // And a rest takes certainty away.
    assert!(factor(&record, &r, &RestPrior::default()) < classical);
}

/// Computed records hold no noise: what is certain becomes more so, and stays finite.
#[test]
fn records_without_noise_have_finite_answers() {
    let n = 200;
    let r = column(3, n, 0.1);
    let mut last = 0.0;
    for sd in [1e-2, 1e-4, 1e-6] {
        let record = record(&data(&r, NoiseModel::white(sd * PEAK)), PEAK);
        let ln_b = factor(&record, &r, &RestPrior::default());
        assert!(ln_b.is_finite() && ln_b > last, "{sd}: {ln_b}");
        last = ln_b;
    }
}

#[test]
fn few_points_say_little_and_break_nothing() {
    for n in [1, 2, 3, 6] {
        let r = column(3, n, 0.1);
        let record = record(&data(&r, NoiseModel::white(0.05)), PEAK);
        let ln_b = factor(&record, &r, &RestPrior::default());
        assert!(ln_b.is_finite() && ln_b.abs() < 4.0, "{n}: {ln_b}");
        let model = linear(r.clone(), &[0, 1, 3], with_effect(), PEAK);
        let e = Evidence::of(&record, &model, &RestPrior::default(), Kernel::Orthogonal).expect("evidence");
        assert!(e.ln_z.is_finite());
        let left = remains(&record, &model, &e, &RestPrior::default(), 0.1);
        assert!(left.all.share_of_peak.is_finite());
    }
}

#[test]
fn units_change_nothing_but_the_density() {
    let n = 50;
    let r = column(3, n, 0.1) + misfit(n, 0.05, 3);
    let of = |unit: f64| {
        let r = &r * unit;
        let noise = NoiseModel::ar1(0.05 * unit, 0.4).with_nuisance(column(1, n, 0.02 * unit));
        let record = record(&data(&r, noise), PEAK * unit);
        let model = linear(r, &[0, 1, 3], with_effect(), PEAK * unit);
        Evidence::of(&record, &model, &RestPrior::default(), Kernel::Plain).expect("evidence")
    };
    let (newton, milli) = (of(1.0), of(1000.0));
    let off = newton.ln_z - milli.ln_z - n as f64 * 1000f64.ln();
    assert!(off.abs() < 1e-6, "{off}");
    assert!((newton.moved - milli.moved).abs() < 1e-6);
}

#[test]
fn the_same_question_has_the_same_bits() {
    let n = 70;
    let r = column(3, n, 0.1) + misfit(n, 0.05, 3);
    let record = record(&data(&r, NoiseModel::ar1(0.05, 0.4)), PEAK);
    let ask = || {
        let model = linear(r.clone(), &[0, 1, 3], with_effect(), PEAK);
        let e = Evidence::of(&record, &model, &RestPrior::default(), Kernel::Plain).expect("evidence");
        let left = remains(&record, &model, &e, &RestPrior::default(), 0.1);
        (e.ln_z.to_bits(), e.ln_z_else.to_bits(), left.all.share_of_peak.to_bits())
    };
    let here = ask();
    assert_eq!(std::thread::scope(|s| s.spawn(ask).join().expect("no panic")), here);
}

/// Two tests, the rest of either as given; without a free parameter.
fn two_tests(rests: [f64; 2], random: &mut Random) -> (Record, Linear) {
    let (n, s) = (150, line(150));
    let points = evidence::Points { s: s.clone(), gap: vec![1; n], sd: 1.0, ar1: 0.0 };
    let mut part = |tau: f64| {
        let size = evidence::RestSize { tau, ..evidence::RestSize::NONE };
        let (rest, noise) = (evidence::Process::new(&points, size).draw(random).0, random.normals(n) * 0.01);
        (0..n).map(|i| PEAK * rest[i] + noise[i]).collect::<Vec<f64>>()
    };
    let names = ["uniaxial", "tearing"];
    let parts: Vec<_> = (names.iter().zip(rests))
        .map(|(name, tau)| ((*name).to_owned(), part(tau), NoiseModel::white(0.01)))
        .collect();
    let data = Data::from_parts(parts).expect("data");
    let places = names.map(|t| Place { test: t.into(), s: s.clone(), peak: PEAK });
    let record = Record::new(&data, &places, 0.015).expect("record");
    let model = Linear {
        misfit: data.measured(),
        jacobian: DMatrix::zeros(2 * n, 0),
        parameters: Vec::new(),
        jumps: Vec::new(),
    };
    (record, model)
}

/// A rest in one test alone is believed far sooner where it may be that; what is in both loses no more than the share of the
/// prior that went elsewhere.
#[test]
fn a_rest_may_be_of_one_test_alone() {
    let mut random = Random::new(8);
    let mut gained = |rests: [f64; 2]| {
        let (record, model) = two_tests(rests, &mut random);
        let ln_z = |alone: f64| {
            let prior = RestPrior { alone, ..RestPrior::default() };
            Evidence::of(&record, &model, &prior, Kernel::Plain).expect("evidence").ln_z
        };
        ln_z(0.5) - ln_z(0.0)
    };
    for _ in 0..10 {
        let (one, both) = (gained([0.0, 0.03]), gained([0.03, 0.03]));
        assert!(one > 3.0, "{one}");
        assert!((-std::f64::consts::LN_2 - 1e-6..0.1).contains(&both), "{both}");
    }
}

/// A gain that wanders is believed sooner where the rest may go with the force; what does not go with it loses no more than the
/// share of the prior that went elsewhere.
#[test]
fn a_rest_may_go_with_the_force() {
    let n = 150;
    let mut random = Random::new(9);
    let mut gained = |proportional: bool| {
        let size = evidence::RestSize { tau: 0.03, proportional, ..evidence::RestSize::NONE };
        let points = evidence::Points { s: line(n), gap: vec![1; n], sd: 1.0, ar1: 0.0 };
        let rest = evidence::Process::beside(&points, size, &pull(n), &[]).draw(&mut random).0;
        let r = DVector::from_vec(rest) * PEAK + random.normals(n) * 0.01;
        let record = pulled(&r, NoiseModel::white(0.01), PEAK);
        let model = linear(r, &[0, 1], base(), PEAK);
        let ln_z = |proportional: f64| {
            let prior = RestPrior { proportional, ..RestPrior::default() };
            Evidence::of(&record, &model, &prior, Kernel::Plain).expect("evidence").ln_z
        };
        ln_z(0.5) - ln_z(0.0)
    };
    let (mut with, mut without) = (0.0, 0.0);
    for _ in 0..10 {
        with += gained(true);
        let lost = gained(false);
        assert!(lost > -std::f64::consts::LN_2 - 1e-6, "{lost}");
        without += lost;
    }
    assert!(with > 10.0 && without < 0.0, "{with} {without}");
}

/// A model that jumps where the record does leads over one that goes on, and over one that jumps elsewhere.
#[test]
fn a_jump_is_worth_what_it_explains() {
    let n = 120;
    let mut random = Random::new(12);
    let step = |at: usize| DVector::from_fn(n, |i, _| if i < at { 0.0 } else { -0.2 * PEAK });
    let y = step(60) + random.normals(n) * 0.01;
    let record = record(&data(&y, NoiseModel::white(0.01)), PEAK);
    let ln_z = |at: usize| {
        let free = [inverse::Free::new("level", (-1.0, 1.0), params::Transform::Identity, 0.0)];
        let near = |i: usize| i + 2 < at || i > at + 2;
        let prediction = inverse::Prediction {
            values: step(at),
            jacobian: Some(DMatrix::from_element(n, 1, PEAK)),
            valid: Some((0..n).map(near).collect()),
        };
        let beliefs = [(Belief::normal(0.0, 0.1), false)];
        let model = Linear::at_fit(&y, &free, &[0.0], &prediction, &beliefs).expect("a model");
        Evidence::of(&record, &model, &RestPrior::default(), Kernel::Plain).expect("evidence").ln_z
    };
    let [there, beside, far, never] = [60, 61, 80, n + 5].map(ln_z);
    // Five points of which nothing is known but that the jump is there: ln(0.2 · PEAK / 0.01) = 4.1 each.
    assert!((there - beside).abs() < 3.0, "{there} {beside}");
    assert!(there > far + 20.0 && there > never + 20.0, "{there} {far} {never}");
}

/// Two tests and a camera: the rest of each test is found where it is, with the interval around the truth.
#[test]
fn what_is_left_is_found_in_its_test() {
    let n = 150;
    let s = line(n);
    let mut random = Random::new(6);
    let (mut low, mut high, mut noise_only) = (0, 0, 0);
    let repeats = 30;
    for _ in 0..repeats {
        let size = evidence::RestSize { tau: 0.02, ..evidence::RestSize::NONE };
        let points = evidence::Points { s: s.clone(), gap: vec![1; n], sd: 1.0, ar1: 0.0 };
        let process = evidence::Process::new(&points, size);
        let draws: Vec<Vec<f64>> = (0..2).map(|_| process.draw(&mut random).0).collect();
        let truth = |k: usize| (draws[k].iter().map(|x| x * x).sum::<f64>() / n as f64).sqrt();
        let part = |k: usize, random: &mut Random| {
            let noise = random.normals(n) * 0.01;
            (0..n).map(|i| PEAK * draws[k][i] + noise[i]).collect::<Vec<f64>>()
        };
        let parts = [("uniaxial", part(0, &mut random)), ("tearing", part(1, &mut random))];
        let data =
            Data::from_parts(parts.map(|(name, values)| (name.to_owned(), values, NoiseModel::white(0.01))))
                .expect("data");
        let places = ["uniaxial", "tearing"].map(|t| Place { test: t.into(), s: s.clone(), peak: PEAK });
        let record = Record::new(&data, &places, 0.015).expect("record");
        let r = data.measured();
        let model = Linear {
            misfit: r,
            jacobian: DMatrix::zeros(2 * n, 0),
            parameters: Vec::new(),
            jumps: Vec::new(),
        };
        let e = Evidence::of(&record, &model, &RestPrior::default(), Kernel::Plain).expect("evidence");
        let left = remains(&record, &model, &e, &RestPrior::default(), 0.1);
        for (k, name) in ["uniaxial", "tearing"].into_iter().enumerate() {
            let [a, b] = left.tests[name].interval_95;
            low += i32::from(truth(k) < a);
            high += i32::from(truth(k) > b);
        }
        noise_only += i32::from(left.none > 0.01);
    }
    assert!(low + high <= 8, "{low} {high} of {}", 2 * repeats);
    assert_eq!(noise_only, 0);
}

#[test]
fn noise_alone_leaves_nothing() {
    let n = 200;
    let mut explained = 0;
    for seed in 0..20 {
        let r = Random::new(seed).normals(n) * 0.02;
        let record = record(&data(&r, NoiseModel::white(0.02)), PEAK);
        let model = linear(r.clone(), &[0, 1], base(), PEAK);
        let e = Evidence::of(&record, &model, &RestPrior::default(), Kernel::Plain).expect("evidence");
        let left = remains(&record, &model, &e, &RestPrior::default(), 0.1);
        assert_ne!(left.explained_to(0.02), ExplainedTo::Not);
        explained += i32::from(left.explained_to(0.02) == ExplainedTo::Noise);
    }
    assert!(explained >= 17, "{explained}");
}

/// y = e^{−b s} is far from its linearisation at the start; asked again at the mode it stands at the truth.
#[test]
fn the_mode_is_approached_until_the_linearisation_stands() {
    let n = 80;
    let s = line(n);
    let curve = |z: f64| DVector::from_fn(n, |i, _| PEAK * (-z.exp() * s[i]).exp());
    let mut random = Random::new(3);
    let y = curve(1.0) + random.normals(n) * 0.02;
    let at = |z: &[f64]| {
        let (here, h) = (curve(z[0]), 1e-6);
        let jacobian = DMatrix::from_columns(&[(curve(z[0] + h) - curve(z[0] - h)) / (2.0 * h)]);
        let mut p = parameter("b", Belief::normal(0.0, 1.0), false);
        p.at = z[0];
        Ok::<_, EvidenceError>(Linear { misfit: &y - here, jacobian, parameters: vec![p], jumps: Vec::new() })
    };
    let record = record(&data(&y, NoiseModel::white(0.02)), PEAK);
    let start = at(&[0.0]).expect("a model");
    let rest = RestPrior::default();
    let first = Evidence::of(&record, &start, &rest, Kernel::Plain).expect("evidence");
    assert!(first.moved > 3.0, "{}", first.moved);
    let (end, stands) = at_the_mode(&record, start, &rest, Kernel::Plain, (8, 0.1), at).expect("evidence");
    assert!(stands && end.moved <= 0.1 && (end.mode[0] - 1.0).abs() < 0.05, "{} {:?}", end.moved, end.mode);
    assert!(end.ln_z > first.ln_z + 10.0);
}

/// Intervals that allow for the rest cover the truth where those of noise alone do not.
#[test]
fn intervals_allow_for_the_rest() {
    let n = 100;
    let mut random = Random::new(11);
    let (mut wide, mut narrow) = (0, 0);
    let repeats = 60;
    for _ in 0..repeats {
        let size = evidence::RestSize { tau: 0.015, ..evidence::RestSize::NONE };
        let points = evidence::Points { s: line(n), gap: vec![1; n], sd: 1.0, ar1: 0.0 };
        let rest = DVector::from_vec(evidence::Process::new(&points, size).draw(&mut random).0) * PEAK;
        let truth = 0.2 * random.normal();
        let r = column(1, n, PEAK) * truth + rest + random.normals(n) * 0.01;
        let record = record(&data(&r, NoiseModel::white(0.01)), PEAK);
        let model = linear(r, &[1], vec![parameter("a", Belief::normal(0.0, 0.2), false)], PEAK);
        let prior = RestPrior::default();
        let e = Evidence::of(&record, &model, &prior, Kernel::Plain).expect("evidence");
        let i = e.intervals(&prior, 0.1)[0];
        let holds = |[a, b]: [f64; 2]| i32::from(a <= truth && truth <= b);
        wide += holds(i.with_rest);
        narrow += holds(i.if_right);
        assert!(i.with_rest[0] < i.median && i.median < i.with_rest[1]);
    }
    assert!(wide >= 54 && narrow <= 30, "{wide} {narrow} of {repeats}");
}

/// A superset judged from its parent's columns is what the same model gives when asked directly; shapes share their prior.
#[test]
fn supersets_are_judged_from_columns() {
    let n = 80;
    let r = column(3, n, 0.15) + misfit(n, 0.03, 3);
    let record = record(&data(&r, NoiseModel::white(0.03)), PEAK);
    let (rest, prior) = (RestPrior::default(), evidence::SetPrior::of_catalogue(2));
    let parent = linear(r.clone(), &[0, 1], base(), PEAK);
    let shape = |kind: usize| {
        let p = parameter("effects.bump.size", Belief::above(0.0, 0.1), true);
        (vec![p], DMatrix::from_columns(&[column(kind, n, PEAK)]))
    };
    let names = ["bump".to_owned()];
    let posterior = |shapes: Vec<_>| {
        let extension = evidence::Extension { effects: names.to_vec(), shapes };
        let asked = evidence::extend(&record, &parent, &extension, (&rest, &prior), Kernel::Plain);
        let e = Evidence::of(&record, &parent, &rest, Kernel::Plain).expect("evidence");
        let models =
            [evidence::Judged::new(&[], &e, &rest, 1.0, &prior), asked.expect("evidence").expect("a shape")];
        assert_eq!(evidence::to_fit(&evidence::Posterior::of(&models, &prior), &models), [names.to_vec()]);
        evidence::Posterior::of(&models, &prior)
    };
    let one = posterior(vec![shape(3)]);
    let direct = linear(r.clone(), &[0, 1, 3], with_effect(), PEAK);
    let direct = Evidence::of(&record, &direct, &rest, Kernel::Plain).expect("evidence");
    let e = Evidence::of(&record, &parent, &rest, Kernel::Plain).expect("evidence");
    let want = evidence::Posterior::of(
        &[
            evidence::Judged::new(&[], &e, &rest, 1.0, &prior),
            evidence::Judged::new(&names, &direct, &rest, 1.0, &prior),
        ],
        &prior,
    );
    assert!((one.effects["bump"] - want.effects["bump"]).abs() < 1e-12);
    // Three further shapes that do not help leave a quarter of the odds.
    let four = posterior(vec![shape(3), shape(5), shape(6), shape(7)]);
    let odds = |p: f64| p / (1.0 - p);
    let ratio = odds(four.effects["bump"]) / odds(one.effects["bump"]);
    assert!((ratio - 0.25).abs() < 0.05, "{ratio}");
    // An extension without shapes says nothing.
    let empty = evidence::Extension { effects: names.to_vec(), shapes: Vec::new() };
    let nothing = evidence::extend(&record, &parent, &empty, (&rest, &prior), Kernel::Plain);
    assert!(nothing.expect("no fault").is_none());
}
