//! The rest: in one test alone, in proportion to the force, beside a jump, and where it is found.

use crate::toys::*;

use evidence::{Belief, Evidence, Kernel, Linear, Place, Record, RestForm, RestPrior, excess, remains};
use inverse::{Data, NoiseModel, Random};
use nalgebra::{DMatrix, DVector};

/// Two tests, the rest of either as given; without a free parameter.
fn two_tests(rests: [f64; 2], random: &mut Random) -> (Record, Linear) {
    let (n, s) = (150, line(150));
    let points = evidence::Points { s: s.clone(), gap: vec![1; n], sd: 1.0, ar1: 0.0, leg: Vec::new() };
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
    let places = names.map(|t| Place { test: t.into(), s: s.clone(), leg: Vec::new(), peak: PEAK });
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

/// A rest of a form is believed sooner where it may have that form; what does not have it loses no more than the share of the
/// prior that went there.
fn a_rest_may_have(form: RestForm) {
    let n = 150;
    let mut random = Random::new(9);
    let mut gained = |has: bool| {
        let drawn = if has { form } else { RestForm::Even };
        let size = evidence::RestSize { tau: 0.03, form: drawn, ..evidence::RestSize::NONE };
        let points = evidence::Points { s: line(n), gap: vec![1; n], sd: 1.0, ar1: 0.0, leg: legs(n) };
        let rest = evidence::Process::beside(&points, size, &pull(n), &[]).draw(&mut random).0;
        let r = DVector::from_vec(rest) * PEAK + random.normals(n) * 0.01;
        let record = pulled(&r, NoiseModel::white(0.01), PEAK);
        let model = linear(r, &[0, 1], base(), PEAK);
        let ln_z = |mass: f64| {
            let mass_of = |f: RestForm| if f == form { mass } else { 0.0 };
            let (proportional, per_leg) = (mass_of(RestForm::Proportional), mass_of(RestForm::PerLeg));
            let prior = RestPrior { proportional, per_leg, ..RestPrior::default() };
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

/// A gain that wanders.
#[test]
fn a_rest_may_go_with_the_force() {
    a_rest_may_have(RestForm::Proportional);
}

/// Friction, or a reading that comes late.
#[test]
fn a_rest_may_begin_anew_with_every_leg() {
    a_rest_may_have(RestForm::PerLeg);
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

/// What a model leaves beyond noise is the mean square of its misfit less the noise's, its parameters at their least squares; where it
/// jumps nothing counts that is not known there.
#[test]
fn what_is_left_beyond_noise_is_a_mean_square() {
    let n = 400;
    let wave = column(5, n, 0.03 * PEAK);
    let noise = Random::new(4).normals(n) * (0.01 * PEAK);
    let model = NoiseModel::white(0.01 * PEAK);
    let of = |r: &DVector<f64>, kinds: &[usize], jumps: Vec<f64>| {
        let record = record(&data(r, model.clone()), PEAK);
        let free = kinds.iter().map(|_| parameter("a", Belief::normal(0.0, 100.0), false)).collect();
        excess(&record, &Linear { jumps, ..linear(r.clone(), kinds, free, 1.0) }).expect("a misfit")
    };
    let r = &wave + &noise;
    let want = wave.norm_squared() / (n as f64 * PEAK * PEAK);
    let (left, taken) = (of(&r, &[0], Vec::new()), of(&r, &[0, 5], Vec::new()));
    assert!((left / want - 1.0).abs() < 0.05 && taken < 0.02 * want, "{left} {taken} {want}");
    let mut off = r.clone();
    off[200] += PEAK;
    let jump = (0..n).map(|i| if i == 200 { PEAK } else { 0.0 }).collect();
    let (counted, known) = (of(&off, &[0], Vec::new()), of(&off, &[0], jump));
    assert!(counted > 2.0 * want && (known / want - 1.0).abs() < 0.05, "{counted} {known} {want}");
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
        let points = evidence::Points { s: s.clone(), gap: vec![1; n], sd: 1.0, ar1: 0.0, leg: Vec::new() };
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
        let places = ["uniaxial", "tearing"].map(|t| Place {
            test: t.into(),
            s: s.clone(),
            leg: Vec::new(),
            peak: PEAK,
        });
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

/// Waves of any length from a few percent of the record on, beside parameters that a longer rest would move: what is left is as large
/// as they are, and no cause from outside is called for.
#[test]
fn short_waves_are_not_taken_for_a_larger_rest() {
    let n = 200;
    let points = evidence::Points { s: line(n), gap: vec![1; n], sd: 1.0, ar1: 0.0, leg: Vec::new() };
    let rest = RestPrior::default();
    let wide = |k: usize| parameter(&format!("p{k}"), Belief::normal(0.0, 2.0), false);
    for smooth_length in [0.02, 0.035, 0.1, 0.25] {
        let size = evidence::RestSize { tau: 0.02, smooth_length, ..evidence::RestSize::NONE };
        let (mut stated, mut beyond, repeats, mut random) = (0.0, 0, 10, Random::new(41));
        for _ in 0..repeats {
            let drawn = DVector::from_vec(evidence::Process::new(&points, size).draw(&mut random).0);
            let r = drawn * PEAK + random.normals(n) * (0.003 * PEAK);
            let record = record(&data(&r, NoiseModel::white(0.003 * PEAK)), PEAK);
            let model = linear(r, &[0, 1, 2, 3], (0..4).map(wide).collect(), PEAK);
            let e = Evidence::of(&record, &model, &rest, Kernel::Plain).expect("evidence");
            stated += remains(&record, &model, &e, &rest, 0.05).all.share_of_peak / f64::from(repeats);
            beyond += i32::from(e.ln_z_else + 0.05f64.ln() > e.ln_z);
        }
        println!(
            "length {smooth_length}: {stated:.4} left for 0.02, {beyond} of {repeats} with something else"
        );
        assert!(stated < 1.4 * 0.02 && stated > 0.02 / 1.4 && beyond <= 1, "{stated} {beyond}");
    }
}
