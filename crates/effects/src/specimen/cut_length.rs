//! A cut that is longer or shorter than the file says.

use model::{Action, Card, Effect, Options, Piece, Scales, Screening, Shape, Sided, Site};
use params::{ParamSpec, Quantity};
use std::sync::Arc;

static CARD: Card = Card {
    name: "cut_length",
    site: Site::Specimen,
    rank: 10,
    summary: "The initial cut is longer or shorter than measured.",
    law: "cut = a0 + Δa;  nodes move along x in proportion between edge, tip and far edge, areas follow the tip;  \
          the tip stays between a0/10 and nine tenths of the ligament",
    reference: "rig practice: the tip of a cut in wet tissue is hard to see",
    shows_in: &["load", "onset", "peak"],
    look_alikes: &["law_shape"],
    separated_by: "a camera on the tear (tear_front_mm), or a photograph of the cut",
    ordinary: "Δa of 3 % of the travel, 0.2 mm at most: a cut measured under a lens",
    excludes: &[],
    needs: &["tearing"],
    screening: Screening::Score(Sided::Both),
    negative_control: false,
    breaks_half_height: false,
};

/// Another length of the initial cut.
#[derive(Clone, Copy, Debug, Default)]
pub struct CutLength;

impl Effect for CutLength {
    fn card(&self) -> &Card {
        &CARD
    }

    fn parameters(&self, _options: &Options) -> Vec<ParamSpec> {
        vec![
            ParamSpec::new(
                "da",
                "Δa",
                Quantity::Length,
                (-2.0, 2.0),
                0.1,
                "cut length beyond the one in the file",
            )
            .neutral(0.0),
        ]
    }

    fn shapes(&self, _scales: &Scales) -> Vec<Vec<f64>> {
        vec![vec![0.0]]
    }

    fn start(&self, scales: &Scales) -> Vec<f64> {
        vec![(0.03 * scales.displacement).min(0.2)]
    }

    fn act(&self, _options: &Options, piece: &Piece) -> Action {
        Action::Shape(Arc::new(Tip { cut: piece.cut, width: piece.width }))
    }
}

struct Tip {
    cut: f64,
    width: f64,
}

impl Shape for Tip {
    /// Piecewise linear along x: 0, tip and far edge stay what they are, nothing is switched.
    fn position(&self, x: [f64; 3], params: &[f64]) -> ([f64; 3], Vec<[f64; 3]>) {
        let ligament = self.width - self.cut;
        if self.cut <= 0.0 || ligament <= 0.0 {
            return (x, vec![[0.0; 3]]);
        }
        // A tip beyond an edge would turn elements inside out: it stops short of both.
        let (least, most) = (-0.9 * self.cut, 0.9 * ligament);
        let moved = params[0].clamp(least, most);
        let share = if x[0] <= self.cut { x[0] / self.cut } else { (self.width - x[0]) / ligament };
        let share = share.clamp(0.0, 1.0);
        let slope = if moved == params[0] { share } else { 0.0 };
        ([x[0] + moved * share, x[1], x[2]], vec![[slope, 0.0, 0.0]])
    }
}
