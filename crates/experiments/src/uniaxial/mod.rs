#![doc = include_str!("README.md")]

use crate::{Experiment, Setting, SupportFault, Supports, at_the_grips, flat_strip, intact_sheet};
use input::{Ends, ExperimentCard, Grips, Test};
use mesh::{Mesh, MeshError, Strip};

/// Usual strain of an intact strip.
const STRETCH: f64 = 0.35;

static CARD: ExperimentCard = ExperimentCard {
    free_strip: true,
    channels: &["grip_displacement", "width_change"],
    ends: &[Ends::Clamped, Ends::Sliding],
    grips: &[Grips::Ends, Grips::Mouth],
    ..intact_sheet("uniaxial", "An intact strip is stretched between two clamps.", |g| STRETCH * g.length)
};

/// An intact strip, stretched.
#[derive(Clone, Copy, Debug, Default)]
pub struct Uniaxial;

impl Experiment for Uniaxial {
    fn card(&self) -> &'static ExperimentCard {
        &CARD
    }

    fn strip(&self, setting: &Setting<'_>) -> Result<Strip, MeshError> {
        flat_strip(setting)
    }

    fn supports(&self, mesh: &Mesh, test: &Test) -> Result<Supports, SupportFault> {
        at_the_grips(mesh, test)
    }
}
