//! Torn faces that do not close again: unloading to a share of the largest opening.

use super::scale;
use crate::decorator::{Call, Decoration, decorate};
use cohesive::{DELTA_MAX, LAMBDA, PENALTY, effective_opening};
use constitutive::{Energy, Law, PointLaw, Response, Scalar};
use model::{Action, Card, Effect, Options, Piece, Scales, Screening, Sided, Site};
use params::{ParamSpec, Quantity};
use std::sync::Arc;

static CARD: Card = Card {
    name: "residual_opening",
    site: Site::Interface,
    rank: 20,
    summary: "The tear does not close when the strip is unloaded: pulled-out fibres keep its faces apart.",
    law: "below δmax: t = t_max ⟨δ − a δmax⟩/(δmax − a δmax) in place of t_max δ/δmax",
    reference: "plastic-damage cohesive-zone models; secant unloading (a = 0): Ortiz & Pandolfi 1999",
    shows_in: &["unload", "reload"],
    look_alikes: &[],
    separated_by: "an unloading in the middle of the tear: the force reaches zero at a larger displacement",
    ordinary: "a = 0.2: torn fibres keep a fifth of the opening from closing",
    excludes: &[],
    needs: &["tearing", "unloading"],
    screening: Screening::Score(Sided::Positive),
    negative_control: false,
    breaks_half_height: false,
};

/// Unloading to a residual opening.
#[derive(Clone, Copy, Debug, Default)]
pub struct ResidualOpening;

fn own_parameters() -> Vec<ParamSpec> {
    vec![
        ParamSpec::new(
            "a",
            "a",
            Quantity::Dimensionless,
            (0.0, 0.9),
            0.2,
            "residual share of the largest opening",
        )
        .neutral(0.0),
    ]
}

impl Effect for ResidualOpening {
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
        vec![0.2]
    }

    fn act(&self, _options: &Options, _piece: &Piece) -> Action {
        Action::Interface(Box::new(|inner| Arc::new(decorate(inner, Residual))))
    }
}

struct Residual;

/// Traction over the one on the secant through the origin; 1 while loading, with no derivative.
fn share<S: Scalar>(a: S, delta: S, delta_max: S) -> S {
    if delta.value() == 0.0 {
        // Nothing is open: the secant's traction is zero whatever it is multiplied by.
        return S::one();
    }
    (-(a * (delta_max / delta)) + 1.0).positive_part() / (-a + 1.0)
}

impl Decoration<3> for Residual {
    const NAME: &'static str = "residual_opening";

    fn parameters(&self) -> Vec<ParamSpec> {
        own_parameters()
    }

    fn respond<S: Scalar>(&self, call: &Call<'_, S, 3>, inner_new: &mut [S], _new: &mut [S]) -> Response<S, 3>
    where
        dyn PointLaw<3>: Law<S, 3>,
    {
        let mut r = call.inner(inner_new);
        let delta = effective_opening(call.gradient, call.base[LAMBDA]);
        let delta_max = inner_new[DELTA_MAX];
        let factor = share(call.own[0], delta, delta_max);
        scale(&mut r, call.gradient, call.base[PENALTY], factor);
        // ½ t (δ − a δmax), not ½ t δ.
        let tail = if delta.value() > 0.0 { -(call.own[0] * (delta_max / delta)) + 1.0 } else { S::one() };
        rescale_energy(&mut r, call.gradient, call.base[PENALTY], tail.positive_part());
        r
    }

    /// The lost part grows by what a lower unloading line no longer gives back, ½ a t_max δmax.
    fn energies(&self, call: &Call<'_, f64, 3>, inner_new: &[f64], _new: &[f64]) -> Energy {
        let inner = call.inner_energies(call.gradient, call.base, inner_new);
        let delta = effective_opening(call.gradient, call.base[LAMBDA]);
        let delta_max = inner_new[DELTA_MAX];
        let n = call.gradient[0].min(0.0);
        let closing = 0.5 * call.base[PENALTY] * n * n;
        let a = call.own[0];
        let tail = if delta > 0.0 { (1.0 - a * delta_max / delta).max(0.0) } else { 1.0 };
        let at_max = call.inner_probe(&[delta_max, 0.0, 0.0], inner_new).energy;
        Energy {
            stored: closing + (inner.stored - closing) * share(a, delta, delta_max) * tail,
            dissipated: inner.dissipated + a * at_max,
        }
    }
}

fn rescale_energy<S: Scalar>(r: &mut Response<S, 3>, opening: &[S; 3], penalty: S, factor: S) {
    let n = opening[0];
    let closing = if n.value() < 0.0 { penalty * n * n * 0.5 } else { S::zero() };
    r.energy = crate::numeric::plus(r.energy, (r.energy - closing) * (factor - 1.0));
}
