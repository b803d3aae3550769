//! A strip that is thicker on one side than on the other.

use model::{Action, Card, Effect, Options, Piece, Scales, Screening, Shape, Sided, Site};
use params::{ParamSpec, Quantity};
use std::sync::Arc;

static CARD: Card = Card {
    name: "thickness_taper",
    site: Site::Specimen,
    rank: 20,
    summary: "The strip is thicker at one edge than at the other: the torn area and the stiffness \
              behind it change along the tear.",
    law: "h(x) = h (1 + a (2x/w − 1)),  h the thickness of the file, w the width",
    reference: "the paper's first limitation: one thickness per specimen",
    shows_in: &["plateau", "tail", "peak"],
    look_alikes: &["bridging", "rate_dependent_strength", "heterogeneity"],
    separated_by: "a thickness profile (calliper, microscope), or a camera on the tear (tear_front_mm)",
    ordinary: "a = 10 %: thickness measured in the middle alone",
    excludes: &[],
    // In the intact strip ±a do the same and the first derivative vanishes; the tear tells the signs apart.
    needs: &["tearing", "a flat sheet"],
    screening: Screening::Score(Sided::Both),
    negative_control: false,
    breaks_half_height: false,
};

/// Thickness linear across the width.
#[derive(Clone, Copy, Debug, Default)]
pub struct ThicknessTaper;

impl Effect for ThicknessTaper {
    fn card(&self) -> &Card {
        &CARD
    }

    fn parameters(&self, _options: &Options) -> Vec<ParamSpec> {
        let about = "relative thickness gained from the middle to the far edge";
        vec![ParamSpec::new("a", "a", Quantity::Dimensionless, (-0.9, 0.9), 0.1, about).neutral(0.0)]
    }

    fn shapes(&self, _scales: &Scales) -> Vec<Vec<f64>> {
        vec![vec![0.0]]
    }

    fn start(&self, _scales: &Scales) -> Vec<f64> {
        vec![0.1]
    }

    fn act(&self, _options: &Options, piece: &Piece) -> Action {
        Action::Shape(Arc::new(Taper { width: piece.width }))
    }
}

struct Taper {
    width: f64,
}

impl Shape for Taper {
    fn position(&self, x: [f64; 3], params: &[f64]) -> ([f64; 3], Vec<[f64; 3]>) {
        // Nodes of an outlined strip may lie outside the nominal width: no fold there.
        let across = (2.0 * x[0] / self.width - 1.0).clamp(-1.0, 1.0);
        ([x[0], x[1], x[2] * (1.0 + params[0] * across)], vec![[0.0, 0.0, x[2] * across]])
    }
}
