//! The noise level of a record from the record itself, never from a model's misfit.
//!
//! The record is cut at the given breaks into windows of about 20 points; in each a polynomial takes the
//! smooth part away exactly, and only what no such curve can explain (an orthonormal set of contrasts)
//! counts. Windows with a step or a kink stand out by their variance and are left out. sd and AR(1) follow
//! by restricted maximum likelihood over the remaining windows together (Patterson & Thompson 1971).

use crate::tails::chi2_isf;
use inverse::orthonormal;
use nalgebra::{DMatrix, DVector};
use serde::Serialize;
use thiserror::Error;

const WINDOW: usize = 20;
const SHORTEST: usize = 8;
const LEAST_FREEDOM: usize = 20;

/// The noise of one record.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct NoiseEstimate {
    /// Standard deviation of one point, unit of the record.
    pub sd: f64,
    /// Correlation of neighbouring points: the estimate where it differs from 0 with 95 % confidence, else 0.
    pub ar1: f64,
    /// The raw estimate of that correlation.
    pub ar1_raw: f64,
    /// Relative standard error of `sd`.
    pub relative_error: f64,
    /// Points in the windows that counted.
    pub points_used: usize,
}

/// Why no noise could be estimated.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum NoiseError {
    /// Too few points between breaks.
    #[error(
        "the record is too short to estimate its noise: {found} independent differences, {LEAST_FREEDOM} needed; give force_sd_N"
    )]
    TooShort {
        /// Differences that a smooth curve cannot explain.
        found: usize,
    },
    /// The record holds no noise that its digits could show.
    #[error("the record is smooth to its last digit (sd below {floor:.1e}), so its noise cannot be estimated; give force_sd_N")]
    Noiseless {
        /// What counts as zero.
        floor: f64,
    },
    /// Lengths disagree, time does not increase, or a number is not finite.
    #[error("the record cannot be used: {0}")]
    Record(String),
}

struct Window {
    points: usize,
    contrasts: DMatrix<f64>,
    u: DVector<f64>,
}

impl Window {
    fn freedom(&self) -> f64 {
        self.u.len() as f64
    }

    fn variance(&self) -> f64 {
        self.u.norm_squared() / self.freedom()
    }
}

/// Estimates the noise of `y` at times `t` (any unit, increasing). `breaks` are the indices where a new
/// smooth stretch begins: turning points, ends of holds, jumps; any order, out-of-range ones are ignored.
///
/// # Errors
/// [`NoiseError`] when the record is too short, noiseless or malformed.
pub fn estimate(t: &[f64], y: &[f64], breaks: &[usize]) -> Result<NoiseEstimate, NoiseError> {
    if t.len() != y.len() {
        return Err(NoiseError::Record(format!("{} times for {} values", t.len(), y.len())));
    }
    if t.iter().chain(y).any(|v| !v.is_finite()) {
        return Err(NoiseError::Record("a number is not finite".into()));
    }
    if t.windows(2).any(|w| w[1] <= w[0]) {
        return Err(NoiseError::Record("time does not increase strictly".into()));
    }
    let windows = keep_smooth(windows(t, y, breaks));
    let freedom: usize = windows.iter().map(|w| w.u.len()).sum();
    if freedom < LEAST_FREEDOM {
        return Err(NoiseError::TooShort { found: freedom });
    }
    let range = y.iter().fold(0.0f64, |m, v| m.max(v.abs()));
    let floor = 1e-9 * range;
    let (white_sd, _) = likelihood(&windows, 0.0);
    if white_sd <= floor {
        return Err(NoiseError::Noiseless { floor });
    }
    let ar1_raw = if freedom >= 3 * LEAST_FREEDOM { most_likely(&windows) } else { 0.0 };
    let gain = 2.0 * (likelihood(&windows, ar1_raw).1 - likelihood(&windows, 0.0).1);
    let ar1 = if gain > 3.84 { ar1_raw } else { 0.0 };
    let (sd, _) = likelihood(&windows, ar1);
    Ok(NoiseEstimate {
        sd,
        ar1,
        ar1_raw,
        relative_error: (0.5 / freedom as f64).sqrt() * ((1.0 + ar1.abs()) / (1.0 - ar1.abs())).sqrt(),
        points_used: windows.iter().map(|w| w.points).sum(),
    })
}

fn windows(t: &[f64], y: &[f64], breaks: &[usize]) -> Vec<Window> {
    let mut edges: Vec<usize> = breaks.iter().copied().filter(|&b| b > 0 && b < t.len()).collect();
    edges.push(0);
    edges.push(t.len());
    edges.sort_unstable();
    edges.dedup();
    let mut out = Vec::new();
    for pair in edges.windows(2) {
        let n = pair[1] - pair[0];
        if n < SHORTEST {
            continue;
        }
        let parts = (n as f64 / WINDOW as f64).round().max(1.0) as usize;
        for k in 0..parts {
            let (a, b) = (pair[0] + k * n / parts, pair[0] + (k + 1) * n / parts);
            out.push(window(&t[a..b], &y[a..b]));
        }
    }
    out
}

/// Contrasts orthogonal to polynomials: degree 5 in long windows, 3 in short ones.
fn window(t: &[f64], y: &[f64]) -> Window {
    let n = t.len();
    let degree = if n >= 16 { 5 } else { 3 };
    let (mid, half) = (0.5 * (t[0] + t[n - 1]), 0.5 * (t[n - 1] - t[0]));
    let powers =
        DMatrix::from_fn(n, degree + 1, |i, k| ((t[i] - mid) / half).powi(i32::try_from(k).unwrap_or(0)));
    let q = orthonormal(&powers);
    let rest = DMatrix::identity(n, n) - &q * q.transpose();
    let mut contrasts = orthonormal(&rest);
    let freedom = n - q.ncols();
    if contrasts.ncols() > freedom {
        contrasts = contrasts.columns(0, freedom).into_owned();
    }
    let u = contrasts.tr_mul(&DVector::from_column_slice(y));
    Window { points: n, contrasts, u }
}

/// Leaves out windows whose variance no noise of the typical level would give.
fn keep_smooth(windows: Vec<Window>) -> Vec<Window> {
    let mut levels: Vec<f64> = windows
        .iter()
        .map(|w| w.variance() / (1.0 - 2.0 / (9.0 * w.freedom())).powi(3))
        .collect();
    if levels.is_empty() {
        return windows;
    }
    levels.sort_by(f64::total_cmp);
    let mut typical = levels[(levels.len() - 1) / 2];
    let fits = |w: &Window, level: f64| w.variance() <= 1.2 * level * chi2_isf(1e-3, w.freedom()) / w.freedom();
    for _ in 0..3 {
        let kept: Vec<&Window> = windows.iter().filter(|w| fits(w, typical)).collect();
        let freedom: f64 = kept.iter().map(|w| w.freedom()).sum();
        if freedom == 0.0 {
            break;
        }
        typical = kept.iter().map(|w| w.u.norm_squared()).sum::<f64>() / freedom;
    }
    windows.into_iter().filter(|w| fits(w, typical)).collect()
}

/// Restricted likelihood of all windows at correlation `phi`, sd profiled: (sd, log likelihood).
fn likelihood(windows: &[Window], phi: f64) -> (f64, f64) {
    let (mut square, mut log_det, mut freedom) = (0.0, 0.0, 0.0);
    for w in windows {
        let n = w.contrasts.nrows();
        let r = DMatrix::from_fn(n, n, |i, j| phi.powi(i32::try_from(i.abs_diff(j)).unwrap_or(i32::MAX)));
        let c = w.contrasts.tr_mul(&(r * &w.contrasts));
        let Some(chol) = c.cholesky() else { return (f64::NAN, f64::NEG_INFINITY) };
        square += w.u.dot(&chol.solve(&w.u));
        log_det += 2.0 * chol.l_dirty().diagonal().iter().map(|d| d.ln()).sum::<f64>();
        freedom += w.freedom();
    }
    let variance = square / freedom;
    (variance.sqrt(), -0.5 * (freedom * variance.max(f64::MIN_POSITIVE).ln() + log_det))
}

/// Grid, then golden section.
fn most_likely(windows: &[Window]) -> f64 {
    let value = |phi: f64| likelihood(windows, phi).1;
    let grid: Vec<f64> = (-12..=18).map(|k| 0.05 * f64::from(k)).collect();
    let best = grid.iter().copied().max_by(|a, b| value(*a).total_cmp(&value(*b))).unwrap_or(0.0);
    let (mut a, mut b) = (best - 0.05, best + 0.05);
    let g = 0.618_033_988_75;
    for _ in 0..20 {
        let (x, y) = (b - g * (b - a), a + g * (b - a));
        if value(x) > value(y) { b = y } else { a = x }
    }
    0.5 * (a + b)
}
