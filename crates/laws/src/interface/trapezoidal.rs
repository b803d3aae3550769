//! A rise, a plateau, a fall.

use super::bilinear::rise;
use crate::entry::{LawCard, LawEntry, Settings};
use cohesive::{Curve, GC, Irreversible, SIGMA_C};
use constitutive::{PointLaw, Scalar};
use params::{ParamSpec, Quantity, Transform};
use std::sync::Arc;

const RISE: usize = cohesive::PARAMETERS;
const PLATEAU: usize = cohesive::PARAMETERS + 1;

static CARD: LawCard = LawCard {
    name: "trapezoidal",
    summary: "Traction rises to σc, stays there over a plateau, and falls to zero: yielding before it tears.",
    equation: "t = σc δ/δc to δc = r δf, σc to δ2 = δc + p (δf − δc), then σc (δf − δ)/(δf − δ2) to \
               δf = 2 Gc/(σc (1 + p (1 − r)));  secant unloading below δmax",
    reference: "Tvergaard & Hutchinson 1992, J. Mech. Phys. Solids 40, 1377–1397, doi:10.1016/0022-5096(92)90020-3",
};

/// The trapezoidal law.
#[derive(Clone, Copy, Debug, Default)]
pub struct Trapezoidal;

impl LawEntry<3> for Trapezoidal {
    fn card(&self) -> &LawCard {
        &CARD
    }

    fn law(&self, _settings: &Settings) -> Arc<dyn PointLaw<3>> {
        Arc::new(Irreversible(*self))
    }
}

/// δc, δ2 and δf, mm.
fn corners<S: Scalar>(params: &[S]) -> [S; 3] {
    let (rise, plateau) = (params[RISE], params[PLATEAU]);
    let rest = -rise + 1.0;
    let last = params[GC] * 2.0 / (params[SIGMA_C] * (plateau * rest + 1.0));
    let peak = rise * last;
    [peak, peak + plateau * rest * last, last]
}

impl Curve for Trapezoidal {
    fn shape(&self) -> Vec<ParamSpec> {
        let about = "plateau over what is left of the opening after the peak; fixed unless freed";
        let plateau = ParamSpec::new("plateau", "p", Quantity::Dimensionless, (0.0, 0.95), 0.4, about)
            .transform(Transform::Logit { lower: -0.05, upper: 1.0 })
            .fixed();
        vec![rise(), plateau]
    }

    fn secant<S: Scalar>(&self, delta: S, params: &[S]) -> S {
        let [peak, fall, last] = corners(params);
        let (strength, at) = (params[SIGMA_C], delta.value());
        if at <= peak.value() {
            strength / peak
        } else if at <= fall.value() {
            strength / delta
        } else if at < last.value() {
            strength * (last - delta) / ((last - fall) * delta)
        } else {
            S::zero()
        }
    }

    fn work<S: Scalar>(&self, delta: S, params: &[S]) -> S {
        let [peak, fall, last] = corners(params);
        let (strength, at) = (params[SIGMA_C], delta.value());
        if at <= peak.value() {
            strength * delta * delta / (peak * 2.0)
        } else if at <= fall.value() {
            strength * (delta - peak * 0.5)
        } else if at < last.value() {
            let left = last - delta;
            params[GC] - strength * left * left / ((last - fall) * 2.0)
        } else {
            params[GC]
        }
    }

    fn delta_c<S: Scalar>(&self, params: &[S]) -> S {
        corners(params)[0]
    }
}
