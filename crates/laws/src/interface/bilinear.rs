//! A straight rise and a straight fall.

use crate::entry::{LawCard, LawEntry, Settings};
use cohesive::{Curve, GC, Irreversible, SIGMA_C};
use constitutive::{PointLaw, Scalar};
use params::{ParamSpec, Quantity, Transform};
use std::sync::Arc;

const RISE: usize = cohesive::PARAMETERS;

static CARD: LawCard = LawCard {
    name: "bilinear",
    summary: "Traction rises in a straight line to σc and falls in a straight line to zero at a finite opening.",
    equation: "t = σc δ/δc to δc = r δf, then σc (δf − δ)/(δf − δc) to δf = 2 Gc/σc;  secant unloading below δmax",
    reference: "Geubelle & Baylor 1998, Composites B 29, 589–602, doi:10.1016/S1359-8368(98)00011-5",
};

/// The bilinear law.
#[derive(Clone, Copy, Debug, Default)]
pub struct Bilinear;

impl LawEntry<3> for Bilinear {
    fn card(&self) -> &LawCard {
        &CARD
    }

    fn law(&self, _settings: &Settings) -> Arc<dyn PointLaw<3>> {
        Arc::new(Irreversible(*self))
    }
}

/// δf, mm.
fn last<S: Scalar>(params: &[S]) -> S {
    params[GC] * 2.0 / params[SIGMA_C]
}

/// Opening of the peak over the last opening, a shape parameter that both laws of straight lines have.
pub(super) fn rise() -> ParamSpec {
    let about = "opening of the peak over the last opening; fixed unless freed";
    ParamSpec::new("rise", "r", Quantity::Dimensionless, (0.005, 0.9), 0.1, about)
        .transform(Transform::Logit { lower: 0.0, upper: 1.0 })
        .fixed()
}

impl Curve for Bilinear {
    fn shape(&self) -> Vec<ParamSpec> {
        vec![rise()]
    }

    fn secant<S: Scalar>(&self, delta: S, params: &[S]) -> S {
        let (peak, last) = (self.delta_c(params), last(params));
        if delta.value() <= peak.value() {
            params[SIGMA_C] / peak
        } else if delta.value() < last.value() {
            params[SIGMA_C] * (last - delta) / ((last - peak) * delta)
        } else {
            S::zero()
        }
    }

    fn work<S: Scalar>(&self, delta: S, params: &[S]) -> S {
        let (peak, last) = (self.delta_c(params), last(params));
        if delta.value() <= peak.value() {
            params[SIGMA_C] * delta * delta / (peak * 2.0)
        } else if delta.value() < last.value() {
            let left = last - delta;
            params[GC] - params[SIGMA_C] * left * left / ((last - peak) * 2.0)
        } else {
            params[GC]
        }
    }

    fn delta_c<S: Scalar>(&self, params: &[S]) -> S {
        params[RISE] * last(params)
    }
}
