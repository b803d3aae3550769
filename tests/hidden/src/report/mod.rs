//! docs/hidden.md from the results. Every number in it is counted here.

mod criteria;
mod matrix;
mod misses;
mod scores;
mod tables;

use crate::outcome::{End, Outcome};
use std::fmt::Write as _;

/// What the study is, how its numbers are defined, what it does not show.
const ABOUT: &str = include_str!("about.md");

/// What else is tested on records whose truth is known.
const BESIDES: &str = include_str!("besides.md");

/// The whole page. `planned`: cases that were asked for.
pub fn page(outcomes: &[Outcome], planned: usize) -> String {
    let mut text = String::from("# Records with a hidden effect\n\n");
    text.push_str(&state(outcomes, planned));
    text.push_str(ABOUT);
    text.push_str(&criteria::section(outcomes));
    text.push_str(&scores::section(outcomes));
    text.push_str(&matrix::section(outcomes));
    text.push_str(&tables::section(outcomes));
    text.push_str(&misses::section(outcomes));
    text.push_str(BESIDES);
    text.lines().flat_map(folded).map(|line| line + "\n").collect()
}

/// Longest line outside of tables, bytes.
const WIDTH: usize = 118;

/// A line of prose or of a list as lines of at most [`WIDTH`] bytes; a row of a table as it is.
fn folded(line: &str) -> Vec<String> {
    let indent = if line.starts_with("- ") { "  " } else { "" };
    if line.len() <= WIDTH || line.starts_with('|') {
        return vec![line.to_owned()];
    }
    let mut lines: Vec<String> = Vec::new();
    for word in line.split(' ') {
        match lines.last_mut() {
            Some(last) if last.len() + 1 + word.len() <= WIDTH => *last += &format!(" {word}"),
            Some(_) => lines.push(format!("{indent}{word}")),
            None => lines.push(word.to_owned()),
        }
    }
    lines
}

/// How much of the study these numbers are.
fn state(outcomes: &[Outcome], planned: usize) -> String {
    let mut text = format!(
        "Written by `just hidden` (`cargo run --release -p hidden-suite -- all`); do not edit by hand. Results of \
         **{} of {planned}** cases",
        outcomes.len()
    );
    let ended = |f: fn(&End) -> bool| outcomes.iter().filter(|o| f(&o.end)).count();
    let late = ended(|e| *e == End::TimeLimit);
    let failed = ended(|e| matches!(e, End::Failed(_)));
    let _ = write!(text, "; {late} stopped by the time limit, {failed} failed");
    let seconds: Vec<f64> = outcomes.iter().map(|o| o.seconds).collect();
    if let (Some(m), Some(most)) = (median(&seconds), seconds.iter().copied().reduce(f64::max)) {
        let _ = write!(text, ". A diagnosis took {m:.0} s (median; {most:.0} s at most) on one thread");
    }
    text.push_str(".\n\n");
    text
}

/// Median; `None` of nothing.
pub(crate) fn median(values: &[f64]) -> Option<f64> {
    let mut v: Vec<f64> = values.iter().copied().filter(|x| x.is_finite()).collect();
    v.sort_by(f64::total_cmp);
    let n = v.len();
    (n > 0).then(|| 0.5 * (v[(n - 1) / 2] + v[n / 2]))
}

/// `3 of 4 (75 %)`.
pub(crate) fn share(part: usize, whole: usize) -> String {
    if whole == 0 {
        return "none to count".into();
    }
    format!("{part} of {whole} ({:.0} %)", 100.0 * part as f64 / whole as f64)
}

/// Cases with one effect of the catalogue.
pub(crate) fn singles(outcomes: &[Outcome]) -> Vec<&Outcome> {
    outcomes.iter().filter(|o| o.truth.effects.len() == 1 && !o.truth.is_outside()).collect()
}

/// Those of them that the record can see.
pub(crate) fn visible_singles(outcomes: &[Outcome]) -> Vec<&Outcome> {
    singles(outcomes).into_iter().filter(|o| o.visible()).collect()
}

/// Names of a group or of several, for a cell.
pub(crate) fn names(groups: &[Vec<String>]) -> String {
    if groups.is_empty() {
        return "no name".into();
    }
    groups.iter().map(|g| g.join(" or ")).collect::<Vec<_>>().join(" + ")
}
