//! Profile likelihood: one parameter held at each value of a grid, the others refitted.

use crate::{Data, Fit, FitError, FitOptions, Free, PredictError, Prediction, Problem, fit};
use std::ops::ControlFlow;

/// A problem with some of its parameters held.
pub struct Fixed<'a> {
    problem: &'a dyn Problem,
    held: Vec<Option<f64>>,
}

impl<'a> Fixed<'a> {
    /// `held[k]` is the value of parameter k where it is held, `None` where it stays free.
    pub fn new(problem: &'a dyn Problem, held: Vec<Option<f64>>) -> Self {
        Self { problem, held }
    }

    /// All parameters from the free ones.
    pub fn whole(&self, theta: &[f64]) -> Vec<f64> {
        let mut rest = theta.iter().copied();
        self.held.iter().map(|h| h.or_else(|| rest.next()).unwrap_or(f64::NAN)).collect()
    }
}

impl Problem for Fixed<'_> {
    fn predict(&self, theta: &[f64], jacobian: bool) -> Result<Prediction, PredictError> {
        let mut answer = self.problem.predict(&self.whole(theta), jacobian)?;
        let open: Vec<usize> = (0..self.held.len()).filter(|&k| self.held[k].is_none()).collect();
        answer.jacobian = answer.jacobian.map(|j| j.select_columns(&open));
        Ok(answer)
    }
}

/// One point of a profile.
#[derive(Clone, Debug, PartialEq)]
pub struct ProfilePoint {
    /// Value of the parameter, physical unit.
    pub value: f64,
    /// Best objective there; `None` where no fit was possible.
    pub f: Option<f64>,
    /// All parameters there, physical units.
    pub theta: Vec<f64>,
}

/// The profile of parameter `index` over `grid` (physical units, any order; answered in ascending order).
/// Each fit starts where its neighbour, seen from the optimum, ended.
///
/// # Errors
/// [`FitError::Parameter`] for an index that does not exist; faults of data and parameters.
pub fn profile(
    problem: &dyn Problem,
    data: &Data,
    free: &[Free],
    optimum: &Fit,
    index: usize,
    grid: &[f64],
    options: &FitOptions,
) -> Result<Vec<ProfilePoint>, FitError> {
    if index >= free.len() {
        return Err(FitError::Parameter(format!("no parameter {index} among {}", free.len())));
    }
    let mut values: Vec<f64> = grid.iter().copied().filter(|v| v.is_finite()).collect();
    values.sort_by(f64::total_cmp);
    let split = values.partition_point(|&v| v < optimum.theta[index]);
    let mut points = Vec::new();
    let down: Vec<f64> = values[..split].iter().rev().copied().collect();
    for side in [down, values[split..].to_vec()] {
        let mut theta = optimum.theta.clone();
        for value in side {
            let point = one(problem, data, free, &theta, index, value, options)?;
            if point.f.is_some() {
                theta.clone_from(&point.theta);
            }
            points.push(point);
        }
    }
    points.sort_by(|a, b| a.value.total_cmp(&b.value));
    Ok(points)
}

fn one(
    problem: &dyn Problem,
    data: &Data,
    free: &[Free],
    from: &[f64],
    index: usize,
    value: f64,
    options: &FitOptions,
) -> Result<ProfilePoint, FitError> {
    let mut held = vec![None; free.len()];
    held[index] = Some(value);
    let fixed = Fixed::new(problem, held);
    let rest: Vec<Free> =
        (0..free.len()).filter(|&k| k != index).map(|k| Free { start: from[k], ..free[k].clone() }).collect();
    match fit(&fixed, data, &rest, options, &mut |_| ControlFlow::Continue(())) {
        Ok(end) => {
            let prior = free[index].prior.map_or(0.0, |p| {
                let weight =
                    if options.objective == crate::Objective::PaperSum { data.mean_sd() } else { 1.0 };
                (weight * (free[index].forward(value) - p.mean) / p.sd).powi(2)
            });
            Ok(ProfilePoint { value, f: Some(end.f + prior), theta: fixed.whole(&end.theta) })
        }
        Err(FitError::Start(_)) => Ok(ProfilePoint { value, f: None, theta: from.to_vec() }),
        Err(e) => Err(e),
    }
}

/// Where the profile crosses `f_best + rise` on either side of the optimum (rise 3.84 for 95 % on χ²), by
/// interpolation of √(f − f_best); `None` on a side where it does not rise that far.
pub fn profile_interval(points: &[ProfilePoint], value: f64, f_best: f64, rise: f64) -> [Option<f64>; 2] {
    let height = |p: &ProfilePoint| p.f.map(|f| (f - f_best).max(0.0).sqrt());
    let crossing = |side: Vec<&ProfilePoint>| {
        let (mut x0, mut h0) = (value, 0.0);
        for p in side {
            let Some(h) = height(p) else { continue };
            if h >= rise.sqrt() {
                return Some(x0 + (p.value - x0) * (rise.sqrt() - h0) / (h - h0).max(1e-300));
            }
            (x0, h0) = (p.value, h);
        }
        None
    };
    let below = points.iter().rev().filter(|p| p.value < value).collect();
    let above = points.iter().filter(|p| p.value > value).collect();
    [crossing(below), crossing(above)]
}
