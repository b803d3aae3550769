//! Load cell, frame and clamps that stretch elastically.

use constitutive::{Context, Describe, Energy, HistorySpec, Law, Response, Scalar};
use model::{Action, Card, Effect, Options, Piece, Scales, Screening, Sided, Site};
use params::{ParamSpec, Quantity};
use std::sync::Arc;

static CARD: Card = Card {
    name: "compliance",
    site: Site::LoadTrain,
    rank: 10,
    summary: "Load cell, frame and clamps stretch elastically, so that the tissue gets less \
              displacement than the actuator reports.",
    law: "u_grip = u_actuator − C F",
    reference: "machine compliance, testing practice",
    shows_in: &["load", "unload", "reload", "peak"],
    look_alikes: &["fiber_recruitment"],
    separated_by: "a camera on the clamped edges (grip_displacement_mm) sees it directly; or two tests of different force level",
    ordinary: "C for which the load train takes 5 % of the travel at the peak force: a small load cell and its grips",
    excludes: &[],
    needs: &[],
    screening: Screening::Score(Sided::Positive),
    negative_control: false,
    breaks_half_height: false,
};

/// Elastic elongation of the load train.
#[derive(Clone, Copy, Debug, Default)]
pub struct Compliance;

impl Effect for Compliance {
    fn card(&self) -> &Card {
        &CARD
    }

    fn parameters(&self, _options: &Options) -> Vec<ParamSpec> {
        Describe::parameters(&Spring)
    }

    fn shapes(&self, _scales: &Scales) -> Vec<Vec<f64>> {
        vec![vec![0.0]]
    }

    fn start(&self, scales: &Scales) -> Vec<f64> {
        vec![(0.05 * scales.displacement / scales.peak_force).clamp(0.0, 100.0)]
    }

    fn act(&self, _options: &Options, _piece: &Piece) -> Action {
        Action::Train(Arc::new(Spring))
    }
}

struct Spring;

impl<S: Scalar> Law<S, 1> for Spring {
    fn respond(
        &self,
        _ctx: &Context,
        force: &[S; 1],
        params: &[S],
        _old: &[S],
        _new: &mut [S],
    ) -> Response<S, 1> {
        let stretch = params[0] * force[0];
        Response { force: [stretch], energy: stretch * force[0] * 0.5 }
    }
}

impl Describe<1> for Spring {
    fn parameters(&self) -> Vec<ParamSpec> {
        let about = "elongation of the load train per force";
        vec![ParamSpec::new("c", "C", Quantity::Compliance, (0.0, 100.0), 0.1, about).neutral(0.0)]
    }

    fn history(&self) -> Vec<HistorySpec> {
        Vec::new()
    }

    fn rate_dependent(&self) -> bool {
        false
    }

    fn energies(&self, _: &Context, force: &[f64; 1], params: &[f64], _: &[f64], _: &[f64]) -> Energy {
        Energy { stored: 0.5 * params[0] * force[0] * force[0], dissipated: 0.0 }
    }
}
