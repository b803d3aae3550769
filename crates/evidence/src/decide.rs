//! From probabilities to an answer, by one table of losses.
//!
//! | truth \ answer | names a group that holds it | names another | says nothing is missing | abstains |
//! |---|---|---|---|---|
//! | an effect of the group acts | 0 | 4 | 1 | 1 |
//! | it does not | 4 | 4 | 0 (nothing acts) | 1 |
//!
//! A group is named where 4 (1 − P) < 1, so P > ¾. A group is the smallest set of effects that holds 95 % of the mass. Where none is
//! named, nothing is said to be missing only where that leads; else the answer is that the records cannot tell.

use crate::posterior::{Posterior, SetProbability};
use crate::remains::ExplainedTo;
use serde::Serialize;

/// Loss of a wrong name in units of that of abstaining.
pub const WRONG_NAME: f64 = 4.0;

/// Probability from which a cause outside the catalogue is said to act: more probable than not.
pub const LIKELY: f64 = 0.5;

/// Mass that the sets of an answer hold.
pub const CREDIBLE: f64 = 0.95;

/// How an answer ends (as in the contract).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// Nothing leads.
    NothingMissing,
    /// Each effect stands alone in its group.
    Explained,
    /// Some group holds several; or none is named, although it is not "nothing" that leads.
    Ambiguous,
    /// The rest is beyond practice, or most probably has a cause outside the catalogue.
    Unexplained,
}

/// The contract's fields.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Decision {
    /// Effects that are named.
    pub found: Vec<String>,
    /// `groups[i]`: `found[i]`, then every effect that may stand in its place.
    pub groups: Vec<Vec<String>>,
    /// Effects of the leading set where the records cannot tell whether any of them acts, so that none is named; else none.
    pub undecided: Vec<String>,
    /// How it ends.
    pub verdict: Verdict,
}

impl Decision {
    /// Where no model was weighed.
    const fn nothing() -> Self {
        let verdict = Verdict::NothingMissing;
        Self { found: Vec::new(), groups: Vec::new(), undecided: Vec::new(), verdict }
    }
}

fn total(s: &SetProbability) -> f64 {
    s.probability + s.with_something_else
}

/// The sets that by their evidence together hold 95 %, most probable first. What an effect loses to an unknown cause that looks like
/// it goes to the set without it, in which nothing stands in its place.
fn credible(posterior: &Posterior) -> Vec<&SetProbability> {
    let mut sets: Vec<&SetProbability> = posterior.by_evidence.iter().collect();
    sets.sort_by(|a, b| total(b).total_cmp(&total(a)).then(a.effects.cmp(&b.effects)));
    let mut held = 0.0;
    let mut out = Vec::new();
    for s in sets {
        if held >= CREDIBLE {
            break;
        }
        held += total(s);
        out.push(s);
    }
    out
}

/// The effect and what stands in its place in a credible set that is else the same.
fn group(
    leader: &SetProbability,
    effect: &str,
    credible: &[&SetProbability],
    posterior: &Posterior,
) -> Vec<String> {
    let rest: Vec<&String> = leader.effects.iter().filter(|e| *e != effect).collect();
    let mut others: Vec<String> = Vec::new();
    for s in credible.iter().filter(|s| s.effects.len() == leader.effects.len()) {
        let mut new = s.effects.iter().filter(|e| !rest.contains(e));
        let (Some(other), None) = (new.next(), new.next()) else { continue };
        if other != effect && !leader.effects.contains(other) {
            others.push(other.clone());
        }
    }
    let p = |e: &String| posterior.effects.get(e).copied().unwrap_or(0.0);
    others.sort_by(|a, b| p(b).total_cmp(&p(a)).then(a.cmp(b)));
    others.dedup();
    std::iter::once(effect.to_owned()).chain(others).collect()
}

/// Probability that at least one of a group acts.
fn holds(posterior: &Posterior, group: &[String]) -> f64 {
    posterior.sets.iter().filter(|s| s.effects.iter().any(|e| group.contains(e))).map(total).sum()
}

/// The answer that costs least.
pub fn decide(posterior: &Posterior, explained: ExplainedTo) -> Decision {
    let Some(leader) = posterior.leader() else { return Decision::nothing() };
    let credible = credible(posterior);
    let mut effects = leader.effects.clone();
    let p = |e: &String| posterior.effects.get(e).copied().unwrap_or(0.0);
    effects.sort_by(|a, b| p(b).total_cmp(&p(a)).then(a.cmp(b)));
    let groups: Vec<Vec<String>> = effects
        .iter()
        .map(|e| group(leader, e, &credible, posterior))
        .filter(|g| WRONG_NAME * (1.0 - holds(posterior, g)) < 1.0)
        .collect();
    let found: Vec<String> = groups.iter().map(|g| g[0].clone()).collect();
    let beyond = explained == ExplainedTo::Not || posterior.something_else > LIKELY;
    let undecided = if found.is_empty() && !beyond { effects } else { Vec::new() };
    let verdict = match (beyond, found.is_empty(), groups.iter().all(|g| g.len() == 1)) {
        (true, ..) => Verdict::Unexplained,
        (_, true, _) if undecided.is_empty() => Verdict::NothingMissing,
        (_, false, true) => Verdict::Explained,
        _ => Verdict::Ambiguous,
    };
    Decision { found, groups, undecided, verdict }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::posterior::{Judged, SetPrior};

    fn posterior(sets: &[(&[&str], f64, f64)]) -> Posterior {
        // Priors taken out, so that the numbers are the posterior's.
        let prior = SetPrior { expected: 0.5, catalogue: 1, beyond: 2.0 / 3.0, factor: 2.0 };
        let models: Vec<Judged> = sets
            .iter()
            .map(|(e, own, other)| {
                let names: Vec<String> = e.iter().map(|s| (*s).to_owned()).collect();
                let k = names.len().max(1) as f64 - 1.0;
                Judged::from_numbers(
                    &names,
                    own.ln() - k * 0.5f64.ln(),
                    other.max(1e-300).ln() - k * 0.5f64.ln(),
                )
            })
            .collect();
        Posterior::of(&models, &prior)
    }

    fn answer(sets: &[(&[&str], f64, f64)]) -> (Verdict, Vec<Vec<String>>) {
        let d = decide(&posterior(sets), ExplainedTo::Noise);
        assert_eq!(d.found, d.groups.iter().map(|g| g[0].clone()).collect::<Vec<_>>());
        (d.verdict, d.groups)
    }

    #[test]
    fn the_table_of_losses_decides() {
        assert_eq!(
            answer(&[(&["a"], 0.97, 0.0), (&["b"], 0.02, 0.0), (&[], 0.01, 0.0)]),
            (Verdict::Explained, vec![vec!["a".into()]])
        );
        let tie = answer(&[(&["a"], 0.6, 0.0), (&["b"], 0.38, 0.0), (&[], 0.02, 0.0)]);
        assert_eq!(tie, (Verdict::Ambiguous, vec![vec!["a".into(), "b".into()]]));
        assert_eq!(answer(&[(&[], 0.9, 0.0), (&["a"], 0.1, 0.0)]), (Verdict::NothingMissing, vec![]));
        // Not safe enough to be named, nor is it nothing that leads.
        assert_eq!(answer(&[(&["a"], 0.6, 0.0), (&[], 0.4, 0.0)]), (Verdict::Ambiguous, vec![]));
        let two = answer(&[(&["a", "b"], 0.7, 0.0), (&["a", "c"], 0.28, 0.0), (&["a"], 0.02, 0.0)]);
        assert_eq!(two, (Verdict::Ambiguous, vec![vec!["a".into()], vec!["b".into(), "c".into()]]));
        let other = answer(&[(&["a"], 0.1, 0.8), (&[], 0.0, 0.1)]);
        assert_eq!(other, (Verdict::Unexplained, vec![vec!["a".into()]]));
    }

    #[test]
    fn what_leads_without_being_safe_to_name_is_undecided() {
        let undecided = |sets: &[(&[&str], f64, f64)], explained| {
            let d = decide(&posterior(sets), explained);
            (d.undecided, d.verdict)
        };
        let open: &[(&[&str], f64, f64)] = &[(&["a"], 0.6, 0.0), (&[], 0.4, 0.0)];
        assert_eq!(undecided(open, ExplainedTo::Practice), (vec!["a".into()], Verdict::Ambiguous));
        // Beyond practice something is missing, whatever it is.
        assert_eq!(undecided(open, ExplainedTo::Not), (vec![], Verdict::Unexplained));
        let named: &[(&[&str], f64, f64)] = &[(&["a"], 0.97, 0.0), (&[], 0.03, 0.0)];
        assert_eq!(undecided(named, ExplainedTo::Noise), (vec![], Verdict::Explained));
        let nothing: &[(&[&str], f64, f64)] = &[(&[], 0.45, 0.0), (&["a"], 0.3, 0.0), (&["b"], 0.25, 0.0)];
        assert_eq!(undecided(nothing, ExplainedTo::Noise), (vec![], Verdict::NothingMissing));
    }

    /// `b` is but a second effect beside `a`; that `a` may be the likeness of an unknown cause, with `b` beside it, puts `b` in nobody's
    /// place.
    #[test]
    fn what_an_unknown_cause_may_look_like_joins_no_group() {
        let prior = SetPrior::of_catalogue(20);
        let named = |e: &[&str]| e.iter().map(|s| (*s).to_owned()).collect::<Vec<String>>();
        let judged = |e: &[String], ln_z: f64, left: f64| Judged::from_numbers(e, ln_z, -900.0).leaving(left);
        let mut models = vec![
            judged(&[], -900.0, 1.0),
            judged(&named(&["a"]), 0.0, 0.0),
            judged(&named(&["b"]), -900.0, 1.0),
            judged(&named(&["a", "b"]), 2.0, 0.0),
        ];
        models.extend((0..14).map(|k| judged(&["a".into(), format!("c{k}")], -0.8, 0.0)));
        let p = Posterior::of(&models, &prior);
        assert!(p.sets.iter().any(|s| s.effects == ["b"] && s.with_something_else > 5e-3), "{:?}", p.sets);
        assert_eq!(decide(&p, ExplainedTo::Noise).groups, [["a"]]);
    }

    #[test]
    fn a_rest_beyond_practice_is_not_explained() {
        let p = posterior(&[(&["a"], 0.99, 0.0), (&[], 0.01, 0.0)]);
        assert_eq!(decide(&p, ExplainedTo::Not).verdict, Verdict::Unexplained);
        assert_eq!(decide(&p, ExplainedTo::Practice).verdict, Verdict::Explained);
    }
}
