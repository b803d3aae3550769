//! What is asked of the answers, with what was measured.

use super::{Beside, median, scores, share, singles, visible_singles};
use crate::outcome::{Grade, Outcome, Stated};
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
pub fn section(outcomes: &[Outcome], beside: Option<&Beside>) -> String {
    let mut text = String::from("## Criteria\n\n| criterion | wanted | measured | met |");
    let other = beside.map(|b| rows(&b.outcomes));
    text += &beside.map_or(String::new(), |b| format!(" {} |", b.name));
    text += if beside.is_some() { "\n|---|---|---|---|---|\n" } else { "\n|---|---|---|---|\n" };
    for (k, r) in rows(outcomes).iter().enumerate() {
        let met = match r.met {
            Some(true) => "yes",
            Some(false) => "**no**",
            None => "–",
        };
        let its = other.as_ref().map_or(String::new(), |o| format!(" {} |", o[k].measured));
        let _ = writeln!(text, "| {} | {} | {} | {met} |{its}", r.what, r.wanted, r.measured);
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
    let mut rows = names(outcomes);
    rows.extend(statements(outcomes));
    rows.extend(outside(outcomes));
    rows.extend(gc(outcomes));
    rows
}

/// What was named.
fn names(outcomes: &[Outcome]) -> Vec<Row> {
    let seen = visible_singles(outcomes);
    let known: Vec<&Outcome> = outcomes.iter().filter(|o| o.truth.is_known()).collect();
    let wrong = known.iter().filter(|o| matches!(o.grade(), Grade::Wrong | Grade::Extra)).count();
    let none: Vec<&&Outcome> = known.iter().filter(|o| o.truth.effects.is_empty()).collect();
    let alarms = none.iter().filter(|o| !o.found.is_empty()).count();
    let pairs: Vec<&&Outcome> = known.iter().filter(|o| o.truth.effects.len() == 2 && o.visible()).collect();
    let both = pairs.iter().filter(|o| matches!(o.grade(), Grade::Right | Grade::Extra)).count();
    let first = seen.iter().filter(|o| o.first()).count();
    let three = seen.iter().filter(|o| o.among_first_three()).count();
    vec![
        at_least("visible effect, or its stated group, first", first, seen.len(), 0.95),
        count_of("visible effect among the first three", three, seen.len()),
        at_most("a name on records without effect", alarms, none.len(), 0.03),
        at_most("a name that is not true, of all cases of the catalogue", wrong, known.len(), 0.02),
        at_least("visible pairs, both found", both, pairs.len(), 0.75),
    ]
}

/// What was stated with 90 % or more.
fn statements(outcomes: &[Outcome]) -> Vec<Row> {
    let (mut all, mut right) = (0, 0);
    for o in outcomes.iter().filter(|o| o.truth.is_known()) {
        for effect in scores::said(o) {
            all += 1;
            right += usize::from(o.truth.effects.contains(effect));
        }
    }
    vec![at_least("of effects stated with 90 % or more, true", right, all, 0.9)]
}

/// What the catalogue does not hold.
fn outside(outcomes: &[Outcome]) -> Vec<Row> {
    let all: Vec<&Outcome> = outcomes.iter().filter(|o| o.truth.is_outside()).collect();
    let told = all.iter().filter(|o| scores::said(o).next().is_some()).count();
    let seen: Vec<&&Outcome> = all.iter().filter(|o| o.visible()).collect();
    let honest = seen.iter().filter(|o| o.is_honest()).count();
    let none = seen.iter().filter(|o| o.found.is_empty()).count();
    vec![
        at_most("outside effects given a name with 90 % or more", told, all.len(), 0.05),
        count_of("visible outside effects `unexplained` or `ambiguous`", honest, seen.len()),
        count_of("the same, given no name at all", none, seen.len()),
    ]
}

/// Gc with the ends of an interval, where an answer states them.
type Interval = fn(&Stated) -> Option<[f64; 3]>;

/// How often an interval of Gc holds the truth where something is hidden, and how wide it is.
fn inside(outcomes: &[Outcome], what: &'static str, (least, of): (f64, Interval)) -> Row {
    let hidden = outcomes.iter().filter(|o| !o.truth.effects.is_empty());
    let stated: Vec<(&Outcome, [f64; 3])> =
        hidden.filter_map(|o| Some((o, of(o.stated.as_ref()?)?))).collect();
    let held = stated.iter().filter(|(o, gc)| scores::inside(o, *gc)).count();
    let widths: Vec<f64> = stated.iter().map(|(o, gc)| scores::half_width(o, *gc)).collect();
    let wide = median(&widths).map_or(String::new(), |w| format!(", ± {:.1} % (median)", 100.0 * w));
    let row = at_least(what, held, stated.len(), least);
    Row { measured: row.measured + &wide, ..row }
}

/// Gc with and without what is missing.
fn gc(outcomes: &[Outcome]) -> Vec<Row> {
    let found: Vec<(f64, f64)> = visible_singles(outcomes)
        .into_iter()
        .filter(|o| matches!(o.grade(), Grade::Right | Grade::Extra))
        .filter_map(Outcome::gc_bias)
        .collect();
    let before: Vec<f64> = found.iter().map(|b| b.0.abs()).collect();
    let after: Vec<f64> = found.iter().map(|b| b.1.abs()).collect();
    let was = median(&before).map_or(String::new(), |m| format!("; {:.1} % before", 100.0 * m));
    vec![
        inside(
            outcomes,
            "true Gc inside the base model's 95 % interval, something hidden",
            (0.85, |s| s.base_gc),
        ),
        inside(
            outcomes,
            "true Gc inside the interval averaged over what may be missing, something hidden",
            (0.85, |s| s.averaged_gc),
        ),
        median_at_most("error of Gc after adding the effect", &after, 0.03, &was),
    ]
}
