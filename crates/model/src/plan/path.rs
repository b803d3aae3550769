//! The actuator's motion out of a noisy or long record: a polyline within the encoder's noise.
//!
//! The polyline of Douglas & Peucker (1973) finds the corners, straight lines through the rows between them place them:
//! a corner taken from a single row would carry that row's noise, and a hold would never stand still.

use super::Corner;

/// Rows beyond this many standard deviations of the encoder's noise are motion.
const BEYOND: f64 = 6.0;

/// Nor is motion what stays within this share of the range.
const SHARE: f64 = 2e-3;

/// Corners that end within this many standard deviations of an earlier one end there.
const SAME: f64 = 3.0;

/// A corner between two rows looks like a leg of so few rows at most, over less than this share of the range.
const CUT_ROWS: usize = 2;
const CUT_SHARE: f64 = 0.03;

/// More corners than that are no protocol: the tolerance is doubled.
const MOST: usize = 400;

/// A corner and the row it stands at.
pub type At = (usize, Corner);

/// Noise of the displacement signal, mm: a robust sd of what parabolas through neighbours miss.
pub fn encoder_noise(t: &[f64], u: &[f64]) -> f64 {
    let mut misses: Vec<f64> = (3..u.len()).map(|i| contrast(&t[i - 3..=i], &u[i - 3..=i]).abs()).collect();
    if misses.is_empty() {
        return 0.0;
    }
    let middle = misses.len() / 2;
    1.4826 * *misses.select_nth_unstable_by(middle, f64::total_cmp).1
}

/// The combination of four neighbours that no parabola has, of unit noise.
fn contrast(t: &[f64], u: &[f64]) -> f64 {
    let (mut sum, mut square) = (0.0, 0.0);
    for i in 0..4 {
        let weight = 1.0 / (0..4).filter(|&j| j != i).map(|j| (t[i] - t[j]) / (t[3] - t[0])).product::<f64>();
        sum += weight * u[i];
        square += weight * weight;
    }
    sum / square.sqrt()
}

/// Corners of the polyline, each at a row. At least two rows.
pub(super) fn simplified(t: &[f64], u: &[f64]) -> Vec<At> {
    let n = t.len();
    let noise = encoder_noise(t, u);
    let (low, high) = u.iter().fold((f64::MAX, f64::MIN), |(l, h), &x| (l.min(x), h.max(x)));
    let travel: f64 = u.windows(2).map(|w| (w[1] - w[0]).abs()).sum();
    // A corner that falls between two rows is missed by part of a step.
    let between = 0.25 * (travel / (n - 1) as f64).min(0.04 * (high - low));
    let mut tolerance = (BEYOND * noise).max(SHARE * (high - low)).max(between);
    let mut rows = split(t, u, tolerance);
    while rows.len() > MOST {
        tolerance *= 2.0;
        rows = split(t, u, tolerance);
    }
    let lines = Lines::new(t, u);
    drop_needless(&mut rows, &lines, t, u, tolerance);
    let mut out = placed(&rows, &lines, t, tolerance);
    // A record starts at displacement 0; what is left of that is noise.
    if let Some(first) = out.first_mut().filter(|c| c.1.displacement.abs() <= tolerance) {
        first.1.displacement = 0.0;
    }
    for i in 1..out.len() {
        let here = out[i].1.displacement;
        let near = |c: &&At| (c.1.displacement - here).abs() <= SAME * noise;
        if let Some(earlier) = out[..i].iter().find(near).map(|c| c.1.displacement) {
            out[i].1.displacement = earlier;
        }
    }
    debug_assert!(out.last().is_none_or(|c| c.0 == n - 1));
    out
}

/// Rows that a polyline within `tolerance` of all rows goes through.
fn split(t: &[f64], u: &[f64], tolerance: f64) -> Vec<usize> {
    let mut corners = vec![0, t.len() - 1];
    let mut stack = vec![(0, t.len() - 1)];
    while let Some((a, b)) = stack.pop() {
        if let Some(i) = beyond(t, u, a, b, tolerance) {
            corners.push(i);
            stack.push((a, i));
            stack.push((i, b));
        }
    }
    corners.sort_unstable();
    corners.dedup();
    corners
}

/// The row between `a` and `b` farthest from the chord, if it is farther than `tolerance`.
fn beyond(t: &[f64], u: &[f64], a: usize, b: usize, tolerance: f64) -> Option<usize> {
    let slope = (u[b] - u[a]) / (t[b] - t[a]);
    let (mut far, mut at) = (tolerance, None);
    for i in a + 1..b {
        let miss = (u[i] - u[a] - slope * (t[i] - t[a])).abs();
        if miss > far {
            (far, at) = (miss, Some(i));
        }
    }
    at
}

/// Takes away corners that the line past them would not miss, and stops too short for a hold.
fn drop_needless(rows: &mut Vec<usize>, lines: &Lines, t: &[f64], u: &[f64], tolerance: f64) {
    let moving: f64 = rows.windows(2).map(|w| (u[w[1]] - u[w[0]]).abs()).sum();
    let typical = moving / (t[t.len() - 1] - t[0]);
    let range = u.iter().fold(f64::MIN, |m, x| m.max(*x)) - u.iter().fold(f64::MAX, |m, x| m.min(*x));
    let mut k = 1;
    while k + 1 < rows.len() {
        let (a, b, c) = (rows[k - 1], rows[k], rows[k + 1]);
        let still = |a: usize, b: usize| lines.travel(a, b).abs() <= tolerance;
        // Too short for a hold; or a corner that fell between two rows.
        let short = |a: usize, b: usize| {
            still(a, b) && typical * (t[b] - t[a]) < 2.0 * tolerance
                || b - a <= CUT_ROWS && (u[b] - u[a]).abs() < CUT_SHARE * range
        };
        let needless = beyond(t, u, a, c, tolerance).is_none()
            || (still(a, b) && still(b, c))
            || (k + 2 < rows.len() && short(b, c))
            || (k == 1 && short(a, b));
        if needless {
            rows.remove(k);
        } else {
            k += 1;
        }
    }
}

/// Corners on the lines through the rows on either side of them.
fn placed(rows: &[usize], lines: &Lines, t: &[f64], tolerance: f64) -> Vec<At> {
    // The straight motion of each stretch, without the rows next to its ends: (rate, displacement at its first row).
    let legs: Vec<(f64, f64)> = rows
        .windows(2)
        .map(|w| {
            let margin = ((w[1] - w[0]) / 20).min(20);
            let (rate, level) = lines.fit(w[0] + margin, w[1] - margin);
            let still = (rate * (t[w[1]] - t[w[0]])).abs() <= tolerance;
            let middle = 0.5 * (t[w[0] + margin] + t[w[1] - margin]);
            let rate = if still { 0.0 } else { rate };
            (rate, level + rate * (t[w[0]] - middle))
        })
        .collect();
    let on = |leg: usize, time: f64| legs[leg].1 + legs[leg].0 * (time - t[rows[leg]]);
    let corner = |k: usize| {
        let (first, last) = (k == 0, k + 1 == rows.len());
        let row = if first || last { rows[k] } else { crossing(rows, &legs, t, k) };
        let time = t[row];
        let displacement = match (first, last) {
            (true, _) => on(0, time),
            (_, true) => on(k - 1, time),
            _ if legs[k - 1].0 == 0.0 => on(k - 1, time),
            _ if legs[k].0 == 0.0 => on(k, time),
            _ => 0.5 * (on(k - 1, time) + on(k, time)),
        };
        (row, Corner { time, displacement })
    };
    let mut out: Vec<At> = (0..rows.len()).map(corner).collect();
    out.dedup_by(|b, a| b.0 <= a.0);
    // Both ends of a hold at one level, to the bit.
    for k in 1..out.len() {
        if out.len() == rows.len() && legs[k - 1].0 == 0.0 {
            out[k].1.displacement = out[k - 1].1.displacement;
        }
    }
    out
}

/// The row nearest to where the lines before and after corner `k` meet, near the corner.
fn crossing(rows: &[usize], legs: &[(f64, f64)], t: &[f64], k: usize) -> usize {
    let (before, after) = (legs[k - 1], legs[k]);
    let (at, rate) = (rows[k], after.0 - before.0);
    let gap = before.1 + before.0 * (t[at] - t[rows[k - 1]]) - after.1;
    let time = t[at] + gap / rate;
    let (low, high) = (at - (at - rows[k - 1]) / 4, at + (rows[k + 1] - at) / 4);
    if !time.is_finite() || time < t[low] || time > t[high] {
        return at;
    }
    let right = t.partition_point(|x| *x < time).clamp(low, high);
    if right > low && time - t[right - 1] < t[right] - time { right - 1 } else { right }
}

/// Least-squares lines through any stretch of rows, from running sums.
struct Lines {
    t: Vec<f64>,
    sums: Vec<[f64; 4]>,
}

impl Lines {
    fn new(t: &[f64], u: &[f64]) -> Self {
        let scale = 0.5 * (t[t.len() - 1] - t[0]);
        let middle = t[0] + scale;
        let shifted: Vec<f64> = t.iter().map(|t| (t - middle) / scale).collect();
        let mut sums = vec![[0.0; 4]];
        let mut s = [0.0; 4];
        for (x, u) in shifted.iter().zip(u) {
            for (s, v) in s.iter_mut().zip([*x, *u, x * x, x * u]) {
                *s += v;
            }
            sums.push(s);
        }
        Self { t: t.to_vec(), sums }
    }

    /// Rate, and displacement at the middle of the times of rows a..=b.
    fn fit(&self, a: usize, b: usize) -> (f64, f64) {
        let n = (b - a + 1) as f64;
        let [x, u, xx, xu] = [0, 1, 2, 3].map(|k| (self.sums[b + 1][k] - self.sums[a][k]) / n);
        let scale = 0.5 * (self.t[self.t.len() - 1] - self.t[0]);
        let spread = xx - x * x;
        let rate = if spread > 0.0 { (xu - x * u) / spread / scale } else { 0.0 };
        let middle = 0.5 * (self.t[a] + self.t[b]);
        let mean = self.t[0] + scale * (1.0 + x);
        (rate, u + rate * (middle - mean))
    }

    fn travel(&self, a: usize, b: usize) -> f64 {
        self.fit(a, b).0 * (self.t[b] - self.t[a])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rows at even times along straight legs, each with an error from −1 to 1 times `jitter`.
    fn rows(legs: &[(f64, f64)], per_leg: usize, jitter: f64) -> (Vec<f64>, Vec<f64>) {
        let (mut t, mut u) = (vec![0.0], vec![0.0]);
        let mut state = 1u64;
        for w in legs.windows(2) {
            for i in 1..=per_leg {
                let s = i as f64 / per_leg as f64;
                state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                let error = (state >> 33) as f64 / f64::from(1u32 << 30) - 1.0;
                t.push(w[0].0 + s * (w[1].0 - w[0].0));
                u.push(w[0].1 + s * (w[1].1 - w[0].1) + jitter * error);
            }
        }
        (t, u)
    }

    const LEGS: [(f64, f64); 7] =
        [(0.0, 0.0), (20.0, 1.0), (40.0, 0.4), (80.0, 1.0), (140.0, 1.0), (142.0, 1.5), (200.0, 2.0)];

    #[test]
    fn noise_is_what_parabolas_miss() {
        let (t, u) = rows(&LEGS, 5000, 2e-4);
        // Sd of a uniform error of half width 2e-4.
        assert!((encoder_noise(&t, &u) / (2e-4 / 3f64.sqrt()) - 1.0).abs() < 0.1);
        let t: Vec<f64> = (0..50).map(|i| f64::from(i) + 0.1 * f64::from(i % 3)).collect();
        let u: Vec<f64> = t.iter().map(|t| 1.0 + 0.3 * t - 0.01 * t * t).collect();
        assert!(encoder_noise(&t, &u) < 1e-12);
    }

    #[test]
    fn corners_do_not_depend_on_the_number_of_rows_nor_on_their_noise() {
        for (per_leg, jitter) in [(60, 2e-4), (3000, 2e-4), (30_000, 2e-4), (3000, 2e-3), (3000, 0.0)] {
            let (t, u) = rows(&LEGS, per_leg, jitter);
            let found = simplified(&t, &u);
            assert_eq!(found.len(), LEGS.len(), "{per_leg} rows, jitter {jitter}: {found:?}");
            for ((_, c), leg) in found.iter().zip(LEGS) {
                let row = 80.0 / per_leg as f64;
                assert!(
                    (c.time - leg.0).abs() <= 1.01 * row + 5.0 * jitter,
                    "{per_leg} {jitter} {c:?} {leg:?}"
                );
                assert!(
                    (c.displacement - leg.1).abs() <= 2e-3 + 2.0 * jitter,
                    "{per_leg} {jitter} {c:?} {leg:?}"
                );
            }
            assert_eq!(found[0].1.displacement, 0.0);
            assert_eq!(found[3].1.displacement, found[4].1.displacement);
        }
    }

    #[test]
    fn corners_between_rows_are_one_corner_each() {
        for n in [150, 400, 701] {
            let (fine_t, fine_u) = rows(&LEGS, 6000, 0.0);
            let pick = |k: usize| k * (fine_t.len() - 1) / (n - 1);
            let shake = |k: usize| if k == 0 { 0.0 } else { 2e-4 * (((k * 7919) % 101) as f64 / 50.0 - 1.0) };
            let t: Vec<f64> = (0..n).map(|k| fine_t[pick(k)]).collect();
            let u: Vec<f64> = (0..n).map(|k| fine_u[pick(k)] + shake(k)).collect();
            assert_eq!(simplified(&t, &u).len(), LEGS.len(), "{n}: {:?}", simplified(&t, &u));
        }
    }

    #[test]
    fn a_pull_within_one_row_is_a_leg() {
        let t: Vec<f64> = (0..200).map(f64::from).collect();
        let u: Vec<f64> =
            (0..200).map(|k| if k == 0 { 0.0 } else { 1.0 + 1e-4 * f64::from(k % 3) }).collect();
        let found = simplified(&t, &u);
        assert_eq!(found.iter().map(|c| c.0).collect::<Vec<_>>(), [0, 1, 199]);
        assert_eq!(found[1].1.displacement, found[2].1.displacement);
    }

    #[test]
    fn a_staircase_of_a_coarse_encoder_is_a_line() {
        let t: Vec<f64> = (0..20_000).map(|i| f64::from(i) * 0.01).collect();
        let u: Vec<f64> = t.iter().map(|t| (t.min(200.0 - t) * 0.01 / 1e-3).round() * 1e-3).collect();
        let found = simplified(&t, &u);
        assert_eq!(found.len(), 3, "{found:?}");
        assert!((found[1].1.displacement - 1.0).abs() < 2e-3);
    }
}
