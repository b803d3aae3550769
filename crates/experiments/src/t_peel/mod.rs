#![doc = include_str!("README.md")]

use crate::{Experiment, Held, Sample, Setting, SupportFault, Supports, peeled_sheet, split_strip};
use input::{ExperimentCard, Geometry, Test};
use mesh::{Mesh, MeshError, Strip};

/// Usual share of the bonded length that is peeled.
const PEELED: f64 = 0.5;
/// Usual stretch of the arms.
const STRETCH: f64 = 1.2;

static CARD: ExperimentCard = peeled_sheet(
    "t_peel",
    "A sheet split in its plane is peeled: its two arms are pulled apart, the rest hangs free.",
    farthest,
);

/// A dissection test: two arms pulled apart.
#[derive(Clone, Copy, Debug, Default)]
pub struct TPeel;

impl Experiment for TPeel {
    fn card(&self) -> &'static ExperimentCard {
        &CARD
    }

    fn sample(&self) -> Option<Sample> {
        Some(Sample {
            specimen: include_str!("sample/specimen.toml"),
            config: include_str!("sample/config.toml"),
            records: &[("peel.csv", include_str!("sample/peel.csv"))],
        })
    }

    fn strip(&self, setting: &Setting<'_>) -> Result<Strip, MeshError> {
        split_strip(setting, true)
    }

    fn supports(&self, mesh: &Mesh, test: &Test) -> Result<Supports, SupportFault> {
        let mut held = Held::at_mirrors(mesh, test)?;
        let share = held.share;
        // Both faces of the tear begin at the ends of the arms: the upper one belongs to the upper arm.
        let upper_face = mesh.set("path_upper").unwrap_or_default();
        for &n in held.set("left")? {
            let upper = mesh.half_height || mesh.nodes[n][1] > mesh.path_y || upper_face.contains(&n);
            held.hold(n, 1, if upper { share } else { 0.0 });
            held.hold(n, 0, 0.0);
            held.hold(n, 2, 0.0);
        }
        Ok(held.done())
    }
}

fn farthest(g: &Geometry) -> f64 {
    2.0 * STRETCH * (g.cut + PEELED * (g.length - g.cut))
}
