//! A load cell whose zero wanders.

use crate::numeric::plus;
use model::{Action, Card, Effect, Options, Piece, Reading, Sample, Scales, Screening, Sensor, Sided, Site};
use params::{ParamSpec, Quantity};
use std::sync::Arc;

static CARD: Card = Card {
    name: "drift",
    site: Site::Sensor,
    rank: 40,
    summary: "The zero of the load cell wanders with time, in every test from its own start.",
    law: "F_recorded = F + b + c t,  t from the start of the test",
    reference: "load-cell practice",
    shows_in: &["hold", "tail", "unload"],
    look_alikes: &["stiffness_drift", "self_weight"],
    separated_by: "a pause at zero displacement at the end of the record",
    ordinary: "c of 3 % of the peak force over the longest test: a load cell that is still warming up",
    excludes: &[],
    needs: &[],
    screening: Screening::Score(Sided::Both),
    negative_control: false,
    breaks_half_height: false,
};

/// Zero drift of the load cell.
#[derive(Clone, Copy, Debug, Default)]
pub struct Drift;

impl Effect for Drift {
    fn card(&self) -> &Card {
        &CARD
    }

    fn parameters(&self, _options: &Options) -> Vec<ParamSpec> {
        vec![
            ParamSpec::new(
                "c",
                "c",
                Quantity::ForceRate,
                (-10.0, 10.0),
                1e-5,
                "drift of the zero per second",
            )
            .neutral(0.0),
            ParamSpec::new(
                "b",
                "b",
                Quantity::Force,
                (-100.0, 100.0),
                0.0,
                "offset at the start of each test",
            )
            .neutral(0.0)
            .fixed(),
        ]
    }

    fn shapes(&self, _scales: &Scales) -> Vec<Vec<f64>> {
        vec![vec![0.0, 0.0]]
    }

    fn start(&self, scales: &Scales) -> Vec<f64> {
        vec![(0.03 * scales.peak_force / scales.duration).min(10.0), 0.0]
    }

    fn act(&self, _options: &Options, _piece: &Piece) -> Action {
        Action::Sensor(Arc::new(Zero))
    }
}

struct Zero;

impl Sensor for Zero {
    fn reading(&self, at: &Sample, force: f64, params: &[f64]) -> Reading {
        let value = plus(plus(force, params[1]), params[0] * at.time);
        Reading { value, slope: 1.0, by_param: vec![at.time, 1.0] }
    }
}
