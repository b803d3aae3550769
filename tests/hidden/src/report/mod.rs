//! docs/hidden.md from the results. Every number in it is counted here.

mod beside;
mod criteria;
mod foreign;
mod left_out;
mod matrix;
mod misses;
mod scores;
mod tables;
#[cfg(test)]
mod tests;

pub use beside::Beside;

use crate::forward::Fineness;
use crate::outcome::{End, Outcome};
use std::fmt::Write as _;

/// What the study is, how its numbers are defined, what it does not show.
const ABOUT: &str = include_str!("about.md");

/// What else is tested on records whose truth is known.
const BESIDES: &str = include_str!("besides.md");

/// How the answers came about.
pub struct Study {
    /// Arguments that make and answer these cases.
    pub command: String,
    /// Commit of the program that answered.
    pub commit: Option<String>,
    /// Cases that were asked for.
    pub planned: usize,
    /// Their meshes.
    pub fineness: Fineness,
    /// Answers to cases whose effect was taken from the catalogue.
    pub left_out: Vec<Outcome>,
}

/// The whole page.
pub fn page(outcomes: &[Outcome], study: &Study, beside: Option<&Beside>) -> String {
    let mut text = format!("# Records with a hidden effect{}\n\n", study.fineness.strips);
    text.push_str(&state(outcomes, study, beside));
    text.push_str(&ABOUT.replace("{meshes}", &meshes(&study.fineness)));
    text.push_str(&criteria::section(outcomes, beside));
    text.push_str(&scores::section(outcomes, beside));
    text.push_str(&matrix::section(outcomes));
    text.push_str(&tables::section(outcomes));
    text.push_str(&foreign::section(outcomes));
    text.push_str(&left_out::section(&study.left_out));
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
fn state(outcomes: &[Outcome], study: &Study, beside: Option<&Beside>) -> String {
    let by = study.commit.as_ref().map_or(String::new(), |c| format!(" by the program of commit {c}"));
    let mut text = format!(
        "Written by `cargo run --release -p hidden-suite {}`{by}; do not edit by hand. Results of **{} of {}** cases",
        study.command,
        outcomes.len(),
        study.planned
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
    if outcomes.len() < study.planned {
        let _ = write!(text, "These are the cases {}; the others were not asked.\n\n", numbers(outcomes));
    }
    if let Some(b) = beside {
        let seconds: Vec<f64> = b.outcomes.iter().map(|o| o.seconds).collect();
        let _ = write!(
            text,
            "Beside it {} on {} of the same records ({:.0} s in the middle): it states no probabilities, so each group \
             that it names counts as 95 % in even shares, and every effect else as an even share of the rest.\n\n",
            b.name,
            b.outcomes.len(),
            median(&seconds).unwrap_or(f64::NAN)
        );
    }
    text
}

/// Rows of a table: what the records were computed on, and what they are fitted on.
fn meshes(f: &Fineness) -> String {
    let counted = |n: usize, one: &str, more: &str| {
        if n == 1 { format!("one {one}") } else { format!("{n} {more}") }
    };
    format!(
        "| mesh of the records | {} mm and {} mm, {}, or a uniform grid; sizes ±10 %; more steps; nodal integration of the \
         tear path |\n| mesh of the fit | {} mm and {} mm, one layer, Gauss points, {}; its nodes are not the records' |",
        f.bulk,
        f.path,
        counted(f.layers, "layer", "layers"),
        f.fit.bulk,
        f.fit.path,
        counted(f.fit.areas, "area", "areas")
    )
}

/// Numbers of cases.
fn numbers(outcomes: &[Outcome]) -> String {
    let number = |o: &Outcome| o.truth.name.trim_start_matches("case-").trim_start_matches('0').to_owned();
    outcomes.iter().map(number).collect::<Vec<_>>().join(", ")
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
    outcomes.iter().filter(|o| o.truth.effects.len() == 1 && o.truth.is_known()).collect()
}

/// Those of them that the record can see.
pub(crate) fn visible_singles(outcomes: &[Outcome]) -> Vec<&Outcome> {
    outcomes.iter().filter(|o| o.is_visible_single()).collect()
}

/// Names of a group or of several, for a cell.
pub(crate) fn names(groups: &[Vec<String>]) -> String {
    if groups.is_empty() {
        return "no name".into();
    }
    groups.iter().map(|g| g.join(" or ")).collect::<Vec<_>>().join(" + ")
}
