#![doc = include_str!("README.md")]

use crate::{
    Experiment, Setting, SupportFault, Supports, across_the_ends, any_piece, at_the_mouth, flat_strip,
    from_area, over_the_torn_area,
};
use input::{Ends, ExperimentCard, Geometry, Grips, Layout, Test};
use mesh::{Mesh, MeshError, Strip};

/// A tear is through within this many lengths.
const FARTHEST: f64 = 2.0;

static CARD: ExperimentCard = ExperimentCard {
    name: "tearing",
    summary: "A strip with a cut is torn across, between clamps at its ends or at the mouth of the cut.",
    layout: Layout::Sheet,
    tears: true,
    whole_section: true,
    free_strip: false,
    two_axes: false,
    channels: &["grip_displacement", "tear_front"],
    ends: &[Ends::Clamped, Ends::Sliding],
    grips: &[Grips::Ends, Grips::Mouth],
    clamped_faces: true,
    shaped: true,
    objection: any_piece,
    farthest: |g: &Geometry| FARTHEST * g.length,
    estimate: from_area,
    balance: over_the_torn_area,
};

/// A strip with a cut, torn.
#[derive(Clone, Copy, Debug, Default)]
pub struct Tearing;

impl Experiment for Tearing {
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
