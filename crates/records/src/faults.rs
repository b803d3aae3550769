//! What is wrong with rows, all of it at once: what is dropped by rule, what is kept and told, what must be mended.

use crate::choices::{Choices, FaultKind, Restart};
use crate::error::{Fault, Question, visible};
use crate::noise;
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
/// Rows that may stand before the clock goes on.
const HICCUP: usize = 3;

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

/// Parts of a file between starts of its clock, each with strictly increasing time.
///
/// # Errors
/// A question where the clock starts again and the user has not said what that means.
pub(crate) fn clock(rows: &mut Rows, choices: &Choices, out: &mut Vec<Found>) -> Result<Vec<Rows>, Question> {
    let t = rows.time.clone();
    let mut keep = vec![false; t.len()];
    let mut starts = vec![0_usize];
    let (mut repeated, mut twice, mut backward) = (Vec::new(), 0, Vec::new());
    // The last two kept rows of this part.
    let (mut before, mut last): (Option<usize>, Option<usize>) = (None, None);
    let mut i = 0;
    while i < t.len() {
        let Some(l) = last else {
            keep[i] = true;
            last = Some(i);
            i += 1;
            continue;
        };
        if t[i] > t[l] {
            keep[i] = true;
            (before, last) = (last, Some(i));
        } else if t[i] == t[l] {
            repeated.push(rows.row[i]);
            twice +=
                usize::from(rows.force[i] == rows.force[l] && rows.displacement[i] == rows.displacement[l]);
        } else if before.is_some_and(|b| t[i] > t[b]) {
            // The row before was the one that jumped ahead.
            keep[l] = false;
            backward.push(rows.row[l]);
            keep[i] = true;
            last = Some(i);
        } else {
            let stay = t[i..].iter().take(HICCUP + 1).take_while(|x| **x <= t[l]).count();
            if stay <= HICCUP && i + stay < t.len() {
                backward.extend(rows.row[i..i + stay].iter());
                i += stay;
                continue;
            }
            starts.push(i);
            keep[i] = true;
            (before, last) = (None, Some(i));
        }
        i += 1;
    }
    if !repeated.is_empty() {
        let what = format!(
            "{} at the time of the row before ({} the same in all, of the others the first is kept)",
            counted(repeated.len(), "row"),
            twice
        );
        out.push(found(FaultKind::Repeated, &repeated, true, what, "export the time with more digits"));
    }
    if !backward.is_empty() {
        let what = format!("{} out of the order of time", counted(backward.len(), "row"));
        out.push(found(FaultKind::Backward, &backward, true, what, "correct the times in the file"));
    }
    if starts.len() > 1 && choices.restart.is_none() {
        let rows: Vec<String> = starts[1..].iter().take(5).map(|s| rows.row[*s].to_string()).collect();
        let more = if starts.len() > 6 { ", …" } else { "" };
        let what = format!("the clock starts again in row {}{more}: {} parts", rows.join(", "), starts.len());
        return Err(Question::new(
            "restart",
            what,
            vec![
                ("split".into(), "every part is a test of its own".into()),
                ("append".into(), "one test: each part goes on where the last one ended".into()),
            ],
        ));
    }
    // Positions of the starts among the rows that stay.
    let kept_before = |at: usize| keep[..at].iter().filter(|k| **k).count();
    let bounds: Vec<usize> = starts.iter().map(|s| kept_before(*s)).chain([kept_before(t.len())]).collect();
    rows.keep(&keep);
    if starts.len() > 1 && choices.restart == Some(Restart::Append) {
        append(rows, &bounds);
        return Ok(vec![std::mem::take(rows)]);
    }
    Ok(bounds.windows(2).map(|w| rows.part(w[0]..w[1])).collect())
}

/// Moves the clock of every part behind the one before, one sampling interval later.
fn append(rows: &mut Rows, bounds: &[usize]) {
    let mut offset = 0.0;
    for w in bounds.windows(2) {
        let part = &mut rows.time[w[0]..w[1]];
        let Some((first, last)) = part.first().copied().zip(part.last().copied()) else { continue };
        let mut steps: Vec<f64> = part.windows(2).map(|p| p[1] - p[0]).collect();
        let step = noise::median(&mut steps).max(1e-9);
        let shift = if w[0] == 0 { 0.0 } else { offset - first };
        part.iter_mut().for_each(|t| *t += shift);
        offset = last + shift + step;
    }
}

/// `1 row`, `3 rows`.
pub(crate) fn counted(n: usize, what: &str) -> String {
    format!("{n} {what}{}", if n == 1 { "" } else { "s" })
}
