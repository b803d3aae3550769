//! A load cell that reads one test larger than the other.

use crate::settings::{kind, word};
use input::OptionSpec;
use model::{Action, Card, Effect, Options, Piece, Reading, Sample, Scales, Screening, Sensor, Sided, Site};
use params::{ParamSpec, Quantity};
use std::sync::Arc;

static CARD: Card = Card {
    name: "gain",
    site: Site::Sensor,
    rank: 30,
    summary: "The load cell is calibrated differently in one kind of test than in the other: all \
              forces of that test are off by one factor.",
    law: "F_recorded = F (1 + g) in the tests of kind test_kind, F in the others",
    reference: "load-cell practice: range switching, two cells",
    shows_in: &["load", "peak", "plateau"],
    look_alikes: &[],
    separated_by: "a dead weight hung on the cell in both set-ups; width_change_mm tells gain from bulk anisotropy",
    ordinary: "g = 3 %: a load cell whose calibration is overdue",
    excludes: &[],
    needs: &["two tests"],
    screening: Screening::Score(Sided::Both),
    negative_control: false,
    breaks_half_height: false,
};

/// Calibration of one kind of test against the other.
#[derive(Clone, Copy, Debug, Default)]
pub struct Gain;

impl Effect for Gain {
    fn card(&self) -> &Card {
        &CARD
    }

    fn parameters(&self, _options: &Options) -> Vec<ParamSpec> {
        let about = "relative error of the force in the tests of that kind";
        vec![ParamSpec::new("g", "g", Quantity::Dimensionless, (-0.5, 1.0), 0.03, about).neutral(0.0)]
    }

    fn options(&self) -> Vec<OptionSpec> {
        vec![kind("test_kind", "tearing", "kind of the tests whose force is off")]
    }

    fn shapes(&self, _scales: &Scales) -> Vec<Vec<f64>> {
        vec![vec![0.0]]
    }

    fn start(&self, _scales: &Scales) -> Vec<f64> {
        vec![0.03]
    }

    fn act(&self, options: &Options, _piece: &Piece) -> Action {
        Action::Sensor(Arc::new(Calibration { kind: word(options, "test_kind", "tearing").to_owned() }))
    }
}

struct Calibration {
    /// Name of the experiment.
    kind: String,
}

impl Sensor for Calibration {
    fn reading(&self, at: &Sample, force: f64, params: &[f64]) -> Reading {
        if at.kind.word() != self.kind {
            return Reading { value: force, slope: 1.0, by_param: vec![0.0] };
        }
        let slope = 1.0 + params[0];
        Reading { value: force * slope, slope, by_param: vec![force] }
    }
}
