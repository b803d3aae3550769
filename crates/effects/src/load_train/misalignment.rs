//! A top clamp that was mounted turned.

use model::{Action, Card, Effect, Mount, Options, Piece, Scales, Screening, Sided, Site};
use params::{ParamSpec, Quantity};
use std::sync::Arc;

static CARD: Card = Card {
    name: "misalignment",
    site: Site::LoadTrain,
    rank: 40,
    summary: "The top clamp is turned in the plane of the strip: one edge is stretched before the \
              test begins, and the tear is loaded earlier or later than the middle.",
    law: "u_y(x) = u_grip + tan θ (x − w/2) on the top clamp, there from mounting on",
    reference: "rig practice: clamp alignment",
    shows_in: &["toe", "onset", "peak"],
    look_alikes: &[],
    separated_by: "the force at zero displacement (records are not tared), or the same strip mounted the other way round",
    ordinary: "θ of 0.01 rad (0.6°): a clamp set by eye",
    excludes: &[],
    // In the intact strip ±θ do the same and the first derivative vanishes; the tear tells the signs apart.
    needs: &["tearing", "clamped ends"],
    screening: Screening::Score(Sided::Both),
    negative_control: false,
    breaks_half_height: true,
};

/// A clamp turned in its plane.
#[derive(Clone, Copy, Debug, Default)]
pub struct Misalignment;

impl Effect for Misalignment {
    fn card(&self) -> &Card {
        &CARD
    }

    fn parameters(&self, _options: &Options) -> Vec<ParamSpec> {
        let about = "angle of the top clamp; positive opens the far edge";
        vec![ParamSpec::new("theta", "θ", Quantity::Angle, (-0.2, 0.2), 0.01, about).neutral(0.0)]
    }

    fn shapes(&self, _scales: &Scales) -> Vec<Vec<f64>> {
        vec![vec![0.0]]
    }

    fn start(&self, _scales: &Scales) -> Vec<f64> {
        vec![0.01]
    }

    fn act(&self, _options: &Options, piece: &Piece) -> Action {
        Action::Mount(Arc::new(Turned { width: piece.width }))
    }
}

struct Turned {
    width: f64,
}

impl Mount for Turned {
    fn offset(&self, x: f64, params: &[f64]) -> (f64, Vec<f64>) {
        let (tan, arm) = (params[0].tan(), x - 0.5 * self.width);
        (tan * arm, vec![(1.0 + tan * tan) * arm])
    }
}
