//! How much of the tearing records a fit leaves, and whether a step was any use to it.

use crate::data::Measured;
use model::{Channel, Model};
use nalgebra::DVector;

/// Standard deviations of χ² that are left to chance.
const CHANCE: f64 = 3.0;

/// Share of the tear's excess that a step leaves where other parameters may have to move.
const STALLED: f64 = 0.5;

/// χ² of the tearing records that a fit left, with their noise as if it were white.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct TearMisfit {
    chi2: f64,
    points: f64,
}

impl TearMisfit {
    pub fn of(model: &Model, measured: &Measured, predicted: &DVector<f64>) -> Self {
        let misfit = measured.data.misfit(predicted);
        let mut left = Self::default();
        for (slot, block) in measured.slots.iter().zip(&measured.data.blocks) {
            if model.tests[slot.test].test.kind.tears && slot.channel == Channel::Force {
                let own = |i: usize| (misfit[i] / block.noise.sd_of(i - block.range.start)).powi(2);
                let used = || block.range.clone().filter(|&i| measured.data.is_used(i));
                left.chi2 += used().map(own).sum::<f64>();
                left.points += used().count() as f64;
            }
        }
        left
    }

    /// Per point; no record of a tear: not a number.
    pub fn per_point(self) -> f64 {
        self.chi2 / self.points
    }

    /// What noise alone does not leave.
    pub fn excess(self) -> f64 {
        self.chi2 - self.points
    }

    /// Whether noise alone would not leave as much.
    pub fn unexplained(self) -> bool {
        self.excess() > CHANCE * (2.0 * self.points).sqrt()
    }

    /// Whether a step that began with `before` led hardly nearer to what noise leaves.
    pub fn stalls(self, before: Self) -> bool {
        self.unexplained() && self.excess() > STALLED * before.excess()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn left(chi2: f64) -> TearMisfit {
        TearMisfit { chi2, points: 200.0 }
    }

    #[test]
    fn three_standard_deviations_are_chance() {
        // χ² of 200 points has a standard deviation of 20.
        assert!(!left(259.0).unexplained() && left(261.0).unexplained());
        assert_eq!((left(300.0).per_point(), left(300.0).excess()), (1.5, 100.0));
        assert!(!TearMisfit::default().unexplained(), "no tear, no misfit");
    }

    #[test]
    fn a_step_stalls_that_leaves_more_than_half_of_the_excess() {
        assert!(left(1210.0).stalls(left(2200.0)), "1010 of 2000");
        assert!(!left(1190.0).stalls(left(2200.0)), "990 of 2000");
        assert!(!left(255.0).stalls(left(256.0)), "what chance leaves is no reason to try anything else");
    }
}
