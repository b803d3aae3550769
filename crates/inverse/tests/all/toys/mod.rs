//! Toy problems shared by the tests.
#![allow(dead_code, missing_docs)]

use inverse::{Data, Fit, FitOptions, Free, NoiseModel, PredictError, Prediction, Problem, fit};
use nalgebra::{DMatrix, DVector};
use params::Transform;
use std::ops::ControlFlow;

/// A model given by a closure for values and jacobian rows.
pub struct Toy<F>(pub usize, pub F);

impl<F: Fn(usize, &[f64]) -> (f64, Vec<f64>) + Sync> Problem for Toy<F> {
    fn predict(&self, theta: &[f64], jacobian: bool) -> Result<Prediction, PredictError> {
        let rows: Vec<(f64, Vec<f64>)> = (0..self.0).map(|i| (self.1)(i, theta)).collect();
        let values = DVector::from_iterator(self.0, rows.iter().map(|r| r.0));
        let j = jacobian.then(|| DMatrix::from_fn(self.0, theta.len(), |i, k| rows[i].1[k]));
        Ok(Prediction::new(values, j))
    }
}

/// y = a exp(−b t) + c at t = i/10.
pub fn exponential(i: usize, p: &[f64]) -> (f64, Vec<f64>) {
    let t = i as f64 / 10.0;
    let e = (-p[1] * t).exp();
    (p[0] * e + p[2], vec![e, -p[0] * t * e, 1.0])
}

pub fn exponential_free() -> Vec<Free> {
    vec![
        Free::new("a", (1e-3, 1e3), Transform::Log, 1.0),
        Free::new("b", (1e-3, 1e2), Transform::Log, 1.0),
        Free::new("c", (-10.0, 10.0), Transform::Identity, 0.0),
    ]
}

pub fn data(values: &DVector<f64>, noise: NoiseModel) -> Data {
    Data::from_parts([("y".to_owned(), values.iter().copied().collect(), noise)]).expect("good data")
}

pub fn quiet(problem: &dyn Problem, data: &Data, free: &[Free], options: &FitOptions) -> Fit {
    fit(problem, data, free, options, &mut |_| ControlFlow::Continue(())).expect("a fit")
}

pub fn truth(problem: &dyn Problem, theta: &[f64]) -> DVector<f64> {
    problem.predict(theta, false).expect("a prediction").values
}
