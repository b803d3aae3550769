//! Posterior over sets of effects, "nothing", and "something else".

use crate::likeness::{IMITATED, set_apart};
use crate::model::{Evidence, View};
use crate::rest::RestPrior;
use crate::special::ln_sum_exp;
use serde::Serialize;
use std::collections::{BTreeMap, BTreeSet};

/// What is believed of the sets before the record.
#[derive(Clone, Debug, PartialEq)]
pub struct SetPrior {
    /// How many effects are expected to act (`[diagnose] expected_effects`).
    pub expected: f64,
    /// Number of effects in the catalogue: each acts with probability `expected` / `catalogue`.
    pub catalogue: usize,
    /// Prior probability that a cause acts which the catalogue does not hold, whatever else does: one that an effect imitates to
    /// the noise, or one that leaves a rest.
    pub beyond: f64,
    /// Factor that sensitivity takes the scales of amplitudes and of the rest by, and divides them by.
    pub factor: f64,
}

impl SetPrior {
    /// 0.7 effects expected of a catalogue; one record in ten shows a cause from outside.
    pub const fn of_catalogue(catalogue: usize) -> Self {
        Self { expected: 0.7, catalogue, beyond: 0.1, factor: 2.0 }
    }

    /// Prior probability of a cause from outside that no effect imitates to the noise: the record has a rest for it.
    pub fn unlike(&self) -> f64 {
        (1.0 - IMITATED) * self.beyond
    }

    /// ln prior of one set of `k` effects.
    fn ln_of(&self, k: usize) -> f64 {
        let q = (self.expected / self.catalogue.max(1) as f64).clamp(1e-9, 0.5);
        k as f64 * q.ln() + self.catalogue.saturating_sub(k) as f64 * (-q).ln_1p()
    }
}

/// Ways of asking: as believed; amplitudes ×2, ×½; rest ×2, ×½.
const ASKED: [&str; 5] = ["as_believed", "amplitude_x2", "amplitude_half", "rest_x2", "rest_half"];

/// A model with its evidence in all the ways an answer needs.
#[derive(Clone, Debug)]
pub struct Judged {
    /// Effects, in any order.
    pub effects: Vec<String>,
    /// ln of the share of the set's prior that this form of its effects has: the forms of a set share it.
    pub ln_form: f64,
    /// Whether it was fitted, or extended from a smaller model's columns.
    pub fitted: bool,
    /// What it gains in ln Z over the model it was extended from; 0 for what was fitted.
    pub gain: f64,
    /// ln Z (complete model's rest, cause from outside) in the ways of asking.
    values: [[f64; 2]; 5],
    /// Probability that it leaves noise alone.
    noise_alone: f64,
    /// Mean square that a complete model is believed to leave.
    complete: f64,
    /// Mean square that it leaves beyond noise, in units of that, where it is known.
    left: Option<f64>,
}

impl Judged {
    /// From an evidence; `form_share` is this form's share of its set's prior (1 where there is one form).
    pub fn new(
        effects: &[String],
        evidence: &Evidence,
        rest: &RestPrior,
        form_share: f64,
        prior: &SetPrior,
    ) -> Self {
        let f = prior.factor;
        let ask = |amplitude: f64, size: f64| {
            let rest = rest.scaled(size);
            evidence.under(&View { rest: &rest, amplitude })
        };
        let values = [
            [evidence.ln_z, evidence.ln_z_else],
            ask(f, 1.0),
            ask(1.0 / f, 1.0),
            ask(1.0, f),
            ask(1.0, 1.0 / f),
        ];
        Self {
            effects: effects.to_vec(),
            ln_form: form_share.max(f64::MIN_POSITIVE).ln(),
            fitted: true,
            gain: 0.0,
            values,
            noise_alone: evidence.noise_alone(&View { rest, amplitude: 1.0 }, prior.unlike()),
            complete: rest.mean_square(),
            left: None,
        }
    }

    /// With the mean square of its misfit beyond noise ([`crate::excess`]). A set's effects are asked whether they are but the
    /// likeness of an unknown cause, or of a complete model's rest, where this is known of the set, and of the set without them.
    pub fn leaving(self, excess: f64) -> Self {
        Self { left: Some((1.0 - self.noise_alone) * excess / self.complete), ..self }
    }

    /// With an evidence that claims less, by so many nats, in every way of asking.
    pub fn less(mut self, nats: f64) -> Self {
        self.values.iter_mut().flatten().for_each(|v| *v -= nats);
        self
    }

    /// From numbers alone: the same in every way of asking.
    pub fn from_numbers(effects: &[String], ln_z: f64, ln_z_else: f64) -> Self {
        Self {
            effects: effects.to_vec(),
            ln_form: 0.0,
            fitted: true,
            gain: 0.0,
            values: [[ln_z, ln_z_else]; 5],
            noise_alone: 0.0,
            complete: RestPrior::default().mean_square(),
            left: None,
        }
    }

    /// Another set that was fitted: this one's evidence and what it has more.
    pub fn with_effects(&self, effects: &[String], more: f64) -> Self {
        Self { fitted: true, gain: 0.0, noise_alone: 0.0, ..self.extended(effects, more) }
    }

    /// A larger set that was not fitted: this one's evidence and what it gains. It leaves noise alone with this one's probability, at
    /// least.
    pub fn extended(&self, effects: &[String], gain: f64) -> Self {
        Self { effects: effects.to_vec(), gain, left: None, ..self.clone() }.predicted(gain)
    }

    /// ln Z with a complete model's rest.
    pub const fn ln_z(&self) -> f64 {
        self.values[0][0]
    }

    /// The same, not fitted, with a correction of ln Z (shapes averaged over their beliefs).
    pub fn predicted(mut self, correction: f64) -> Self {
        self.fitted = false;
        self.values.iter_mut().flatten().for_each(|v| *v += correction);
        self
    }
}

/// One set.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SetProbability {
    /// Effects, sorted.
    pub effects: Vec<String>,
    /// Posterior probability that these act, and nothing else.
    pub probability: f64,
    /// That these act, and something that the catalogue does not hold.
    pub with_something_else: f64,
}

/// The answer under other scales.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Brief {
    /// Probability of each effect.
    pub effects: BTreeMap<String, f64>,
    /// That nothing is missing.
    pub nothing: f64,
    /// That something is missing that the catalogue does not hold.
    pub something_else: f64,
}

/// Posterior probabilities. `nothing`, `something_else` and the `probability` of all other sets sum to 1.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Posterior {
    /// Every set that was judged, most probable first; the empty one is "nothing".
    pub sets: Vec<SetProbability>,
    /// Probability that each effect acts, alone or not.
    pub effects: BTreeMap<String, f64>,
    /// That nothing is missing.
    pub nothing: f64,
    /// That something is missing that the catalogue does not hold.
    pub something_else: f64,
    /// How that changes with the scales of amplitudes and of the rest.
    pub sensitivity: BTreeMap<&'static str, Brief>,
    /// Probability of all sets that were not fitted.
    pub unfitted: f64,
    /// The sets by their evidence alone, no effect asked whether it is but the likeness of an unknown cause: what a search goes by.
    pub by_evidence: Vec<SetProbability>,
}

type Key = BTreeSet<String>;

/// ln joint (own rest, something else) of each set, forms summed; `keep` selects models.
fn joint(
    models: &[Judged],
    prior: &SetPrior,
    way: usize,
    keep: impl Fn(&Judged) -> bool,
) -> BTreeMap<Key, [f64; 2]> {
    let mut parts: BTreeMap<Key, [Vec<f64>; 2]> = BTreeMap::new();
    for m in models.iter().filter(|m| keep(m)) {
        let key: Key = m.effects.iter().cloned().collect();
        let front = prior.ln_of(key.len()) + m.ln_form;
        let entry = parts.entry(key).or_default();
        let beyond = [(1.0 - prior.beyond).ln(), prior.unlike().ln()];
        for k in 0..2 {
            entry[k].push(front + beyond[k] + m.values[way][k]);
        }
    }
    parts.into_iter().map(|(k, v)| (k, v.map(ln_sum_exp))).collect()
}

/// The mean square that each set leaves beyond noise, by the form of it that leads.
fn left_by(models: &[Judged]) -> BTreeMap<Key, f64> {
    let mut best: BTreeMap<Key, &Judged> = BTreeMap::new();
    for m in models {
        let here = best.entry(m.effects.iter().cloned().collect()).or_insert(m);
        if m.ln_z() > here.ln_z() {
            *here = m;
        }
    }
    best.into_iter().filter_map(|(set, m)| Some((set, m.left?))).collect()
}

/// The sets by their evidence.
fn weighed(models: &[Judged], prior: &SetPrior, way: usize) -> Vec<SetProbability> {
    let ln = joint(models, prior, way, |_| true);
    let sum = ln_sum_exp(ln.values().flatten().copied().collect::<Vec<_>>());
    ln.into_iter()
        .map(|(key, [own, other])| SetProbability {
            effects: key.into_iter().collect(),
            probability: (own - sum).exp(),
            with_something_else: (other - sum).exp(),
        })
        .collect()
}

/// The same, each effect asked whether it is but the likeness of an unknown cause.
fn normalised(models: &[Judged], prior: &SetPrior, way: usize) -> Vec<SetProbability> {
    let mut sets = set_apart(weighed(models, prior, way), &left_by(models), prior);
    // Differences of large logarithms leave a sum that is 1 but for rounding.
    let all: f64 = sets.iter().map(|s| s.probability + s.with_something_else).sum();
    for s in &mut sets {
        s.probability /= all;
        s.with_something_else /= all;
    }
    sorted(sets)
}

/// Most probable first, what needs nothing else before what does.
fn sorted(mut sets: Vec<SetProbability>) -> Vec<SetProbability> {
    sets.sort_by(|a, b| {
        let total = |s: &SetProbability| s.probability + s.with_something_else;
        b.probability
            .total_cmp(&a.probability)
            .then(total(b).total_cmp(&total(a)))
            .then(a.effects.cmp(&b.effects))
    });
    sets
}

fn brief(sets: &[SetProbability]) -> Brief {
    let mut out = Brief::default();
    for s in sets {
        if s.effects.is_empty() {
            out.nothing = s.probability;
        }
        out.something_else += s.with_something_else;
        for e in &s.effects {
            *out.effects.entry(e.clone()).or_default() += s.probability + s.with_something_else;
        }
    }
    out.effects.values_mut().for_each(|p| *p = p.min(1.0));
    out
}

impl Posterior {
    /// The posterior over the judged sets. The evidence of a set is the mean over its forms, weighed by their prior shares.
    pub fn of(models: &[Judged], prior: &SetPrior) -> Self {
        let sets = normalised(models, prior, 0);
        let own = brief(&sets);
        let sensitivity =
            (1..ASKED.len()).map(|way| (ASKED[way], brief(&normalised(models, prior, way)))).collect();
        let all = joint(models, prior, 0, |_| true);
        let sum = ln_sum_exp(all.values().flatten().copied().collect::<Vec<_>>());
        let not = joint(models, prior, 0, |m| !m.fitted);
        let unfitted = not.values().flatten().map(|v| (v - sum).exp()).sum();
        Self {
            sets,
            effects: own.effects,
            nothing: own.nothing,
            something_else: own.something_else,
            sensitivity,
            unfitted,
            by_evidence: sorted(weighed(models, prior, 0)),
        }
    }

    /// The set that leads, whether or not something else acts.
    pub fn leader(&self) -> Option<&SetProbability> {
        self.sets.iter().max_by(|a, b| {
            let total = |s: &SetProbability| s.probability + s.with_something_else;
            total(a).total_cmp(&total(b)).then(b.effects.cmp(&a.effects))
        })
    }
}
