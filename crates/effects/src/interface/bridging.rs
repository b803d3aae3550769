//! Fibres that still hold the torn faces together far behind the tip.

use super::add_secant;
use crate::decorator::{Call, Decoration, decorate};
use crate::settings::spread;
use cohesive::{DELTA_MAX, LAMBDA, dissipated, effective_opening};
use constitutive::{Energy, Law, PointLaw, Response, Scalar};
use model::{Action, Card, Effect, Options, Piece, Scales, Screening, Sided, Site};
use params::{ParamSpec, Quantity};
use std::f64::consts::E;
use std::sync::Arc;

const SIGMA_B: usize = 0;
const DELTA_B: usize = 1;
const LENGTHS: (f64, f64) = (1e-3, 1e3);

static CARD: Card = Card {
    name: "bridging",
    site: Site::Interface,
    rank: 30,
    summary: "Fibres bridge the torn faces and pull them together over openings much larger than \
              those of the peak: the tear resistance rises as the bridged zone grows.",
    law: "t → t + σb (δ/δb) exp(1 − δ/δb) on loading, along its secant to the origin below δmax;  δb ≫ δc;  \
          adds e σb δb to the fracture energy",
    reference: "superposed exponential law of the kind of Ortiz & Pandolfi 1999; fibre bridging: \
                Sørensen & Jacobsen 1998, Composites A 29",
    shows_in: &["plateau", "tail"],
    look_alikes: &["thickness_taper", "rate_dependent_strength", "heterogeneity"],
    separated_by: "a camera on the tear (tear_front_mm), or unloadings along the tear: bridging keeps the unloading stiffness high",
    ordinary: "σb of a tenth of the strength: fibres that span the tear behind its front",
    excludes: &[],
    needs: &["tearing"],
    screening: Screening::Score(Sided::Positive),
    negative_control: false,
    breaks_half_height: false,
};

/// A second, long-ranged cohesive law beside the first.
#[derive(Clone, Copy, Debug, Default)]
pub struct Bridging;

fn own_parameters() -> Vec<ParamSpec> {
    vec![
        ParamSpec::new("sigma_b", "σb", Quantity::Stress, (0.0, 100.0), 0.02, "largest bridging traction")
            .neutral(0.0),
        ParamSpec::new(
            "delta_b",
            "δb",
            Quantity::Length,
            LENGTHS,
            2.0,
            "opening of the largest bridging traction",
        ),
    ]
}

impl Effect for Bridging {
    fn card(&self) -> &Card {
        &CARD
    }

    fn parameters(&self, _options: &Options) -> Vec<ParamSpec> {
        own_parameters()
    }

    fn shapes(&self, scales: &Scales) -> Vec<Vec<f64>> {
        // From a few δc to openings the test never reaches, where bridging is a plain rise.
        let low = (2.0 * scales.delta_c).min(scales.displacement);
        let lengths = spread(low, (2.0 * scales.displacement).max(4.0 * low), 5);
        lengths.into_iter().map(|d| vec![0.0, d.clamp(LENGTHS.0, LENGTHS.1)]).collect()
    }

    fn start(&self, scales: &Scales) -> Vec<f64> {
        vec![(0.1 * scales.sigma_c).min(100.0), (4.0 * scales.delta_c).clamp(LENGTHS.0, LENGTHS.1)]
    }

    /// Two laws of one form under one opening: that of the longer opening bridges.
    fn exchanged(&self, law: &str, [gc, sigma_c]: [f64; 2], own: &[f64]) -> Option<([f64; 2], Vec<f64>)> {
        let (sigma_b, delta_b) = (own[SIGMA_B], own[DELTA_B]);
        let delta_c = gc / (E * sigma_c);
        let swapped = law == "exponential" && sigma_b > 0.0 && delta_b < delta_c;
        swapped.then(|| ([E * sigma_b * delta_b, sigma_b], vec![sigma_c, delta_c]))
    }

    fn act(&self, _options: &Options, _piece: &Piece) -> Action {
        Action::Interface(Box::new(|inner| Arc::new(decorate(inner, Fibres))))
    }
}

/// δmax is the base law's own: both laws see the same effective opening.
struct Fibres;

impl Decoration<3> for Fibres {
    const NAME: &'static str = "bridging";

    fn parameters(&self) -> Vec<ParamSpec> {
        own_parameters()
    }

    fn respond<S: Scalar>(&self, call: &Call<'_, S, 3>, inner_new: &mut [S], _new: &mut [S]) -> Response<S, 3>
    where
        dyn PointLaw<3>: Law<S, 3>,
    {
        let mut r = call.inner(inner_new);
        let lambda = call.base[LAMBDA];
        let delta = effective_opening(call.gradient, lambda);
        let length = call.own[DELTA_B];
        let secant = call.own[SIGMA_B] * E / length * (-(inner_new[DELTA_MAX] / length)).exp();
        add_secant(&mut r, call.gradient, lambda, delta, secant);
        r
    }

    fn energies(&self, call: &Call<'_, f64, 3>, inner_new: &[f64], _new: &[f64]) -> Energy {
        let mut e = call.inner_energies(call.gradient, call.base, inner_new);
        let (sigma, length) = (call.own[SIGMA_B], call.own[DELTA_B]);
        if sigma > 0.0 {
            let delta = effective_opening(call.gradient, call.base[LAMBDA]);
            let secant = sigma * E / length * (-inner_new[DELTA_MAX] / length).exp();
            e.stored += 0.5 * secant * delta * delta;
            e.dissipated += dissipated(inner_new[DELTA_MAX], E * sigma * length, sigma);
        }
        e
    }
}
