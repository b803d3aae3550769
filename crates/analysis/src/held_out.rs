//! What whole segments say that a fit did not see.

use crate::data::Measured;
use input::Case;
use inverse::Whitened;
use model::Channel;
use nalgebra::{DMatrix, DVector};

/// Share of the segments that is held out.
const SHARE: f64 = 0.25;
/// Fewer held-out points say nothing.
const LEAST: usize = 10;

/// How well held-out segments are predicted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HeldOut {
    /// Whitened χ² per point.
    pub chi2: f64,
    /// Points.
    pub points: usize,
    /// Root mean square misfit, N.
    pub rms: f64,
}

/// Whole segments left out, their prediction corrected to first order for not having been fitted. `None` where the
/// record has too few of them.
pub fn held_out(case: &Case, measured: &Measured, white: &Whitened, at_bound: &[bool]) -> Option<HeldOut> {
    let mask = mask(case, measured);
    let rows = white.rows.len();
    let out: Vec<usize> = (0..rows).filter(|&r| mask[white.rows[r]]).collect();
    if out.len() < LEAST {
        return None;
    }
    let open: Vec<usize> = (0..at_bound.len()).filter(|&k| !at_bound[k]).collect();
    let j = DMatrix::from_fn(white.jacobian.nrows(), open.len(), |r, c| white.jacobian[(r, open[c])]);
    let kept: Vec<usize> = (0..j.nrows()).filter(|r| *r >= rows || !mask[white.rows[*r]]).collect();
    let jt = DMatrix::from_fn(kept.len(), open.len(), |r, c| j[(kept[r], c)]);
    let rt = DVector::from_iterator(kept.len(), kept.iter().map(|&r| white.r[r]));
    let normal = jt.tr_mul(&jt);
    let ridge = 1e-9 * normal.diagonal().max();
    let step =
        (normal + DMatrix::identity(open.len(), open.len()) * ridge).cholesky()?.solve(&jt.tr_mul(&rt));
    let sd = |point: usize| {
        measured.data.blocks.iter().find(|b| b.range.contains(&point)).map_or(1.0, |b| b.noise.sd)
    };
    let (mut chi2, mut square) = (0.0, 0.0);
    for &r in &out {
        let left = white.r[r] - j.row(r).dot(&step.transpose());
        chi2 += left * left;
        square += (left * sd(white.rows[r])).powi(2);
    }
    let n = out.len() as f64;
    Some(HeldOut { chi2: chi2 / n, points: out.len(), rms: (square / n).sqrt() })
}

/// Points of the segments that are held out.
fn mask(case: &Case, measured: &Measured) -> Vec<bool> {
    let mut mask = vec![false; measured.data.points()];
    for (slot, block) in measured.slots.iter().zip(&measured.data.blocks) {
        let test = &case.tests[slot.test];
        let (Some(r), Channel::Force) = (&test.record, slot.channel) else { continue };
        let segments = crate::compare::segments(test, r);
        let split = diagnose::holdout::split(&segments, r.len(), SHARE);
        for (k, i) in block.range.clone().enumerate() {
            mask[i] = split.mask.get(slot.rows[k]).copied().unwrap_or(false);
        }
    }
    mask
}
