//! Arms of intervals whose standard error changes along them: closed forms, and whether they hold the truth.
#![allow(missing_docs)]

use crate::line;
use crate::toys;

use inverse::*;
use line::*;
use nalgebra::DVector;
use params::Transform;
use toys::{Toy, data, quiet, truth};

/// Value and derivatives of a point.
trait Rows: Fn(usize, &[f64]) -> (f64, Vec<f64>) + Sync {}
impl<F: Fn(usize, &[f64]) -> (f64, Vec<f64>) + Sync> Rows for F {}

fn said<F: Rows>(toy: &Toy<F>, d: &Data, free: &[Free]) -> Uncertainty {
    let end = quiet(toy, d, free, &exactly(Objective::Whitened));
    uncertainty(d, free, &end, &Identifiability::default()).unwrap()
}

/// What the same data say with the optimum at other values.
fn there<F: Rows>(toy: &Toy<F>, d: &Data, free: &[Free], theta: &[f64]) -> Uncertainty {
    let end = quiet(toy, d, free, &exactly(Objective::Whitened));
    let prediction = toy.predict(theta, true).unwrap();
    let at_bound = free.iter().zip(theta).map(|(f, &v)| f.at_bound(v)).collect();
    let moved = Fit { theta: theta.to_vec(), prediction, at_bound, ..end };
    uncertainty(d, free, &moved, &Identifiability::default()).unwrap()
}

fn asked<F: Rows>(toy: &Toy<F>, d: &Data, free: &[Free]) -> Uncertainty {
    let u = said(toy, d, free);
    let probes = u.probes(2);
    let all: Vec<_> = probes.iter().map(|p| Some(there(toy, d, free, &p.theta))).collect();
    u.with_asymmetric_intervals(&probes, &all)
}

#[test]
fn a_line_is_asked_at_the_ends_of_its_intervals_and_keeps_them() {
    let toy = Toy(5, line);
    let (d, free) = (data(&truth(&toy, &[1.0, 2.0]), NoiseModel::white(0.5)), free(10.0));
    let u = said(&toy, &d, &free);
    let side = [Z95 * 0.5 / 5f64.sqrt(), Z95 * 0.5 / 10f64.sqrt()];
    let at: Vec<Vec<f64>> = u.probes(9).into_iter().map(|p| p.theta).collect();
    assert_eq!((at.len(), u.probes(1).len(), u.probes(0).len()), (4, 2, 0));
    for (k, pair) in at.chunks(2).enumerate() {
        close((pair[0][k] - pair[1][k]).abs(), 2.0 * side[k]);
        close(pair[0][k] + pair[1][k], 2.0 * [1.0, 2.0][k]);
        close(pair[0][1 - k], [2.0, 1.0][k]);
    }
    assert_eq!(asked(&toy, &d, &free).estimates, u.estimates);
    let probes = u.probes(2);
    assert_eq!(u.clone().with_asymmetric_intervals(&probes, &vec![None; 4]).estimates, u.estimates);
    // Nothing is fixed: there is nothing to ask.
    let loud = data(&truth(&toy, &[1.0, 2.0]), NoiseModel::white(500.0));
    assert!(said(&toy, &loud, &free).probes(2).is_empty());
}

/// y = b − c b²/2, four times: the standard error is σ/2/(1 − c b).
fn bent(c: f64) -> Toy<impl Rows> {
    Toy(4, move |_, p: &[f64]| (p[0] - 0.5 * c * p[0] * p[0], vec![1.0 - c * p[0]]))
}

#[test]
fn a_side_takes_the_mean_error_along_it_and_none_gets_shorter() {
    let free = vec![Free::new("b", (-4.0, 4.0), Transform::Identity, 0.1)];
    for c in [0.3, -0.3] {
        let d = data(&truth(&bent(c), &[0.0]), NoiseModel::white(0.5));
        let straight = said(&bent(c), &d, &free);
        let e = &asked(&bent(c), &d, &free).estimates[0];
        let u = Z95 * 0.25 * 0.3;
        let longer = 1.0 + 0.5 * u / (1.0 - u * u);
        let (low, high) = if c > 0.0 { (1.0, longer) } else { (longer, 1.0) };
        assert!((e.interval_95[0] + Z95 * 0.25 * low).abs() < 1e-6, "{:?}", e.interval_95);
        assert!((e.interval_95[1] - Z95 * 0.25 * high).abs() < 1e-6, "{:?}", e.interval_95);
        assert_eq!(
            Estimate {
                interval_95: straight.estimates[0].interval_95,
                interval_95_if_right: straight.estimates[0].interval_95,
                ..e.clone()
            },
            straight.estimates[0]
        );
    }
    // An answer that loses all its slope doubles an side and no more; at a bound nothing is known of it.
    let d = data(&truth(&bent(1.0), &[0.0]), NoiseModel::white(0.5));
    let u = said(&bent(1.0), &d, &free);
    let probes = u.probes(2);
    let up = usize::from(probes[0].theta[0] < 0.0);
    let only = |theta: f64| {
        let mut all = vec![None; 2];
        all[up] = Some(there(&bent(1.0), &d, &free, &[theta]));
        u.clone().with_asymmetric_intervals(&probes, &all).estimates[0].interval_95
    };
    assert!((only(0.999)[1] - 2.0 * Z95 * 0.25).abs() < 1e-6 && (only(0.999)[0] + Z95 * 0.25).abs() < 1e-6);
    assert_eq!(only(4.0), u.estimates[0].interval_95);
    // One end alone says half of what both would: twice the error there, a quarter of the side.
    assert!((only(0.5)[1] - 1.25 * Z95 * 0.25).abs() < 1e-6 && (only(0.5)[0] + Z95 * 0.25).abs() < 1e-6);
}

/// y = a and y = 2 (a + b): sd of a is σ, of b √1.25 σ, their correlation −1/√1.25. A parameter takes part as far as it loads.
#[test]
fn sides_share_what_a_combination_says() {
    let pair = |i: usize, p: &[f64]| {
        if i == 0 { (p[0], vec![1.0, 0.0]) } else { (2.0 * (p[0] + p[1]), vec![2.0, 2.0]) }
    };
    let (toy, free) = (Toy(2, pair), free(10.0));
    let d = data(&DVector::from_vec(vec![0.0, 0.0]), NoiseModel::white(0.5));
    let u = said(&toy, &d, &free);
    let probes = u.probes(1);
    // At the end where b is large every error is twice as large, at the other end the same.
    let loud = said(&toy, &data(&DVector::from_vec(vec![0.0, 0.0]), NoiseModel::white(1.0)), &free);
    let all: Vec<_> =
        probes.iter().map(|p| Some(if p.theta[1] > 0.0 { loud.clone() } else { u.clone() })).collect();
    let e = u.clone().with_asymmetric_intervals(&probes, &all).estimates;
    // The larger eigenvalue of [[1, −1], [−1, 1.25]], and how far a and b load on its vector.
    let l = 1.125 + (0.125f64.powi(2) + 1.0).sqrt();
    let v = DVector::from_vec(vec![1.0, 1.0 - l]).normalize();
    let loading = [v[0].abs() * l.sqrt(), v[1].abs() * l.sqrt() / 1.25f64.sqrt()];
    for (k, longer) in [(0, 0), (1, 1)] {
        let sd = e[k].std_error.unwrap();
        close(e[k].interval_95[longer].abs(), (1.0 + 0.25 * loading[k]) * Z95 * sd);
        close(e[k].interval_95[1 - longer].abs(), Z95 * sd);
    }
}

/// A parameter that the data do not fix is no axis; it follows the others as they are correlated.
#[test]
fn what_is_unknown_follows() {
    // y = a + b and y = b/2 at σ = 0.5: sd of b is 1, of a √1.25, their covariance −1.
    let pair = |i: usize, p: &[f64]| {
        if i == 0 { (p[0] + p[1], vec![1.0, 1.0]) } else { (0.5 * p[1], vec![0.0, 0.5]) }
    };
    let toy = Toy(2, pair);
    let free = vec![
        Free::new("a", (-10.0, 10.0), Transform::Identity, 0.1),
        Free::new("b", (-1.9, 1.9), Transform::Identity, 0.1),
    ];
    let d = data(&DVector::from_vec(vec![0.0, 0.0]), NoiseModel::white(0.5));
    let u = said(&toy, &d, &free);
    assert_eq!([u.estimates[0].identifiable, u.estimates[1].identifiable], [true, false]);
    let probes = u.probes(2);
    assert_eq!(probes.len(), 2);
    let sd = 1.25f64.sqrt();
    for p in &probes {
        close(p.theta[0].abs(), Z95 * sd);
        close(p.theta[1], -p.theta[0] / 1.25);
    }
    // Two combinations of the same two parameters may be longer than what counts as known: no probe goes beyond.
    let wide = vec![
        Free { lower: -2.5, upper: 2.5, ..free[0].clone() },
        Free { lower: -2.5, upper: 2.5, ..free[1].clone() },
    ];
    let u = said(&toy, &d, &wide);
    assert!(u.estimates.iter().all(|e| e.identifiable));
    for p in u.probes(1) {
        close((p.theta[0].powi(2) + p.theta[1].powi(2)).sqrt(), Z95 * 0.5 * 2.5);
    }
}

/// The standard error of b in y = ln(1 + b) grows with b: estimates that came out small are too sure of themselves.
#[test]
fn asymmetric_intervals_hold_what_straight_ones_lose() {
    let toy = Toy(4, |_, p: &[f64]| ((1.0 + p[0]).ln(), vec![1.0 / (1.0 + p[0])]));
    let free = vec![Free::new("b", (-0.95, 20.0), Transform::Identity, 1.0)];
    let (mut straight, mut held) = (0, 0);
    let repeats = 1000;
    for seed in 0..repeats {
        let noise = Random::new(seed).normals(4);
        let d = data(&(truth(&toy, &[1.0]) + noise), NoiseModel::white(1.0));
        let inside = |u: &Uncertainty| {
            let [low, high] = u.estimates[0].interval_95;
            usize::from(low <= 1.0 && 1.0 <= high)
        };
        straight += inside(&said(&toy, &d, &free));
        held += inside(&asked(&toy, &d, &free));
    }
    let share = |n: usize| 100.0 * n as f64 / repeats as f64;
    println!("straight {:.1} %, with sides {:.1} %", share(straight), share(held));
    assert!(share(straight) < 92.0, "{straight}");
    assert!((92.0..=98.0).contains(&share(held)), "{held}");
}
