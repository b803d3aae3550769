//! A fit's rung: χ² and kin.

use super::{FeLadder, Fitted};
use crate::held_out::held_out;
use diagnose::FittedModel;
use inverse::{Noise, Whitened};
use model::Channel;

impl FeLadder<'_> {
    /// The rung of a fit.
    pub fn fitted_model(&self, effects: &[String], f: &Fitted) -> FittedModel {
        let misfit = self.measured.data.misfit(&f.fit.prediction.values);
        let mut force = Vec::new();
        for (slot, block) in self.measured.slots.iter().zip(&self.measured.data.blocks) {
            if slot.channel == Channel::Force {
                force.extend(
                    block.range.clone().filter(|&i| self.measured.data.is_used(i)).map(|i| misfit[i]),
                );
            }
        }
        let white = Whitened::new(
            &self.measured.data,
            &f.free_parameters,
            &f.fit.theta,
            &f.fit.prediction,
            Noise::Total,
        );
        let rows = white.rows.len();
        let structure = diagnose::atlas::structure_p(white.r.rows(0, rows).into_owned().as_slice());
        let fitted_model = FittedModel::new(effects, &f.quality, inverse::rms(force), structure);
        match held_out(&self.case, &self.measured, &white, &f.fit.at_bound) {
            Some(h) => fitted_model.held_out(h.chi2, h.points, h.rms),
            None => fitted_model,
        }
    }
}
