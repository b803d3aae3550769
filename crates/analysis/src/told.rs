//! An answer by probabilities in sentences.

use crate::ladder::{LeftOut, Weighed};
use crate::probable::{Brief, PosteriorAnswer, Probable};
use diagnose::{Discovery, Verdict};
use std::collections::BTreeMap;

/// Effects of which a sentence gives the probability.
const SHOWN: usize = 4;
/// Least probability that a sentence gives.
const WORTH: f64 = 0.05;
/// A change of a probability, by other scales of what is believed, that is said.
const MOVES: f64 = 0.02;

/// The verdict, the probabilities behind it, what they depend on, what is left. Names of `laws` are said to be laws.
pub(crate) fn words(weighed: &Weighed, laws: &[String]) -> Vec<String> {
    let mut out = vec![verdict(&weighed.discovery, &weighed.probable.posterior, laws)];
    out.extend(probabilities(&weighed.probable));
    out
}

/// The probabilities, what they depend on, what is left.
pub(crate) fn probabilities(probable: &Probable) -> Vec<String> {
    let p = &probable.posterior;
    let mut out = vec![listed(p)];
    out.extend(sensitivity(p));
    out.push(probable.what_is_left());
    out
}

fn verdict(d: &Discovery, p: &PosteriorAnswer, laws: &[String]) -> String {
    let called = |name: &String| if laws.contains(name) { format!("the law `{name}`") } else { name.clone() };
    let joined = |names: &[String], word: &str| joined(&names.iter().map(called).collect::<Vec<_>>(), word);
    let rms = |k: usize| d.ladder.get(k).map_or(0.0, |r| r.rms);
    let (first, last) = (rms(0), rms(d.ladder.len().saturating_sub(1)));
    let decimals = digits(first).max(digits(last)).max(digits_of_difference(first, last));
    let fall = format!("the misfit falls from {first:.decimals$} to {last:.decimals$} N");
    let names: Vec<String> = d.groups.iter().map(|g| joined(g, "or")).collect();
    let text = match d.verdict {
        Verdict::NothingMissing => {
            format!(
                "No effect is called for: that nothing is missing has a probability of {}.",
                percent(p.nothing)
            )
        }
        Verdict::Explained => format!("Missing: {}. With it {fall}.", joined(&d.found, "and")),
        Verdict::Ambiguous if d.groups.is_empty() => {
            let names = joined(&d.undecided.iter().map(called).collect::<Vec<_>>(), "and");
            format!("No effect is named: these records cannot tell whether {names} is missing, or nothing.")
        }
        Verdict::Ambiguous => format!(
            "Missing: {}. These records cannot tell which; with {} {fall}.",
            names.join(", and "),
            joined(&d.found, "and")
        ),
        Verdict::Unexplained => {
            // Where a cause from outside is no more probable than none, it is not said to act.
            let more = if p.something_else > evidence::LIKELY {
                "something is missing that the catalogue does not hold"
            } else {
                "more is left than a complete model of such a test leaves"
            };
            match names.as_slice() {
                [] => format!("No effect is probable enough to be named, and {more}."),
                names => format!("With {} {fall}, but {more}.", names.join(" and ")),
            }
        }
    };
    if d.interrupted { format!("{text} The search was stopped before its end.") } else { text }
}

/// That the answer is one to a part of the records.
pub(crate) fn without(left_out: &[LeftOut]) -> Option<String> {
    let part = |l: &LeftOut| format!("the last {} of {} points of {}", l.points, l.of, l.test);
    let parts: Vec<String> = left_out.iter().map(part).collect();
    (!parts.is_empty()).then(|| {
        format!(
            "No effect came near the whole records: this is the answer to them without {}, where the force falls by many \
             times its noise from one point to the next.",
            joined(&parts, "and")
        )
    })
}

/// The most probable effects, "nothing" and "something else", as one sentence.
pub(crate) fn listed(p: &PosteriorAnswer) -> String {
    let mut effects: Vec<(&String, f64)> =
        p.effects.iter().map(|(e, p)| (e, *p)).filter(|e| e.1 >= WORTH).collect();
    effects.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(b.0)));
    let one = |(name, p): (&String, f64)| format!("{name} {}", percent(p));
    let mut parts: Vec<String> = effects.into_iter().take(SHOWN).map(one).collect();
    parts.push(format!("nothing {}", percent(p.nothing)));
    parts.push(format!("something else {}", percent(p.something_else)));
    format!("Probabilities: {}.", parts.join(", "))
}

/// How the leading probability moves with what is believed.
fn sensitivity(p: &PosteriorAnswer) -> Option<String> {
    let most = p.effects.iter().max_by(|a, b| a.1.total_cmp(b.1)).filter(|e| *e.1 > p.nothing);
    let name = most.map(|(effect, _)| effect.as_str());
    let of = |b: &Brief| name.map_or(b.nothing, |e| b.effects.get(e).copied().unwrap_or(0.0));
    let (low, high) = range(&p.sensitivity, &of)?;
    let name = name.unwrap_or("nothing");
    (high - low > MOVES).then(|| {
        format!(
            "With amplitudes, or the rest, believed twice or half as large, {name} has {} to {}.",
            percent(low),
            percent(high)
        )
    })
}

fn range(all: &BTreeMap<&'static str, Brief>, of: &dyn Fn(&Brief) -> f64) -> Option<(f64, f64)> {
    let values = || all.values().map(of);
    (!all.is_empty())
        .then(|| (values().fold(f64::INFINITY, f64::min), values().fold(f64::NEG_INFINITY, f64::max)))
}

/// A probability in percent; neither nothing nor all is said where it is not.
pub fn percent(p: f64) -> String {
    match p {
        p if p > 0.0 && p < 0.005 => "< 1 %".to_owned(),
        p if p < 1.0 && p > 0.995 => "> 99 %".to_owned(),
        p => format!("{:.0} %", 100.0 * p),
    }
}

fn joined(names: &[String], word: &str) -> String {
    match names {
        [] => String::new(),
        [one] => one.clone(),
        [head @ .., last] => format!("{} {word} {last}", head.join(", ")),
    }
}

/// Decimals that show how two numbers differ; none where they do not.
fn digits_of_difference(a: f64, b: f64) -> usize {
    if a == b { 0 } else { digits(a - b).saturating_sub(1) }
}

/// Decimals of two significant digits; none of zero.
fn digits(x: f64) -> usize {
    if x == 0.0 {
        return 0;
    }
    let place = 1.0 - x.abs().log10().floor();
    place.clamp(0.0, 9.0) as usize
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ladder::tests::undecided;
    use evidence::{Judged, Posterior, SetPrior};

    /// An effect that leads without being safe to name is told as what it is: neither a name nor nothing.
    #[test]
    fn what_is_undecided_is_not_told_as_nothing_missing() {
        let names = [vec![], vec!["compliance".to_owned()]];
        let models = [0.0, 4.0].iter().zip(&names).map(|(z, e)| Judged::from_numbers(e, *z, -99.0));
        let posterior = Posterior::of(&models.collect::<Vec<_>>(), &SetPrior::of_catalogue(20));
        let decision = evidence::decide(&posterior, evidence::ExplainedTo::Practice);
        assert_eq!(decision.undecided, ["compliance"]);
        let leads: Vec<&str> = decision.undecided.iter().map(String::as_str).collect();
        let said = verdict(&undecided(&leads), &posterior.into(), &[]);
        assert_eq!(
            said,
            "No effect is named: these records cannot tell whether compliance is missing, or nothing."
        );
    }

    /// A cause from outside is said to act only where it is more probable than none.
    #[test]
    fn what_is_left_is_not_told_as_a_cause_from_outside() {
        let names = [vec![], vec!["bridging".to_owned()]];
        let said = |other: f64| {
            let models = [(-30.0, -30.0), (0.0, other)].into_iter().zip(&names);
            let models: Vec<Judged> =
                models.map(|((own, other), e)| Judged::from_numbers(e, own, other)).collect();
            let posterior = Posterior::of(&models, &SetPrior::of_catalogue(20));
            let found = Discovery {
                found: names[1].clone(),
                groups: vec![names[1].clone()],
                verdict: Verdict::Unexplained,
                ..undecided(&[])
            };
            verdict(&found, &posterior.into(), &[])
        };
        assert!(said(-9.0).ends_with("but more is left than a complete model of such a test leaves."));
        assert!(said(9.0).ends_with("but something is missing that the catalogue does not hold."));
    }
}
