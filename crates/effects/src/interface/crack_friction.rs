//! Friction of closed tear faces: a negative control, void in mode I.

use crate::decorator::{Call, Decoration, decorate};
use crate::numeric::plus;
use cohesive::PENALTY;
use constitutive::{Energy, Law, PointLaw, Response, Scalar};
use model::{Action, Card, Effect, Options, Piece, Scales, Screening, Sided, Site};
use params::{ParamSpec, Quantity};
use std::sync::Arc;

static CARD: Card = Card {
    name: "crack_friction",
    site: Site::Interface,
    rank: 60,
    summary: "Closed tear faces rub when they slide on each other. In a mode I tear they do not \
              slide: a negative control.",
    law: "closed faces carry up to |t_s| = μ p beside the law, p = pressure at the last converged step, \
          sticking with the penalty stiffness K",
    reference: "Coulomb friction with an elastic-plastic stick–slip rule",
    shows_in: &["unload"],
    look_alikes: &[],
    separated_by: "not on records of this kind: a mode II test would be needed",
    ordinary: "μ = 0.1: wet tissue on wet tissue",
    excludes: &[],
    needs: &["tearing", "unloading"],
    screening: Screening::Score(Sided::Positive),
    negative_control: true,
    breaks_half_height: false,
};

/// Coulomb friction of the closed faces.
#[derive(Clone, Copy, Debug, Default)]
pub struct CrackFriction;

fn own_parameters() -> Vec<ParamSpec> {
    vec![
        ParamSpec::new(
            "mu",
            "μ",
            Quantity::Dimensionless,
            (0.0, 1.0),
            0.1,
            "friction coefficient of closed faces",
        )
        .neutral(0.0),
    ]
}

impl Effect for CrackFriction {
    fn card(&self) -> &Card {
        &CARD
    }

    fn parameters(&self, _options: &Options) -> Vec<ParamSpec> {
        own_parameters()
    }

    fn shapes(&self, _scales: &Scales) -> Vec<Vec<f64>> {
        vec![vec![0.0]]
    }

    fn start(&self, _scales: &Scales) -> Vec<f64> {
        vec![0.1]
    }

    fn act(&self, _options: &Options, _piece: &Piece) -> Action {
        Action::Interface(Box::new(|inner| Arc::new(decorate(inner, Coulomb))))
    }
}

struct Coulomb;

/// Slipped opening (2), pressure, energy lost.
const PRESSURE: usize = 2;
const LOST: usize = 3;

/// Friction traction, and by how much it slipped.
fn friction<S: Scalar>(mu: S, pressure: S, stiffness: S, trial: [S; 2]) -> ([S; 2], S) {
    let square = trial[0] * trial[0] + trial[1] * trial[1];
    let limit = mu * pressure;
    if square.value() == 0.0 {
        return ([S::zero(); 2], S::zero());
    }
    let size = square.sqrt();
    if size.value() <= limit.value() {
        return (trial, S::zero());
    }
    (trial.map(|t| limit * (t / size)), (size - limit) / stiffness)
}

impl Decoration<3> for Coulomb {
    const NAME: &'static str = "crack_friction";

    fn parameters(&self) -> Vec<ParamSpec> {
        own_parameters()
    }

    fn history(&self) -> Vec<(String, f64)> {
        ["slip_1", "slip_2", "pressure", "lost"].map(|n| (n.to_owned(), 0.0)).to_vec()
    }

    fn respond<S: Scalar>(&self, call: &Call<'_, S, 3>, inner_new: &mut [S], new: &mut [S]) -> Response<S, 3>
    where
        dyn PointLaw<3>: Law<S, 3>,
    {
        let mut r = call.inner(inner_new);
        let [n, s, t] = *call.gradient;
        let k = call.base[PENALTY];
        let closed = n.value() < 0.0;
        // Pressure of the last converged step: a current one would make the tangent unsymmetric.
        let pressure = if closed { call.old[PRESSURE] } else { S::zero() };
        let trial = [k * (s - call.old[0]), k * (t - call.old[1])];
        let (traction, slipped) = friction(call.own[0], pressure, k, trial);
        let size = (traction[0] * traction[0] + traction[1] * traction[1]).value();
        for i in 0..2 {
            r.force[1 + i] = plus(r.force[1 + i], traction[i]);
            new[i] = call.gradient[1 + i] - traction[i] / k;
        }
        let elastic = (traction[0] * traction[0] + traction[1] * traction[1]) / (k * 2.0);
        r.energy = if size > 0.0 { r.energy + elastic } else { r.energy };
        new[PRESSURE] = if closed { -(k * n) } else { S::zero() };
        new[LOST] = call.old[LOST] + call.own[0] * pressure * slipped;
        r
    }

    fn energies(&self, call: &Call<'_, f64, 3>, inner_new: &[f64], new: &[f64]) -> Energy {
        let inner = call.inner_energies(call.gradient, call.base, inner_new);
        let stick = [call.gradient[1] - new[0], call.gradient[2] - new[1]];
        let elastic = 0.5 * call.base[PENALTY] * (stick[0] * stick[0] + stick[1] * stick[1]);
        Energy { stored: inner.stored + elastic, dissipated: inner.dissipated + new[LOST] }
    }
}
