//! A cohesive law that is blunter or sharper than the base one, at the same strength and work.

use super::add_secant;
use crate::decorator::{Call, Decoration, decorate};
use cohesive::{DELTA_MAX, GC, LAMBDA, SIGMA_C, effective_opening};
use constitutive::{Capability, Energy, Law, PointLaw, Response, Scalar};
use model::{Action, Card, Effect, Options, Piece, Scales, Screening, Sided, Site};
use params::{ParamSpec, Quantity};
use statrs::function::gamma::{digamma, gamma, gamma_lr};
use std::f64::consts::E;
use std::sync::Arc;

static CARD: Card = Card {
    name: "law_shape",
    site: Site::Interface,
    rank: 10,
    summary: "The softening of the tear follows another curve than the exponential one, at the same \
              strength and fracture energy: blunt and long (n < 1) or narrow about its peak (n > 1).",
    law: "t = σc (δ/δc)ⁿ exp(1 − (δ/δc)ⁿ),  peak σc at δc,  Gc = e σc δc Γ(1 + 1/n)/n fixes δc;  n = 1 is the \
          base law.  Below 10⁻³ δc the secant is held, so that the initial stiffness is finite; unloading follows \
          the secant of δmax, or the curve where that lies lower (n > 1, small openings)",
    reference: "cohesive-law shape studies; exponential base law: Ortiz & Pandolfi 1999",
    shows_in: &["onset", "peak", "tail"],
    look_alikes: &["cut_length"],
    separated_by: "a camera on the tear (tear_front_mm), or a test with a longer cut",
    ordinary: "n off by 0.2 from the exponential law's 1: the peak moves visibly, the law stays of its kind",
    excludes: &[],
    needs: &["tearing"],
    screening: Screening::Score(Sided::Both),
    negative_control: false,
    breaks_half_height: false,
};

/// Exponent of the cohesive law.
#[derive(Clone, Copy, Debug, Default)]
pub struct LawShape;

fn own_parameters() -> Vec<ParamSpec> {
    vec![
        ParamSpec::new("n", "n", Quantity::Dimensionless, (0.4, 3.0), 1.2, "exponent of the cohesive law")
            .neutral(1.0),
    ]
}

impl Effect for LawShape {
    fn card(&self) -> &Card {
        &CARD
    }

    fn parameters(&self, _options: &Options) -> Vec<ParamSpec> {
        own_parameters()
    }

    fn asks(&self, _options: &Options) -> Vec<Capability> {
        vec![Capability::ExponentialCurve]
    }

    fn shapes(&self, _scales: &Scales) -> Vec<Vec<f64>> {
        vec![vec![1.0]]
    }

    fn start(&self, _scales: &Scales) -> Vec<f64> {
        vec![1.2]
    }

    fn act(&self, _options: &Options, _piece: &Piece) -> Action {
        Action::Interface(Box::new(|inner| Arc::new(decorate(inner, Exponent))))
    }
}

/// The innermost decorator of the tear path: the base law's secant is exchanged for its own.
struct Exponent;

/// Opening, in units of δc, below which the secant is held.
const HELD: f64 = 1e-3;

/// Γ(1 + 1/n).
fn gamma_of<S: Scalar>(n: S) -> S {
    let a = 1.0 + 1.0 / n.value();
    let g = gamma(a);
    n.chain(g, -g * digamma(a) / (n.value() * n.value()))
}

/// Opening of the peak for an exponent n.
fn peak_opening<S: Scalar>(n: S, gc: S, sigma_c: S) -> S {
    gc * n / (sigma_c * E * gamma_of(n))
}

/// √((δ/δc)² + held²): the opening in units of δc, rounded off at zero.
fn rounded<S: Scalar>(delta: S, peak: S) -> S {
    let x = delta / peak;
    (x * x + HELD * HELD).sqrt()
}

/// Secant stiffness t/δ for an exponent n.
fn secant<S: Scalar>(n: S, delta_max: S, gc: S, sigma_c: S) -> S {
    let peak = peak_opening(n, gc, sigma_c);
    let ln = rounded(delta_max, peak).ln();
    sigma_c / peak * ((n - 1.0) * ln + 1.0 - (n * ln).exp()).exp()
}

/// Secant stiffness at δ ≤ δmax. For n > 1 the curve starts convex: below its crossing with the
/// secant of δmax unloading follows the curve, or closing would give back more than was put in.
fn unloading<S: Scalar>(n: S, delta: S, delta_max: S, gc: S, sigma_c: S) -> S {
    let at_max = secant(n, delta_max, gc, sigma_c);
    if n.value() <= 1.0 {
        return at_max;
    }
    let here = secant(n, delta, gc, sigma_c);
    if here.value() < at_max.value() { here } else { at_max }
}

/// Secant for n less the secant for 1. At n = 1 the value is zero by definition, not by rounding;
/// the derivatives are kept.
fn secant_change<S: Scalar>(n: S, delta: S, delta_max: S, gc: S, sigma_c: S) -> S {
    let change = unloading(n, delta, delta_max, gc, sigma_c) - secant(S::one(), delta_max, gc, sigma_c);
    if n.value() == 1.0 { change.chain(-0.0, 1.0) } else { change }
}

/// Work to the opening δmax, in closed form: rounding turns δ dδ into x dx.
fn work(n: f64, delta_max: f64, gc: f64, sigma_c: f64) -> f64 {
    let x = rounded(delta_max, peak_opening(n, gc, sigma_c));
    let share = |x: f64| gamma_lr(1.0 + 1.0 / n, x.powf(n).min(700.0));
    gc * (share(x) - share(HELD))
}

/// What unloading from δ gives back: along the curve to the crossing, along the secant beyond.
fn recoverable(n: f64, delta: f64, delta_max: f64, gc: f64, sigma_c: f64) -> f64 {
    let k = secant(n, delta_max, gc, sigma_c);
    let crossing = if n > 1.0 { crossing(n, k, delta_max, gc, sigma_c) } else { 0.0 };
    if delta <= crossing {
        return work(n, delta, gc, sigma_c);
    }
    work(n, crossing, gc, sigma_c) + 0.5 * k * (delta * delta - crossing * crossing)
}

/// Opening on the convex part of the curve (n > 1) where its secant is `k`.
fn crossing(n: f64, k: f64, delta_max: f64, gc: f64, sigma_c: f64) -> f64 {
    let stiffest = peak_opening(n, gc, sigma_c) * ((n - 1.0) / n).powf(1.0 / n);
    let (mut low, mut high) = (0.0, stiffest);
    if delta_max <= stiffest {
        return delta_max;
    }
    if secant(n, low, gc, sigma_c) >= k {
        return 0.0;
    }
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if secant(n, middle, gc, sigma_c) < k { low = middle } else { high = middle }
    }
    low
}

impl Decoration<3> for Exponent {
    const NAME: &'static str = "law_shape";

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
        let delta_max = inner_new[DELTA_MAX];
        let k = secant_change(call.own[0], delta, delta_max, call.base[GC], call.base[SIGMA_C]);
        add_secant(&mut r, call.gradient, lambda, delta, k);
        r
    }

    fn energies(&self, call: &Call<'_, f64, 3>, inner_new: &[f64], _new: &[f64]) -> Energy {
        let mut e = call.inner_energies(call.gradient, call.base, inner_new);
        let (n, gc, sigma_c, delta_max) =
            (call.own[0], call.base[GC], call.base[SIGMA_C], inner_new[DELTA_MAX]);
        if n != 1.0 {
            let delta = effective_opening(call.gradient, call.base[LAMBDA]);
            let k = secant(1.0, delta_max, gc, sigma_c);
            e.stored += recoverable(n, delta, delta_max, gc, sigma_c) - 0.5 * k * delta * delta;
            let own = work(n, delta_max, gc, sigma_c) - recoverable(n, delta_max, delta_max, gc, sigma_c);
            e.dissipated += own - work(1.0, delta_max, gc, sigma_c) + 0.5 * k * delta_max * delta_max;
        }
        e
    }
}
