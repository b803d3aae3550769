//! Actuator motion that is taken up before the strip is straight.

use crate::numeric::{plus, softplus};
use constitutive::{Context, Describe, Energy, HistorySpec, Law, Response, Scalar};
use model::{Action, Card, Effect, Options, Piece, Scales, Screening, Sided, Site};
use params::{ParamSpec, Quantity};
use std::sync::Arc;

const U0: usize = 0;
const TOE: usize = 1;

static CARD: Card = Card {
    name: "slack",
    site: Site::LoadTrain,
    rank: 30,
    summary: "The first part of the actuator's motion only takes up slack: the curve starts late, \
              and the same displacement means less stretch.",
    law: "u → s(u) = w [ln(1 + e^((u − u0)/w)) − ln(1 + e^(−u0/w))],  w = r u0 the width of the toe;  s(0) = 0, s = u at u0 = 0",
    reference: "rig practice: choice of the zero-force length",
    shows_in: &["toe", "load", "unload"],
    look_alikes: &["permanent_set", "grip_slip"],
    separated_by: "a camera on the clamped edges (grip_displacement_mm) sees it directly; or the first record of the \
                   untouched piece: set and slip need a load first",
    ordinary: "u0 of 5 % of the travel (the shorter one where tests differ): a strip that hung slightly loose \
               when the grips closed",
    excludes: &["prestretch"],
    needs: &[],
    // The response at u0 = 0 is differentiable from one side only and changes its kind there.
    screening: Screening::Refit(Sided::Positive),
    negative_control: false,
    breaks_half_height: false,
};

/// Dead travel with a smooth toe.
#[derive(Clone, Copy, Debug, Default)]
pub struct Slack;

impl Effect for Slack {
    fn card(&self) -> &Card {
        &CARD
    }

    fn parameters(&self, _options: &Options) -> Vec<ParamSpec> {
        Describe::parameters(&TakeUp)
    }

    fn shapes(&self, _scales: &Scales) -> Vec<Vec<f64>> {
        vec![vec![0.0, 0.15], vec![0.0, 0.5]]
    }

    fn start(&self, scales: &Scales) -> Vec<f64> {
        vec![(0.05 * scales.uniaxial_displacement.min(scales.displacement)).min(100.0), 0.25]
    }

    fn act(&self, _options: &Options, _piece: &Piece) -> Action {
        Action::TakeUp(Arc::new(TakeUp))
    }
}

struct TakeUp;

/// s(u). The toe's width is a share of u0, so that the law goes over into s = u as u0 → 0; there
/// only the one-sided derivative is left.
fn taken<S: Scalar>(u: S, u0: S, toe: S) -> S {
    if u0.value() == 0.0 {
        let per_slack = toe * softplus(-toe.recip()) + 1.0;
        return if u.value() > 0.0 { plus(u, -(u0 * per_slack)) } else { u };
    }
    let w = toe * u0;
    w * (softplus((u - u0) / w) - softplus(-(u0 / w)))
}

impl<S: Scalar> Law<S, 1> for TakeUp {
    fn respond(
        &self,
        _ctx: &Context,
        u: &[S; 1],
        params: &[S],
        _old: &[S],
        _new: &mut [S],
    ) -> Response<S, 1> {
        Response { force: [taken(u[0], params[U0], params[TOE])], energy: S::zero() }
    }
}

impl Describe<1> for TakeUp {
    fn parameters(&self) -> Vec<ParamSpec> {
        vec![
            ParamSpec::new("u0", "u0", Quantity::Length, (0.0, 100.0), 0.05, "actuator motion taken up")
                .neutral(0.0),
            // Narrower toes leave no slope at the start, where path control divides by it.
            ParamSpec::new("toe", "r", Quantity::Dimensionless, (0.1, 2.0), 0.25, "width of the toe over u0"),
        ]
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
