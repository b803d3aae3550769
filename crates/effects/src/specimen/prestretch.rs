//! Tissue that is already stretched when the record begins.

use crate::numeric::plus;
use constitutive::{Context, Describe, Energy, HistorySpec, Law, Response, Scalar};
use model::{Action, Card, Effect, Options, Piece, Scales, Screening, Sided, Site};
use params::{ParamSpec, Quantity};
use std::sync::Arc;

static CARD: Card = Card {
    name: "prestretch",
    site: Site::Specimen,
    rank: 30,
    summary: "The tissue is already stretched when the record begins: it starts beyond its toe, \
              with a force at zero displacement.",
    law: "u → u + (λ0 − 1) L,  L the length of the file, in mounting, before the test begins",
    reference: "residual stress and preload of arterial tissue; testing practice",
    shows_in: &["toe", "load"],
    look_alikes: &["self_weight"],
    separated_by: "the force at zero displacement (records are not tared) and the steepness of the toe",
    ordinary: "λ0 = 1.01: the preload that straightens the strip",
    excludes: &["slack"],
    needs: &[],
    screening: Screening::Score(Sided::Positive),
    negative_control: false,
    breaks_half_height: false,
};

/// Stretch by mounting.
#[derive(Clone, Copy, Debug, Default)]
pub struct Prestretch;

fn own_parameters() -> Vec<ParamSpec> {
    let about = "stretch of the tissue at zero displacement";
    vec![ParamSpec::new("lambda0", "λ0", Quantity::Dimensionless, (1.0, 1.5), 1.01, about).neutral(1.0)]
}

impl Effect for Prestretch {
    fn card(&self) -> &Card {
        &CARD
    }

    fn parameters(&self, _options: &Options) -> Vec<ParamSpec> {
        own_parameters()
    }

    fn shapes(&self, _scales: &Scales) -> Vec<Vec<f64>> {
        vec![vec![1.0]]
    }

    fn start(&self, _scales: &Scales) -> Vec<f64> {
        vec![1.01]
    }

    fn act(&self, _options: &Options, piece: &Piece) -> Action {
        Action::TakeUp(Arc::new(Mounted { length: piece.length }))
    }
}

struct Mounted {
    length: f64,
}

impl<S: Scalar> Law<S, 1> for Mounted {
    fn respond(
        &self,
        _ctx: &Context,
        u: &[S; 1],
        params: &[S],
        _old: &[S],
        _new: &mut [S],
    ) -> Response<S, 1> {
        Response { force: [plus(u[0], (params[0] - 1.0) * self.length)], energy: S::zero() }
    }
}

impl Describe<1> for Mounted {
    fn parameters(&self) -> Vec<ParamSpec> {
        own_parameters()
    }

    fn history(&self) -> Vec<HistorySpec> {
        Vec::new()
    }

    fn rate_dependent(&self) -> bool {
        false
    }

    fn energies(&self, _: &Context, _: &[f64; 1], _: &[f64], _: &[f64], _: &[f64]) -> Energy {
        Energy::default()
    }
}
