//! The strip's own weight on the load cell: a negative control.

use crate::numeric::plus;
use model::{Action, Card, Effect, Options, Piece, Reading, Sample, Scales, Screening, Sensor, Sided, Site};
use params::{ParamSpec, Quantity};
use std::sync::Arc;

/// Newton per mm³ and g/cm³.
const UNIT: f64 = 9.81e-6;

static CARD: Card = Card {
    name: "self_weight",
    site: Site::Sensor,
    rank: 20,
    summary: "Half the strip's weight hangs on the load cell: a tenth of a millinewton or two. A \
              negative control.",
    law: "F_cell = F + ½ ρ g V,  ρ ≤ 2 g/cm³,  V = length · width · thickness of the file",
    reference: "statics",
    shows_in: &["toe", "tail"],
    look_alikes: &["drift", "prestretch"],
    separated_by: "the force at zero displacement before mounting",
    ordinary: "ρ = 1.05 g/cm³: the density of arterial wall",
    excludes: &[],
    needs: &[],
    screening: Screening::Score(Sided::Positive),
    negative_control: true,
    breaks_half_height: false,
};

/// Weight of the strip on the load cell.
#[derive(Clone, Copy, Debug, Default)]
pub struct SelfWeight;

impl Effect for SelfWeight {
    fn card(&self) -> &Card {
        &CARD
    }

    fn parameters(&self, _options: &Options) -> Vec<ParamSpec> {
        vec![
            ParamSpec::new("density", "ρ", Quantity::Density, (0.0, 2.0), 1.0, "mass density of the tissue")
                .neutral(0.0),
        ]
    }

    fn shapes(&self, _scales: &Scales) -> Vec<Vec<f64>> {
        vec![vec![0.0]]
    }

    fn start(&self, _scales: &Scales) -> Vec<f64> {
        vec![1.05]
    }

    fn act(&self, _options: &Options, piece: &Piece) -> Action {
        let volume = piece.length * piece.width * piece.thickness;
        Action::Sensor(Arc::new(Weight { per_density: 0.5 * UNIT * volume }))
    }
}

struct Weight {
    /// Force per density, N per g/cm³.
    per_density: f64,
}

impl Sensor for Weight {
    fn reading(&self, _at: &Sample, force: f64, params: &[f64]) -> Reading {
        let value = plus(force, params[0] * self.per_density);
        Reading { value, slope: 1.0, by_param: vec![self.per_density] }
    }
}
