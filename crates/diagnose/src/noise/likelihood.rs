//! The restricted likelihood of windows of a record, and the correlation that makes it largest.
//!
//! Of points y with correlation R = L Lᵀ counts what no smooth curve (orthonormal basis Q) can explain. With contrasts C
//! orthogonal to Q, Harville (1974): det(CᵀRC) = det R · det(QᵀR⁻¹Q), and the square of Cᵀy in its own covariance is that of
//! y in R⁻¹ less what the best curve takes of it. L⁻¹ is two numbers a point, since neighbours pass the correlation on, so
//! a window costs a few columns instead of a matrix of contrasts.

use super::Window;
use nalgebra::DMatrix;

/// Golden section.
const GOLDEN: f64 = 0.618_033_988_75;

/// Restricted likelihood of all windows at correlation `phi`, sd profiled: (sd, log likelihood).
pub(super) fn likelihood(windows: &[Window], phi: f64) -> (f64, f64) {
    let (mut square, mut log_det, mut freedom) = (0.0, 0.0, 0.0);
    for w in windows {
        let Some((s, d)) = of_window(w, phi) else { return (f64::NAN, f64::NEG_INFINITY) };
        (square, log_det, freedom) = (square + s, log_det + d, freedom + w.freedom());
    }
    let variance = square / freedom;
    (variance.sqrt(), -0.5 * (freedom * variance.max(f64::MIN_POSITIVE).ln() + log_det))
}

/// Square and log determinant of a window's contrasts; `None` where the correlation is none.
fn of_window(w: &Window, phi: f64) -> Option<(f64, f64)> {
    let (n, p) = w.basis.shape();
    let next = |i: usize| match w.position.get(i + 1) {
        Some(after) => inverse::correlation_at(phi, after - w.position[i]),
        None => phi,
    };
    // What the point before says of this one, and the sd of what it does not say.
    let (mut before, mut own, mut log_det) = (vec![0.0; n], vec![1.0; n], 0.0);
    for i in 1..n {
        let passed = next(i - 1);
        let variance = 1.0 - passed * passed;
        (before[i], own[i]) = (passed, 1.0 / variance.sqrt());
        log_det += variance.ln();
    }
    let whitened = |x: &[f64], out: &mut [f64]| {
        let mut last = 0.0;
        for i in 0..n {
            out[i] = own[i] * (x[i] - before[i] * last);
            last = x[i];
        }
    };
    // The basis and, last, the points.
    let mut all = DMatrix::zeros(n, p + 1);
    for k in 0..p {
        whitened(w.basis.column(k).as_slice(), all.column_mut(k).as_mut_slice());
    }
    whitened(w.rest.as_slice(), all.column_mut(p).as_mut_slice());
    let gram = all.tr_mul(&all);
    let curve = gram.view((0, 0), (p, p)).into_owned().cholesky()?;
    let taken = curve.l_dirty().view((0, 0), (p, p)).solve_lower_triangular(&gram.view((0, p), (p, 1)))?;
    log_det += 2.0 * curve.l_dirty().diagonal().iter().map(|d| d.ln()).sum::<f64>();
    let square = gram[(p, p)] - taken.norm_squared();
    (square.is_finite() && log_det.is_finite()).then_some((square.max(0.0), log_det))
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

    /// Contrasts, and the correlation of every pair of points, as matrices: even and uneven places, correlated either way.
    #[test]
    fn a_window_says_what_its_contrasts_say() {
        let (n, p) = (9, 3);
        let uneven = [0.0, 0.6, 1.9, 2.0, 3.5, 4.1, 6.0, 6.3, 9.0];
        for (phi, position) in
            [(0.7, Vec::<f64>::new()), (-0.4, vec![]), (0.6, uneven.to_vec()), (0.0, uneven.to_vec())]
        {
            let curves = DMatrix::from_fn(n, p, |i, k| (i as f64).powi(k as i32));
            let basis = inverse::orthonormal(&curves);
            let y = DVector::from_fn(n, |i, _| ((i * i) as f64 * 1.7).sin());
            let rest = &y - &basis * basis.tr_mul(&y);
            let mut contrasts = inverse::orthonormal(&(DMatrix::identity(n, n) - &basis * basis.transpose()));
            contrasts = contrasts.columns(0, n - p).into_owned();
            let distance = |i: usize, j: usize| match position.is_empty() {
                true => i.abs_diff(j) as f64,
                false => (position[i] - position[j]).abs(),
            };
            let all = DMatrix::from_fn(n, n, |i, j| match i == j {
                true => 1.0,
                false => inverse::correlation_at(phi, distance(i, j)),
            });
            let covariance = contrasts.tr_mul(&(all * &contrasts));
            let u = contrasts.tr_mul(&y);
            let square = u.dot(&(covariance.clone().try_inverse().expect("regular") * &u));
            let w = Window { basis, rest, position };
            let (s, d) = of_window(&w, phi).expect("a likelihood");
            assert_relative_eq!(s, square, max_relative = 1e-10);
            assert_relative_eq!(d, covariance.determinant().ln(), max_relative = 1e-9, epsilon = 1e-12);
        }
    }
}
