//! What is wrong with rows, all of it at once: what is dropped by rule, what is kept and told, what must be mended.

use crate::choices::{Choices, FaultKind};
use crate::error::{Fault, visible};
use crate::rows::{Bad, Rows, Unread};
use serde::Serialize;

/// Faults of one kind that do not keep the file from being a record.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Found {
    /// Which.
    pub kind: FaultKind,
    /// How many.
    pub count: usize,
    /// Rows of the file, from 1; the first of them.
    pub rows: Vec<u32>,
    /// What was done: `dropped` or `kept`.
    pub rule: &'static str,
    /// What was seen.
    pub what: String,
    /// The flag or edit for another rule.
    pub remedy: String,
}

/// Rows that are listed.
const LISTED: usize = 12;
/// Share of rows without a value that is dropped without being asked.
const FEW: f64 = 0.05;

pub(crate) fn found(kind: FaultKind, rows: &[u32], dropped: bool, what: String, remedy: &str) -> Found {
    let rule = if dropped { "dropped" } else { "kept" };
    let listed = rows.iter().copied().take(LISTED).collect();
    Found { kind, count: rows.len(), rows: listed, rule, what, remedy: remedy.to_owned() }
}

/// Rows whose cells were not read: dropped where blank and few, or where the user says so; else faults.
pub(crate) fn unread(
    rows: &mut Rows,
    unread: &Unread,
    choices: &Choices,
    out: &mut Vec<Found>,
) -> Vec<Fault> {
    let mut faults = Vec::new();
    let mut keep = vec![true; rows.len()];
    let numbers = |bad: &[Bad]| {
        let mut numbers: Vec<u32> = bad.iter().map(|b| rows.row[b.at]).collect();
        numbers.dedup();
        numbers
    };
    let missing = numbers(&unread.missing);
    if !missing.is_empty() {
        if missing.len() as f64 > FEW * rows.len() as f64 && !choices.drop.contains(&FaultKind::Missing) {
            faults.extend(each(
                rows,
                &unread.missing,
                |b| match b.cell.as_str() {
                    "" => format!("`{}` is blank", visible(&b.name)),
                    cell => format!("`{}` is `{}`", visible(&b.name), visible(cell)),
                },
                "fill the cell, or say --drop missing to leave such rows out",
            ));
        }
        unread.missing.iter().for_each(|b| keep[b.at] = false);
        let what = format!("{} without a value in a needed column", counted(missing.len(), "row"));
        out.push(found(FaultKind::Missing, &missing, true, what, "fill the cells in the file"));
    }
    let unreadable = numbers(&unread.unreadable);
    if !unreadable.is_empty() {
        if choices.drop.contains(&FaultKind::Unreadable) {
            unread.unreadable.iter().for_each(|b| keep[b.at] = false);
            let what = format!("{} with text where a number should be", counted(unreadable.len(), "row"));
            out.push(found(FaultKind::Unreadable, &unreadable, true, what, "correct the cells in the file"));
        } else {
            faults.extend(each(
                rows,
                &unread.unreadable,
                |b| format!("`{}` is `{}`; expected a number", visible(&b.name), visible(&b.cell)),
                "correct the cell, or say --drop unreadable to leave such rows out",
            ));
        }
    }
    if faults.is_empty() {
        rows.keep(&keep);
    }
    faults
}

/// One fault per cell, the first of them; the rest counted.
fn each(rows: &Rows, bad: &[Bad], message: impl Fn(&Bad) -> String, remedy: &str) -> Vec<Fault> {
    let fault = |b: &Bad| Fault {
        row: Some(rows.row[b.at] as usize),
        column: Some(b.column),
        message: message(b),
        remedy: remedy.to_owned(),
    };
    let mut out: Vec<Fault> = bad.iter().take(LISTED).map(fault).collect();
    if bad.len() > LISTED {
        out.push(Fault {
            row: None,
            column: None,
            message: format!("… and {} more such cells", bad.len() - LISTED),
            remedy: remedy.to_owned(),
        });
    }
    out
}

/// `1 row`, `3 rows`.
pub(crate) fn counted(n: usize, what: &str) -> String {
    format!("{n} {what}{}", if n == 1 { "" } else { "s" })
}
