//! What is answered where the catalogue lacks what is hidden.

use super::{names, share};
use crate::outcome::Outcome;
use std::fmt::Write as _;

/// Probability from which on a name is a statement.
const SURE: f64 = 0.95;

/// The section; nothing where nothing was left out.
pub fn section(left_out: &[Outcome]) -> String {
    if left_out.is_empty() {
        return String::new();
    }
    let wrong = left_out.iter().filter(|o| sure(o).is_some()).count();
    let mut text = format!(
        "## One effect left out of the catalogue\n\nVisible single effects, each answered once more by a catalogue without \
         it (`-- leave-out`). Another effect was stated with {:.0} % or more in {} (wanted: at most 5 %).\n\n| case | \
         protocol | hidden (strength; signal) | verdict | named | most probable | something else | rest |\n\
         |---|---|---|---|---|---|---|---|\n",
        100.0 * SURE,
        share(wrong, left_out.len())
    );
    for o in left_out {
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

/// An effect that is stated for sure.
fn sure(o: &Outcome) -> Option<&String> {
    o.stated.as_ref()?.effects.iter().find(|(_, p)| **p >= SURE).map(|(e, _)| e)
}
