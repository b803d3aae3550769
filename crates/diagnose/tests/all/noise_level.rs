//! The noise estimator: unbiased within a few per cent on smooth curves at about 40 points per ramp, with white and
//! AR(1) noise, with steps and turning points. `-- --nocapture` prints the figures.
#![allow(missing_docs)]

use diagnose::noise::{NoiseError, estimate};
use diagnose::segments::breaks;
use inverse::Random;
use rayon::prelude::*;

/// Loads, holds and unloads of 40 points each; a stiffening force with relaxation.
fn record(step: bool) -> (Vec<f64>, Vec<f64>, Vec<f64>, f64) {
    let rates = [1.0, 0.0, -0.7, 1.2, 0.0, -0.5, 0.9, 1.0];
    let (mut t, mut u) = (vec![0.0], vec![0.0]);
    let mut random = Random::new(4);
    for rate in rates {
        for _ in 0..40 {
            let dt = 0.025 * (1.0 + 0.2 * (random.uniform() - 0.5));
            t.push(t[t.len() - 1] + dt);
            u.push(u[u.len() - 1] + rate * dt);
        }
    }
    let mut memory = 0.0;
    let mut f: Vec<f64> = (0..t.len())
        .map(|i| {
            if i > 0 {
                memory += (t[i] - t[i - 1]) / 0.4 * (u[i] - memory);
            }
            0.3 * u[i] + 0.05 * ((1.8 * u[i]).exp() - 1.0) + 0.2 * (u[i] - memory)
        })
        .collect();
    let peak = f.iter().copied().fold(0.0, f64::max);
    if step {
        for v in &mut f[290..] {
            *v -= 0.3 * peak;
        }
    }
    (t, u, f, peak)
}

fn mean_estimate(share: f64, ar1: f64, step: bool) -> (f64, f64, f64) {
    let (t, u, f, peak) = record(step);
    let sd = share * peak;
    let runs = 150_u64;
    let one = |seed: u64| {
        let noise = Random::new(seed + 40).ar1(f.len(), sd, ar1);
        let y: Vec<f64> = f.iter().zip(noise.iter()).map(|(a, b)| a + b).collect();
        let e = estimate(&t, &y, &breaks(&t, &u)).unwrap();
        assert!(e.points_used > 150);
        (e.sd / sd, e.ar1_raw)
    };
    let all: Vec<(f64, f64)> = (0..runs).into_par_iter().map(one).collect();
    let mean = |g: &dyn Fn(&(f64, f64)) -> f64| all.iter().map(g).sum::<f64>() / runs as f64;
    let level = mean(&|a| a.0);
    (level, (mean(&|a| a.0.powi(2)) - level * level).max(0.0).sqrt(), mean(&|a| a.1))
}

#[test]
fn white_noise_is_estimated_without_bias() {
    for share in [0.005, 0.007, 0.01] {
        let (level, spread, phi) = mean_estimate(share, 0.0, false);
        println!("white {share}: sd / true {level:.3} ± {spread:.3}, ar1 {phi:.3}");
        assert!((level - 1.0).abs() < 0.03 && spread < 0.08 && phi.abs() < 0.05);
    }
}

#[test]
fn autocorrelated_noise_is_estimated_without_bias() {
    for ar1 in [0.3, 0.6] {
        let (level, spread, phi) = mean_estimate(0.008, ar1, false);
        println!("AR(1) {ar1}: sd / true {level:.3} ± {spread:.3}, ar1 {phi:.3}");
        assert!((level - 1.0).abs() < 0.06 && spread < 0.25 && (phi - ar1).abs() < 0.06);
    }
}

#[test]
fn steps_do_not_count_as_noise() {
    let (level, spread, phi) = mean_estimate(0.007, 0.0, true);
    println!("with a step: sd / true {level:.3} ± {spread:.3}, ar1 {phi:.3}");
    assert!((level - 1.0).abs() < 0.03);
}

#[test]
fn unit_of_time_and_force_do_not_matter() {
    let (t, u, f, _) = record(false);
    let noise = Random::new(1).normals(f.len());
    let y: Vec<f64> = f.iter().zip(noise.iter()).map(|(a, b)| a + 0.01 * b).collect();
    let e = estimate(&t, &y, &breaks(&t, &u)).unwrap();
    let minutes: Vec<f64> = t.iter().map(|v| v / 60.0).collect();
    let milli: Vec<f64> = y.iter().map(|v| v * 1000.0).collect();
    let other = estimate(&minutes, &milli, &breaks(&t, &u)).unwrap();
    assert!((other.sd / 1000.0 - e.sd).abs() < 1e-6 * e.sd && (other.ar1 - e.ar1).abs() < 1e-4);
}

#[test]
fn short_smooth_and_malformed_records_are_errors() {
    let t: Vec<f64> = (0..60).map(f64::from).collect();
    let line: Vec<f64> = t.iter().map(|x| 0.1 * x).collect();
    assert!(matches!(estimate(&t[..7], &line[..7], &[]), Err(NoiseError::TooShort { .. })));
    assert!(matches!(estimate(&[], &[], &[]), Err(NoiseError::TooShort { .. })));
    assert!(matches!(estimate(&t, &line, &[]), Err(NoiseError::Noiseless { .. })));
    assert!(matches!(estimate(&t, &[0.0; 60], &[]), Err(NoiseError::Noiseless { .. })));
    assert!(matches!(estimate(&t, &line[1..], &[]), Err(NoiseError::Record(_))));
    let mut back = t.clone();
    back[30] = back[29];
    assert!(matches!(estimate(&back, &line, &[]), Err(NoiseError::Record(_))));
    let mut nan = line.clone();
    nan[3] = f64::NAN;
    assert!(matches!(estimate(&t, &nan, &[900, 0]), Err(NoiseError::Record(_))));
}
