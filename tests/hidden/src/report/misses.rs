//! Every answer that was not right where it could have been, with what the search saw.

use super::names;
use crate::outcome::{End, Grade, Outcome, Step};
use std::fmt::Write as _;

/// Whether a case belongs on the list.
fn missed(o: &Outcome) -> bool {
    let t = &o.truth;
    if t.is_outside() {
        return o.visible() && !o.is_honest();
    }
    if t.foreign().is_some() {
        return super::foreign::names_another(o);
    }
    match o.grade() {
        Grade::Right => false,
        Grade::Abstained | Grade::Part => o.visible(),
        // A wrong or surplus name is a miss whether or not the record could see the truth.
        _ => true,
    }
}

/// The list.
pub fn section(outcomes: &[Outcome]) -> String {
    let mut text = String::from(
        "## Misses\n\nVisible effects that were not named, alone or in their group, or only one of a pair; names that are \
         not true, visible or not; visible outside effects that were answered neither `unexplained` nor `ambiguous`; \
         foreign laws with the name of another kind.\n\n",
    );
    let list: Vec<&Outcome> = outcomes.iter().filter(|o| missed(o)).collect();
    for o in &list {
        let t = &o.truth;
        let hidden: Vec<String> =
            t.effects.iter().zip(&t.strengths).map(|(e, s)| format!("{e} × {s}")).collect();
        let _ = writeln!(
            text,
            "- **{}** ({:?}, {}, signal {}): {} {}. {}",
            t.name,
            t.protocol,
            if hidden.is_empty() { "no effect".into() } else { hidden.join(" + ") },
            signals(o),
            o.verdict,
            names(&o.groups),
            reason(o)
        );
    }
    text.push_str(if list.is_empty() { "None.\n\n" } else { "\n" });
    text
}

/// What no base parameter imitates of each hidden effect; by the tangent where that was not measured.
fn signals(o: &Outcome) -> String {
    let one = |e: &String| format!("{:.1}", o.signal(e));
    let all: Vec<String> = o.truth.effects.iter().map(one).collect();
    if all.is_empty() { "none".into() } else { all.join(" and ") }
}

/// What the search saw of the truth, and of what it chose instead.
fn reason(o: &Outcome) -> String {
    match &o.end {
        End::Failed(why) => return format!("No answer: {why}."),
        End::TimeLimit => return "Stopped by the time limit.".into(),
        End::Answered => {}
    }
    let mut parts: Vec<String> = Vec::new();
    let truth: Vec<&String> = o.truth.effects.iter().filter(|e| !e.starts_with("outside:")).collect();
    for e in &truth {
        parts.push(screened(o, e));
    }
    if !truth.is_empty() {
        parts.push(match o.step(&o.truth.effects) {
            Some(s) => format!("refitted: {}", step(s)),
            None => match o.failed.iter().find(|f| f.0 == o.truth.effects) {
                Some((_, why)) => format!("its refit failed ({why})"),
                None => "never refitted".into(),
            },
        });
    }
    if let (Some(base), Some(last)) = (o.ladder.first(), o.ladder.last()) {
        parts.push(format!("base: {}", step(base)));
        if !o.found.is_empty() {
            parts.push(format!("chosen {}: {}", o.found.join(" + "), step(last)));
        }
    }
    format!("{}.", capital(&parts.join("; ")))
}

fn screened(o: &Outcome, effect: &str) -> String {
    match (o.place(effect), o.screen.iter().find(|r| r.effect == effect)) {
        (Some(place), Some(r)) => format!(
            "{effect} at place {place} of the screen (fall {:.1}, q {:.0e}, plausible amplitude {:.1} sd{}{})",
            r.fall,
            r.q_value,
            r.snr,
            if r.significant { "" } else { ", not significant" },
            if r.refit_only { ", by short refit" } else { "" }
        ),
        _ => format!("{effect} not on the screen"),
    }
}

fn step(s: &Step) -> String {
    let held = s.held_out_chi2.map_or(String::new(), |h| format!(", held out {h:.2}"));
    let shape = if s.explained { "explained" } else { "not explained" };
    format!(
        "χ² {:.2}, BIC {:.0}{held}, structure p {:.0e}, {shape}",
        s.reduced_chi2_total, s.bic, s.structure_p
    )
}

fn capital(text: &str) -> String {
    let mut chars = text.chars();
    chars.next().map_or(String::new(), |c| c.to_uppercase().chain(chars).collect())
}
