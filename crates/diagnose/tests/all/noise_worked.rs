//! The noise estimate against dense linear algebra: residuals of least-squares polynomials, and the restricted
//! likelihood in its textbook form, log|R| + log|XᵀR⁻¹X| instead of contrasts.
#![allow(missing_docs)]

use diagnose::noise::{NoiseError, estimate};
use inverse::Random;
use nalgebra::{DMatrix, DVector};

fn clock(n: usize) -> Vec<f64> {
    (0..n).map(|i| 0.1 * i as f64).collect()
}

/// A smooth curve that every window's polynomial holds, and noise.
fn curve(n: usize, sd: f64, ar1: f64, seed: u64) -> Vec<f64> {
    let noise = Random::new(seed).ar1(n, sd, ar1);
    clock(n).iter().zip(noise.iter()).map(|(t, e)| 1.0 + 0.5 * t - 0.02 * t.powi(3) + e).collect()
}

/// Powers of time on a window, scaled to −1 … 1.
fn powers(n: usize, degree: usize) -> DMatrix<f64> {
    DMatrix::from_fn(n, degree + 1, |i, k| (2.0 * i as f64 / (n - 1) as f64 - 1.0).powi(k as i32))
}

/// Of windows (start, points, degree) at correlation `phi`: sd, log likelihood, degrees of freedom.
fn restricted(y: &[f64], windows: &[(usize, usize, usize)], phi: f64) -> (f64, f64, f64) {
    let (mut square, mut log_det, mut freedom) = (0.0, 0.0, 0.0);
    for &(start, n, degree) in windows {
        let (x, v) = (powers(n, degree), DVector::from_column_slice(&y[start..start + n]));
        let r = DMatrix::from_fn(n, n, |i, j| phi.powi(i.abs_diff(j) as i32));
        let inverse = r.clone().try_inverse().unwrap();
        let inner = x.transpose() * &inverse * &x;
        let weighed = &inverse * &v;
        let right = x.tr_mul(&weighed);
        square += v.dot(&weighed) - right.dot(&inner.clone().lu().solve(&right).unwrap());
        log_det += (r.determinant() * inner.determinant() / (x.tr_mul(&x)).determinant()).ln();
        freedom += (n - degree - 1) as f64;
    }
    let variance = square / freedom;
    (variance.sqrt(), -0.5 * (freedom * variance.ln() + log_det), freedom)
}

fn close(a: f64, b: f64, tolerance: f64) {
    assert!((a - b).abs() <= tolerance * b.abs(), "{a} {b}");
}

#[test]
fn white_noise_is_the_residual_of_a_polynomial_in_each_window() {
    let y = curve(40, 0.03, 0.0, 1);
    // Two windows of twenty, of degree five; too few to ask for a correlation.
    let e = estimate(&clock(40), &y, &[]).unwrap();
    let (sd, _, freedom) = restricted(&y, &[(0, 20, 5), (20, 20, 5)], 0.0);
    assert_eq!(freedom, 28.0);
    close(e.sd, sd, 1e-9);
    close(e.relative_error, (0.5f64 / 28.0).sqrt(), 1e-12);
    assert_eq!((e.ar1, e.ar1_raw, e.conservative_ar1, e.points_used), (0.0, 0.0, 0.0, 40));
    close(e.conservative_sd, sd, 1e-9);
    // A break after eight: a window of degree three, the rest in two. After seven: those are lost.
    let e = estimate(&clock(40), &y, &[8]).unwrap();
    close(e.sd, restricted(&y, &[(0, 8, 3), (8, 16, 5), (24, 16, 5)], 0.0).0, 1e-9);
    let e = estimate(&clock(40), &y, &[7, 0, 40, 99]).unwrap();
    close(e.sd, restricted(&y, &[(7, 16, 5), (23, 17, 5)], 0.0).0, 1e-9);
    assert_eq!(e.points_used, 33);
    // Twenty-nine points are one window, thirty-two are two.
    let e = estimate(&clock(61), &curve(61, 0.03, 0.0, 5), &[29]).unwrap();
    close(e.sd, restricted(&curve(61, 0.03, 0.0, 5), &[(0, 29, 5), (29, 16, 5), (45, 16, 5)], 0.0).0, 1e-9);
}

#[test]
fn a_window_with_a_step_is_left_out() {
    let mut y = curve(60, 0.03, 0.0, 2);
    for v in &mut y[30..] {
        *v += 5.0;
    }
    let e = estimate(&clock(60), &y, &[]).unwrap();
    assert_eq!(e.points_used, 40);
    close(e.sd, restricted(&y, &[(0, 20, 5), (40, 20, 5)], 0.0).0, 1e-9);
}

#[test]
fn a_correlation_maximises_the_restricted_likelihood_of_long_windows() {
    let y = curve(160, 0.03, 0.6, 3);
    let e = estimate(&clock(160), &y, &[]).unwrap();
    assert_eq!(e.points_used, 160);
    let windows = [(0, 40, 7), (40, 40, 7), (80, 40, 7), (120, 40, 7)];
    let value = |phi: f64| restricted(&y, &windows, phi).1;
    let with_prior = |phi: f64| value(phi) + (1.0 - phi * phi).ln();
    assert!(e.ar1 > 0.3 && e.ar1 == e.ar1_raw, "{e:?}");
    for h in [1e-3, 1e-2] {
        assert!(with_prior(e.ar1) > with_prior(e.ar1 - h) && with_prior(e.ar1) > with_prior(e.ar1 + h));
    }
    let (sd, _, freedom) = restricted(&y, &windows, e.ar1);
    close(e.sd, sd, 1e-6);
    let curvature = (2.0 * value(e.ar1) - value(e.ar1 - 0.03) - value(e.ar1 + 0.03)) / 9e-4;
    close(e.ar1_error, curvature.powf(-0.5), 1e-4);
    close(e.conservative_ar1, (e.ar1 + 1.5 * e.ar1_error).min(0.9), 1e-12);
    close(e.conservative_sd, restricted(&y, &windows, e.conservative_ar1).0, 1e-6);
    close(e.relative_error, (0.5 / freedom).sqrt() * (1.0 + e.ar1) / (1.0 - e.ar1), 1e-9);
    close(e.freedom(), freedom * ((1.0 - e.ar1) / (1.0 + e.ar1)).powi(2), 1e-9);
}

/// What is not significant is not used, but conservative noise whitens with it where it is positive.
#[test]
fn a_small_correlation_is_for_conservative_noise_only() {
    let (mut up, mut down) = (0, 0);
    for seed in 0..8 {
        let y = curve(120, 0.03, 0.0, 40 + seed);
        let e = estimate(&clock(120), &y, &[]).unwrap();
        let windows: Vec<_> = (0..6).map(|k| (20 * k, 20, 5)).collect();
        let value = |phi: f64| restricted(&y, &windows, phi).1;
        let gain = 2.0 * (value(e.ar1_raw) - value(0.0));
        let needed = if e.ar1_raw > 0.0 { 2.0 } else { 3.84 };
        if e.points_used < 120 || gain > needed {
            continue;
        }
        assert_eq!((e.ar1, e.conservative_ar1), (0.0, e.ar1_raw.max(0.0)));
        close(e.sd, restricted(&y, &windows, 0.0).0, 1e-9);
        close(e.conservative_sd, restricted(&y, &windows, e.conservative_ar1).0, 1e-6);
        if e.ar1_raw > 0.0 { up += 1 } else { down += 1 }
    }
    assert!(up > 0 && down > 0, "{up} {down}: both kinds must occur");
}

#[test]
fn the_least_that_can_be_estimated_is_twenty_differences() {
    // Two windows of sixteen have ten each, one of twenty has fourteen.
    let of = |n: usize, breaks: &[usize]| estimate(&clock(n), &curve(n, 0.03, 0.0, 4), breaks);
    assert!(of(32, &[16]).is_ok());
    assert_eq!(of(20, &[]), Err(NoiseError::TooShort { found: 14 }));
    let small: Vec<f64> =
        clock(40).iter().enumerate().map(|(i, t)| t + if i % 2 == 0 { 1e-12 } else { 0.0 }).collect();
    let said = estimate(&clock(40), &small, &[]).unwrap_err().to_string();
    assert!(said.starts_with("the record is smooth to its last digit (sd below 3.9e-9)"), "{said}");
}
