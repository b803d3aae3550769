use super::*;
use nalgebra::{DMatrix, DVector};

fn points(ar1: f64) -> Points {
    let s: Vec<f64> = (0..40).map(|i| (f64::from(i) / 39.0).powf(1.3)).collect();
    let gap = (0..40).map(|i| if i == 17 { 4 } else { 1 }).collect();
    let leg = (0..40).map(|i| i / 13).collect();
    Points { s, gap, sd: 0.01, ar1, leg }
}

fn dense(p: &Points, size: &RestSize) -> (DMatrix<f64>, DMatrix<f64>) {
    let at: Vec<i32> = p
        .gap
        .iter()
        .enumerate()
        .scan(0, |a, (k, g)| {
            *a += if k > 0 { *g as i32 } else { 0 };
            Some(*a)
        })
        .collect();
    let n = p.s.len();
    let noise = DMatrix::from_fn(n, n, |i, j| p.sd.powi(2) * p.ar1.powi((at[i] - at[j]).abs()));
    let r = noise + DMatrix::from_diagonal(&DVector::from_vec(jumps()).map(|x| x * x));
    let k = DMatrix::from_fn(n, n, |i, j| {
        let factor = match size.form {
            RestForm::Even => 1.0,
            RestForm::Proportional => predicted()[i] * predicted()[j],
            RestForm::PerLeg => f64::from(u8::from(i / 13 == j / 13)),
        };
        factor * size.covariance((p.s[i] - p.s[j]).abs())
    });
    (r, k)
}

/// Two points of a jump.
fn jumps() -> Vec<f64> {
    (0..40).map(|i| if i == 20 || i == 21 { 0.1 } else { 0.0 }).collect()
}

/// A pull and a release that ends below zero.
fn predicted() -> Vec<f64> {
    (0..40).map(|i| (0.1 * f64::from(i)).sin()).collect()
}

#[test]
fn filter_and_dense_matrices_agree() {
    let sizes = [
        RestSize::NONE,
        RestSize { tau: 0.03, ..RestSize::NONE },
        RestSize { upsilon: 0.02, ..RestSize::NONE },
        RestSize { tau: 0.3, upsilon: 0.004, smooth_length: 0.1, jerk_length: 0.02, ..RestSize::NONE },
        RestSize { tau: 0.3, upsilon: 0.02, form: RestForm::Proportional, ..RestSize::NONE },
        RestSize { tau: 0.3, upsilon: 0.02, form: RestForm::PerLeg, ..RestSize::NONE },
    ];
    for (size, ar1) in sizes.iter().flat_map(|s| [0.0, 0.6, -0.4].map(|a| (*s, a))) {
        let p = points(ar1);
        let process = Process::beside(&p, size, &predicted(), &jumps());
        let (r, k) = dense(&p, &size);
        let chol = (&r + &k).cholesky().expect("positive");
        let want: f64 = 2.0 * chol.l().diagonal().iter().map(|d| d.ln()).sum::<f64>();
        assert!((process.ln_det - want).abs() < 1e-8 * want.abs(), "{} {want}", process.ln_det);
        let v = DVector::from_fn(40, |i, _| (0.3 * i as f64).sin() + 0.2);
        let mut w = v.as_slice().to_vec();
        process.whiten(&mut w);
        let q = w.iter().map(|x| x * x).sum::<f64>();
        assert!((q - v.dot(&chol.solve(&v))).abs() < 1e-7 * q, "{q}");
        let mut solved = v.as_slice().to_vec();
        process.solve(&mut solved);
        let error = DVector::from_vec(solved) - chol.solve(&v);
        assert!(error.norm() < 1e-7 * chol.solve(&v).norm());
        let close =
            |a: Vec<f64>, b: DVector<f64>| (DVector::from_vec(a) - &b).norm() <= 1e-12 * (1e-9 + b.norm());
        assert!(close(process.noise_times(v.as_slice()), &r * &v));
        assert!(close(process.rest_times(v.as_slice()), &k * &v));
    }
}

#[test]
fn draws_have_the_covariance() {
    let p = points(0.5);
    for form in [RestForm::Even, RestForm::Proportional, RestForm::PerLeg] {
        let size = RestSize { tau: 0.03, upsilon: 0.02, smooth_length: 0.3, jerk_length: 0.05, form };
        let (r, k) = dense(&p, &size);
        let process = Process::beside(&p, size, &predicted(), &jumps());
        let mut random = Random::new(4);
        let (mut sum, mut noise) = (DMatrix::zeros(40, 40), DMatrix::zeros(40, 40));
        let draws = 20_000;
        for _ in 0..draws {
            let (d, e) = process.draw(&mut random);
            let (d, e) = (DVector::from_vec(d), DVector::from_vec(e));
            sum += &d * d.transpose();
            noise += &e * e.transpose();
        }
        let far = |a: DMatrix<f64>, b: &DMatrix<f64>| (a / f64::from(draws) - b).abs().max() / b.max();
        assert!(far(sum, &k) < 0.04 && far(noise, &r) < 0.04);
    }
}
