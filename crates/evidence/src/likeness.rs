//! A cause from outside the catalogue may look like an effect of it.
//!
//! The rest is a Gaussian process, and next to none of its draws look like an effect. Real causes do: friction makes a loop as
//! viscoelasticity does. Of what an unknown cause leaves, let a share ρ² look like that effect of the catalogue which is nearest to it;
//! nothing is known of ρ², so it is uniform over [0, 1]. Where a set S with the effect e leaves x times the mean square that it
//! leaves without e, an unknown cause with 1 − x or more in common with e does the same as e. Against "S acts" this has
//! the odds
//!
//! (b / N) x : (q / N)(1 − b) where S leaves what a complete model does, (b / N) x : (q / N) b where something else acts beside S,
//!
//! with q effects expected of N and the prior b of a cause from outside. What leaves noise alone has x = 0, and loses nothing.

use crate::posterior::{SetPrior, SetProbability};
use std::collections::{BTreeMap, BTreeSet};

/// Moves from every set the probability that one of its effects is but the likeness of a cause from outside, to the set without
/// that effect, with something else. `left`: the mean square that sets leave beyond noise, of those where it is known.
pub(crate) fn set_apart(
    sets: Vec<SetProbability>,
    left: &BTreeMap<BTreeSet<String>, f64>,
    prior: &SetPrior,
) -> Vec<SetProbability> {
    let key = |s: &SetProbability| s.effects.iter().cloned().collect::<BTreeSet<String>>();
    let mut all: BTreeMap<BTreeSet<String>, [f64; 2]> =
        sets.iter().map(|s| (key(s), [s.probability, s.with_something_else])).collect();
    let own = prior.beyond / (prior.expected.max(1e-9) * (1.0 - prior.beyond));
    let other = 1.0 / prior.expected.max(1e-9);
    for s in sets {
        let set = key(&s);
        let without = |e: &String| set.iter().filter(|x| *x != e).cloned().collect::<BTreeSet<String>>();
        let likeness: Vec<(BTreeSet<String>, f64)> = (set.iter().map(without))
            .filter_map(|smaller| {
                let (with, without) = (left.get(&set)?, left.get(&smaller)?);
                (*without > 0.0).then(|| (smaller, (with / without).clamp(0.0, 1.0)))
            })
            .collect();
        let sum: f64 = likeness.iter().map(|l| l.1).sum();
        let kept = [s.probability / (1.0 + own * sum), s.with_something_else / (1.0 + other * sum)];
        if let Some(here) = all.get_mut(&set) {
            here[0] += kept[0] - s.probability;
            here[1] += kept[1] - s.with_something_else;
        }
        for (smaller, x) in likeness {
            all.entry(smaller).or_default()[1] += x * (own * kept[0] + other * kept[1]);
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

    #[test]
    fn what_leaves_noise_alone_loses_nothing() {
        let out = asked(&[(&["a"], [0.9, 0.1])], &[(&[], 1.0), (&["a"], 0.0)]);
        assert_eq!(out["a"], [0.9, 0.1]);
        // Nor where it is not known what is left.
        assert_eq!(asked(&[(&["a"], [0.9, 0.1])], &[(&["a"], 1.0)])["a"], [0.9, 0.1]);
    }

    #[test]
    fn an_effect_that_takes_nothing_beside_an_unknown_cause_may_be_its_likeness() {
        let out = asked(&[(&["a"], [0.0, 1.0])], &[(&[], 1.0), (&["a"], 1.0)]);
        assert!((out["a"][1] - 0.7 / 1.7).abs() < 1e-12 && (out[""][1] - 1.0 / 1.7).abs() < 1e-12, "{out:?}");
        // Where what is left is what a complete model leaves, the unknown cause must be believed first.
        let out = asked(&[(&["a"], [1.0, 0.0])], &[(&[], 1.0), (&["a"], 0.5)]);
        let odds = 0.5 * 0.1 / (0.7 * 0.9);
        assert!((out[""][1] / out["a"][0] - odds).abs() < 1e-12 && out[""][0] == 0.0, "{out:?}");
    }

    #[test]
    fn in_a_pair_each_is_asked_for_what_it_takes() {
        let sets: &[(&[&str], [f64; 2])] = &[(&["a", "b"], [0.5, 0.5]), (&["a"], [0.0, 0.0])];
        let out = asked(sets, &[(&["a", "b"], 0.1), (&["a"], 0.1), (&["b"], 10.0)]);
        let sum: f64 = out.values().flatten().sum();
        assert!((sum - 1.0).abs() < 1e-12, "{out:?}");
        assert!(out["a"][1] > 0.3 && out["b"][1] < 0.01, "{out:?}");
    }
}
