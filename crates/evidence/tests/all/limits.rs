//! Limits, invariances, and what is left.

use crate::toys;

use evidence::{
    Belief, Evidence, EvidenceError, ExplainedTo, Kernel, Linear, Record, RestPrior, at_the_mode, density,
    remains,
};
use inverse::{NoiseModel, Random};
use nalgebra::{DMatrix, DVector};
use toys::*;

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
        Linear { misfit: &y - here, jacobian, parameters: vec![p], jumps: Vec::new() }
    };
    let record = record(&data(&y, NoiseModel::white(0.02)), PEAK);
    let start = at(&[0.0]);
    let rest = RestPrior::default();
    let first = Evidence::of(&record, &start, &rest, Kernel::Plain).expect("evidence");
    assert!(first.moved > 3.0, "{}", first.moved);
    let to_the_mode = |answers: &dyn Fn(f64) -> bool| {
        let asked = std::cell::RefCell::new(Vec::new());
        let model = |z: &[f64]| {
            asked.borrow_mut().push(z[0]);
            Ok::<_, EvidenceError>(answers(z[0]).then(|| at(z)))
        };
        let end = at_the_mode(&record, start.clone(), &rest, (8, 0.1), model).expect("evidence");
        (end, asked.into_inner())
    };
    let (end, asked) = to_the_mode(&|_| true);
    let evidence = &end.evidence;
    assert!(end.stands && evidence.moved <= 0.1 && (evidence.mode[0] - 1.0).abs() < 0.05, "{evidence:?}");
    assert!(evidence.ln_z > first.ln_z + 10.0);
    // Every step is denser than the one before it.
    let densities: Vec<f64> =
        asked.iter().map(|&z| density(&record, &at(&[z]), &rest).expect("a density")).collect();
    assert!(densities.is_sorted() && densities.len() > 1, "{asked:?} {densities:?}");
    // Beyond a point without an answer it goes half the way, and no further.
    let edge = 0.5 * asked[0];
    let (short, tried) = to_the_mode(&|z| z <= edge);
    assert!(tried[..2] == [asked[0], edge] && tried.len() == 6, "{tried:?}");
    assert!(!short.stands && short.linear.parameters[0].at == edge, "{:?}", short.linear.parameters);
    // What the linearisation there promises beyond the edge is not claimed; near the mode nothing is in doubt.
    assert!(short.unseen > 5.0 && end.unseen == 0.0, "{} {}", short.unseen, end.unseen);
    let at_edge = density(&record, &at(&[edge]), &rest).expect("a density");
    assert!(short.evidence.ln_z - short.unseen < at_edge, "{} {at_edge}", short.evidence.ln_z);
    // Where nothing answers, it stays where it began.
    let (none, tried) = to_the_mode(&|_| false);
    assert!(!none.stands && none.linear == start && tried.len() == 4, "{tried:?}");
}

/// The step from far out on an arc tangent ends farther away than it began: a share is taken that is denser, and none that is not.
#[test]
fn a_step_to_the_mode_that_is_too_long_is_shortened() {
    let n = 80;
    let s = line(n);
    let y = Random::new(5).normals(n) * 0.02;
    let at = |z: f64| {
        let here = DVector::from_fn(n, |i, _| PEAK * z.atan() * s[i]);
        let jacobian = DMatrix::from_fn(n, 1, |i, _| PEAK * s[i] / (1.0 + z * z));
        let mut p = parameter("b", Belief::normal(0.0, 20.0), false);
        p.at = z;
        Linear { misfit: &y - here, jacobian, parameters: vec![p], jumps: Vec::new() }
    };
    let record = record(&data(&y, NoiseModel::white(0.02)), PEAK);
    let rest = RestPrior::default();
    let dense = |z: f64| density(&record, &at(z), &rest).expect("a density");
    let mut tried = Vec::new();
    let model = |z: &[f64]| {
        tried.push(z[0]);
        Ok::<_, EvidenceError>(Some(at(z[0])))
    };
    let end = at_the_mode(&record, at(3.0), &rest, (1, 0.1), model).expect("evidence");
    let (taken, refused) = tried.split_last().expect("a step");
    assert!(!refused.is_empty() && refused.iter().all(|&z| dense(z) <= dense(3.0)), "{tried:?}");
    assert!(end.linear.parameters[0].at == *taken && dense(*taken) > dense(3.0), "{tried:?}");
}

/// Intervals that allow for the rest cover the truth where those of noise alone do not, whatever length it has of those that are
/// believed: a long one, which a parameter may follow, less often.
#[test]
fn intervals_allow_for_the_rest() {
    let (n, repeats) = (100, 100);
    let prior = RestPrior::default();
    let points = evidence::Points { s: line(n), gap: vec![1; n], sd: 1.0, ar1: 0.0, leg: Vec::new() };
    let (mut all, mut without) = (0, 0);
    for smooth_length in [0.05, 0.1, 0.2, 0.3] {
        let (mut wide, mut random) = (0, Random::new(11));
        let size = evidence::RestSize { tau: 0.015, smooth_length, ..evidence::RestSize::NONE };
        for _ in 0..repeats {
            let rest = DVector::from_vec(evidence::Process::new(&points, size).draw(&mut random).0) * PEAK;
            let truth = 0.2 * random.normal();
            let r = column(1, n, PEAK) * truth + rest + random.normals(n) * 0.01;
            let record = record(&data(&r, NoiseModel::white(0.01)), PEAK);
            let model = linear(r, &[1], vec![parameter("a", Belief::normal(0.0, 0.2), false)], PEAK);
            let e = Evidence::of(&record, &model, &prior, Kernel::Plain).expect("evidence");
            let i = e.intervals(&prior, 0.1)[0];
            let holds = |[a, b]: [f64; 2]| i32::from(a <= truth && truth <= b);
            wide += holds(i.with_rest);
            without += holds(i.if_right);
            assert!(i.with_rest[0] < i.median && i.median < i.with_rest[1]);
        }
        println!("length {smooth_length}: {wide} of {repeats}");
        assert!(wide >= 80, "{smooth_length}: {wide} of {repeats}");
        all += wide;
    }
    println!("all: {all}, by noise alone {without}, of {}", 4 * repeats);
    assert!(all >= 360 && without <= 120, "{all} {without}");
}
