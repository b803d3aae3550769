#![doc = include_str!("README.md")]

use crate::{Experiment, Setting, SupportFault, Supports, across_the_ends, flat_strip, torn_sheet};
use input::{Balance, ExperimentCard, Geometry, Record, Test};
use mesh::{Mesh, MeshError, Strip};

/// Least width over the distance of the clamps.
const WIDE: f64 = 3.0;

static CARD: ExperimentCard = ExperimentCard {
    objection,
    estimate,
    balance,
    ..torn_sheet(
        "pure_shear",
        "A wide sheet with a cut is pulled between long clamps until the tear runs.",
        |g| g.length,
    )
};

/// A wide sheet with a cut.
#[derive(Clone, Copy, Debug, Default)]
pub struct PureShear;

impl Experiment for PureShear {
    fn card(&self) -> &'static ExperimentCard {
        &CARD
    }

    fn strip(&self, setting: &Setting<'_>) -> Result<Strip, MeshError> {
        flat_strip(setting)
    }

    fn supports(&self, mesh: &Mesh, test: &Test) -> Result<Supports, SupportFault> {
        across_the_ends(mesh, test)
    }
}

fn objection(g: &Geometry) -> Option<(&'static str, String)> {
    let least = WIDE * g.length;
    (g.width < least)
        .then(|| ("width", format!("takes a wide sheet; expected at least {least:.3} mm, {WIDE} lengths")))
}

fn balance(g: &Geometry, record: &Record) -> Option<Balance> {
    let (gc, _) = estimate(g, record);
    let how = "by W h₀, the work up to the peak over the ligament (what lies beside the cut is not unloaded wholly)";
    (gc > 0.0).then_some(Balance { gc, how })
}

/// Energy W h₀ stored at the peak per area of the ligament, which is then given free where the tear runs; and the stress of
/// the peak.
fn estimate(g: &Geometry, record: &Record) -> (f64, f64) {
    let area = (g.width - g.cut) * g.thickness;
    let (u, f) = (&record.displacement, &record.force);
    let peak = (0..f.len()).fold(0, |m, i| if f[i] > f[m] { i } else { m });
    let work: f64 = (1..=peak).map(|i| 0.5 * (f[i] + f[i - 1]) * (u[i] - u[i - 1])).sum();
    (work.max(0.0) / area, f.get(peak).map_or(0.0, |f| f.max(0.0)) / area)
}
