//! What is wrong with rows, all of it at once: what is dropped by rule, what is kept and told, what must be mended.

use crate::choices::{Choices, FaultKind, Restart};
use crate::error::{Fault, Question, short, visible};
use crate::noise;
use crate::physics::range;
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

fn found(kind: FaultKind, rows: &[u32], dropped: bool, what: String, remedy: &str) -> Found {
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

/// Spikes, plateaus, gaps and coarse steps of one test; rows go only where the user says so.
pub(crate) fn inspect(rows: &mut Rows, choices: &Choices, out: &mut Vec<Found>) {
    let n = rows.len();
    if n < 8 {
        return;
    }
    let mut keep = vec![true; n];
    let mut tell = |kind: FaultKind, at: &[usize], what: String, remedy: &str, keep: &mut Vec<bool>| {
        let dropped = choices.drop.contains(&kind) && matches!(kind, FaultKind::Spike | FaultKind::Clipped);
        if dropped {
            at.iter().for_each(|i| keep[*i] = false);
        }
        let numbers: Vec<u32> = at.iter().map(|i| rows.row[*i]).collect();
        out.push(found(kind, &numbers, dropped, what, remedy));
    };
    for (channel, word) in [(&rows.force, "force"), (&rows.displacement, "displacement")] {
        let spikes = spikes(channel);
        if !spikes.is_empty() {
            let what = format!("{} of the {word}, far from both neighbours", counted(spikes.len(), "value"));
            tell(FaultKind::Spike, &spikes, what, "--drop spike leaves them out", &mut keep);
        }
    }
    if let Some((run, level)) = clipped(&rows.force, &rows.displacement) {
        let what = format!(
            "the force stays at {} N, its extreme, over {} rows while the actuator moves: the load cell's limit?",
            short(level),
            run.len()
        );
        let remedy = "--drop clipped leaves them out; test with a larger load cell";
        tell(FaultKind::Clipped, &run.collect::<Vec<_>>(), what, remedy, &mut keep);
    }
    let gaps = gaps(&rows.time);
    if !gaps.is_empty() {
        let what = format!("{} of rows in an otherwise regular record", counted(gaps.len(), "gap"));
        tell(FaultKind::Gap, &gaps, what, "nothing to do: points may be unevenly spaced", &mut keep);
    }
    if let Some(step) = coarse(&rows.force) {
        let what = format!(
            "the force comes in steps of {} N, {} % of its range",
            short(step),
            short(100.0 * step / range(&rows.force))
        );
        tell(
            FaultKind::Quantised,
            &[],
            what,
            "export more digits, or use a load cell of a smaller range",
            &mut keep,
        );
    }
    rows.keep(&keep);
}

/// Single values that leave and come back, by more than noise and 3 % of the range.
fn spikes(x: &[f64]) -> Vec<usize> {
    let limit = (15.0 * noise::sd(x)).max(0.03 * range(x));
    if limit == 0.0 {
        return Vec::new();
    }
    let out = |i: &usize| {
        let (a, b) = (x[*i] - x[i - 1], x[*i] - x[i + 1]);
        let jump = (x[i + 1] - x[i - 1]).abs();
        a * b > 0.0 && a.abs().min(b.abs()) > limit && a.abs().min(b.abs()) > 3.0 * jump
    };
    (1..x.len().saturating_sub(1)).filter(out).collect()
}

/// The longest run of equal values at an extreme, if it is longer than runs elsewhere and the actuator moves in it.
fn clipped(f: &[f64], u: &[f64]) -> Option<(std::ops::Range<usize>, f64)> {
    let (low, high) = f.iter().fold((f64::MAX, f64::MIN), |(l, h), x| (l.min(*x), h.max(*x)));
    let (mut best, mut other, mut at): (std::ops::Range<usize>, usize, usize) = (0..0, 1, 0);
    for run in f.chunk_by(|a, b| a == b) {
        let extreme = (run[0] == high || run[0] == low) && run[0] != 0.0;
        if extreme && run.len() > best.len() {
            best = at..at + run.len();
        } else if !extreme {
            other = other.max(run.len());
        }
        at += run.len();
    }
    let moved = range(&u[best.clone()]) > 0.01 * range(u);
    (best.len() >= 5.max(3 * other) && high > low && moved).then(|| (best.clone(), f[best.start]))
}

/// Rows before which rows are missing, where the sampling is regular.
fn gaps(t: &[f64]) -> Vec<usize> {
    let mut steps: Vec<f64> = t.windows(2).map(|w| w[1] - w[0]).collect();
    let step = noise::median(&mut steps);
    let regular = steps.iter().filter(|d| (**d - step).abs() <= 0.2 * step).count();
    if (regular as f64) < 0.95 * steps.len() as f64 {
        return Vec::new();
    }
    (1..t.len()).filter(|&i| t[i] - t[i - 1] > 2.5 * step).collect()
}

/// The step of a force that has few values, if it is coarse.
fn coarse(f: &[f64]) -> Option<f64> {
    let mut values = f.to_vec();
    values.sort_unstable_by(f64::total_cmp);
    values.dedup();
    if f.len() < 50 || values.len() < 3 || values.len() * 4 > f.len() {
        return None;
    }
    let step = values.windows(2).map(|w| w[1] - w[0]).fold(f64::MAX, f64::min);
    (step > 0.005 * range(f)).then_some(step)
}

/// `1 row`, `3 rows`.
fn counted(n: usize, what: &str) -> String {
    format!("{n} {what}{}", if n == 1 { "" } else { "s" })
}
