//! What looks wrong in rows that were read: spikes, a clipped load cell, gaps, coarse steps.

use crate::choices::{Choices, FaultKind};
use crate::error::short;
use crate::faults::{Found, counted, found};
use crate::noise;
use crate::physics::range;
use crate::rows::Rows;

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
    for (channel, word) in rows.named() {
        let spikes = spikes(channel);
        if !spikes.is_empty() {
            let what = format!("{} of the {word}, far from both neighbours", counted(spikes.len(), "value"));
            tell(FaultKind::Spike, &spikes, what, "--drop spike leaves them out", &mut keep);
        }
    }
    for (force, displacement, word) in rows.axes() {
        let Some((run, level)) = clipped(force, displacement) else { continue };
        let what = format!(
            "the {word} stays at {} N, its extreme, over {} rows while the actuator moves: the load cell's limit?",
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
    for (force, _, word) in rows.axes() {
        let Some(step) = coarse(force) else { continue };
        let what = format!(
            "the {word} comes in steps of {} N, {} % of its range",
            short(step),
            short(100.0 * step / range(force))
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

/// Single values that leave and come back, by more than noise, than 3 % of the range, and than five steps of their
/// neighbours: the turn of a triangle is none.
fn spikes(x: &[f64]) -> Vec<usize> {
    let limit = (15.0 * noise::sd(x)).max(0.03 * range(x));
    let out = |i: &usize| {
        let (a, b) = (x[*i] - x[i - 1], x[*i] - x[i + 1]);
        let left = (x[i - 1] - x[i.saturating_sub(2)]).abs();
        let right = (x[(i + 2).min(x.len() - 1)] - x[i + 1]).abs();
        let least = a.abs().min(b.abs());
        a * b > 0.0 && least > limit && least > 5.0 * left.max(right)
    };
    if limit > 0.0 { (1..x.len().saturating_sub(1)).filter(out).collect() } else { Vec::new() }
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
