//! Mass that is accelerated at the turns: a negative control.

use crate::numeric::plus;
use model::{Action, Card, Effect, Options, Piece, Reading, Sample, Scales, Screening, Sensor, Sided, Site};
use params::{ParamSpec, Quantity};
use std::sync::Arc;

/// Newton per gram and mm/s².
const UNIT: f64 = 1e-6;

static CARD: Card = Card {
    name: "inertia",
    site: Site::Sensor,
    rank: 10,
    summary: "Tissue and clamp are accelerated at every turn. Quasi-static tests do not feel it: a \
              negative control.",
    law: "F_cell = F + m ü,  m at most what tissue and a light clamp weigh (50 g)",
    reference: "Newton's second law",
    shows_in: &["rate change"],
    look_alikes: &[],
    separated_by: "not on quasi-static records: tests at 100 mm/s and more would be needed",
    ordinary: "m = 10 g: a light grip and its screws",
    excludes: &[],
    needs: &[],
    screening: Screening::Score(Sided::Positive),
    negative_control: true,
    breaks_half_height: false,
};

/// Inertia of what hangs on the load cell.
#[derive(Clone, Copy, Debug, Default)]
pub struct Inertia;

impl Effect for Inertia {
    fn card(&self) -> &Card {
        &CARD
    }

    fn parameters(&self, _options: &Options) -> Vec<ParamSpec> {
        // `params` knows no mass; the unit is part of the name, so that it stands in the key.
        let about = "mass that is accelerated with the actuator, g";
        vec![ParamSpec::new("mass_g", "m", Quantity::Dimensionless, (0.0, 50.0), 1.0, about).neutral(0.0)]
    }

    fn shapes(&self, _scales: &Scales) -> Vec<Vec<f64>> {
        vec![vec![0.0]]
    }

    fn start(&self, _scales: &Scales) -> Vec<f64> {
        vec![10.0]
    }

    fn act(&self, _options: &Options, _piece: &Piece) -> Action {
        Action::Sensor(Arc::new(Mass))
    }
}

struct Mass;

impl Sensor for Mass {
    fn reading(&self, at: &Sample, force: f64, params: &[f64]) -> Reading {
        let per_gram = UNIT * at.acceleration;
        Reading { value: plus(force, params[0] * per_gram), slope: 1.0, by_param: vec![per_gram] }
    }
}
