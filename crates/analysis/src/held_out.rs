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

/// Least share of their fitted square that held-out misfits have where a fit has arrived; below 1 for fits that stop
/// where steps no longer matter.
const ARRIVED: f64 = 0.8;

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
/// record has too few of them, or the fit has not arrived.
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
    let left = unseen(&white.r, &j, &kept, &out)?;
    let sd = |point: usize| {
        let mine = measured.data.blocks.iter().find(|b| b.range.contains(&point));
        mine.map_or(1.0, |b| b.noise.sd_of(point - b.range.start))
    };
    let (mut chi2, mut square) = (0.0, 0.0);
    for (left, &r) in left.iter().zip(&out) {
        chi2 += left * left;
        square += (left * sd(white.rows[r])).powi(2);
    }
    let n = out.len() as f64;
    Some(HeldOut { chi2: chi2 / n, points: out.len(), rms: (square / n).sqrt() })
}

/// Misfits `r` of the rows `out` if the linear model with derivatives `j` had been fitted to the rows `kept` alone.
///
/// `None` where they come out clearly smaller than the fit left them: leaving points out cannot predict them better than
/// fitting them did, so that fit has not arrived (a rough misfit, a limit of iterations) and its derivatives promise
/// what a step along them would not keep.
fn unseen(r: &DVector<f64>, j: &DMatrix<f64>, kept: &[usize], out: &[usize]) -> Option<Vec<f64>> {
    let jt = DMatrix::from_fn(kept.len(), j.ncols(), |i, c| j[(kept[i], c)]);
    let rt = DVector::from_iterator(kept.len(), kept.iter().map(|&i| r[i]));
    let normal = jt.tr_mul(&jt);
    let ridge = 1e-9 * normal.diagonal().max();
    let step = (normal + DMatrix::identity(j.ncols(), j.ncols()) * ridge).cholesky()?.solve(&jt.tr_mul(&rt));
    let left: Vec<f64> = out.iter().map(|&i| r[i] - j.row(i).dot(&step.transpose())).collect();
    let square = |values: &mut dyn Iterator<Item = f64>| values.map(|x| x * x).sum::<f64>();
    let (unseen, seen) = (square(&mut left.iter().copied()), square(&mut out.iter().map(|&i| r[i])));
    (unseen >= ARRIVED * seen).then_some(left)
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

#[cfg(test)]
mod tests {
    use super::*;

    /// A line through 40 points, two of which in three are kept, with this misfit at the start.
    fn line(misfit: impl Fn(f64) -> f64) -> (DVector<f64>, DMatrix<f64>, Vec<usize>, Vec<usize>) {
        let x = |i: usize| i as f64 / 40.0;
        let r = DVector::from_fn(40, |i, _| misfit(x(i)));
        let j = DMatrix::from_fn(40, 2, |i, c| if c == 0 { 1.0 } else { x(i) });
        let (out, kept) = (0..40).partition(|i| i % 3 == 0);
        (r, j, kept, out)
    }

    #[test]
    fn points_left_out_of_a_fit_are_predicted_worse_than_fitted() {
        let (mut r, j, kept, out) = line(|x| (40.0 * x).sin());
        // At the optimum of all points.
        let step = (j.tr_mul(&j)).cholesky().unwrap().solve(&j.tr_mul(&r));
        r -= &j * step;
        let left = unseen(&r, &j, &kept, &out).expect("a fit that has arrived");
        let fitted: f64 = out.iter().map(|&i| r[i] * r[i]).sum();
        assert!(left.iter().map(|x| x * x).sum::<f64>() > fitted);
    }

    #[test]
    fn a_fit_that_has_not_arrived_predicts_nothing() {
        let (r, j, kept, out) = line(|x| 5.0 + 3.0 * x + 0.1 * (40.0 * x).sin());
        assert_eq!(unseen(&r, &j, &kept, &out), None);
    }
}
