//! The second axis of a test: its columns, and its displacement over that of the first.

use super::section::Section;
use crate::case::Record;
use crate::diagnostics::Report;
use crate::experiment::TestKind;
use crate::keys::plain;

/// Largest departure of the second displacement from its share of the first, over the larger of both ranges.
const APART: f64 = 0.02;

/// Displacement along x over that along y: by the record, else by the file. What does not fit the experiment is an error.
pub(super) fn ratio(s: &Section<'_>, kind: TestKind, record: Option<&Record>) -> f64 {
    let given = s.number("ratio_x");
    if !kind.two_axes {
        refuse(s, kind, record);
        return given;
    }
    let Some(record) = record else { return given };
    if s.entry("ratio_x").is_some() {
        s.fault("ratio_x", "`ratio_x` stands beside `data`; the record says it, leave the key out");
    }
    match (&record.displacement_x, &record.force_x) {
        (Some(across), Some(_)) => by_record(s, record, across),
        (across, force) => {
            let missing = [("displacement_x_mm", across.is_none()), ("force_x_N", force.is_none())];
            let names: Vec<&str> = missing.iter().filter(|m| m.1).map(|m| m.0).collect();
            let message = format!(
                "the record lacks {}; a `{}` test has two actuators and two load cells",
                names.join(" and "),
                kind.word()
            );
            data_fault(s, message, "columns time_s,displacement_mm,force_N,displacement_x_mm,force_x_N");
            given
        }
    }
}

/// A second axis where the experiment has one.
fn refuse(s: &Section<'_>, kind: TestKind, record: Option<&Record>) {
    for key in ["ratio_x", "force_x_sd"] {
        if s.entry(key).is_some() {
            s.fault(key, format!("`{}`: a `{}` test has one axis", s.spelling(key), kind.word()));
        }
    }
    let Some(record) = record else { return };
    for (column, given) in
        [("displacement_x_mm", record.displacement_x.is_some()), ("force_x_N", record.force_x.is_some())]
    {
        if given {
            let message = format!("column `{column}` of a {} test: it has one axis", kind.word());
            data_fault(s, message, "leave the column out, or give the kind of the test that was done");
        }
    }
}

fn data_fault(s: &Section<'_>, message: String, help: &str) {
    let span = s.entry("data").map_or(s.span.clone(), |e| e.item.span());
    s.context.report(Report::error(message).key("data").help(help), span);
}

/// The ratio by least squares; a record that leaves it is an error.
fn by_record(s: &Section<'_>, record: &Record, across: &[f64]) -> f64 {
    let along = &record.displacement;
    let square: f64 = along.iter().map(|u| u * u).sum();
    let ratio =
        if square > 0.0 { along.iter().zip(across).map(|(u, x)| u * x).sum::<f64>() / square } else { 0.0 };
    let range = along.iter().chain(across).fold(0.0f64, |m, u| m.max(u.abs()));
    let off = |k: &usize| (across[*k] - ratio * along[*k]).abs() > APART * range;
    if let Some(k) = (0..along.len().min(across.len())).find(off) {
        let message = format!(
            "`displacement_x_mm` is {} at {} s, where `displacement_mm` is {}; expected {} times that, as in the whole record",
            plain(across[k]),
            plain(record.time[k]),
            plain(along[k]),
            plain((1e4 * ratio).round() / 1e4)
        );
        data_fault(
            s,
            message,
            "one ratio of the displacements is one test: cut the record where the ratio changes",
        );
    }
    ratio
}
