//! What must still be fitted: supersets judged from the columns of fitted models.

use crate::linear::{Linear, Parameter};
use crate::model::{Evidence, Kernel, View};
use crate::posterior::{Judged, Posterior, SetPrior};
use crate::record::{EvidenceError, Record};
use crate::rest::RestPrior;
use crate::special::ln_sum_exp;
use nalgebra::DMatrix;

/// Effects that may be added to a fitted model: their parameters and columns, once for every shape of a grid.
#[derive(Clone, Debug)]
pub struct Extension {
    /// Effects of the larger model.
    pub effects: Vec<String>,
    /// One entry per shape, of equal prior mass: parameters and raw columns (n × k) at the fitted model.
    pub shapes: Vec<(Vec<Parameter>, DMatrix<f64>)>,
}

/// A model whose optimistic evidence is this far below the best (nats) is not fitted to its end.
pub const HOPELESS: f64 = 12.0;

/// Posterior mass of what was not fitted at which a search ends.
pub const LEFT: f64 = 0.01;

/// Whether a fit in progress can be dropped: even with the fall of its last step (in ln Z) doubled, it is [`HOPELESS`] below
/// the best.
pub fn hopeless(ln_joint: f64, last_fall: f64, best: f64) -> bool {
    ln_joint + last_fall.max(0.0) < best - HOPELESS
}

/// Judges a superset from the parent's misfit and jacobian. Every shape is asked with noise alone and with the parent's
/// most probable rest; the best one gets the integral over the rest, and the others their share of it.
///
/// # Errors
/// [`EvidenceError`] when columns do not fit.
pub fn extend(
    record: &Record,
    parent: &Linear,
    extension: &Extension,
    (rest, prior): (&RestPrior, &SetPrior),
    kernel: Kernel,
) -> Result<Option<Judged>, EvidenceError> {
    let mut asked = Vec::new();
    for (parameters, columns) in &extension.shapes {
        let linear = parent.with(parameters, columns)?;
        asked.push((Evidence::quick(record, &linear, (rest, prior), kernel)?, linear));
    }
    let best = asked.iter().enumerate().max_by(|a, b| a.1.0.total_cmp(&b.1.0));
    let Some((_, (most, linear))) = best else { return Ok(None) };
    let evidence = Evidence::of(record, linear, rest, kernel)?;
    let mean = ln_sum_exp(asked.iter().map(|a| a.0).collect::<Vec<_>>()) - (asked.len() as f64).ln();
    let gain = mean - Evidence::quick(record, parent, (rest, prior), kernel)?;
    let mut judged = Judged::new(&extension.effects, &evidence, rest, 1.0, prior).predicted(mean - most);
    judged.gain = gain;
    Ok(Some(judged))
}

impl Evidence {
    /// The evidence on a handful of sizes of the rest, whatever causes it, in place of the integral: what hardly weighs beside others
    /// needs no more.
    ///
    /// # Errors
    /// As [`Evidence::of`].
    pub fn few(
        record: &Record,
        linear: &Linear,
        rest: &RestPrior,
        kernel: Kernel,
    ) -> Result<Self, EvidenceError> {
        Self::on(record, linear, rest, kernel, &[0.3, 1.0, rest.else_median])
    }

    /// ln Z on a handful of sizes of the rest, whatever causes it: enough to tell shapes of one effect apart, and which of some models
    /// lead. The largest size is one that a cause outside the catalogue has: where all models leave as much, smaller ones would
    /// count what a further column takes from it as if it were noise.
    pub fn quick(
        record: &Record,
        linear: &Linear,
        (rest, prior): (&RestPrior, &SetPrior),
        kernel: Kernel,
    ) -> Result<f64, EvidenceError> {
        let few = Self::few(record, linear, rest, kernel)?;
        let [own, other] = few.under(&View { rest, amplitude: 1.0 });
        Ok(ln_sum_exp([own + (1.0 - prior.beyond).ln(), other + prior.unlike().ln()]))
    }
}

/// The sets that were judged but not fitted and matter, most probable first, until what is left holds less than [`LEFT`].
/// Sets whose last effect the records speak against are not among them: an effect that they do not want stays near its
/// neutral value, where its columns say all. Empty: the search is at its end.
pub fn to_fit(posterior: &Posterior, models: &[Judged]) -> Vec<Vec<String>> {
    let fitted = |effects: &[String]| {
        models.iter().any(|m| {
            let mut own = m.effects.clone();
            own.sort();
            m.fitted && own == effects
        })
    };
    let wanted = |effects: &[String]| models.iter().any(|m| m.effects == effects && m.gain > 0.0);
    let mut open: Vec<(f64, &Vec<String>)> = posterior
        .by_evidence
        .iter()
        .filter(|s| !fitted(&s.effects) && wanted(&s.effects))
        .map(|s| (s.probability + s.with_something_else, &s.effects))
        .collect();
    open.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(b.1)));
    let mut left: f64 = open.iter().map(|o| o.0).sum();
    let mut out = Vec::new();
    for (p, effects) in open {
        if left < LEFT {
            break;
        }
        left -= p;
        out.push(effects.clone());
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_matters_is_fitted_until_one_percent_is_left() {
        let names = |s: &str| s.split_whitespace().map(str::to_owned).collect::<Vec<_>>();
        let prior = SetPrior { expected: 0.5, catalogue: 1, beyond: 1e-12, factor: 2.0 };
        let judged = |s: &str, p: f64| Judged::from_numbers(&names(s), p.ln(), -700.0);
        let open = |s: &str, p: f64, gain: f64| {
            let mut out = judged(s, p).predicted(0.0);
            out.gain = gain;
            out
        };
        let models = [
            judged("", 0.5),
            judged("a", 0.3),
            open("b", 0.10, 1.0),
            open("c", 0.045, 0.1),
            open("d", 0.005, 2.0),
            open("n", 0.05, -0.2),
        ];
        let posterior = Posterior::of(&models, &prior);
        assert_eq!(to_fit(&posterior, &models), [names("b"), names("c")]);
        assert!((posterior.unfitted - 0.2).abs() < 1e-6, "{}", posterior.unfitted);
        assert!(hopeless(-30.0, 5.0, -12.0) && !hopeless(-30.0, 7.0, -12.0));
    }
}
