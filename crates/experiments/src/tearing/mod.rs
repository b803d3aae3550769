#![doc = include_str!("README.md")]

use crate::{Experiment, Setting, SupportFault, Supports, at_the_grips, flat_strip, torn_sheet};
use input::{Ends, ExperimentCard, Grips, Test};
use mesh::{Mesh, MeshError, Strip};

/// A tear is through within this many lengths.
const FARTHEST: f64 = 2.0;

static CARD: ExperimentCard = ExperimentCard {
    ends: &[Ends::Clamped, Ends::Sliding],
    grips: &[Grips::Ends, Grips::Mouth],
    ..torn_sheet(
        "tearing",
        "A strip with a cut is torn across, between clamps at its ends or at the mouth of the cut.",
        |g| FARTHEST * g.length,
    )
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
        at_the_grips(mesh, test)
    }
}
