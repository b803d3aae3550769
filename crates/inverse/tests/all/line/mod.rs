//! A line, its design and its search: what the tests with closed forms share.
#![allow(dead_code)]

use inverse::*;
use nalgebra::{DMatrix, DVector};
use params::Transform;

/// y = a + b t at t = −2, …, 2: XᵀX = diag(5, 10).
pub fn line(i: usize, p: &[f64]) -> (f64, Vec<f64>) {
    let t = i as f64 - 2.0;
    (p[0] + p[1] * t, vec![1.0, t])
}

pub fn design(n: usize) -> DMatrix<f64> {
    DMatrix::from_fn(n, 2, |i, k| line(i, &[0.0; 2]).1[k])
}

pub fn free(limit: f64) -> Vec<Free> {
    let one = |name: &str| Free::new(name, (-limit, limit), Transform::Identity, 0.1);
    vec![one("a"), one("b")]
}

pub fn exactly(objective: Objective) -> FitOptions {
    FitOptions { objective, tolerance: 1e-13, insignificant: 0.0, ..FitOptions::default() }
}

pub fn close(a: f64, b: f64) {
    assert!((a - b).abs() <= 1e-7 * b.abs().max(1e-12), "{a} {b}");
}

pub fn same(a: &DMatrix<f64>, b: &DMatrix<f64>) {
    assert!((a - b).norm() <= 1e-7 * b.norm(), "{a} {b}");
}

/// Two blocks of five points, own noise each, numerical error of a block and across both, one point held out.
pub fn two_blocks() -> Data {
    let error = DVector::from_vec(vec![0.1, 0.3, -0.2, 0.0, 0.4]);
    let noise = [NoiseModel::ar1(0.3, 0.5), NoiseModel::ar1(0.8, -0.4).with_nuisance(error)];
    let values = [1.0, 0.7, 1.9, 2.2, 3.3, 2.9, 4.8, 4.0, 5.5, 6.1];
    let part = |k: usize| (format!("{k}"), values[5 * k..5 * k + 5].to_vec(), noise[k].clone());
    let mut d = Data::from_parts([part(0), part(1)]).unwrap();
    d.nuisance = vec![DVector::from_fn(10, |i, _| 0.05 * i as f64 - 0.2)];
    d.held_out = (0..10).map(|i| i == 3).collect();
    d
}
