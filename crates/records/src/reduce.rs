//! A record thinned out for programs that take one standard deviation for all points (`--points`; fits average whole
//! records themselves, in `analysis`): corners of path and force stay rows of the file, holds are spaced by the
//! logarithm of time, in between are means. Every point is made of the same number of rows, so that one standard
//! deviation of the force holds for all of them.

use crate::noise;
use crate::path::corners;
use crate::physics::range;
use crate::rows::Rows;
use serde::Serialize;
use std::ops::Range;

/// Points that one hold gets at most.
const HOLD: usize = 40;
/// Slower than this share of the fastest leg: a hold.
const STANDING: f64 = 0.02;

/// How a test was reduced.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Reduction {
    /// Rows before.
    pub rows: usize,
    /// Points after.
    pub points: usize,
    /// Rows whose mean a point is.
    pub rows_per_point: usize,
    /// Turns, holds' ends, changes of rate, breaks: time and displacement are those of a row.
    pub corners: usize,
}

/// Reduces a test to about `points`; `None` if it has no more already.
pub(crate) fn reduce(full: &Rows, points: usize) -> Option<(Rows, Reduction)> {
    let n = full.len();
    if n <= points || points < 8 {
        return None;
    }
    let corners = all_corners(full, points);
    let legs = Legs::new(full, &corners, points.saturating_sub(corners.len()));
    let size = legs.size(full, points);
    let windows = legs.windows(full, size);
    let mut out = Rows {
        labels: full.labels.clone(),
        camera: full.camera.clone().map(|c| c.map(|_| Vec::new())),
        ..Rows::default()
    };
    let mut next = windows.iter().peekable();
    for (k, &corner) in corners.iter().enumerate() {
        let before = if k > 0 { corners[k - 1] + 1 } else { corner };
        let after = corners.get(k + 1).copied().unwrap_or(corner);
        let force = if size > 1 {
            at_corner(full, before..corner, corner, corner + 1..after, size)
        } else {
            full.force[corner]
        };
        out.push(full, corner..corner + 1, Some(force));
        while let Some(w) = next.next_if(|w| w.end <= after) {
            out.push(full, w.clone(), None);
        }
    }
    let made = Reduction { rows: n, points: out.len(), rows_per_point: size, corners: corners.len() };
    Some((out, made))
}

/// Corners of the path and of the force, and where segments change.
fn all_corners(full: &Rows, points: usize) -> Vec<usize> {
    let (t, u, f) = (&full.time, &full.displacement, &full.force);
    let tolerance = |x: &[f64], noises: f64, share: f64| (noises * noise::sd(x)).max(share * range(x));
    let drop = tolerance(f, 8.0, 0.02);
    let mut all = corners(t, u, tolerance(u, 6.0, 2e-3), points / 3);
    // A smooth force needs no corners: its means follow it. What drops within a mean or two does.
    let breaks = corners(t, f, drop, points / 8);
    let size = (full.len() / points.max(1)).max(1);
    let sharp = |w: &[usize]| w[1] - w[0] <= 2 * size && (f[w[1]] - f[w[0]]).abs() > drop;
    all.extend(breaks.windows(2).filter(|w| sharp(w)).flatten());
    let changes = full.label.windows(2).enumerate().filter(|(_, w)| w[0] != w[1]).map(|(i, _)| i);
    // Both sides of a change; many short segments would leave nothing for what is inside them.
    all.extend(changes.take(points / 8).flat_map(|i| [i, i + 1]));
    all.sort_unstable();
    all.dedup();
    all
}

/// What lies between corners: motions and holds, and how many points either get.
struct Legs {
    /// First and last corner, and whether the actuator stands.
    legs: Vec<(usize, usize, bool)>,
    for_each_hold: usize,
    for_motions: usize,
}

impl Legs {
    fn new(full: &Rows, corners: &[usize], points: usize) -> Self {
        let (t, u) = (&full.time, &full.displacement);
        let speed = |a: usize, b: usize| (u[b] - u[a]).abs() / (t[b] - t[a]).max(f64::MIN_POSITIVE);
        let large = |a: usize, b: usize| (u[b] - u[a]).abs() > 0.05 * range(u);
        let pairs = || corners.windows(2).map(|w| (w[0], w[1]));
        let fastest = pairs().filter(|&(a, b)| large(a, b)).map(|(a, b)| speed(a, b)).fold(0.0, f64::max);
        let legs: Vec<_> = pairs().map(|(a, b)| (a, b, speed(a, b) < STANDING * fastest)).collect();
        let holds = legs.iter().filter(|l| l.2).count();
        let for_holds = (holds * HOLD).min(points * 3 / 10);
        Self { legs, for_each_hold: (for_holds / holds.max(1)).max(1), for_motions: points - for_holds }
    }

    /// Rows of a mean: as many as fill the motions, not fewer than a quarter of an even share of all rows.
    fn size(&self, full: &Rows, points: usize) -> usize {
        let moving: usize = self.legs.iter().filter(|l| !l.2).map(|l| l.1 - l.0).sum();
        let even = full.len() / points.max(1);
        (moving / self.for_motions.max(1)).clamp(even / 4, even).max(1)
    }

    /// The rows of each mean, in order, none across a corner.
    fn windows(&self, full: &Rows, size: usize) -> Vec<Range<usize>> {
        let (u, f) = (&full.displacement, &full.force);
        let (path, work): (f64, f64) = self
            .legs
            .iter()
            .filter(|l| !l.2)
            .fold((0.0, 0.0), |(p, w), l| (p + (u[l.1] - u[l.0]).abs(), w + (f[l.1] - f[l.0]).abs()));
        let share = |part: f64, all: f64| if all > 0.0 { part / all } else { 0.0 };
        let mut out = Vec::new();
        for &(a, b, hold) in &self.legs {
            let inside = a + 1..b;
            if hold {
                out.extend(log_spaced(inside, self.for_each_hold, size));
            } else {
                let weight = 0.5 * share((u[b] - u[a]).abs(), path) + 0.5 * share((f[b] - f[a]).abs(), work);
                out.extend(evenly(inside, (self.for_motions as f64 * weight).round() as usize, size));
            }
        }
        out
    }
}

/// At most `count` windows of `size` rows, evenly over a leg.
fn evenly(leg: Range<usize>, count: usize, size: usize) -> Vec<Range<usize>> {
    let count = count.min(leg.len() / size);
    let free = leg.len() - count * size;
    let start = |k: usize| leg.start + k * size + free * (2 * k + 1) / (2 * count.max(1));
    (0..count).map(|k| start(k)..start(k) + size).collect()
}

/// At most `count` windows of `size` rows, each later by the same factor than the one before where that is farther.
fn log_spaced(hold: Range<usize>, count: usize, size: usize) -> Vec<Range<usize>> {
    let starts = |factor: f64| {
        let mut out = Vec::new();
        let mut at = 0_usize;
        while at + size <= hold.len() && out.len() <= count {
            out.push(at);
            let middle = at as f64 + 0.5 * size as f64;
            at += size.max((middle * (factor - 1.0)) as usize);
        }
        out
    };
    // The least factor that fits.
    let (mut low, mut high) = (1.0, 1.0 + hold.len() as f64);
    for _ in 0..40 {
        let middle = 0.5 * (low + high);
        if starts(middle).len() > count { low = middle } else { high = middle }
    }
    starts(high).into_iter().take(count).map(|s| hold.start + s..hold.start + s + size).collect()
}

/// The force at a corner from straight lines through the rows on its sides, as well known as a mean of `size` rows.
/// Where the sides contradict each other (a relaxation faster than the rows), the one that is the straighter.
fn at_corner(full: &Rows, before: Range<usize>, corner: usize, after: Range<usize>, size: usize) -> f64 {
    let (one_sided, two_sided) = (4 * size, 2 * size);
    let length = if before.is_empty() || after.is_empty() { one_sided } else { two_sided };
    let left = before.end.saturating_sub(length).max(before.start)..before.end;
    let right = after.start..(after.start + length).min(after.end);
    let t0 = full.time[corner];
    let lines = [line(full, left, t0, size), line(full, right, t0, size)];
    match lines {
        [Some(a), Some(b)] => {
            let (va, vb) = (a.variance * a.scatter, b.variance * b.scatter);
            let apart = (a.value - b.value).powi(2) > 16.0 * (va + vb);
            if apart {
                if a.scatter <= b.scatter { a.value } else { b.value }
            } else {
                (a.value / a.variance + b.value / b.variance) / (1.0 / a.variance + 1.0 / b.variance)
            }
        }
        [Some(a), None] | [None, Some(a)] => a.value,
        [None, None] => full.force[corner],
    }
}

/// A straight line at a time: value, variance in units of a row's, variance of a row about it.
struct Line {
    value: f64,
    variance: f64,
    scatter: f64,
}

fn line(full: &Rows, rows: Range<usize>, t0: f64, size: usize) -> Option<Line> {
    let n = rows.len();
    if n < size.max(3) {
        return None;
    }
    let (t, f) = (&full.time[rows.clone()], &full.force[rows]);
    let m = n as f64;
    let (tm, fm) = (t.iter().sum::<f64>() / m, f.iter().sum::<f64>() / m);
    let (mut tt, mut tf) = (0.0, 0.0);
    for (t, f) in t.iter().zip(f) {
        tt += (t - tm).powi(2);
        tf += (t - tm) * (f - fm);
    }
    if tt <= 0.0 {
        return None;
    }
    let slope = tf / tt;
    let left: f64 = t.iter().zip(f).map(|(t, f)| (f - fm - slope * (t - tm)).powi(2)).sum();
    Some(Line {
        value: fm + slope * (t0 - tm),
        variance: 1.0 / m + (t0 - tm).powi(2) / tt,
        scatter: (left / (m - 2.0).max(1.0)).max(f64::MIN_POSITIVE),
    })
}

impl Rows {
    /// Adds the mean of some rows of `full`; a camera's over what it saw.
    fn push(&mut self, full: &Rows, rows: Range<usize>, force: Option<f64>) {
        let mean = |x: &[f64]| if x.len() == 1 { x[0] } else { x.iter().sum::<f64>() / x.len() as f64 };
        self.row.push(full.row[rows.start]);
        self.table.push(full.table[rows.start]);
        self.time.push(mean(&full.time[rows.clone()]));
        self.displacement.push(mean(&full.displacement[rows.clone()]));
        self.force.push(force.unwrap_or_else(|| mean(&full.force[rows.clone()])));
        for (into, from) in self.camera.iter_mut().zip(&full.camera) {
            if let (Some(into), Some(from)) = (into, from) {
                let seen: Vec<f64> = from[rows.clone()].iter().copied().filter(|x| x.is_finite()).collect();
                into.push(if seen.is_empty() { f64::NAN } else { mean(&seen) });
            }
        }
        if !full.label.is_empty() {
            self.label.push(full.label[rows.start]);
        }
    }
}

/// Standard deviation of a row's force, and of a point's that is the mean of `size` rows.
pub(crate) fn deviations(full: &Rows, size: usize) -> (f64, f64) {
    let row = noise::sd(&full.force);
    if size < 2 {
        return (row, row);
    }
    let white = row / (size as f64).sqrt();
    let seen = noise::sd_of_means(&full.force, size).unwrap_or(white);
    (row, white.max(seen))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn windows_fit_and_grow() {
        assert_eq!(evenly(10..30, 2, 5), [12..17, 22..27]);
        assert_eq!(evenly(10..13, 4, 5), Vec::<Range<usize>>::new());
        let hold = log_spaced(100..1100, 12, 10);
        assert!(hold.len() >= 8 && hold.len() <= 12, "{hold:?}");
        assert_eq!(hold[0], 100..110);
        assert!(hold.windows(2).all(|w| w[1].start >= w[0].end));
        assert!(hold.last().is_some_and(|w| w.end > 700 && w.end <= 1100), "{hold:?}");
    }
}
