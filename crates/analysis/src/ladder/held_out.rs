//! How well a fit does: χ² and kin, and what whole segments say that the fit did not see.

use super::{FeLadder, Fitted};
use diagnose::Rung;
use inverse::{Noise, Whitened};
use model::Channel;
use nalgebra::{DMatrix, DVector};

impl FeLadder<'_> {
    /// The rung of a fit.
    pub fn rung(&self, effects: &[String], f: &Fitted) -> Rung {
        let misfit = self.measured.data.misfit(&f.fit.prediction.values);
        let mut force = Vec::new();
        for (slot, block) in self.measured.slots.iter().zip(&self.measured.data.blocks) {
            if slot.channel == Channel::Force {
                force.extend(block.range.clone().map(|i| misfit[i]));
            }
        }
        let white =
            Whitened::new(&self.measured.data, &f.frees, &f.fit.theta, &f.fit.prediction, Noise::Total);
        let rows = white.rows.len();
        let structure = diagnose::atlas::structure_p(white.r.rows(0, rows).into_owned().as_slice());
        let rung = Rung::new(effects, &f.quality, inverse::rms(force), structure);
        match self.held_out(f, &white) {
            Some((chi2, points, rms)) => rung.held_out(chi2, points, rms),
            None => rung,
        }
    }

    /// Whole segments left out in turn, their prediction corrected to first order for not having
    /// been fitted: reduced χ² and rms of what the fit did not see.
    fn held_out(&self, f: &Fitted, white: &Whitened) -> Option<(f64, usize, f64)> {
        let mask = self.hold_out_mask();
        let rows = white.rows.len();
        let out: Vec<usize> = (0..rows).filter(|&r| mask[white.rows[r]]).collect();
        if out.len() < 10 {
            return None;
        }
        let open: Vec<usize> = (0..f.free.len()).filter(|&k| !f.fit.at_bound[k]).collect();
        let j = DMatrix::from_fn(white.jacobian.nrows(), open.len(), |r, c| white.jacobian[(r, open[c])]);
        let kept: Vec<usize> = (0..j.nrows()).filter(|r| *r >= rows || !mask[white.rows[*r]]).collect();
        let jt = DMatrix::from_fn(kept.len(), open.len(), |r, c| j[(kept[r], c)]);
        let rt = DVector::from_iterator(kept.len(), kept.iter().map(|&r| white.r[r]));
        let normal = jt.tr_mul(&jt);
        let ridge = 1e-9 * normal.diagonal().max();
        let step =
            (normal + DMatrix::identity(open.len(), open.len()) * ridge).cholesky()?.solve(&jt.tr_mul(&rt));
        let (mut chi2, mut square) = (0.0, 0.0);
        for &r in &out {
            let left = white.r[r] - j.row(r).dot(&step.transpose());
            chi2 += left * left;
            let sd = self.sd_at(white.rows[r]);
            square += (left * sd).powi(2);
        }
        let n = out.len() as f64;
        Some((chi2 / n, out.len(), (square / n).sqrt()))
    }

    fn sd_at(&self, point: usize) -> f64 {
        self.measured.data.blocks.iter().find(|b| b.range.contains(&point)).map_or(1.0, |b| b.noise.sd)
    }

    fn hold_out_mask(&self) -> Vec<bool> {
        let mut mask = vec![false; self.measured.data.points()];
        for (slot, block) in self.measured.slots.iter().zip(&self.measured.data.blocks) {
            let test = &self.case.tests[slot.test];
            let (Some(r), Channel::Force) = (&test.record, slot.channel) else { continue };
            let segments = crate::compare::segments(test, r);
            let split = diagnose::holdout::split(&segments, r.len(), 0.25);
            for (k, i) in block.range.clone().enumerate() {
                mask[i] = split.mask.get(slot.rows[k]).copied().unwrap_or(false);
            }
        }
        mask
    }
}
