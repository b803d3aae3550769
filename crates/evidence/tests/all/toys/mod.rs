//! Small problems that the tests share, and their dense covariances.
#![allow(dead_code, reason = "each test uses some of it")]

use evidence::{Belief, Linear, Parameter, Place, Record, RestForm, RestPrior, RestSize};
use inverse::{Data, NoiseModel, Random};
use nalgebra::{DMatrix, DVector};

/// Peak of most of them, in newtons.
pub const PEAK: f64 = 3.0;

/// Two parameters of a base model.
pub fn base() -> Vec<Parameter> {
    vec![parameter("a", Belief::normal(0.0, 0.2), false), parameter("b", Belief::normal(0.0, 0.3), false)]
}

/// The same with an effect's amplitude.
pub fn with_effect() -> Vec<Parameter> {
    let mut p = base();
    p.push(parameter("effects.bump.size", Belief::above(0.0, 0.1), true));
    p
}

/// Path coordinates of `n` points, not evenly spaced.
pub fn line(n: usize) -> Vec<f64> {
    (0..n).map(|i| (i as f64 / (n.max(2) - 1) as f64).powf(1.2)).collect()
}

/// Three legs.
pub fn legs(n: usize) -> Vec<usize> {
    (0..n).map(|i| 3 * i / n).collect()
}

/// One test of `n` points with these numbers and noise.
pub fn data(values: &DVector<f64>, noise: NoiseModel) -> Data {
    Data::from_parts([("pull".to_owned(), values.as_slice().to_vec(), noise)]).expect("good data")
}

pub fn record(data: &Data, peak: f64) -> Record {
    let n = data.points();
    let place = Place { test: "pull".into(), s: line(n), leg: legs(n), peak };
    Record::new(data, &[place], 0.015).expect("good record")
}

pub fn parameter(path: &str, belief: Belief, amplitude: bool) -> Parameter {
    Parameter { path: path.into(), at: 0.0, belief, amplitude }
}

/// Smooth columns of size `peak`: constant, line, wave, bump, kink.
pub fn column(kind: usize, n: usize, peak: f64) -> DVector<f64> {
    let s = line(n);
    DVector::from_fn(n, |i, _| {
        peak * match kind {
            0 => 1.0,
            1 => s[i],
            2 => (9.0 * s[i]).sin(),
            3 => (-30.0 * (s[i] - 0.5).powi(2)).exp(),
            4 => (s[i] - 0.4).max(0.0),
            _ => (s[i] * 4.0 * kind as f64).cos(),
        }
    })
}

pub fn linear(misfit: DVector<f64>, kinds: &[usize], parameters: Vec<Parameter>, peak: f64) -> Linear {
    let n = misfit.len();
    let columns: Vec<_> = kinds.iter().map(|&k| column(k, n, peak)).collect();
    let jacobian = if columns.is_empty() { DMatrix::zeros(n, 0) } else { DMatrix::from_columns(&columns) };
    Linear { misfit, jacobian, parameters, jumps: Vec::new() }
}

/// Profile of what the model of a pull predicts, its root mean square 1: it rises, falls, and ends a little below zero.
pub fn pull(n: usize) -> Vec<f64> {
    let wave = DVector::from_iterator(n, line(n).iter().map(|s| (3.5 * s).sin()));
    let size = wave.norm() / (n as f64).sqrt();
    (wave / size).as_slice().to_vec()
}

/// A record whose model predicts a pull and misses `r`.
pub fn pulled(r: &DVector<f64>, noise: NoiseModel, peak: f64) -> Record {
    // Half of it: the size of what a model predicts is nothing to its rest.
    let predicted = DVector::from_vec(pull(r.len())) * (0.5 * peak);
    record(&data(&(r + predicted), noise), peak)
}

/// A prior without a rest.
pub fn no_rest() -> RestPrior {
    RestPrior { zero: 1.0, ..RestPrior::default() }
}

/// A record of a rough misfit.
pub fn misfit(n: usize, sd: f64, seed: u64) -> DVector<f64> {
    let wave = column(2, n, 0.6 * sd);
    Random::new(seed).normals(n) * sd + wave
}

/// Covariance of the rest, shares of the peak, beside a model that predicts a pull.
pub fn dense_rest(s: &[f64], size: &RestSize) -> DMatrix<f64> {
    let n = s.len();
    let (h, leg) = (pull(n), legs(n));
    DMatrix::from_fn(n, n, |i, j| {
        let factor = match size.form {
            RestForm::Even => 1.0,
            RestForm::Proportional => h[i] * h[j],
            RestForm::PerLeg => f64::from(u8::from(leg[i] == leg[j])),
        };
        factor * size.covariance((s[i] - s[j]).abs())
    })
}

/// Covariance of AR(1) noise.
pub fn dense_noise(n: usize, sd: f64, ar1: f64) -> DMatrix<f64> {
    DMatrix::from_fn(n, n, |i, j| sd * sd * ar1.powi(i.abs_diff(j) as i32))
}

/// ln N(x; 0, C).
pub fn ln_normal(x: &DVector<f64>, c: &DMatrix<f64>) -> f64 {
    let chol = c.clone().cholesky().expect("positive definite");
    let ln_det = 2.0 * chol.l().diagonal().iter().map(|d| d.ln()).sum::<f64>();
    -0.5 * (x.dot(&chol.solve(x)) + ln_det + x.len() as f64 * std::f64::consts::TAU.ln())
}
