//! The potential-based law of Park, Paulino and Roesler in mode I.

use crate::entry::{LawCard, LawEntry, Settings};
use cohesive::{Curve, GC, Irreversible, SIGMA_C};
use constitutive::{PointLaw, Scalar};
use params::{ParamSpec, Quantity};
use std::sync::Arc;

const ALPHA: usize = cohesive::PARAMETERS;
const SLOPE: usize = cohesive::PARAMETERS + 1;

static CARD: LawCard = LawCard {
    name: "ppr",
    summary: "Potential-based law with a shape α: a concave fall (α < 2), nearly straight (α = 2) or convex (α > 2), \
              to zero at a finite opening.",
    equation: "t = (Gc/δf) α(α + m)/m · x (1 − x)^(α−1) (1 + αx/m)^(m−1),  x = δ/δf;  \
               m = α(α − 1)λ²/(1 − αλ²), the peak σc at δc = λ δf, \
               δf = (Gc/σc) αλ (1 − λ)^(α−1) (α/m + 1)(αλ/m + 1)^(m−1);  secant unloading below δmax",
    reference: "Park, Paulino & Roesler 2009, J. Mech. Phys. Solids 57, 891–908, doi:10.1016/j.jmps.2008.10.003; \
                Δt = 0 and φn = φt",
};

/// Park–Paulino–Roesler, mode I.
#[derive(Clone, Copy, Debug, Default)]
pub struct Ppr;

impl LawEntry<3> for Ppr {
    fn card(&self) -> &LawCard {
        &CARD
    }

    fn law(&self, _settings: &Settings) -> Arc<dyn PointLaw<3>> {
        Arc::new(Irreversible(*self))
    }
}

/// base^exponent of a positive base.
fn power<S: Scalar>(base: S, exponent: S) -> S {
    (exponent * base.ln()).exp()
}

/// m, from the place of the peak.
fn exponent<S: Scalar>(params: &[S]) -> S {
    let (alpha, square) = (params[ALPHA], params[SLOPE] * params[SLOPE]);
    alpha * (alpha - 1.0) * square / (-(alpha * square) + 1.0)
}

/// δf, mm.
fn last<S: Scalar>(params: &[S], m: S) -> S {
    let (alpha, at) = (params[ALPHA], params[SLOPE]);
    params[GC] / params[SIGMA_C]
        * alpha
        * at
        * power(-at + 1.0, alpha - 1.0)
        * (alpha / m + 1.0)
        * power(alpha * at / m + 1.0, m - 1.0)
}

impl Curve for Ppr {
    /// Within these bounds (2α − 1) λ² < 1: the secant never rises.
    fn shape(&self) -> Vec<ParamSpec> {
        let shape = "shape α of the fall; fixed unless freed";
        let peak = "opening of the peak over the last opening; fixed unless freed";
        vec![
            ParamSpec::new("alpha", "α", Quantity::Dimensionless, (1.2, 8.0), 3.0, shape).fixed(),
            ParamSpec::new("peak_at", "λn", Quantity::Dimensionless, (0.005, 0.25), 0.1, peak).fixed(),
        ]
    }

    fn secant<S: Scalar>(&self, delta: S, params: &[S]) -> S {
        let (alpha, m) = (params[ALPHA], exponent(params));
        let last = last(params, m);
        let x = delta / last;
        if x.value() >= 1.0 {
            return S::zero();
        }
        params[GC] / (last * last)
            * (alpha * (alpha + m) / m)
            * power(-x + 1.0, alpha - 1.0)
            * power(alpha * x / m + 1.0, m - 1.0)
    }

    /// Gc (1 − (1 − x)^α (1 + αx/m)^m), the potential itself.
    fn work<S: Scalar>(&self, delta: S, params: &[S]) -> S {
        let (alpha, m) = (params[ALPHA], exponent(params));
        let x = delta / last(params, m);
        if x.value() >= 1.0 {
            return params[GC];
        }
        let ln = alpha * (-x).ln_1p() + m * (alpha * x / m).ln_1p();
        -(params[GC] * ln.exp_m1())
    }

    fn delta_c<S: Scalar>(&self, params: &[S]) -> S {
        params[SLOPE] * last(params, exponent(params))
    }
}
