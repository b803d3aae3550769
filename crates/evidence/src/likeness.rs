//! A cause from outside the catalogue may look like an effect of it.
//!
//! The rest is a Gaussian process, and next to none of its draws look like an effect. Real causes do: friction makes a loop as
//! viscoelasticity does. Of what an unknown cause leaves, let a share ρ² look like that effect of the catalogue which is nearest to it.
//! With probability [`IMITATED`] that is all of it, to the noise; else nothing is known of ρ², and it is uniform over [0, 1]. Where a
//! set S with the effect e leaves x times the mean square that it leaves without e, an unknown cause with 1 − x or more in common
//! with e does the same as e. Against "S acts" this has the odds, with m = [`IMITATED`],
//!
//! (b / N) (m + (1 − m) x) : (q / N)(1 − b) where S leaves what a complete model does,
//! (b / N) (1 − m) x : (q / N) b (1 − m) where something else acts beside S, which is none that is imitated to the noise,
//!
//! with q effects expected of N and the prior b of a cause from outside.
//!
//! What a complete model leaves is no draw of a process either, and a share of it looks like an effect as well. Where S without e
//! leaves little more than a complete model does, no cause has to be believed for that: against "S acts" this has the odds
//!
//! (1 / N) x exp(−(l′ − l)/2) : q / N,
//!
//! l and l′ being what S and S without e leave, in units of the mean square that a complete model is believed to leave.

use crate::posterior::{SetPrior, SetProbability};
use std::collections::{BTreeMap, BTreeSet};

/// Probability that the nearest effect imitates an unknown cause to the noise. What the catalogue lacks is taken to be as what it
/// holds: of eight effects of it that were left out, the others imitated four (docs/hidden.md, one effect left out).
pub(crate) const IMITATED: f64 = 0.5;

/// An effect of a set, asked what it may be but the likeness of.
struct Asked {
    /// The set without it.
    smaller: BTreeSet<String>,
    /// Odds against it of an unknown cause, where what the set leaves is a complete model's rest, and where something else acts.
    cause: [f64; 2],
    /// Of a complete model's rest.
    rest: f64,
}

impl Asked {
    /// From what the set leaves with the effect, and without it.
    fn of(smaller: BTreeSet<String>, [with, without]: [f64; 2], prior: &SetPrior) -> Self {
        // Where nothing is left without the effect, nothing was taken.
        let x = if without > 0.0 { (with / without).min(1.0) } else { f64::from(u8::from(with > 0.0)) };
        let expected = prior.expected.max(1e-9);
        let own = prior.beyond / (expected * (1.0 - prior.beyond));
        let as_large = (-0.5 * (without - with).max(0.0)).exp();
        Self {
            smaller,
            cause: [own * (IMITATED + (1.0 - IMITATED) * x), x / expected],
            rest: x / expected * as_large,
        }
    }
}

/// Moves from every set the probability that one of its effects is but the likeness of a cause from outside, to the set without
/// that effect, with something else; or of a complete model's rest, to that set alone. `left`: the mean square that sets leave
/// beyond noise, in units of a complete model's, of those where it is known.
pub(crate) fn set_apart(
    sets: Vec<SetProbability>,
    left: &BTreeMap<BTreeSet<String>, f64>,
    prior: &SetPrior,
) -> Vec<SetProbability> {
    let key = |s: &SetProbability| s.effects.iter().cloned().collect::<BTreeSet<String>>();
    let mut all: BTreeMap<BTreeSet<String>, [f64; 2]> =
        sets.iter().map(|s| (key(s), [s.probability, s.with_something_else])).collect();
    for s in sets {
        let set = key(&s);
        let without = |e: &String| set.iter().filter(|x| *x != e).cloned().collect::<BTreeSet<String>>();
        let asked: Vec<Asked> = (set.iter().map(without))
            .filter_map(|smaller| {
                let both = [*left.get(&set)?, *left.get(&smaller)?];
                Some(Asked::of(smaller, both, prior))
            })
            .collect();
        let [own, other] = [0, 1].map(|k| asked.iter().map(|a| a.cause[k]).sum::<f64>());
        let rest: f64 = asked.iter().map(|a| a.rest).sum();
        let kept = [s.probability / (1.0 + own + rest), s.with_something_else / (1.0 + other)];
        if let Some(here) = all.get_mut(&set) {
            here[0] += kept[0] - s.probability;
            here[1] += kept[1] - s.with_something_else;
        }
        for a in asked {
            let smaller = all.entry(a.smaller).or_default();
            smaller[0] += a.rest * kept[0];
            smaller[1] += a.cause[0] * kept[0] + a.cause[1] * kept[1];
        }
    }
    all.into_iter()
        .map(|(effects, [probability, with_something_else])| SetProbability {
            effects: effects.into_iter().collect(),
            probability,
            with_something_else,
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(list: &[&str]) -> BTreeSet<String> {
        list.iter().map(|s| (*s).to_owned()).collect()
    }

    fn asked(sets: &[(&[&str], [f64; 2])], left: &[(&[&str], f64)]) -> BTreeMap<String, [f64; 2]> {
        let prior = SetPrior { expected: 0.7, catalogue: 20, beyond: 0.1, factor: 2.0 };
        let sets = sets.iter().map(|(e, p)| SetProbability {
            effects: names(e).into_iter().collect(),
            probability: p[0],
            with_something_else: p[1],
        });
        let left = left.iter().map(|(e, x)| (names(e), *x)).collect();
        let out = set_apart(sets.collect(), &left, &prior);
        out.into_iter().map(|s| (s.effects.join("+"), [s.probability, s.with_something_else])).collect()
    }

    /// Odds of an unknown cause that is all of an effect, against the effect, in the prior of these tests.
    const ODDS: f64 = 0.1 / (0.7 * 0.9);
    /// A hundred times what a complete model leaves.
    const MUCH: f64 = 100.0;

    #[test]
    fn what_leaves_noise_alone_loses_what_an_unknown_cause_imitates() {
        let out = asked(&[(&["a"], [0.9, 0.1])], &[(&[], MUCH), (&["a"], 0.0)]);
        assert!((out[""][1] / out["a"][0] - IMITATED * ODDS).abs() < 1e-12, "{out:?}");
        // One that is imitated leaves nothing for something else.
        assert!(out["a"][1] == 0.1 && out[""][0] == 0.0, "{out:?}");
        // Also where the noise hides what the effect does.
        let out = asked(&[(&["a"], [1.0, 0.0])], &[(&[], 0.0), (&["a"], 0.0)]);
        assert!((out[""][1] / out["a"][0] - IMITATED * ODDS).abs() < 1e-12, "{out:?}");
        // Where it is not known what is left, nothing.
        assert_eq!(asked(&[(&["a"], [0.9, 0.1])], &[(&["a"], 1.0)])["a"], [0.9, 0.1]);
    }

    #[test]
    fn an_effect_that_takes_nothing_beside_an_unknown_cause_may_be_its_likeness() {
        let out = asked(&[(&["a"], [0.0, 1.0])], &[(&[], 1.0), (&["a"], 1.0)]);
        assert!((out[""][1] / out["a"][1] - 1.0 / 0.7).abs() < 1e-12, "{out:?}");
        // Where what is left is what a complete model leaves, the unknown cause must be believed first.
        let out = asked(&[(&["a"], [1.0, 0.0])], &[(&[], MUCH), (&["a"], 0.5 * MUCH)]);
        let odds = (IMITATED + 0.5 * (1.0 - IMITATED)) * ODDS;
        assert!((out[""][1] / out["a"][0] - odds).abs() < 1e-12 && out[""][0] < 1e-10, "{out:?}");
    }

    #[test]
    fn an_effect_that_takes_nothing_of_a_complete_models_rest_may_be_its_likeness() {
        let out = asked(&[(&["a"], [1.0, 0.0])], &[(&[], 2.0), (&["a"], 2.0)]);
        assert!((out[""][0] / out["a"][0] - 1.0 / 0.7).abs() < 1e-12, "{out:?}");
        // What is larger without the effect is less believed of a complete model.
        let out = asked(&[(&["a"], [1.0, 0.0])], &[(&[], 4.0), (&["a"], 2.0)]);
        assert!((out[""][0] / out["a"][0] - 0.5 / 0.7 * (-1.0f64).exp()).abs() < 1e-12, "{out:?}");
        // What leaves noise alone is asked nothing of this.
        assert_eq!(asked(&[(&["a"], [1.0, 0.0])], &[(&[], 2.0), (&["a"], 0.0)])[""][0], 0.0);
    }

    #[test]
    fn in_a_pair_each_is_asked_for_what_it_takes() {
        let sets: &[(&[&str], [f64; 2])] = &[(&["a", "b"], [0.5, 0.5]), (&["a"], [0.0, 0.0])];
        let out = asked(sets, &[(&["a", "b"], 0.1 * MUCH), (&["a"], 0.1 * MUCH), (&["b"], 10.0 * MUCH)]);
        let sum: f64 = out.values().flatten().sum();
        assert!((sum - 1.0).abs() < 1e-12, "{out:?}");
        // x is 0.01 for a, without which a hundred times as much is left, and 1 for b, without which as much is.
        let (a, b) = ([ODDS * 0.505, 0.01 / 0.7], [ODDS, 1.0 / 0.7]);
        let kept = [0.5 / (1.0 + a[0] + b[0] + 1.0 / 0.7), 0.5 / (1.0 + a[1] + b[1])];
        let expected = [("b", a), ("a", b)].map(|(left, odds)| (left, odds[0] * kept[0] + odds[1] * kept[1]));
        for (left, moved) in expected {
            assert!((out[left][1] - moved).abs() < 1e-12, "{left}: {moved} {out:?}");
        }
    }
}
