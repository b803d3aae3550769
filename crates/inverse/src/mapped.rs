//! Fits of an expensive model that search on a cheap one (manifold mapping).
//!
//! Around an anchor θ₀ the expensive model f is replaced by the cheap model c with both its value and its jacobian put
//! right: f̂(z) = c(z) + [f(z₀) − c(z₀)] + [f′(z₀) − c′(z₀)](z − z₀), z the transformed coordinates. A fit of f̂ inside a
//! trust region gives the next anchor; where rounds settle, the gradient of f vanishes, not that of c. Value alone put
//! right would settle elsewhere. Echeverría & Hemker 2005, doi:10.2478/cmam-2005-0006; first-order consistent models
//! inside a trust region: Alexandrov, Lewis, Gumbert, Green & Newman 2001, doi:10.2514/2.2877.

use crate::fit::{fit, objective};
use crate::gain::Gain;
use crate::map::Mapped;
use crate::{Data, Fit, FitError, FitOptions, Free, Iterate, PredictError, Prediction, Problem, StopReason};
use std::ops::ControlFlow;

/// How a mapped fit goes.
#[derive(Clone, Debug, PartialEq)]
pub struct MappedOptions {
    /// Settings of the whole: objective, tolerance, largest number of rounds (`max_iterations`).
    pub outer: FitOptions,
    /// Settings of the fits of f̂.
    pub inner: FitOptions,
    /// A predicted fall of χ² that is not worth a run of the expensive model; times the reduced χ² where that is above 1,
    /// since less than that is less than what the model leaves would explain.
    pub settled: f64,
    /// Runs of the cheap model that take as long as one of the expensive.
    pub ratio: f64,
    /// The trust region to begin with, in natural scales; infinite where nothing is known of where the map holds.
    pub radius: f64,
}

/// Rejections in a row that end the fit.
const REJECTED: usize = 6;
/// Radius after a step that the expensive model rejects, or cannot be computed at, as a share of that step.
const SHRINK: f64 = 0.4;
/// Share of a predicted fall from which on the radius grows, and below which it shrinks.
const GOOD: f64 = 0.75;
const POOR: f64 = 0.25;

/// Who hears of runs, and may end the fit.
type Observer<'a> = &'a mut dyn FnMut(&Iterate) -> ControlFlow<()>;

/// An accepted place.
struct Place {
    theta: Vec<f64>,
    f: f64,
    prediction: Prediction,
}

/// A mapped fit in progress.
struct Rounds<'a> {
    expensive: &'a dyn Problem,
    data: &'a Data,
    free: &'a [Free],
    options: &'a MappedOptions,
    at: Place,
    /// Of the trust region, in natural scales.
    radius: f64,
    rejected: usize,
    rounds: usize,
    runs: usize,
    history: Vec<Iterate>,
}

/// Fits `expensive` from the start values of `free`; one run of it (with its jacobian) a round. `observer` hears of these
/// runs, `watch` of those of the fits in between; either may end the fit. Where the cheap model cannot be computed at an
/// anchor, or the map leads nowhere from one that is far from the data (`FitOptions::poll` of the whole says how far), the
/// expensive one searches alone from there.
///
/// # Errors
/// [`FitError`] as [`fit`]'s.
pub fn fit_mapped(
    expensive: &dyn Problem,
    cheap: &dyn Problem,
    data: &Data,
    free: &[Free],
    options: &MappedOptions,
    observer: Observer,
    watch: Observer,
) -> Result<Fit, FitError> {
    let begin = FitOptions { max_iterations: 0, ..options.outer.clone() };
    let first = fit(expensive, data, free, &begin, observer)?;
    if free.is_empty() || first.stop == StopReason::Stopped {
        return Ok(first);
    }
    let at = Place { theta: first.theta, f: first.f, prediction: first.prediction };
    let (radius, history) = (options.radius, first.history);
    let mut fit =
        Rounds { expensive, data, free, options, at, radius, rejected: 0, rounds: 0, runs: 1, history };
    while fit.rounds < options.outer.max_iterations {
        let map = match Mapped::at(cheap, free, &fit.at.theta, &fit.at.prediction) {
            Ok(map) => map,
            Err(PredictError::Interrupted) => return Ok(fit.end(StopReason::Stopped)),
            Err(PredictError::NotComputable(_)) => return fit.alone(observer),
        };
        match fit.round(&map, observer, watch) {
            // The map may jump where the expensive model does not.
            Some(StopReason::NoDescent) if fit.is_far() => return fit.alone(observer),
            Some(stop) => return Ok(fit.end(stop)),
            None => {}
        }
    }
    Ok(fit.end(StopReason::MaxIterations))
}

impl Rounds<'_> {
    /// Fits of the map, in smaller and smaller trust regions, until the expensive model agrees that one of them is better;
    /// a reason to stop, if there is one.
    fn round(&mut self, map: &Mapped, observer: Observer, watch: Observer) -> Option<StopReason> {
        let (data, free, outer) = (self.data, self.free, &self.options.outer);
        let worth =
            (self.options.settled * outer.worth(data, self.at.f)).max(1e-3 * outer.tolerance * self.at.f);
        loop {
            let region = within(free, &self.at.theta, self.radius);
            let (mut gain, mut enough) = (Gain::from(self.at.f, self.options.ratio), false);
            let mut until = |i: &Iterate| {
                enough = gain.is_enough(i, worth);
                if enough { ControlFlow::Break(()) } else { watch(i) }
            };
            let inner = fit(map, data, &region, &self.options.inner, &mut until);
            let inner = match inner {
                Ok(inner) if enough || inner.stop != StopReason::Stopped => inner,
                Ok(_) | Err(FitError::Start(PredictError::Interrupted)) => return Some(StopReason::Stopped),
                Err(_) => return Some(StopReason::NoDescent),
            };
            let predicted = self.at.f - inner.f;
            if predicted <= worth {
                let settled = self.rejected == 0 && inner.stop != StopReason::NoDescent;
                return Some(if settled { StopReason::Converged } else { StopReason::NoDescent });
            }
            self.runs += 1;
            let there = match self.expensive.predict(&inner.theta, true) {
                Ok(p) => Some((objective(data, free, &inner.theta, &p, outer.objective), p)),
                Err(PredictError::NotComputable(_)) => None,
                Err(PredictError::Interrupted) => return Some(StopReason::Stopped),
            };
            let f = there.as_ref().map(|t| t.0);
            let accepted = f.is_some_and(|f| f < self.at.f);
            let told = self.tell(&inner.theta, f, accepted, observer);
            self.learn(&inner.theta, f.map(|f| (self.at.f - f) / predicted));
            if let (true, Some((f, prediction))) = (accepted, there) {
                (self.rounds, self.rejected) = (self.rounds + 1, 0);
                self.at = Place { theta: inner.theta, f, prediction };
            } else {
                self.rejected += 1;
            }
            if told.is_break() {
                return Some(StopReason::Stopped);
            }
            if accepted {
                return None;
            }
            if self.rejected == REJECTED {
                return Some(StopReason::NoDescent);
            }
        }
    }

    /// The trust region after a trial: `kept` is the share of the predicted fall that came; none without an answer.
    fn learn(&mut self, trial: &[f64], kept: Option<f64>) {
        let far = distance(self.free, &self.at.theta, trial);
        match kept {
            Some(kept) if kept > GOOD => self.radius = self.radius.max(2.0 * far),
            Some(kept) if kept >= POOR => {}
            _ => self.radius = SHRINK * far,
        }
    }

    fn tell(&mut self, theta: &[f64], f: Option<f64>, accepted: bool, observer: Observer) -> ControlFlow<()> {
        let damping = if self.radius.is_finite() { 1.0 / self.radius } else { 0.0 };
        let iterate = Iterate { iteration: self.rounds + 1, f, theta: theta.to_vec(), accepted, damping };
        let flow = observer(&iterate);
        self.history.push(iterate);
        flow
    }

    /// Whether so much is left that it may be the map that hinders, not what the model can do.
    fn is_far(&self) -> bool {
        let outer = &self.options.outer;
        outer.poll.as_ref().is_some_and(|p| p.is_far(self.at.f, self.data, outer))
    }

    /// The rest of the fit without a cheap model.
    fn alone(self, observer: Observer) -> Result<Fit, FitError> {
        let start = |(f, &start): (&Free, &f64)| Free { start, ..f.clone() };
        let from: Vec<Free> = self.free.iter().zip(&self.at.theta).map(start).collect();
        let outer = &self.options.outer;
        let left = outer.max_iterations.saturating_sub(self.rounds);
        let options = FitOptions { max_iterations: left, ..outer.clone() };
        let last = fit(self.expensive, self.data, &from, &options, observer)?;
        let history = self.history.into_iter().chain(last.history).collect();
        let (iterations, forward_runs) = (self.rounds + last.iterations, self.runs + last.forward_runs);
        Ok(Fit { iterations, forward_runs, history, ..last })
    }

    fn end(self, stop: StopReason) -> Fit {
        Fit {
            at_bound: self.free.iter().zip(&self.at.theta).map(|(f, &x)| f.at_bound(x)).collect(),
            theta: self.at.theta,
            f: self.at.f,
            prediction: self.at.prediction,
            objective: self.options.outer.objective,
            iterations: self.rounds,
            forward_runs: self.runs,
            stop,
            history: self.history,
        }
    }
}

/// The free parameters confined to `radius` natural scales around θ.
fn within(free: &[Free], theta: &[f64], radius: f64) -> Vec<Free> {
    let one = |(f, &x): (&Free, &f64)| {
        let mut f = Free { start: x, ..f.clone() };
        if radius.is_finite() {
            let (z, far) = (f.forward(x), radius * f.natural_scale(x));
            let (low, high) = (f.backward(z - far), f.backward(z + far));
            if low < high {
                (f.lower, f.upper) = (low, high);
            }
        }
        f
    };
    free.iter().zip(theta).map(one).collect()
}

/// The largest change of a transformed coordinate, in natural scales.
fn distance(free: &[Free], from: &[f64], to: &[f64]) -> f64 {
    let one = |((f, &a), &b): ((&Free, &f64), &f64)| (f.forward(b) - f.forward(a)).abs() / f.natural_scale(a);
    free.iter().zip(from).zip(to).map(one).fold(0.0, f64::max)
}
