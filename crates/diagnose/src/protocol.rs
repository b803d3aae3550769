//! A record's protocol from its displacement: a polyline in time, robust to measured (noisy) displacement.

use std::ops::Range;

/// Rates in this proportion are one rate.
pub(crate) const LIKE: Range<f64> = 0.77..1.3;

/// A stretch of constant rate.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct MotionPart {
    /// Points, the last shared with nobody: pieces tile the record.
    pub range: Range<usize>,
    /// Displacement per time.
    pub rate: f64,
    /// No motion.
    pub hold: bool,
}

/// Noise of the displacement: a robust scale of what a straight line through neighbours misses.
pub(crate) fn displacement_noise(t: &[f64], u: &[f64]) -> f64 {
    let mut misses: Vec<f64> = (1..u.len().saturating_sub(1))
        .map(|i| {
            let w = (t[i] - t[i - 1]) / (t[i + 1] - t[i - 1]);
            let miss = u[i] - (1.0 - w) * u[i - 1] - w * u[i + 1];
            miss.abs() / (1.0 + w * w + (1.0 - w).powi(2)).sqrt()
        })
        .collect();
    if misses.is_empty() {
        return 0.0;
    }
    misses.sort_by(f64::total_cmp);
    1.4826 * misses[misses.len() / 2]
}

/// Cuts the record where the rate changes (Douglas & Peucker 1973 on displacement against time, then
/// neighbours of like rate are joined and each corner is moved to where two lines fit best).
pub(crate) fn pieces(t: &[f64], u: &[f64]) -> Vec<MotionPart> {
    let n = t.len();
    if n < 2 {
        return Vec::new();
    }
    let (low, high) = u.iter().fold((f64::MAX, f64::MIN), |(a, b), &x| (a.min(x), b.max(x)));
    let tolerance = (5.0 * displacement_noise(t, u)).max(2e-3 * (high - low));
    let mut corners = vec![0, n - 1];
    split(t, u, 0, n - 1, tolerance, &mut corners);
    corners.sort_unstable();
    corners.dedup();
    join(t, u, &mut corners, tolerance);
    for _ in 0..2 {
        refine(t, u, &mut corners);
    }
    corners
        .windows(2)
        .enumerate()
        .map(|(k, w)| {
            let start = if k == 0 { 0 } else { w[0] + 1 };
            let (rate, hold) = motion(t, u, w[0], w[1], tolerance);
            MotionPart { range: start..w[1] + 1, rate, hold }
        })
        .filter(|p| !p.range.is_empty())
        .collect()
}

fn split(t: &[f64], u: &[f64], a: usize, b: usize, tolerance: f64, corners: &mut Vec<usize>) {
    let mut stack = vec![(a, b)];
    while let Some((a, b)) = stack.pop() {
        let line = |i: usize| u[a] + (u[b] - u[a]) * (t[i] - t[a]) / (t[b] - t[a]);
        let far = (a..b).map(|i| (i, (u[i] - line(i)).abs())).max_by(|x, y| x.1.total_cmp(&y.1));
        if let Some((i, _)) = far.filter(|f| f.1 > tolerance) {
            corners.push(i);
            stack.push((a, i));
            stack.push((i, b));
        }
    }
}

/// Least-squares rate between two corners, and whether the stretch is a hold.
fn motion(t: &[f64], u: &[f64], a: usize, b: usize, tolerance: f64) -> (f64, bool) {
    let (rate, _) = line_fit(t, u, a, b);
    let travel = rate * (t[b] - t[a]);
    (rate, travel.abs() <= tolerance)
}

/// Rate and sum of squares of the line through points a..=b.
fn line_fit(t: &[f64], u: &[f64], a: usize, b: usize) -> (f64, f64) {
    let n = (b - a + 1) as f64;
    let (mt, mu) = (t[a..=b].iter().sum::<f64>() / n, u[a..=b].iter().sum::<f64>() / n);
    let (mut tt, mut tu, mut uu) = (0.0, 0.0, 0.0);
    for i in a..=b {
        let (x, y) = (t[i] - mt, u[i] - mu);
        tt += x * x;
        tu += x * y;
        uu += y * y;
    }
    if tt > 0.0 { (tu / tt, (uu - tu * tu / tt).max(0.0)) } else { (0.0, 0.0) }
}

/// Takes away corners between stretches of like motion.
fn join(t: &[f64], u: &[f64], corners: &mut Vec<usize>, tolerance: f64) {
    let mut k = 1;
    while k + 1 < corners.len() {
        let (r1, h1) = motion(t, u, corners[k - 1], corners[k], tolerance);
        let (r2, h2) = motion(t, u, corners[k], corners[k + 1], tolerance);
        let like = (h1 && h2) || (!h1 && !h2 && LIKE.contains(&(r1 / r2)));
        if like {
            corners.remove(k);
        } else {
            k += 1;
        }
    }
}

/// Moves each inner corner by up to three points to where the two lines beside it fit best.
fn refine(t: &[f64], u: &[f64], corners: &mut [usize]) {
    for k in 1..corners.len().saturating_sub(1) {
        let (a, c) = (corners[k - 1], corners[k + 1]);
        let near = (a + 1..c).filter(|b| b.abs_diff(corners[k]) <= 3);
        let square = |b: usize| line_fit(t, u, a, b).1 + line_fit(t, u, b, c).1;
        if let Some(best) = near.min_by(|&x, &y| square(x).total_cmp(&square(y))) {
            corners[k] = best;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pieces_tile_the_record() {
        let t: Vec<f64> = (0..90).map(f64::from).collect();
        let u: Vec<f64> = t.iter().map(|&t| t.min(30.0) - (t - 60.0).max(0.0)).collect();
        let ranges: Vec<Range<usize>> = pieces(&t, &u).into_iter().map(|p| p.range).collect();
        assert_eq!(ranges, [0..31, 31..61, 61..90]);
    }

    /// Points that lie in turn at ±a around a ramp miss the line through their neighbours by 2 a, which is √(3/2) sd of
    /// independent errors at even times.
    #[test]
    fn noise_of_the_displacement_is_what_neighbours_do_not_share() {
        let t: Vec<f64> = (0..40).map(f64::from).collect();
        let u: Vec<f64> =
            (0..40).map(|i| 0.3 * f64::from(i) + if i % 2 == 0 { 0.01 } else { -0.01 }).collect();
        assert!((displacement_noise(&t, &u) / (1.4826 * 0.02 / 1.5f64.sqrt()) - 1.0).abs() < 1e-9);
        assert_eq!(displacement_noise(&t[..2], &u[..2]), 0.0);
    }
}
