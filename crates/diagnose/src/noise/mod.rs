//! The noise level of a record from the record itself, never from a model's misfit.
//!
//! The record is cut at the given breaks into windows of about 20 points (40 where the noise turns out to be
//! autocorrelated); in each a polynomial takes the smooth part away exactly, and only what no such curve can explain
//! counts. Windows with a step or a kink stand out by their variance and are left out. sd and AR(1) follow by restricted
//! maximum likelihood over the remaining windows together (Patterson & Thompson 1971).

mod likelihood;

use crate::ratio::ratio;
use crate::tails::chi2_isf;
use inverse::orthonormal;
use likelihood::{curvature_error, likelihood, most_likely};
use nalgebra::{DMatrix, DVector};
use serde::Serialize;
use std::ops::Range;
use thiserror::Error;

const WINDOW: usize = 20;
const LONG_WINDOW: usize = 40;
const SHORTEST: usize = 8;
const LEAST_FREEDOM: usize = 20;
/// Points of a larger spread say nothing of the usual ones.
const WIDE: f64 = 1.5;
/// More windows tell no more: of those of a long record as many are taken, evenly.
const MOST_WINDOWS: usize = 150;

/// The noise of one record.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct NoiseEstimate {
    /// Standard deviation of one point, unit of the record.
    pub sd: f64,
    /// Correlation of neighbouring points: the estimate where twice its gain in log likelihood over white noise
    /// exceeds 2 (3.84 for a negative one), else 0.
    pub ar1: f64,
    /// The raw estimate of that correlation.
    pub ar1_raw: f64,
    /// Standard error of the raw estimate; 1 where it could not be made.
    pub ar1_error: f64,
    /// Correlation to whiten with when a false alarm is worse than a miss: 1.5 standard errors above `ar1`
    /// where the noise is autocorrelated, else `ar1_raw` where positive. Underestimated correlation is what makes smooth misfits look
    /// significant.
    pub conservative_ar1: f64,
    /// Most likely sd at `conservative_ar1`.
    pub conservative_sd: f64,
    /// Relative standard error of `sd`.
    pub relative_error: f64,
    /// Points in the windows that counted.
    pub points_used: usize,
}

impl NoiseEstimate {
    /// Degrees of freedom of a χ² that is as uncertain as the square of `sd`.
    pub fn freedom(&self) -> f64 {
        0.5 / self.relative_error.powi(2)
    }
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
    #[error(
        "the record is smooth to its last digit (sd below {floor:.1e}), so its noise cannot be estimated; give force_sd_N"
    )]
    Noiseless {
        /// What counts as zero.
        floor: f64,
    },
    /// Lengths disagree, time does not increase, or a number is not finite.
    #[error("the record cannot be used: {0}")]
    Record(String),
}

struct Window {
    /// Orthonormal basis of the smooth curves.
    basis: DMatrix<f64>,
    /// The points without their smooth part.
    rest: DVector<f64>,
    /// Places of the points, where they are not 0, 1, 2, ….
    position: Vec<f64>,
}

/// Points that are averages of unequal numbers of readings: sd of each in units of a common one, and places in units of
/// neighbours' distance (as [`inverse::NoiseModel`] has them). Empty lists: single readings.
#[derive(Clone, Copy, Debug, Default)]
pub struct Averages<'a> {
    /// Sd of each point.
    pub spread: &'a [f64],
    /// Place of each point, growing.
    pub position: &'a [f64],
}

impl Window {
    fn freedom(&self) -> f64 {
        self.independent() as f64
    }

    /// Differences that no smooth curve can explain.
    fn independent(&self) -> usize {
        self.rest.len() - self.basis.ncols()
    }

    fn variance(&self) -> f64 {
        self.rest.norm_squared() / self.freedom()
    }
}

/// Estimates the noise of `y` at times `t` (any unit, increasing). `breaks` are the indices where a new
/// smooth stretch begins: turning points, ends of holds, jumps; any order, out-of-range ones are ignored.
///
/// # Errors
/// [`NoiseError`] when the record is too short, noiseless or malformed.
pub fn estimate(t: &[f64], y: &[f64], breaks: &[usize]) -> Result<NoiseEstimate, NoiseError> {
    estimate_averages(t, y, Averages::default(), breaks)
}

/// The same of averages: the sd is that of a point of spread 1. Points of a clearly larger spread are left out: they are few
/// readings close to each other, and share errors that others do not.
///
/// # Errors
/// As [`estimate`].
pub fn estimate_averages(
    t: &[f64],
    y: &[f64],
    averages: Averages,
    breaks: &[usize],
) -> Result<NoiseEstimate, NoiseError> {
    for list in [averages.spread, averages.position] {
        if !list.is_empty() && list.len() != y.len() {
            return Err(NoiseError::Record(format!("{} averages for {} values", list.len(), y.len())));
        }
    }
    if averages.spread.iter().any(|s| *s > WIDE) {
        let kept: Vec<usize> = (0..y.len()).filter(|&i| averages.spread[i] <= WIDE).collect();
        let pick = |v: &[f64]| kept.iter().filter_map(|&i| v.get(i).copied()).collect::<Vec<f64>>();
        let (spread, position) = (pick(averages.spread), pick(averages.position));
        let breaks: Vec<usize> = breaks.iter().map(|b| kept.partition_point(|k| k < b)).collect();
        let averages = Averages { spread: &spread, position: &position };
        return estimate_averages(&pick(t), &pick(y), averages, &breaks);
    }
    if t.len() != y.len() {
        return Err(NoiseError::Record(format!("{} times for {} values", t.len(), y.len())));
    }
    if t.iter().chain(y).any(|v| !v.is_finite()) {
        return Err(NoiseError::Record("a number is not finite".into()));
    }
    if t.windows(2).any(|w| w[1] <= w[0]) {
        return Err(NoiseError::Record("time does not increase strictly".into()));
    }
    let windows = keep_smooth(cut(t, y, averages, breaks, WINDOW));
    let freedom: usize = windows.iter().map(Window::independent).sum();
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
    if !significant(&windows, ar1_raw) {
        return Ok(summary(&windows, 0.0, ar1_raw));
    }
    // Autocorrelated noise lives at low frequencies, which only longer windows see.
    let long = keep_smooth(cut(t, y, averages, breaks, LONG_WINDOW));
    let enough = long.iter().map(Window::independent).sum::<usize>() >= freedom / 2;
    let windows = if enough { long } else { windows };
    let ar1 = most_likely(&windows);
    Ok(summary(&windows, ar1, ar1))
}

fn significant(windows: &[Window], ar1: f64) -> bool {
    let gain = 2.0 * (likelihood(windows, ar1).1 - likelihood(windows, 0.0).1);
    gain > if ar1 > 0.0 { 2.0 } else { 3.84 }
}

fn summary(windows: &[Window], ar1: f64, ar1_raw: f64) -> NoiseEstimate {
    let freedom: f64 = windows.iter().map(Window::freedom).sum();
    let ar1_error = curvature_error(windows, ar1_raw);
    let conservative_ar1 = if ar1 == 0.0 { ar1_raw.max(0.0) } else { (ar1 + 1.5 * ar1_error).min(0.9) };
    NoiseEstimate {
        sd: likelihood(windows, ar1).0,
        ar1,
        ar1_raw,
        ar1_error,
        conservative_ar1,
        conservative_sd: likelihood(windows, conservative_ar1).0,
        relative_error: (0.5 / freedom).sqrt() * ((1.0 + ar1.abs()) / (1.0 - ar1.abs())),
        points_used: windows.iter().map(|w| w.rest.len()).sum(),
    }
}

fn cut(t: &[f64], y: &[f64], averages: Averages, breaks: &[usize], target: usize) -> Vec<Window> {
    let mut edges: Vec<usize> = breaks.iter().map(|&b| b.min(t.len())).collect();
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
        let parts = (n as f64 / target as f64).round().max(1.0) as usize;
        for k in 0..parts {
            out.push(pair[0] + k * n / parts..pair[0] + (k + 1) * n / parts);
        }
    }
    let (all, taken) = (out.len(), out.len().min(MOST_WINDOWS));
    (0..taken).map(|k| window(t, y, averages, out[k * all / taken].clone())).collect()
}

/// What polynomials leave: of degree 3, 5 or 7 as the window grows.
fn window(t: &[f64], y: &[f64], averages: Averages, range: Range<usize>) -> Window {
    let (t, n) = (&t[range.clone()], range.len());
    let share = |i: usize| averages.spread.get(range.start + i).copied().unwrap_or(1.0);
    let degree = match n {
        32.. => 7,
        16.. => 5,
        _ => 3,
    };
    let (mid, half) = (0.5 * (t[0] + t[n - 1]), 0.5 * (t[n - 1] - t[0]));
    let powers = DMatrix::from_fn(n, degree + 1, |i, k| {
        ((t[i] - mid) / half).powi(i32::try_from(k).unwrap_or(0)) / share(i)
    });
    let basis = orthonormal(&powers);
    let points = DVector::from_fn(n, |i, _| y[range.start + i] / share(i));
    let mut rest = &points - &basis * basis.tr_mul(&points);
    // A large mean leaves its rounding in the rest, which a second time takes away.
    rest -= &basis * basis.tr_mul(&rest);
    let position = averages.position.get(range).map_or_else(Vec::new, <[f64]>::to_vec);
    Window { basis, rest, position }
}

/// Leaves out windows whose variance no noise of the typical level would give.
fn keep_smooth(windows: Vec<Window>) -> Vec<Window> {
    let mut levels: Vec<f64> =
        windows.iter().map(|w| w.variance() / (1.0 - 2.0 / (9.0 * w.freedom())).powi(3)).collect();
    if levels.is_empty() {
        return windows;
    }
    levels.sort_by(f64::total_cmp);
    let mut typical = levels[(levels.len() - 1) / 2];
    let fits =
        |w: &Window, level: f64| w.variance() <= 1.2 * level * chi2_isf(1e-3, w.freedom()) / w.freedom();
    for _ in 0..3 {
        let kept: Vec<&Window> = windows.iter().filter(|w| fits(w, typical)).collect();
        let freedom: f64 = kept.iter().map(|w| w.freedom()).sum();
        typical = ratio(kept.iter().map(|w| w.rest.norm_squared()).sum(), freedom);
    }
    windows.into_iter().filter(|w| fits(w, typical)).collect()
}
