//! Typical points of a curve, as the paper's Fig. 7: start, peak, end, half-way up and down, and
//! between them where the curve is longest.

/// A typical point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TypicalPoint {
    /// Step of the run.
    pub step: usize,
    /// Displacement there, mm.
    pub displacement: f64,
    /// Force there, N.
    pub force: f64,
}

/// At most `count` typical points in the order of the run.
pub fn typical_points(displacement: &[f64], force: &[f64], count: usize) -> Vec<TypicalPoint> {
    let n = displacement.len().min(force.len());
    if n == 0 || count == 0 {
        return Vec::new();
    }
    let arc = arc_length(&displacement[..n], &force[..n]);
    let mut chosen: Vec<usize> = Vec::new();
    for feature in features(&force[..n]) {
        if chosen.len() < count && !chosen.contains(&feature) {
            chosen.push(feature);
        }
    }
    while chosen.len() < count.min(n) {
        let gap = |i: usize| chosen.iter().fold(f64::MAX, |m, &c| m.min((arc[i] - arc[c]).abs()));
        let free = (0..n).filter(|i| !chosen.contains(i));
        let Some(far) = free.max_by(|&a, &b| gap(a).total_cmp(&gap(b)).then(b.cmp(&a))) else { break };
        chosen.push(far);
    }
    chosen.sort_unstable();
    chosen
        .into_iter()
        .map(|step| TypicalPoint { step, displacement: displacement[step], force: force[step] })
        .collect()
}

/// Peak, end, half of the peak before and after it, start: the order in which they matter.
fn features(force: &[f64]) -> Vec<usize> {
    let n = force.len();
    let peak = (0..n).max_by(|&a, &b| force[a].total_cmp(&force[b]).then(b.cmp(&a))).unwrap_or(0);
    let half = 0.5 * force[peak];
    let rise = (0..peak).find(|&i| force[i] >= half);
    let fall = (peak..n).find(|&i| force[i] <= half);
    [Some(peak), Some(n - 1), rise, fall, Some(0)].into_iter().flatten().collect()
}

/// Length along the curve, both axes scaled to their range.
fn arc_length(u: &[f64], f: &[f64]) -> Vec<f64> {
    let range = |x: &[f64]| {
        let (low, high) = x.iter().fold((f64::MAX, f64::MIN), |(l, h), v| (l.min(*v), h.max(*v)));
        (high - low).max(f64::MIN_POSITIVE)
    };
    let (ru, rf) = (range(u), range(f));
    let mut s = vec![0.0; u.len()];
    for i in 1..u.len() {
        s[i] = s[i - 1] + ((u[i] - u[i - 1]) / ru).hypot((f[i] - f[i - 1]) / rf);
    }
    s
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_features_are_among_the_points() {
        let u: Vec<f64> = (0..101).map(|i| f64::from(i) * 0.1).collect();
        let f: Vec<f64> = u.iter().map(|u| u * (-u / 3.0f64).exp()).collect();
        let points = typical_points(&u, &f, 8);
        let steps: Vec<usize> = points.iter().map(|p| p.step).collect();
        assert_eq!(points.len(), 8);
        assert!(steps.contains(&0) && steps.contains(&30) && steps.contains(&100), "{steps:?}");
        assert!(steps.is_sorted());
        assert_eq!(typical_points(&u[..3], &f[..3], 8).len(), 3);
    }
}
