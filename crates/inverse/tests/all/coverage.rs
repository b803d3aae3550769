//! 95 % intervals cover the truth in 92–98 % of synthetic repeats: white and AR(1) noise, the sandwich of the
//! plain sum of squares, numerical error, and the second of two stages. Fixed seeds.
//! `cargo test -p inverse coverage:: -- --nocapture` prints the figures.
#![allow(missing_docs)]

use crate::toys;

use inverse::*;
use nalgebra::{DMatrix, DVector};
use params::Transform;
use toys::{Toy, data, exponential, exponential_free, quiet, truth};

const REPEATS: u64 = 1000;
const TRUTH: [f64; 3] = [3.0, 0.7, -0.4];

/// Share of repeats in which each interval holds the truth.
fn coverage(noise: NoiseModel, objective: Objective, label: &str) -> Vec<f64> {
    let toy = Toy(60, exponential);
    let clean = truth(&toy, &TRUTH);
    let options = FitOptions { objective, ..Default::default() };
    let mut hits = [0.0; 3];
    let template = data(&clean, noise.clone());
    for repeat in 0..REPEATS {
        let y = &clean + template.simulate_noise(&mut Random::new(repeat + 17));
        let d = data(&y, noise.clone());
        let end = quiet(&toy, &d, &exponential_free(), &options);
        let u = uncertainty(&d, &exponential_free(), &end, &Identifiability::default()).unwrap();
        for (k, e) in u.estimates.iter().enumerate() {
            assert!(e.identifiable, "{label}: {e:?}");
            hits[k] += f64::from(u8::from(e.interval_95[0] <= TRUTH[k] && TRUTH[k] <= e.interval_95[1]));
        }
    }
    let shares: Vec<f64> = hits.iter().map(|h| h / REPEATS as f64).collect();
    println!("coverage, {label}: a {:.3}, b {:.3}, c {:.3}", shares[0], shares[1], shares[2]);
    shares
}

fn assert_calibrated(shares: &[f64]) {
    assert!(shares.iter().all(|s| (0.92..=0.98).contains(s)), "{shares:?}");
}

#[test]
fn white_noise() {
    assert_calibrated(&coverage(NoiseModel::white(0.05), Objective::Whitened, "white"));
}

#[test]
fn autocorrelated_noise() {
    assert_calibrated(&coverage(NoiseModel::ar1(0.05, 0.6), Objective::Whitened, "AR(1) 0.6"));
}

#[test]
fn plain_sum_with_the_sandwich() {
    assert_calibrated(&coverage(NoiseModel::white(0.05), Objective::PaperSum, "plain sum, white"));
    assert_calibrated(&coverage(NoiseModel::ar1(0.05, 0.6), Objective::PaperSum, "plain sum, AR(1) 0.6"));
}

#[test]
fn numerical_error_of_the_model() {
    let e = DVector::from_fn(60, |i, _| 0.04 * (i as f64 / 15.0).sin());
    let noise = NoiseModel::white(0.03).with_nuisance(e);
    assert_calibrated(&coverage(noise.clone(), Objective::Whitened, "with numerical error"));
    assert_calibrated(&coverage(noise.clone(), Objective::Record, "weighed by the record's noise alone"));
    assert_calibrated(&coverage(noise, Objective::PaperSum, "plain sum, numerical error"));
}

/// Two tests: the first fixes a and b, the second fixes d with a and b held: y₂ = a d (1 − exp(−b t)).
#[test]
fn second_stage_knows_what_the_first_does_not() {
    let first = Toy(30, exponential);
    let second_values = |i: usize, p: &[f64]| {
        let t = i as f64 / 10.0;
        let e = (-p[1] * t).exp();
        let y = p[0] * p[2] * (1.0 - e);
        (y, vec![y / p[0], p[0] * p[2] * t * e, y / p[2]])
    };
    let all = Toy(50, second_values);
    let (clean1, clean2) = (truth(&first, &TRUTH), truth(&all, &[3.0, 0.7, 2.0]));
    let (noise1, noise2) = (NoiseModel::white(0.08), NoiseModel::ar1(0.08, 0.4));
    let free2 = vec![Free::new("d", (0.01, 100.0), Transform::Log, 1.0)];
    let (mut hits, mut naive) = (0.0, 0.0);
    for repeat in 0..REPEATS {
        let mut random = Random::new(repeat + 5000);
        let d1 = data(&(&clean1 + random.ar1(30, 0.08, 0.0)), noise1.clone());
        let d2 = data(&(&clean2 + random.ar1(50, 0.08, 0.4)), noise2.clone());
        let one = quiet(&first, &d1, &exponential_free(), &FitOptions::default());
        let rule = Identifiability::default();
        let u1 = uncertainty(&d1, &exponential_free(), &one, &rule).unwrap();
        let held = Fixed::new(&all, vec![Some(one.theta[0]), Some(one.theta[1]), None]);
        let options = FitOptions { objective: Objective::PaperSum, ..Default::default() };
        let two = quiet(&held, &d2, &free2, &options);
        let full = all.predict(&held.whole(&two.theta), true).unwrap().jacobian.unwrap();
        let covariance = u1.covariance();
        let hand = Held {
            jacobian: full.columns(0, 2).into_owned(),
            covariance: DMatrix::from_fn(2, 2, |i, j| covariance[(i, j)]),
        };
        let inside = |u: Uncertainty| {
            let [lo, hi] = u.estimates[0].interval_95;
            f64::from(u8::from(lo <= 2.0 && 2.0 <= hi))
        };
        hits += inside(staged_uncertainty(&d2, &free2, &two, &hand, &rule).unwrap());
        naive += inside(uncertainty(&d2, &free2, &two, &rule).unwrap());
    }
    let (share, naive) = (hits / REPEATS as f64, naive / REPEATS as f64);
    println!("coverage, second stage: {share:.3} (without propagation {naive:.3})");
    assert_calibrated(&[share]);
    assert!(naive < 0.9, "the test must be able to fail: {naive}");
}

#[test]
fn reduced_chi_square_is_one_and_degrees_of_freedom_add_up() {
    let toy = Toy(60, exponential);
    let clean = truth(&toy, &TRUTH);
    let e = DVector::from_fn(60, |i, _| 0.2 * (i as f64 / 20.0).cos());
    let noise = NoiseModel::ar1(0.05, 0.5).with_nuisance(e);
    let template = data(&clean, noise.clone());
    let (mut total, mut dof) = (0.0, 0.0);
    for repeat in 0..300 {
        let d = data(&(&clean + template.simulate_noise(&mut Random::new(repeat))), noise.clone());
        let end = quiet(&toy, &d, &exponential_free(), &FitOptions::default());
        let q = quality(&d, &exponential_free(), &end);
        total += q.reduced_chi2_total / 300.0;
        dof += q.blocks[0].degrees_of_freedom / 300.0;
        assert!(q.chi2 >= q.chi2_total && q.bic > q.chi2_total && q.aicc > q.chi2_total);
    }
    println!("mean reduced chi2 (total) {total:.3}, degrees of freedom {dof:.3}");
    assert!((total - 1.0).abs() < 0.03 && (dof - 3.0).abs() < 1e-6);
}

#[test]
fn profile_interval_agrees_with_the_linear_one_and_bends_where_it_should() {
    let toy = Toy(60, exponential);
    let y = truth(&toy, &TRUTH) + Random::new(9).normals(60) * 0.05;
    let d = data(&y, NoiseModel::white(0.05));
    let (free, options) = (exponential_free(), FitOptions::default());
    let end = quiet(&toy, &d, &free, &options);
    let u = uncertainty(&d, &free, &end, &Identifiability::default()).unwrap();
    let e = &u.estimates[1];
    let sd = e.std_error.unwrap();
    let grid: Vec<f64> = (-12..=12).map(|i| e.value + 0.3 * f64::from(i) * sd).collect();
    let points = profile(&toy, &d, &free, &end, 1, &grid, &options).unwrap();
    let [lo, hi] = profile_interval(&points, e.value, end.f, 3.84);
    assert!((lo.unwrap() - e.interval_95[0]).abs() < 0.15 * sd, "{lo:?} {e:?}");
    assert!((hi.unwrap() - e.interval_95[1]).abs() < 0.15 * sd, "{hi:?} {e:?}");
    assert!(profile(&toy, &d, &free, &end, 7, &grid, &options).is_err());
}

#[test]
fn a_prior_counts_once_and_is_not_called_knowledge_from_the_data() {
    let toy = Toy(30, |i: usize, p: &[f64]| {
        let t = i as f64;
        (p[0] * p[1] * t, vec![p[1] * t, p[0] * t])
    });
    let d = data(&truth(&toy, &[2.0, 3.0]), NoiseModel::white(0.1));
    let free = vec![
        Free::new("a", (1e-3, 1e3), Transform::Log, 1.0).prior(2f64.ln(), 0.5),
        Free::new("b", (1e-3, 1e3), Transform::Log, 1.0).prior(3f64.ln(), 0.5),
    ];
    let end = quiet(&toy, &d, &free, &FitOptions { tolerance: 1e-12, ..Default::default() });
    assert!((end.theta[0] - 2.0).abs() < 1e-4 && (end.theta[1] - 3.0).abs() < 1e-4, "{:?}", end.theta);
    let u = uncertainty(&d, &free, &end, &Identifiability::default()).unwrap();
    assert!((u.estimates[0].scaled_sd - 0.5 / 2f64.sqrt()).abs() < 0.01, "{:?}", u.estimates[0]);
    assert!(u.correlation[(0, 1)] < -0.99);
}
