//! Many starts, because one search finds one optimum (the paper's fourth limitation).

use crate::halton::halton;
use crate::{Data, Fit, FitError, FitOptions, Free, Iterate, PredictError, Problem, fit};
use rayon::prelude::*;
use std::ops::ControlFlow;

/// Where the further starts lie, in transformed coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Spread {
    /// Anywhere within the bounds (infinite bounds: as `Around(2.0)`).
    Bounds,
    /// Within this many natural scales of the given start, and within the bounds.
    Around(f64),
}

/// How many starts, and where.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MultiStart {
    /// Number of starts; the first is the given one.
    pub starts: usize,
    /// Where the others lie.
    pub spread: Spread,
    /// Two ends agree when f differs by less than this share of the best f (or by 0.1 in χ²).
    pub same: f64,
    /// Run the starts on several threads. The answer is the same; the observer then sees whole runs,
    /// in the order of the starts, after they end.
    pub parallel: bool,
}

impl Default for MultiStart {
    fn default() -> Self {
        Self { starts: 8, spread: Spread::Around(1.5), same: 1e-3, parallel: false }
    }
}

/// The ends of all starts.
#[derive(Debug)]
pub struct Starts {
    /// Best end.
    pub best: Fit,
    /// Index of its start.
    pub best_start: usize,
    /// Each start's values (physical units) and end, in order; `Err` where the model cannot be computed there.
    pub ends: Vec<(Vec<f64>, Result<Fit, FitError>)>,
    /// How many ends have the best objective.
    pub agreeing: usize,
    /// How many starts ended at all.
    pub ended: usize,
}

impl Starts {
    /// The agreement as a sentence.
    pub fn sentence(&self) -> String {
        let Self { agreeing, ended, ends, .. } = self;
        let failed = ends.len() - ended;
        let tail = if failed > 0 { format!(" {failed} could not start.") } else { String::new() };
        if agreeing == ended {
            format!("All {ended} starts end at the same optimum.{tail}")
        } else {
            format!("{agreeing} of {ended} starts end at the best optimum, the others at worse ones.{tail}")
        }
    }
}

/// The start values, first the given ones.
pub fn starts(free: &[Free], how: &MultiStart) -> Vec<Vec<f64>> {
    let given: Vec<f64> = free.iter().map(|f| f.start).collect();
    let further = (1..how.starts.max(1)).map(|i| {
        let u = halton(i - 1, free.len());
        free.iter().zip(u).map(|(f, u)| place(f, u, how.spread)).collect()
    });
    std::iter::once(given).chain(further).collect()
}

fn place(f: &Free, u: f64, spread: Spread) -> f64 {
    let (lo, hi) = f.bounds_z();
    let around = |radius: f64| {
        let z = f.forward(f.start);
        let d = radius * f.natural_scale(f.start);
        ((z - d).max(lo), (z + d).min(hi))
    };
    let (a, b) = match spread {
        Spread::Bounds if (hi - lo).is_finite() => (lo, hi),
        Spread::Bounds => around(2.0),
        Spread::Around(radius) => around(radius),
    };
    f.backward(a + u * (b - a))
}

/// Fits from every start and compares the ends.
///
/// # Errors
/// The first start's error when none could be fitted.
pub fn multi_start(
    problem: &dyn Problem,
    data: &Data,
    free: &[Free],
    options: &FitOptions,
    how: &MultiStart,
    observer: &mut dyn FnMut(usize, &Iterate) -> ControlFlow<()>,
) -> Result<Starts, FitError> {
    let points = starts(free, how);
    let from = |theta: &Vec<f64>| -> Vec<Free> {
        free.iter().zip(theta).map(|(f, &x)| Free { start: x, ..f.clone() }).collect()
    };
    let mut ends: Vec<(Vec<f64>, Result<Fit, FitError>)> = Vec::new();
    if how.parallel {
        let runs: Vec<_> = points
            .par_iter()
            .map(|theta| fit(problem, data, &from(theta), options, &mut |_| ControlFlow::Continue(())))
            .collect();
        for (i, (theta, run)) in points.into_iter().zip(runs).enumerate() {
            let stop = run.iter().flat_map(|r| &r.history).any(|it| observer(i, it).is_break());
            ends.push((theta, run));
            if stop {
                break;
            }
        }
    } else {
        for (i, theta) in points.into_iter().enumerate() {
            let mut stop = false;
            let run = fit(problem, data, &from(&theta), options, &mut |it| {
                let flow = observer(i, it);
                stop |= flow.is_break();
                flow
            });
            stop |= matches!(run, Err(FitError::Start(PredictError::Interrupted)));
            ends.push((theta, run));
            if stop {
                break;
            }
        }
    }
    compare(ends, how.same)
}

fn compare(ends: Vec<(Vec<f64>, Result<Fit, FitError>)>, same: f64) -> Result<Starts, FitError> {
    let fits = || ends.iter().enumerate().filter_map(|(i, (_, r))| r.as_ref().ok().map(|f| (i, f)));
    let Some((best_start, best)) = fits().min_by(|a, b| a.1.f.total_cmp(&b.1.f).then(a.0.cmp(&b.0))) else {
        let first = ends.into_iter().find_map(|(_, r)| r.err());
        return Err(first.unwrap_or_else(|| FitError::Parameter("no start was given".into())));
    };
    let slack = match best.objective {
        crate::Objective::Whitened | crate::Objective::Record => (same * best.f).max(0.1),
        crate::Objective::PaperSum => same * best.f,
    };
    let agreeing = fits().filter(|(_, f)| f.f <= best.f + slack).count();
    let ended = fits().count();
    let best = best.clone();
    Ok(Starts { best, best_start, ends, agreeing, ended })
}
