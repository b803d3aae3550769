//! A force that is recorded late.

use model::{Action, Card, Effect, Options, Piece, Reading, Sample, Scales, Screening, Sensor, Sided, Site};
use params::{ParamSpec, Quantity};
use std::sync::Arc;

static CARD: Card = Card {
    name: "lag",
    site: Site::Sensor,
    rank: 50,
    summary: "The force is recorded later than the displacement: a filter or two clocks.",
    law: "F_recorded(t) = F(t − τ)",
    reference: "measuring practice: low-pass filters, unsynchronised channels",
    shows_in: &["unload", "reload", "rate change", "hold"],
    look_alikes: &["viscoelastic", "backlash"],
    separated_by: "a hold: a late force settles within τ, a viscous one relaxes on; or two rates: the loop of a lag widens with the rate",
    ordinary: "τ of one interval between the record's points: amplifiers are set to filter what is sampled",
    excludes: &[],
    needs: &["pause or two rates"],
    screening: Screening::Score(Sided::Positive),
    negative_control: false,
    breaks_half_height: false,
};

/// Delay of the force channel.
#[derive(Clone, Copy, Debug, Default)]
pub struct Lag;

impl Effect for Lag {
    fn card(&self) -> &Card {
        &CARD
    }

    fn parameters(&self, _options: &Options) -> Vec<ParamSpec> {
        vec![
            ParamSpec::new("tau", "τ", Quantity::Time, (0.0, 60.0), 0.1, "delay of the recorded force")
                .neutral(0.0),
        ]
    }

    fn shapes(&self, _scales: &Scales) -> Vec<Vec<f64>> {
        vec![vec![0.0]]
    }

    fn start(&self, scales: &Scales) -> Vec<f64> {
        vec![scales.sampling.clamp(0.0, 60.0)]
    }

    fn act(&self, _options: &Options, _piece: &Piece) -> Action {
        Action::Sensor(Arc::new(Late))
    }
}

struct Late;

impl Sensor for Late {
    fn delay(&self, params: &[f64]) -> (f64, Vec<f64>) {
        (params[0], vec![1.0])
    }

    fn reading(&self, _at: &Sample, force: f64, _params: &[f64]) -> Reading {
        Reading { value: force, slope: 1.0, by_param: vec![0.0] }
    }
}
