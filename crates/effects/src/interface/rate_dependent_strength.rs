//! A tear that resists more when it is opened faster.

use super::{effective_traction, scale};
use crate::decorator::{Call, Decoration, decorate};
use crate::settings::spread;
use cohesive::{LAMBDA, PENALTY, effective_opening};
use constitutive::{Energy, Law, PointLaw, Response, Scalar};
use model::{Action, Card, Effect, Options, Piece, Scales, Screening, Sided, Site};
use params::{ParamSpec, Quantity};
use std::sync::Arc;

const C: usize = 0;
const RATE0: usize = 1;
const RATES: (f64, f64) = (1e-8, 1e2);

static CARD: Card = Card {
    name: "rate_dependent_strength",
    site: Site::Interface,
    rank: 50,
    summary: "The tear resists more when it opens faster: strength and fracture energy grow with \
              the logarithm of the opening rate.",
    law: "t → t (1 + c ln(1 + ⟨δ̇⟩/δ̇0)) on the irreversible traction whenever the opening grows; t_max is kept \
          without it; in an instantaneous change the last rate stays",
    reference: "logarithmic rate laws of cohesive zones: Corigliano & Ricci 2001, Int. J. Solids Struct. 38; \
                Marzi et al. 2009, Eng. Fract. Mech. 76",
    shows_in: &["rate change", "hold", "peak", "plateau", "unload"],
    look_alikes: &["bridging", "thickness_taper", "heterogeneity"],
    separated_by: "a change of rate (or a pause) in the middle of the tear",
    ordinary: "c = 3 % per e-fold of rate: some 7 % a decade",
    excludes: &[],
    needs: &["tearing", "pause or two rates"],
    screening: Screening::Score(Sided::Positive),
    negative_control: false,
    breaks_half_height: false,
};

/// Logarithmic rate law on the tear's traction.
#[derive(Clone, Copy, Debug, Default)]
pub struct RateDependentStrength;

fn own_parameters() -> Vec<ParamSpec> {
    use Quantity::{Dimensionless, Speed};
    vec![
        ParamSpec::new(
            "c",
            "c",
            Dimensionless,
            (0.0, 2.0),
            0.02,
            "relative rise of traction per e-fold of rate",
        )
        .neutral(0.0),
        ParamSpec::new("rate0", "δ̇0", Speed, RATES, 1e-3, "opening rate from which the rise counts"),
    ]
}

impl Effect for RateDependentStrength {
    fn card(&self) -> &Card {
        &CARD
    }

    fn parameters(&self, _options: &Options) -> Vec<ParamSpec> {
        own_parameters()
    }

    fn shapes(&self, scales: &Scales) -> Vec<Vec<f64>> {
        // Well below the tear's rates only the logarithm is seen, well above them it is linear.
        let r = scales.opening_rate;
        spread(1e-3 * r, 3.0 * r, 4)
            .into_iter()
            .map(|rate0| vec![0.0, rate0.clamp(RATES.0, RATES.1)])
            .collect()
    }

    fn start(&self, scales: &Scales) -> Vec<f64> {
        vec![0.03, (0.05 * scales.opening_rate).clamp(RATES.0, RATES.1)]
    }

    fn act(&self, _options: &Options, _piece: &Piece) -> Action {
        Action::Interface(Box::new(|inner| Arc::new(decorate(inner, Rate))))
    }
}

struct Rate;

const DELTA: usize = 0;
const TRACTION: usize = 1;
const SPEED: usize = 2;
const LOST: usize = 3;

impl Decoration<3> for Rate {
    const NAME: &'static str = "rate_dependent_strength";

    fn parameters(&self) -> Vec<ParamSpec> {
        own_parameters()
    }

    /// Effective opening, traction without the rise, opening rate, and the work of the rise: all
    /// of that is lost.
    fn history(&self) -> Vec<(String, f64)> {
        ["delta", "traction", "rate", "lost"].map(|n| (n.to_owned(), 0.0)).to_vec()
    }

    fn rate_dependent(&self) -> bool {
        true
    }

    fn respond<S: Scalar>(&self, call: &Call<'_, S, 3>, inner_new: &mut [S], new: &mut [S]) -> Response<S, 3>
    where
        dyn PointLaw<3>: Law<S, 3>,
    {
        let mut r = call.inner(inner_new);
        let delta = effective_opening(call.gradient, call.base[LAMBDA]);
        let growth = delta - call.old[DELTA];
        let rate = match call.ctx.dt {
            // From a standing point the search for equilibrium begins as if it opened: the strength that it then gains
            // is next to a step, and held until it is overcome.
            dt if dt > 0.0 && growth.value() >= 0.0 => growth / dt,
            dt if dt > 0.0 => S::zero(),
            _ => call.old[SPEED],
        };
        let rise = call.own[C] * (rate / call.own[RATE0]).ln_1p();
        let traction = effective_traction(&r.force, call.gradient, delta);
        new[DELTA] = delta;
        new[TRACTION] = traction;
        new[SPEED] = rate;
        new[LOST] = call.old[LOST] + rise * (traction + call.old[TRACTION]) * 0.5 * growth;
        scale(&mut r, call.gradient, call.base[PENALTY], rise + 1.0);
        r
    }

    fn energies(&self, call: &Call<'_, f64, 3>, inner_new: &[f64], new: &[f64]) -> Energy {
        let inner = call.inner_energies(call.gradient, call.base, inner_new);
        Energy { dissipated: inner.dissipated + new[LOST], ..inner }
    }
}
