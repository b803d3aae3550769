//! Tables by effect, of pairs and of outside effects.

use super::{median, names, singles};
use crate::outcome::{Grade, Outcome};
use std::collections::BTreeMap;
use std::fmt::Write as _;

/// All tables.
pub fn section(outcomes: &[Outcome]) -> String {
    let mut text = by_effect(outcomes);
    text.push_str(&list(outcomes, "Pairs", |o| o.truth.effects.len() == 2));
    text.push_str(&list(outcomes, "Effects that the catalogue does not hold", |o| o.truth.is_outside()));
    text.push_str(&list(outcomes, "Records without effect", |o| o.truth.effects.is_empty()));
    text
}

fn by_effect(outcomes: &[Outcome]) -> String {
    let mut groups: BTreeMap<&str, Vec<&Outcome>> = BTreeMap::new();
    for o in singles(outcomes) {
        groups.entry(o.truth.effects[0].as_str()).or_default().push(o);
    }
    let mut text = String::from(
        "## By effect\n\nVisible cases unless said otherwise. *abstained*: no name. *invisible, wrong*: cases that the \
         record cannot see, and in which something else was named. Δχ² and errors of Gc are medians.\n\n\
         | effect | cases | visible | right | with more | abstained | wrong | invisible, wrong | predicted / actual \
         Δχ² | Gc error before | after |\n|---|---|---|---|---|---|---|---|---|---|---|\n",
    );
    for (effect, all) in groups {
        let seen: Vec<&&Outcome> = all.iter().filter(|o| o.visible()).collect();
        let count = |g: Grade| seen.iter().filter(|o| o.grade() == g).count();
        let unseen_wrong = all.iter().filter(|o| !o.visible() && o.grade() == Grade::Wrong).count();
        let ratio: Vec<f64> = seen.iter().filter_map(|o| o.falls()).map(|(p, a)| p / a).collect();
        let bias: Vec<(f64, f64)> = seen.iter().filter_map(|o| o.gc_bias()).collect();
        let percent = |v: Vec<f64>| median(&v).map_or("–".into(), |m| format!("{:.1} %", 100.0 * m));
        let _ = writeln!(
            text,
            "| {effect} | {} | {} | {} | {} | {} | {} | {unseen_wrong} | {} | {} | {} |",
            all.len(),
            seen.len(),
            count(Grade::Right),
            count(Grade::Extra),
            count(Grade::Abstained) + count(Grade::None),
            count(Grade::Wrong),
            median(&ratio).map_or("–".into(), |m| format!("{m:.2}")),
            percent(bias.iter().map(|b| b.0.abs()).collect()),
            percent(bias.iter().map(|b| b.1.abs()).collect()),
        );
    }
    text.push('\n');
    text
}

/// One line per case.
fn list(outcomes: &[Outcome], title: &str, which: impl Fn(&Outcome) -> bool) -> String {
    let mut text = format!(
        "## {title}\n\n| case | protocol | hidden (strength; signal) | verdict | named | reduced χ² before → after | \
         Gc error before → after |\n|---|---|---|---|---|---|---|\n"
    );
    for o in outcomes.iter().filter(|o| which(o)) {
        let t = &o.truth;
        let hidden: Vec<String> = t
            .effects
            .iter()
            .zip(&t.strengths)
            .map(|(e, s)| format!("{e} ({s}; {:.0})", o.signal(e)))
            .collect();
        let ends = |f: &dyn Fn(&crate::outcome::Step) -> f64| match (o.ladder.first(), o.ladder.last()) {
            (Some(a), Some(b)) => (f(a), f(b)),
            _ => (f64::NAN, f64::NAN),
        };
        let (before, after) = ends(&|s| s.reduced_chi2_total);
        let (gc0, gc1) = o.gc_bias().unwrap_or((f64::NAN, f64::NAN));
        let _ = writeln!(
            text,
            "| {} | {:?} | {} | {} | {} | {before:.2} → {after:.2} | {:.1} % → {:.1} % |",
            t.name,
            t.protocol,
            if hidden.is_empty() { "–".into() } else { hidden.join(" + ") },
            if o.verdict.is_empty() { "–" } else { &o.verdict },
            names(&o.groups),
            100.0 * gc0,
            100.0 * gc1
        );
    }
    text.push('\n');
    text
}

/// One line per case with one thing hidden, with what is stated.
pub fn stated<'a>(outcomes: impl IntoIterator<Item = &'a Outcome>) -> String {
    let mut text = String::from(
        "| case | protocol | hidden (strength; signal) | verdict | named | most probable | something else | rest |\n\
         |---|---|---|---|---|---|---|---|\n",
    );
    for o in outcomes {
        let (t, effect) = (&o.truth, &o.truth.effects[0]);
        let first = o.stated.iter().flat_map(|s| &s.effects).max_by(|a, b| a.1.total_cmp(b.1));
        let percent = |p: Option<f64>| p.map_or("–".into(), |p| format!("{:.0} %", 100.0 * p));
        let _ = writeln!(
            text,
            "| {} | {:?} | {effect} ({}; {:.0}) | {} | {} | {} | {} | {} |",
            t.name,
            t.protocol,
            t.strengths[0],
            o.signal(effect),
            if o.verdict.is_empty() { "–" } else { &o.verdict },
            names(&o.groups),
            first.map_or("–".into(), |(e, p)| format!("{e} {:.0} %", 100.0 * p)),
            percent(o.stated.as_ref().map(|s| s.something_else)),
            o.stated.as_ref().map_or("–".into(), |s| format!("{:.1} %", 100.0 * s.rest)),
        );
    }
    text.push('\n');
    text
}
