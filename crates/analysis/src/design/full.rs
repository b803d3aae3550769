//! What a protocol shows by the full model, where a linear look would promise what a real record does not keep.
//!
//! Per effect: the record without noise, the effect in it at some size; the base fitted to it, as before any screen; and
//! there the screen's own rules on many draws of the noise ([`diagnose::chances`]). What the base parameters
//! imitate along their way, shapes in a maximum and the shared false-discovery rate are then what they are. A search
//! over the size finds where given powers stand.

use super::engine::{Linear, SHORT, linear, measure, model_of, options};
use super::table::Table;
use crate::columns::{case_with, config_of, transfer};
use crate::identify::AnalysisError;
use crate::problem::FeProblem;
use diagnose::tails::normal_isf;
use diagnose::{Chance, Foreseen, chances};
use input::Leg;
use inverse::{Fit, FitOptions, Iterate, Objective, Problem as _};
use model::{Discretisation, Model};
use nalgebra::DVector;
use serde::Serialize;
use std::ops::ControlFlow;
use std::sync::Arc;

/// Records that are drawn for a chance.
const DRAWS: usize = 1000;
/// Sizes that are tried, the plausible one among them.
const TRIALS: usize = 14;
/// Standard deviations, by the linear look, of an effect that is worth asking about.
const FAINT: f64 = 1.0;
/// Powers whose sizes are looked for.
pub(super) const POWERS: [f64; 3] = [0.5, 0.8, 0.9];
/// A power that differs by less (in normal quantiles: 2 to 3 points) is the one that is looked for.
const HIT: f64 = 0.07;
/// Sizes that are nearer to each other than this share are one: a power that leaps between them stands nowhere.
const NARROW: f64 = 5e-3;
/// Largest factor from one trial to the next.
const STRIDE: f64 = 2.5;
/// Shares of the plausible size beyond which no size is looked for.
const SHARES: std::ops::RangeInclusive<f64> = 1e-4..=8.0;

/// An effect that was asked of the full model.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Confirmed {
    /// Name in the catalogue.
    pub effect: String,
    /// Name of its amplitude.
    pub amplitude: String,
    /// A plausible size of it, as a deviation from neutral.
    pub plausible: f64,
    /// Shape parameters that it has.
    pub shape: Vec<(String, f64)>,
    /// Chance that the screen calls it significant at the plausible size.
    pub power: f64,
    /// The least tried size that is seen with 50, 80 and 90 % power; none where none was found.
    pub seen_at: [Option<f64>; 3],
    /// Sizes that were tried and their powers, the least first.
    pub tried: Vec<(f64, f64)>,
    /// Sizes and the base's values fitted there.
    #[serde(skip)]
    pub(super) fitted: Vec<(f64, Vec<f64>)>,
    /// Why sizes are missing.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub not: Option<String>,
}

/// The least tried size that has a power. Not between two of them: where the base has more than one optimum, the power does
/// not go evenly from one to the other.
pub(super) fn seen_at(tried: &[(f64, f64)], power: f64) -> Option<f64> {
    tried.iter().find(|t| hits(t.1, power)).map(|t| t.0)
}

/// Whether a power is one that is looked for, as far as the draws tell.
fn hits(found: f64, power: f64) -> bool {
    (quantile(found) - quantile(power)).abs() < HIT
}

/// Normal quantile of a share of the draws, not beyond what they can tell.
fn quantile(share: f64) -> f64 {
    let least = 0.5 / DRAWS as f64;
    -normal_isf(share.clamp(least, 1.0 - least))
}

/// A protocol, ready to be asked.
pub(super) struct Full<'a> {
    table: Table<'a>,
    base: Model,
    how: Discretisation,
    linear: Linear,
}

impl<'a> Full<'a> {
    /// Load cell alone.
    pub fn new(table: &Table<'a>, legs: &[Vec<Leg>], noise: &[f64]) -> Result<Self, AnalysisError> {
        let table = Table { steps: SHORT, ..table.clone() };
        let (linear, planned) = table.look(table.planned(legs, noise, false), table.catalogue)?;
        let (base, how) = model_of(&planned, table.catalogue)?;
        Ok(Self { table, base, how, linear })
    }

    /// What the linear look says of the effects.
    pub fn foreseen(&self) -> Result<Vec<Foreseen>, AnalysisError> {
        Ok(self.linear.foresight(self.table.catalogue, &self.table.policy, false)?.effects)
    }

    /// The power at the plausible size, and the sizes of some powers.
    pub fn confirmed(&self, f: &Foreseen) -> Result<Confirmed, AnalysisError> {
        let mut search = PromisedSize { full: self, f, tried: Vec::new(), fitted: Vec::new() };
        let mut not = None;
        let mut share = Some(1.0);
        for _ in 0..TRIALS {
            let Some(next) = share else { break };
            match search.try_at(next) {
                Ok(()) => share = POWERS.iter().find_map(|p| search.next(*p)),
                Err(e) if self.table.cancelled.stops() => return Err(e),
                Err(e) => {
                    not = Some(e.to_string());
                    break;
                }
            }
        }
        let power = search.tried.iter().find(|t| t.0 == 1.0).map_or(0.0, |t| t.1);
        let tried: Vec<(f64, f64)> = search.tried.iter().map(|(s, p)| (s * f.plausible, *p)).collect();
        Ok(Confirmed {
            effect: f.effect.clone(),
            amplitude: f.amplitude.clone(),
            plausible: f.plausible,
            shape: f.shape.clone(),
            power,
            seen_at: POWERS.map(|p| seen_at(&tried, p)),
            tried,
            fitted: search.fitted,
            not,
        })
    }

    /// What the records would read with the effect at a size, in full.
    pub fn truth(&self, f: &Foreseen, size: f64) -> Result<DVector<f64>, AnalysisError> {
        let missing = || AnalysisError::Case(format!("`{}` is not in the catalogue", f.effect));
        let effect = self.table.catalogue.get(&f.effect).ok_or_else(missing)?;
        let specs = effect.parameters(&model::Options::new());
        let of_shape = |key: &str| f.shape.iter().find(|s| s.0 == key).map(|s| s.1);
        let mut values: Vec<f64> = specs.iter().map(|s| of_shape(&s.key()).unwrap_or(s.start)).collect();
        if let (Some(value), Some(spec)) = (values.first_mut(), specs.first()) {
            *value = spec.neutral.unwrap_or(0.0) + size;
            if *value < spec.lower || *value > spec.upper {
                let text = format!("{} = {value:.3e} is outside what `{}` admits", spec.name, f.effect);
                return Err(AnalysisError::Case(text));
            }
        }
        let case = case_with(&self.base.case, &[config_of(effect, &values)]);
        let model = Model::new(Arc::new(case), self.table.catalogue, self.how)?;
        let mut theta = transfer(&self.base, self.linear.all(), &model);
        for (s, v) in specs.iter().zip(&values) {
            if let Some(at) = model.find(&format!("effects.{}.{}", f.effect, s.name)) {
                theta[at] = *v;
            }
        }
        let slots = &self.linear.measured.slots;
        let options = options(&model.case, SHORT);
        let problem = FeProblem::new(&model, theta, Vec::new(), slots, options, self.table.cancelled);
        Ok(problem.predict(&[], false)?.values)
    }

    /// The base fitted to a record, the best from several starts, and what a screen computes there.
    pub fn refitted(&self, truth: &DVector<f64>, starts: &[Vec<f64>]) -> Result<Linear, AnalysisError> {
        let mut measured = self.linear.measured.clone();
        measure(&mut measured, truth);
        let (base, all) = (&self.base, self.linear.all().to_vec());
        let slots = &self.linear.measured.slots;
        let options = options(&base.case, SHORT);
        let problem = FeProblem::new(base, all, base.free(), slots, options, self.table.cancelled);
        let how_far = FitOptions { objective: Objective::Record, ..Default::default() };
        let mut best: Option<Fit> = None;
        for start in starts {
            let mut free_parameters = self.linear.base().0.to_vec();
            free_parameters.iter_mut().zip(start).for_each(|(f, s)| f.start = *s);
            let mut watch = |_: &Iterate| ControlFlow::Continue(());
            let fit = inverse::fit(&problem, &measured.data, &free_parameters, &how_far, &mut watch)?;
            if best.as_ref().is_none_or(|b| fit.f < b.f) {
                best = Some(fit);
            }
        }
        let theta = best.map_or_else(|| self.linear.all().to_vec(), |b| problem.full(&b.theta));
        linear(base, (self.how, SHORT), &theta, measured, self.table.catalogue, self.table.cancelled)
    }

    /// Starts of a fit to a record with the effect at a size: the base without it, and the base fitted to the nearest size
    /// that was tried. Where the base goes far to imitate an effect, it has more than one optimum.
    pub fn starts(&self, tried: &[(f64, Vec<f64>)], size: f64) -> Vec<Vec<f64>> {
        let distance = |t: &&(f64, Vec<f64>)| (t.0 - size).abs();
        let near = tried.iter().min_by(|a, b| distance(a).total_cmp(&distance(b)));
        [self.linear.base().1.to_vec()].into_iter().chain(near.map(|n| n.1.clone())).collect()
    }

    /// What the records would read without an effect, and the base's values.
    #[cfg(test)]
    pub fn without(&self) -> (DVector<f64>, Vec<f64>) {
        (self.linear.prediction.values.clone(), self.linear.base().1.to_vec())
    }

    /// Noise of a record.
    #[cfg(test)]
    pub fn noise(&self, random: &mut inverse::Random) -> DVector<f64> {
        self.linear.measured.data.simulate_noise(random)
    }

    fn chance(&self, linear: &Linear, effect: &str) -> Result<f64, AnalysisError> {
        let found =
            chances(&linear.misfit(), &linear.at_bound(), &linear.candidates, DRAWS, &self.table.policy)
                .map_err(|e| AnalysisError::Case(e.to_string()))?;
        Ok(found.iter().find(|c: &&Chance| c.effect == effect).map_or(0.0, |c| c.called))
    }
}

/// A search over the size of an effect, as a share of the plausible one.
struct PromisedSize<'a> {
    full: &'a Full<'a>,
    f: &'a Foreseen,
    /// Shares and powers, the smallest share first.
    tried: Vec<(f64, f64)>,
    fitted: Vec<(f64, Vec<f64>)>,
}

impl PromisedSize<'_> {
    fn try_at(&mut self, share: f64) -> Result<(), AnalysisError> {
        let size = share * self.f.plausible;
        let truth = self.full.truth(self.f, size)?;
        let linear = self.full.refitted(&truth, &self.full.starts(&self.fitted, size))?;
        let power = self.full.chance(&linear, &self.f.effect)?;
        self.fitted.push((size, linear.base().1.to_vec()));
        let at = self.tried.partition_point(|t| t.0 < share);
        self.tried.insert(at, (share, power));
        Ok(())
    }

    /// The share to try next for a power; `None` where one that was tried has it, or none has.
    fn next(&self, power: f64) -> Option<f64> {
        let z = quantile(power);
        let all: Vec<(f64, f64)> = self.tried.iter().map(|t| (t.0, quantile(t.1))).collect();
        if seen_at(&self.tried, power).is_some() {
            return None;
        }
        let told = |q: f64| quantile(0.0) < q && q < quantile(1.0);
        if let Some(pair) = all.windows(2).find(|w| w[0].1 < z && z <= w[1].1) {
            let [(a, p), (b, q)] = [pair[0], pair[1]];
            // Halved where the line would stay at an end: the power may leap.
            let on_line = (z - p) / (q - p);
            let even = told(p) && told(q) && (0.1..0.9).contains(&on_line);
            let inside = a + (b - a) * if even { on_line } else { 0.5 };
            return ((b - a) > NARROW * b).then_some(inside);
        }
        let (first, last) = (all.first()?, all.last()?);
        let from = if first.1 >= z { first } else { last };
        // How much the quantile grows with the size: as between the two nearest that the draws tell, else by the linear law.
        let known: Vec<&(f64, f64)> = all.iter().filter(|t| told(t.1)).collect();
        let secant = match (known.as_slice(), first.1 >= z) {
            ([a, b, ..], true) | ([.., a, b], false) => (b.1 - a.1) / (b.0 - a.0),
            _ => self.f.snr,
        };
        let rising = if secant > 0.0 { secant } else { self.f.snr };
        let stride = from.0 * STRIDE.powf((z - from.1).signum());
        let onward =
            if told(from.1) { from.0 + (z - from.1) / rising } else { self.f.least? / self.f.plausible };
        let right = (onward - from.0) * (z - from.1) > 0.0;
        // The linear law may stand anywhere; a step from a known size goes no farther than a stride.
        let share = match (right, told(from.1)) {
            (false, _) => stride,
            (true, true) => onward.clamp(from.0 / STRIDE, from.0 * STRIDE),
            (true, false) => onward,
        };
        SHARES.contains(&share).then_some(share)
    }
}

/// Whether a linear look leaves something to ask: an effect whose plausible size hardly rises above the noise does not
/// show by what is not linear in it.
pub(super) fn worth_asking(f: &Foreseen) -> bool {
    f.snr >= FAINT
}
