//! How probable is each set of effects that was fitted, and how much is left: the rungs of a search put to `evidence`.

use crate::columns::scales;
use crate::data::Measured;
use crate::ladder::{FeLadder, Fitted};
use evidence::{
    Belief, Evidence, EvidenceError, ExplainedTo, Judged, Kernel, Linear, Place, Posterior, Record, Remains,
    RestPrior, SetPrior,
};
use inverse::Free;
use model::{Catalogue, Scales, Screening, Sided};
use params::ParamSpec;
use rayon::prelude::*;
use serde::Serialize;

/// Largest share of the peak that a complete model leaves in practice.
const PRACTICE: f64 = 0.02;

/// Spread of a shape's belief in its natural coordinate: a factor of 4.5 either way in a logarithm.
const SHAPE_SPREAD: f64 = 1.5;

/// What the fitted rungs say together.
#[derive(Clone, Debug, Serialize)]
pub struct Probable {
    /// Probabilities of the sets that were fitted, of their effects, of nothing, and of something else.
    pub posterior: Posterior,
    /// What the leading set leaves unexplained.
    pub rest: Remains,
    /// To what the record is explained by it.
    pub explained_to: ExplainedTo,
    /// For each set: ln Z, how far its mode is from its fit, and sizes of the rest that were looked at.
    pub models: Vec<Weighed>,
}

/// One rung's evidence.
#[derive(Clone, Debug, Serialize)]
pub struct Weighed {
    /// Effects.
    pub effects: Vec<String>,
    /// ln Z with a complete model's rest.
    pub ln_z: f64,
    /// ln Z with a cause outside the catalogue.
    pub ln_z_else: f64,
    /// Standard deviations from the fit to the mode; above 1 the linearisation at the fit is void.
    pub moved: f64,
}

impl Probable {
    /// The leading answers and what is left, as one line.
    pub fn sentence(&self) -> String {
        let percent = |p: f64| format!("{:.0} %", 100.0 * p);
        let mut effects: Vec<(&String, &f64)> = self.posterior.effects.iter().collect();
        effects.sort_by(|a, b| b.1.total_cmp(a.1).then(a.0.cmp(b.0)));
        let mut parts: Vec<String> =
            effects.iter().take(3).map(|(name, p)| format!("{name} {}", percent(**p))).collect();
        parts.push(format!("nothing {}", percent(self.posterior.nothing)));
        parts.push(format!("something else {}", percent(self.posterior.something_else)));
        let share = &self.rest.all;
        let [low, high] = share.interval_95.map(|x| 100.0 * x);
        format!(
            "Of what was fitted: {}; what is left: {:.1} % of the peak ({low:.1} to {high:.1}).",
            parts.join(", "),
            100.0 * share.share_of_peak
        )
    }
}

/// Where each block stands on the path of its test.
fn places(measured: &Measured, f: &Fitted) -> Vec<Place> {
    let one = |(slot, block): (&crate::data::Slot, &inverse::Block)| {
        let test = &f.model.tests[slot.test].test;
        let s = test.record.as_ref().map_or(Vec::new(), |r| evidence::path(&r.time, &r.displacement));
        let peak = block.measured.iter().fold(0.0f64, |m, v| m.max(v.abs()));
        Place {
            test: test.name.clone(),
            s: slot.rows.iter().filter_map(|&r| s.get(r).copied()).collect(),
            peak,
        }
    };
    measured.slots.iter().zip(&measured.data.blocks).map(one).collect()
}

/// The effect and parameter of a path `effects.NAME.PARAMETER`.
fn of_effect(path: &str) -> Option<(&str, &str)> {
    path.strip_prefix("effects.")?.split_once('.')
}

/// Belief of an amplitude: normal around neutral, half-normal where it has a sign, as wide as what a lab would call
/// ordinary.
fn amplitude(free: &Free, spec: &ParamSpec, at: usize, card: &model::Card, start: &[f64]) -> Option<Belief> {
    let neutral = spec.neutral?;
    let ordinary = start.get(at).map_or(0.0, |s| (s - neutral).abs());
    let ordinary = if ordinary > 0.0 { ordinary } else { (spec.start - neutral).abs().max(1e-12) };
    let sd = ordinary / free.transform.slope(neutral).abs().max(1e-300);
    let (lower, upper) = free.bounds_z();
    let z = free.transform.forward(neutral);
    let (Screening::Score(side) | Screening::Refit(side)) = card.screening;
    let whole = match side {
        Sided::Positive => Belief::above(z, sd).within(z, upper),
        Sided::Both => Belief::normal(z, sd).within(lower, upper),
    };
    (whole.lower < whole.upper).then_some(whole)
}

fn belief(free: &Free, f: &Fitted, catalogue: &Catalogue, scales: &Scales) -> (Belief, bool) {
    let (lower, upper) = free.bounds_z();
    let wide = |mean: f64, sd: f64| (Belief::normal(mean, sd).within(lower, upper), false);
    if let Some((name, parameter)) = of_effect(&free.path)
        && let Some(effect) = catalogue.get(name)
        && let Some(config) = f.model.case.effects.iter().find(|c| c.name == name)
        && let Some(at) = config.specs.iter().position(|s| s.name == parameter)
    {
        let start = if config.options.is_empty() { effect.start(scales) } else { Vec::new() };
        let spec = &config.specs[at];
        if let Some(b) = amplitude(free, spec, at, effect.card(), &start) {
            return (b, true);
        }
        let typical = start.get(at).copied().unwrap_or(spec.start).clamp(spec.lower, spec.upper);
        return wide(free.forward(typical), SHAPE_SPREAD * free.natural_scale(typical));
    }
    match free.prior {
        Some(p) => wide(p.mean, p.sd),
        // Nothing is believed: the same for all sets.
        None => wide(free.forward(free.start), 3.0 * free.natural_scale(free.start)),
    }
}

/// The fitted rungs weighed against each other, on the points that all of them predict smoothly.
///
/// # Errors
/// [`EvidenceError`] when a number cannot be used or nothing was fitted.
pub fn probable(ladder: &FeLadder) -> Result<Probable, EvidenceError> {
    let base = ladder.rungs.values().next().ok_or(EvidenceError::Empty)?;
    let measured = ladder.measured.as_estimated(&base.model).unwrap_or_else(|_| ladder.measured.clone());
    let mut keep = vec![true; measured.data.points()];
    for f in ladder.rungs.values() {
        let valid = f.fit.prediction.valid.iter().flatten();
        keep.iter_mut().zip(valid).for_each(|(k, v)| *k &= v);
    }
    let rest = RestPrior::default();
    let catalogue = ladder.catalogue();
    let prior = SetPrior::of_catalogue(catalogue.iter().filter(|e| !e.card().negative_control).count());
    let record = Record::new(&measured.data, &places(&measured, base), Some(&keep), rest.smooth)?;
    let y = measured.data.measured();
    let weigh = |(effects, f): (&Vec<String>, &Fitted)| {
        let sizes = scales(&f.model, &f.theta);
        let beliefs: Vec<_> = f.frees.iter().map(|x| belief(x, f, catalogue, &sizes)).collect();
        let linear = Linear::at_fit(&y, &f.frees, &f.fit.theta, &f.fit.prediction, &beliefs)?;
        let evidence = Evidence::of(&record, &linear, &rest, Kernel::Plain)?;
        let judged = Judged::new(effects, &evidence, &rest, 1.0, &prior);
        Ok((linear, evidence, judged))
    };
    let all: Vec<(&Vec<String>, &Fitted)> = ladder.rungs.iter().collect();
    let weighed: Vec<_> = all.par_iter().map(|r| weigh(*r)).collect::<Result<_, EvidenceError>>()?;
    let models: Vec<Judged> = weighed.iter().map(|w| w.2.clone()).collect();
    let posterior = Posterior::of(&models, &prior);
    let leads =
        |w: &&(Linear, Evidence, Judged)| posterior.leader().is_some_and(|l| l.effects == w.2.effects);
    let (linear, evidence, _) = weighed.iter().find(leads).ok_or(EvidenceError::Empty)?;
    let left = evidence::remains(&record, linear, evidence, &rest, prior.beyond);
    let rows = weighed.iter().map(|(_, e, j)| Weighed {
        effects: j.effects.clone(),
        ln_z: e.ln_z,
        ln_z_else: e.ln_z_else,
        moved: e.moved,
    });
    Ok(Probable { explained_to: left.explained_to(PRACTICE), models: rows.collect(), rest: left, posterior })
}
