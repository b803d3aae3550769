//! The restricted likelihood of windows of a record, and the correlation that makes it largest.

use super::Window;
use nalgebra::DMatrix;

/// Golden section.
const GOLDEN: f64 = 0.618_033_988_75;

/// Restricted likelihood of all windows at correlation `phi`, sd profiled: (sd, log likelihood).
pub(super) fn likelihood(windows: &[Window], phi: f64) -> (f64, f64) {
    let (mut square, mut log_det, mut freedom) = (0.0, 0.0, 0.0);
    for w in windows {
        let half = correlated(w, phi);
        let c = half.tr_mul(&half);
        let Some(chol) = c.cholesky() else { return (f64::NAN, f64::NEG_INFINITY) };
        square += w.u.dot(&chol.solve(&w.u));
        log_det += 2.0 * chol.l_dirty().diagonal().iter().map(|d| d.ln()).sum::<f64>();
        freedom += w.freedom();
    }
    let variance = square / freedom;
    (variance.sqrt(), -0.5 * (freedom * variance.max(f64::MIN_POSITIVE).ln() + log_det))
}

/// Lᵀ C, with the contrasts C and the correlation L Lᵀ of a window's points: that of neighbours, passed on from each to the
/// next.
fn correlated(w: &Window, phi: f64) -> DMatrix<f64> {
    let n = w.contrasts.nrows();
    let next = |i: usize| match w.position.get(i + 1) {
        Some(after) => inverse::correlation_at(phi, after - w.position[i]),
        None => phi,
    };
    let passed: Vec<f64> = (0..n - 1).map(next).collect();
    let mut out = w.contrasts.clone();
    for mut column in out.column_iter_mut() {
        for i in (0..n - 1).rev() {
            column[i] += passed[i] * column[i + 1];
        }
        for i in 1..n {
            column[i] *= (1.0 - passed[i - 1] * passed[i - 1]).sqrt();
        }
    }
    out
}

/// Grid, then golden section, with the weak prior 1 − φ²: in short windows a correlation near 1 looks like a
/// smooth curve, and its sd would be without bound.
pub(super) fn most_likely(windows: &[Window]) -> f64 {
    let value = |phi: f64| likelihood(windows, phi).1 + (1.0 - phi * phi).ln();
    let grid: Vec<f64> = (-12..=17).map(|k| 0.05 * f64::from(k)).collect();
    let tried = grid.into_iter().map(|phi| (phi, value(phi)));
    let best = tried.max_by(|a, b| a.1.total_cmp(&b.1)).map_or(0.0, |t| t.0);
    let (mut a, mut b) = (best - 0.05, best + 0.05);
    let inner = |a: f64, b: f64| (b - GOLDEN * (b - a), a + GOLDEN * (b - a));
    let (x, y) = inner(a, b);
    let (mut at_x, mut at_y) = (value(x), value(y));
    for _ in 0..20 {
        let (x, y) = inner(a, b);
        if at_x > at_y {
            b = y;
            (at_y, at_x) = (at_x, value(inner(a, b).0));
        } else {
            a = x;
            (at_x, at_y) = (at_y, value(inner(a, b).1));
        }
    }
    0.5 * (a + b)
}

/// Standard error of a correlation from the curvature of the likelihood.
pub(super) fn curvature_error(windows: &[Window], ar1: f64) -> f64 {
    let h = 0.03;
    let value = |phi: f64| likelihood(windows, phi).1;
    let curvature = (2.0 * value(ar1) - value(ar1 - h) - value(ar1 + h)) / (h * h);
    if curvature > 1.0 { curvature.sqrt().recip() } else { 1.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;
    use nalgebra::DVector;

    /// Each entry from its own pair of points, even and uneven, correlated either way.
    #[test]
    fn what_neighbours_pass_on_is_the_correlation_of_all() {
        let (n, m) = (7, 4);
        let uneven = [0.0, 0.6, 1.9, 2.0, 3.5, 4.1, 6.0];
        for (phi, position) in
            [(0.7, Vec::<f64>::new()), (-0.4, vec![]), (0.6, uneven.to_vec()), (0.0, uneven.to_vec())]
        {
            let contrasts = DMatrix::from_fn(n, m, |i, k| ((i + 1) as f64 * (k as f64 + 0.3)).sin());
            let distance = |i: usize, j: usize| match position.is_empty() {
                true => i.abs_diff(j) as f64,
                false => (position[i] - position[j]).abs(),
            };
            let all = DMatrix::from_fn(n, n, |i, j| match i == j {
                true => 1.0,
                false => inverse::correlation_at(phi, distance(i, j)),
            });
            let expected = contrasts.tr_mul(&(all * &contrasts));
            let w = Window { points: n, contrasts, u: DVector::zeros(m), position };
            let half = correlated(&w, phi);
            assert_relative_eq!(half.tr_mul(&half), expected, max_relative = 1e-12, epsilon = 1e-12);
        }
    }
}
