//! Truth drawn from the prior: of everything stated at p, p is right.

use crate::toys;

use evidence::scores::{brier, log_score, reliability};
use evidence::{
    Belief, Evidence, Judged, Kernel, Points, Posterior, Process, RestForm, RestPrior, RestSize, SetPrior,
    excess,
};
use inverse::{NoiseModel, Random};
use nalgebra::DVector;
use std::collections::BTreeSet;
use toys::*;

const N: usize = 40;
const PEAK: f64 = 2.0;
const SD: f64 = 0.02;
const EFFECTS: [(&str, usize); 4] = [("wave", 2), ("bump", 3), ("kink", 4), ("cosine", 6)];

fn belief(effect: usize) -> Belief {
    // Two with a sign, two without.
    if effect.is_multiple_of(2) { Belief::normal(0.0, 0.08) } else { Belief::above(0.0, 0.08) }
}

fn half_normal(random: &mut Random, scale: f64) -> f64 {
    if random.uniform() < 0.5 { 0.0 } else { scale * random.normal().abs() }
}

/// One of a few values, each as often as its prior mass says.
fn by_mass(values: &[(f64, f64)], random: &mut Random) -> f64 {
    let mut left = random.uniform();
    let chosen = values.iter().find(|v| {
        left -= v.1;
        left < 0.0
    });
    chosen.or(values.last()).expect("a value").0
}

fn form(random: &mut Random, rest: &RestPrior) -> RestForm {
    match random.uniform() {
        u if u < rest.proportional => RestForm::Proportional,
        u if u < rest.proportional + rest.per_leg => RestForm::PerLeg,
        _ => RestForm::Even,
    }
}

struct Drawn {
    r: DVector<f64>,
    set: BTreeSet<usize>,
    beyond: bool,
}

fn draw(random: &mut Random, prior: &SetPrior, rest: &RestPrior) -> Drawn {
    let q = prior.expected / EFFECTS.len() as f64;
    let set = loop {
        let set: BTreeSet<usize> = (0..EFFECTS.len()).filter(|_| random.uniform() < q).collect();
        if set.len() <= 2 {
            break set;
        }
    };
    // Without those that an effect imitates to the noise.
    let beyond = random.uniform() < prior.unlike() / (1.0 - prior.beyond + prior.unlike());
    let (mut tau, mut upsilon) = (half_normal(random, rest.smooth), half_normal(random, rest.jerk));
    if beyond {
        let size = |scale: f64, z: f64| scale * rest.else_median * (rest.else_spread * z).exp();
        let z = random.normal();
        if random.uniform() < 0.5 { tau = size(rest.smooth, z) } else { upsilon = size(rest.jerk, z) }
    }
    let length = by_mass(&rest.smooth_lengths, random);
    let size = RestSize {
        tau,
        upsilon,
        smooth_length: length,
        jerk_length: rest.jerk_lengths[0].0,
        form: form(random, rest),
    };
    let points = Points { s: line(N), gap: vec![1; N], sd: SD / PEAK, ar1: 0.0, leg: legs(N) };
    let (delta, noise) = Process::beside(&points, size, &pull(N), &[]).draw(random);
    let mut r = DVector::from_fn(N, |i, _| PEAK * (delta[i] + noise[i]));
    for k in 0..2 {
        r += column(k, N, PEAK) * (0.2 * random.normal());
    }
    for &e in &set {
        r += column(EFFECTS[e].1, N, PEAK) * belief(e).quantile(random.uniform());
    }
    Drawn { r, set, beyond }
}

/// What is stated where effects are not asked if they are but the likeness of an unknown cause, and where they are.
fn posteriors(drawn: &Drawn, prior: &SetPrior, rest: &RestPrior) -> [Posterior; 2] {
    let record = pulled(&drawn.r, NoiseModel::white(SD), PEAK);
    let mut models = Vec::new();
    for mask in 0..1usize << EFFECTS.len() {
        let set: Vec<usize> = (0..EFFECTS.len()).filter(|e| mask >> e & 1 == 1).collect();
        if set.len() > 2 {
            continue;
        }
        let kinds: Vec<usize> = [0, 1].into_iter().chain(set.iter().map(|&e| EFFECTS[e].1)).collect();
        let mut p: Vec<_> = (0..2).map(|_| parameter("base", Belief::normal(0.0, 0.2), false)).collect();
        p.extend(set.iter().map(|&e| parameter(EFFECTS[e].0, belief(e), true)));
        let names: Vec<String> = set.iter().map(|&e| EFFECTS[e].0.to_owned()).collect();
        let model = linear(drawn.r.clone(), &kinds, p, PEAK);
        let evidence = Evidence::of(&record, &model, rest, Kernel::Plain).expect("evidence");
        let judged = Judged::new(&names, &evidence, rest, 1.0, prior);
        let left = excess(&record, &model).expect("a misfit");
        models.push([judged.clone(), judged.leaving(left)]);
    }
    [0, 1].map(|k| Posterior::of(&models.iter().map(|m| m[k].clone()).collect::<Vec<_>>(), prior))
}

/// Sum of stated probabilities against what happened, in standard deviations of a calibrated forecaster.
fn surprise(stated: &[f64], happened: &[bool]) -> f64 {
    let expected: f64 = stated.iter().sum();
    let count = happened.iter().filter(|y| **y).count() as f64;
    let spread = stated.iter().map(|p| p * (1.0 - p)).sum::<f64>().sqrt();
    (count - expected) / spread.max(0.3)
}

#[test]
fn stated_probabilities_are_frequencies() {
    let prior = SetPrior { expected: 0.9, catalogue: EFFECTS.len(), beyond: 0.2, factor: 2.0 };
    let rest = RestPrior::default();
    let mut random = Random::new(77);
    let (mut stated, mut happened) = (Vec::new(), Vec::new());
    let (mut nothing, mut was_nothing, mut other, mut was_other) =
        (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    for _ in 0..150 {
        let drawn = draw(&mut random, &prior, &rest);
        let [p, _] = posteriors(&drawn, &prior, &rest);
        for (e, (name, _)) in EFFECTS.iter().enumerate() {
            stated.push(p.effects[*name]);
            happened.push(drawn.set.contains(&e));
        }
        nothing.push(p.nothing);
        was_nothing.push(drawn.set.is_empty() && !drawn.beyond);
        other.push(p.something_else);
        was_other.push(drawn.beyond);
        let sum: f64 = p.sets.iter().map(|s| s.probability).sum::<f64>() + p.something_else;
        assert!((sum - 1.0).abs() < 1e-9);
    }
    for (name, p, y) in [
        ("effects", &stated, &happened),
        ("nothing", &nothing, &was_nothing),
        ("something else", &other, &was_other),
    ] {
        let r = reliability(p, y, 200);
        println!(
            "{name}: {:+.2} sd, Brier {:.4} = miscalibration {:.4} − discrimination {:.4} + uncertainty {:.4}, log score {:.3}, within bands {:.2}",
            surprise(p, y),
            r.brier,
            r.miscalibration,
            r.discrimination,
            r.uncertainty,
            log_score(p, y, 1e-6),
            r.within
        );
        assert!(surprise(p, y).abs() < 3.0, "{name}: {}", surprise(p, y));
        assert!(r.within > 0.7 && r.discrimination > 3.0 * r.miscalibration, "{name}: {r:?}");
        // In each third of the statements, too.
        for (low, high) in [(0.0, 0.2), (0.2, 0.8), (0.8, 1.01)] {
            let inside: Vec<usize> = (0..p.len()).filter(|&i| p[i] >= low && p[i] < high).collect();
            let (p, y): (Vec<f64>, Vec<bool>) = inside.iter().map(|&i| (p[i], y[i])).unzip();
            assert!(surprise(&p, &y).abs() < 3.5, "{name} {low}: {}", surprise(&p, &y));
        }
        assert!(brier(p, y) < r.uncertainty);
    }
}

/// A cause from outside that looks like an effect, with either sign: every second time all of it does, else any share of it, and the
/// other share like a draw of a process.
fn alike(random: &mut Random, prior: &SetPrior, rest: &RestPrior) -> Drawn {
    let mut drawn = draw(random, &SetPrior { beyond: 0.0, ..prior.clone() }, rest);
    drawn.beyond = random.uniform() < prior.beyond;
    if drawn.beyond {
        let of_size_one = |v: DVector<f64>| v.clone() * ((N as f64).sqrt() / v.norm());
        let e = (random.uniform() * EFFECTS.len() as f64) as usize % EFFECTS.len();
        let share = if random.uniform() < 0.5 { 1.0 } else { random.uniform() };
        let points = Points { s: line(N), gap: vec![1; N], sd: SD / PEAK, ar1: 0.0, leg: legs(N) };
        let size = RestSize { tau: 1.0, smooth_length: rest.smooth_lengths[0].0, ..RestSize::NONE };
        let process = DVector::from_vec(Process::beside(&points, size, &pull(N), &[]).draw(random).0);
        // It looks along the effect or against it.
        let sign = if random.uniform() < 0.5 { 1.0 } else { -1.0 };
        let shape = of_size_one(column(EFFECTS[e].1, N, 1.0)) * (sign * share.sqrt())
            + of_size_one(process) * (1.0 - share).sqrt();
        drawn.r +=
            shape * (PEAK * rest.smooth * rest.else_median * (rest.else_spread * random.normal()).exp());
    }
    drawn
}

/// Where unknown causes look like effects, an effect is not that certain: what is stated scores better, and what is stated above one
/// half is nearer to what is.
#[test]
fn likeness_makes_names_beside_unknown_causes_honest() {
    let prior = SetPrior { expected: 0.9, catalogue: EFFECTS.len(), beyond: 0.3, factor: 2.0 };
    let rest = RestPrior::default();
    let mut random = Random::new(78);
    let (mut plain, mut asked, mut happened) = (Vec::new(), Vec::new(), Vec::new());
    for _ in 0..100 {
        let drawn = alike(&mut random, &prior, &rest);
        let [without, with] = posteriors(&drawn, &prior, &rest);
        for (e, (name, _)) in EFFECTS.iter().enumerate() {
            plain.push(without.effects[*name]);
            asked.push(with.effects[*name]);
            happened.push(drawn.set.contains(&e));
        }
    }
    let [before, after] = [&plain, &asked].map(|p| {
        let (high, so): (Vec<f64>, Vec<bool>) = p.iter().zip(&happened).filter(|(p, _)| **p > 0.5).unzip();
        (log_score(p, &happened, 1e-6), surprise(p, &happened), surprise(&high, &so), high.len())
    });
    println!(
        "likeness: {before:.3?} {after:.3?} (log score; sd, of all and of those above one half; how many these are)"
    );
    assert!(after.0 < before.0 && after.1.abs() < 3.0, "{before:?} {after:?}");
    assert!(before.2 < -3.0 && after.2.abs() < 2.0 && 2 * after.3 > before.3, "{before:?} {after:?}");
}
