#![doc = include_str!("README.md")]

use crate::{
    Experiment, Setting, SupportFault, Supports, across_the_ends, any_piece, at_the_mouth, flat_strip,
    no_balance, nothing,
};
use input::{Ends, ExperimentCard, Geometry, Grips, Layout, Test};
use mesh::{Mesh, MeshError, Strip};

/// Usual strain of an intact strip.
const STRETCH: f64 = 0.35;

static CARD: ExperimentCard = ExperimentCard {
    name: "uniaxial",
    summary: "An intact strip is stretched between two clamps.",
    layout: Layout::Sheet,
    tears: false,
    whole_section: true,
    free_strip: true,
    two_axes: false,
    channels: &["grip_displacement", "width_change"],
    ends: &[Ends::Clamped, Ends::Sliding],
    grips: &[Grips::Ends, Grips::Mouth],
    clamped_faces: true,
    shaped: true,
    objection: any_piece,
    farthest: |g: &Geometry| STRETCH * g.length,
    estimate: nothing,
    balance: no_balance,
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
        match test.grips {
            Grips::Ends => across_the_ends(mesh, test),
            Grips::Mouth => at_the_mouth(mesh, test),
        }
    }
}
