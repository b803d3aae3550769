//! Problems whose misfit is large where it is least: the jacobian alone says little of the curvature there.
#![allow(missing_docs)]

use crate::toys::{Toy, data, quiet};
use inverse::*;
use nalgebra::DVector;
use params::Transform;

/// Brown and Dennis's function: 20 residuals of 4 parameters, least sum of squares 85822.2 (Moré, Garbow & Hillstrom 1981,
/// doi:10.1145/355934.355936, problem 16), least at (−11.594, 13.204, −0.40344, 0.23678).
#[test]
fn a_large_misfit_is_least_where_it_is_published_to_be() {
    let toy = Toy(20, |i: usize, x: &[f64]| {
        let t = (i + 1) as f64 / 5.0;
        let (a, b) = (x[0] + t * x[1] - t.exp(), x[2] + x[3] * t.sin() - t.cos());
        (a * a + b * b, vec![2.0 * a, 2.0 * a * t, 2.0 * b, 2.0 * b * t.sin()])
    });
    let d = data(&DVector::zeros(20), NoiseModel::white(1.0));
    let free: Vec<Free> = [("a", 25.0), ("b", 5.0), ("c", -5.0), ("d", -1.0)]
        .iter()
        .map(|(n, x)| Free::new(*n, (f64::NEG_INFINITY, f64::INFINITY), Transform::Identity, *x))
        .collect();
    let options = FitOptions { max_iterations: 100, tolerance: 1e-9, ..FitOptions::default() };
    let fit = quiet(&toy, &d, &free, &options);
    assert!((fit.f - 85822.2).abs() < 0.05, "{} after {} runs", fit.f, fit.forward_runs);
    for (x, want) in fit.theta.iter().zip([-11.594, 13.204, -0.40344, 0.23678]) {
        assert!((x - want).abs() < 1e-2 * want.abs(), "{:?}", fit.theta);
    }
    assert!(fit.forward_runs <= 30, "{} runs", fit.forward_runs);
}
