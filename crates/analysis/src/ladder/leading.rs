//! Which sets an answer may hang on.

use evidence::{Posterior, SetProbability};

/// Share of the posterior from which on a set is fitted on the file's mesh, and the catalogue's columns are computed there, to
/// see what would be added to it.
const LEADS: f64 = 0.05;
/// Share of a set, in those of its part that has most, from which on it may say something else than its part does: it was
/// fitted from there, with the file's mesh seen from there.
const OVERTAKES: f64 = 1.0 / 3.0;

fn share(s: &SetProbability) -> f64 {
    s.probability + s.with_something_else
}

fn part(a: &SetProbability, of: &SetProbability) -> bool {
    !a.effects.is_empty()
        && a.effects.len() < of.effects.len()
        && a.effects.iter().all(|e| of.effects.contains(e))
}

/// Those with a share of the posterior, or of what it says if no cause from outside acts, unless a part of theirs has most of it.
/// A cause from outside fits whatever is there; before it has the answer, what the catalogue can do is fitted to its end.
pub(super) fn leading(posterior: &Posterior) -> Vec<Vec<String>> {
    let sets = &posterior.by_evidence;
    let overtaken = |s: &SetProbability| sets.iter().any(|p| part(p, s) && share(s) < OVERTAKES * share(p));
    let known: f64 = sets.iter().map(|s| s.probability).sum();
    let leads = |s: &SetProbability| share(s) >= LEADS || (known > 0.0 && s.probability >= LEADS * known);
    sets.iter().filter(|s| leads(s) && !overtaken(s)).map(|s| s.effects.clone()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use evidence::{Judged, SetPrior};

    fn leads(sets: &[(&str, f64, f64)]) -> Vec<String> {
        let prior = SetPrior { expected: 0.5, catalogue: 1, beyond: 2.0 / 3.0, factor: 2.0 };
        let names = |s: &str| s.split_whitespace().map(str::to_owned).collect::<Vec<_>>();
        let models: Vec<Judged> = sets
            .iter()
            .map(|(s, own, other)| Judged::from_numbers(&names(s), own.ln(), other.ln()))
            .collect();
        leading(&Posterior::of(&models, &prior)).into_iter().map(|s| s.join(" ")).collect()
    }

    #[test]
    fn what_the_catalogue_says_leads_also_where_a_cause_outside_holds_nearly_all() {
        assert_eq!(leads(&[("", 1e-6, 0.96), ("a", 0.03, 1e-6), ("b", 1e-4, 1e-6)]), ["a", ""]);
        // Without a cause outside, a share of the posterior is what counts.
        assert_eq!(leads(&[("", 0.9, 1e-9), ("a", 0.08, 1e-9), ("b", 0.02, 1e-9)]), ["", "a"]);
    }

    #[test]
    fn a_set_that_a_part_of_it_leaves_behind_does_not_lead() {
        assert_eq!(leads(&[("a", 0.8, 1e-9), ("a b", 0.2, 1e-9)]), ["a"]);
        assert_eq!(leads(&[("a", 0.5, 1e-9), ("a b", 0.5, 1e-9)]), ["a", "a b"]);
    }
}
