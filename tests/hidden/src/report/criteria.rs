//! The conditions under which the study counts as passed (issue 3), with what was measured.

use super::{median, share, singles, visible_singles};
use crate::outcome::{Grade, Outcome};
use std::fmt::Write as _;

struct Row {
    what: &'static str,
    wanted: String,
    measured: String,
    met: Option<bool>,
}

/// A rate that must reach `least`.
fn at_least(what: &'static str, part: usize, whole: usize, least: f64) -> Row {
    let met = (whole > 0).then_some(part as f64 >= least * whole as f64);
    Row { what, wanted: format!("≥ {:.0} %", 100.0 * least), measured: share(part, whole), met }
}

/// A rate that must not exceed `most`.
fn at_most(what: &'static str, part: usize, whole: usize, most: f64) -> Row {
    let met = (whole > 0).then_some(part as f64 <= most * whole as f64);
    Row { what, wanted: format!("≤ {:.0} %", 100.0 * most), measured: share(part, whole), met }
}

/// A rate of which nothing is asked.
fn count_of(what: &'static str, part: usize, whole: usize) -> Row {
    Row { what, wanted: "–".into(), measured: share(part, whole), met: None }
}

/// A median departure that must not exceed `most`.
fn median_at_most(what: &'static str, values: &[f64], most: f64, note: &str) -> Row {
    let m = median(values);
    let measured = m
        .map_or("none to count".into(), |m| format!("{:.1} % (median of {}{note})", 100.0 * m, values.len()));
    Row { what, wanted: format!("≤ {:.0} %", 100.0 * most), measured, met: m.map(|m| m <= most) }
}

/// The table.
pub fn section(outcomes: &[Outcome]) -> String {
    let mut text =
        String::from("## Criteria\n\n| criterion | wanted | measured | met |\n|---|---|---|---|\n");
    for r in rows(outcomes) {
        let met = match r.met {
            Some(true) => "yes",
            Some(false) => "**no**",
            None => "–",
        };
        let _ = writeln!(text, "| {} | {} | {} | {met} |", r.what, r.wanted, r.measured);
    }
    let seen = visible_singles(outcomes);
    let sizes: Vec<usize> = seen
        .iter()
        .filter_map(|o| o.groups.iter().find(|g| g.iter().any(|e| o.truth.effects.contains(e))).map(Vec::len))
        .collect();
    let of = |k: usize| sizes.iter().filter(|s| **s == k).count();
    let more = sizes.iter().filter(|s| **s > 3).count();
    let _ = writeln!(
        text,
        "\nVisible: {} of {} cases with one effect. Where the truth was named it stood alone in {}, in a group of \
         two in {}, of three in {}, of more in {more}.\n",
        seen.len(),
        singles(outcomes).len(),
        of(1),
        of(2),
        of(3)
    );
    text
}

fn rows(outcomes: &[Outcome]) -> Vec<Row> {
    let seen = visible_singles(outcomes);
    let n = seen.len();
    let count = |f: &dyn Fn(&Outcome) -> bool| seen.iter().filter(|o| f(o)).count();
    let none: Vec<&Outcome> = outcomes.iter().filter(|o| o.truth.effects.is_empty()).collect();
    let alarms = none.iter().filter(|o| !o.found.is_empty()).count();
    let open = none.iter().filter(|o| o.verdict == "unexplained").count();
    let outside: Vec<&Outcome> = outcomes.iter().filter(|o| o.truth.is_outside() && o.visible()).collect();
    let honest = outside.iter().filter(|o| o.is_honest()).count();
    let wrong = outside.iter().filter(|o| !o.is_honest() && !o.found.is_empty()).count();
    let none_named = outside.iter().filter(|o| o.found.is_empty()).count();
    let pairs: Vec<&Outcome> =
        outcomes.iter().filter(|o| o.truth.effects.len() == 2 && o.visible()).collect();
    let both = pairs.iter().filter(|o| matches!(o.grade(), Grade::Right | Grade::Extra)).count();
    let falls: Vec<f64> = seen
        .iter()
        .filter_map(|o| o.falls())
        .filter(|f| f.1 > 0.0)
        .map(|(predicted, actual)| (predicted / actual - 1.0).abs())
        .collect();
    let bias: Vec<(f64, f64)> = seen
        .iter()
        .filter(|o| matches!(o.grade(), Grade::Right | Grade::Extra))
        .filter_map(|o| o.gc_bias())
        .collect();
    let tangent: Vec<&Outcome> = singles(outcomes).into_iter().filter(|o| o.truth.visible()).collect();
    let first = tangent.iter().filter(|o| o.first()).count();
    let three = tangent.iter().filter(|o| o.among_first_three()).count();
    let two: Vec<&Outcome> =
        outcomes.iter().filter(|o| o.truth.effects.len() == 2 && o.truth.visible()).collect();
    let both_of_two = two.iter().filter(|o| matches!(o.grade(), Grade::Right | Grade::Extra)).count();
    let before: Vec<f64> = bias.iter().map(|b| b.0.abs()).collect();
    let after: Vec<f64> = bias.iter().map(|b| b.1.abs()).collect();
    let was = median(&before).map_or(String::new(), |m| format!("; {:.1} % before", 100.0 * m));
    vec![
        at_least("visible effect, or its stated group, first", count(&Outcome::first), n, 0.9),
        at_least("visible effect among the first three", count(&Outcome::among_first_three), n, 0.98),
        at_most("false alarms on records without effect", alarms, none.len(), 0.05),
        at_most("the same, called unexplained", open, none.len(), 0.05),
        at_least("visible outside effects `unexplained` or `ambiguous`", honest, outside.len(), 0.8),
        count_of("the same, explained by a wrong name", wrong, outside.len()),
        count_of("the same, given no name at all", none_named, outside.len()),
        at_least("visible pairs, both found", both, pairs.len(), 0.7),
        median_at_most("predicted against actual Δχ²", &falls, 0.25, ""),
        median_at_most("error of Gc after adding the effect", &after, 0.03, &was),
        at_least("effects visible by the tangent's estimate, first", first, tangent.len(), 0.9),
        at_least("the same, among the first three", three, tangent.len(), 0.98),
        at_least("pairs visible by the tangent's estimate, both found", both_of_two, two.len(), 0.7),
    ]
}
