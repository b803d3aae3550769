//! The misfit atlas: where the model is off, segment by segment.

use crate::ratio::ratio;
use crate::segments::Segment;
use crate::tails::normal_sf;
use inverse::rms;
use serde::Serialize;

/// The misfit of one segment.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SegmentMisfit {
    /// Name of the segment.
    pub segment: String,
    /// Number of points.
    pub points: usize,
    /// Share of the record's Σ r².
    pub share: f64,
    /// Root mean square misfit, unit of the misfit.
    pub rms: f64,
    /// Mean misfit (measurement − model).
    pub mean: f64,
    /// `+` measured above the model, `-` below, `0` neither (mean within two standard errors of zero,
    /// autocorrelation counted).
    pub sign: char,
    /// Lag-1 autocorrelation about zero.
    pub autocorrelation: f64,
    /// Durbin–Watson statistic: 2 for independent misfits, near 0 for a smooth misfit.
    pub durbin_watson: f64,
    /// p-value of the runs test (Wald & Wolfowitz 1940) against too few changes of sign.
    pub runs_p: f64,
}

/// One row per segment. `misfit` belongs to the whole record (whitened or in its unit); points out of range
/// are ignored, empty segments give zeros.
pub fn atlas(misfit: &[f64], segments: &[Segment]) -> Vec<SegmentMisfit> {
    let total: f64 = misfit.iter().map(|r| r * r).sum();
    segments
        .iter()
        .map(|s| {
            let end = s.range.end.min(misfit.len());
            row(&s.name, &misfit[s.range.start.min(end)..end], total)
        })
        .collect()
}

/// The same by position, such as that of the tear front, one value per point: a row for the points that stand at the
/// least position, and one for each of `classes` equal stretches beyond it that holds any. Ends of each, and the row.
pub fn atlas_by(misfit: &[f64], position: &[f64], classes: usize) -> Vec<([f64; 2], SegmentMisfit)> {
    let total: f64 = misfit.iter().map(|r| r * r).sum();
    let low = position.iter().copied().fold(f64::INFINITY, f64::min);
    let high = position.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let width = (high - low) / classes as f64;
    if !(width.is_finite() && width > 0.0) {
        return Vec::new();
    }
    let class = |x: f64| (((x - low) / width).ceil() as usize).min(classes);
    let stretch = |k: usize| {
        let r: Vec<f64> =
            misfit.iter().zip(position).filter(|(_, x)| class(**x) == k).map(|(r, _)| *r).collect();
        let ends = [low + k.saturating_sub(1) as f64 * width, low + k as f64 * width];
        (!r.is_empty()).then(|| (ends, row(&format!("{:.2} mm", ends[1]), &r, total)))
    };
    (0..=classes).filter_map(stretch).collect()
}

fn row(name: &str, r: &[f64], total: f64) -> SegmentMisfit {
    let square: f64 = r.iter().map(|v| v * v).sum();
    let n = r.len() as f64;
    let mean = ratio(r.iter().sum(), n);
    let rho = autocorrelation(r);
    let changes: f64 = r.windows(2).map(|w| (w[1] - w[0]).powi(2)).sum();
    let effective = (n * (1.0 - rho.max(0.0)) / (1.0 + rho.max(0.0))).max(1.0);
    let spread = ((square / n.max(1.0) - mean * mean).max(0.0) / effective).sqrt();
    let sign = match mean {
        m if m > 2.0 * spread => '+',
        m if m < -2.0 * spread => '-',
        _ => '0',
    };
    SegmentMisfit {
        segment: name.to_owned(),
        points: r.len(),
        share: ratio(square, total),
        rms: rms(r.iter().copied()),
        mean,
        sign,
        autocorrelation: rho,
        durbin_watson: if square > 0.0 { changes / square } else { 2.0 },
        runs_p: runs_p(r),
    }
}

/// Lag-1 autocorrelation about zero; 0 for fewer than two points.
pub fn autocorrelation(r: &[f64]) -> f64 {
    let square: f64 = r.iter().map(|v| v * v).sum();
    ratio(r.windows(2).map(|w| w[0] * w[1]).sum(), square)
}

/// p-value that independent signs change as seldom as those of `r` or more seldom; 1 for fewer than ten points.
pub fn runs_p(r: &[f64]) -> f64 {
    let signs: Vec<bool> = r.iter().filter(|v| **v != 0.0).map(|v| *v > 0.0).collect();
    let up = signs.iter().filter(|&&s| s).count() as f64;
    let n = signs.len() as f64;
    let down = n - up;
    if n < 10.0 {
        return 1.0;
    }
    if up == 0.0 || down == 0.0 {
        return 0.5f64.powf(n - 1.0).max(crate::tails::SMALLEST);
    }
    let runs = 1.0 + signs.windows(2).filter(|w| w[0] != w[1]).count() as f64;
    let expected = 1.0 + 2.0 * up * down / n;
    let variance = (expected - 1.0) * (expected - 2.0) / (n - 1.0);
    if variance <= 0.0 { 1.0 } else { normal_sf((expected - runs) / variance.sqrt()) }
}

/// p-value that whitened misfits (variance 1 each) are as positively autocorrelated over lags 1 to 5 as seen: a
/// sum of lagged products, normal for independent misfits. 1 for fewer than 20 points.
pub fn structure_p(whitened: &[f64]) -> f64 {
    let n = whitened.len();
    if n < 20 {
        return 1.0;
    }
    let variance = whitened.iter().map(|v| v * v).sum::<f64>() / n as f64;
    if variance <= 0.0 {
        return 1.0;
    }
    let (mut sum, mut terms) = (0.0, 0.0);
    for lag in 1..=5 {
        sum += (lag..n).map(|i| whitened[i] * whitened[i - lag]).sum::<f64>() / variance;
        terms += (n - lag) as f64;
    }
    normal_sf(sum / terms.sqrt()).max(crate::tails::SMALLEST)
}
