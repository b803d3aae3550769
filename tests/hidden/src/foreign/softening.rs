//! Softening that is a part along half a cosine.

use cohesive::{Curve, GC, PARAMETERS, SIGMA_C};
use constitutive::Scalar;
use params::{ParamSpec, Quantity};
use std::f64::consts::PI;

const ABOUT: &str = "share of the cosine";

/// Part of the last opening at which the cosine's traction peaks.
const RISE: f64 = 0.1;

pub(super) fn parameters() -> Vec<ParamSpec> {
    vec![ParamSpec::new("share", "w", Quantity::Dimensionless, (0.0, 1.0), 0.4, ABOUT).neutral(0.0)]
}

/// The mixture: both have the strength σc and the work Gc.
#[derive(Clone, Copy)]
pub(super) struct Mixed;

/// Opening of the cosine's peak, and how far it falls from there.
fn openings<S: Scalar>(params: &[S]) -> (S, S) {
    let last = params[GC] * 2.0 / params[SIGMA_C];
    (last * RISE, last * (1.0 - RISE))
}

impl Curve for Mixed {
    fn shape(&self) -> Vec<ParamSpec> {
        let named = |p: ParamSpec| ParamSpec { name: format!("foreign_softening.{}", p.name).into(), ..p };
        parameters().into_iter().map(named).collect()
    }

    fn secant<S: Scalar>(&self, delta: S, params: &[S]) -> S {
        let ((rise, fall), w) = (openings(params), params[PARAMETERS]);
        let beyond = delta - rise;
        let cosine = if beyond.value() <= 0.0 {
            params[SIGMA_C] / rise
        } else if beyond.value() < fall.value() {
            params[SIGMA_C] * ((beyond / fall * PI).cos() + 1.0) * 0.5 / delta
        } else {
            S::zero()
        };
        let exponential = cohesive::secant_stiffness(delta, params[GC], params[SIGMA_C]);
        exponential + w * (cosine - exponential)
    }

    fn work<S: Scalar>(&self, delta: S, params: &[S]) -> S {
        let ((rise, fall), w) = (openings(params), params[PARAMETERS]);
        let beyond = delta - rise;
        let cosine = if beyond.value() <= 0.0 {
            params[SIGMA_C] * delta.square() / (rise * 2.0)
        } else if beyond.value() < fall.value() {
            let sine = (beyond / fall * PI).sin() * fall / PI;
            params[SIGMA_C] * (rise + beyond + sine) * 0.5
        } else {
            params[GC]
        };
        let exponential = cohesive::work(delta, params[GC], params[SIGMA_C]);
        exponential + w * (cosine - exponential)
    }

    fn delta_c<S: Scalar>(&self, params: &[S]) -> S {
        cohesive::delta_c(params[GC], params[SIGMA_C])
    }
}

#[cfg(test)]
mod tests {
    use super::Mixed;
    use cohesive::Curve;

    /// The work is the integral of the traction, and all of it is Gc.
    #[test]
    fn work_is_what_the_traction_does() {
        for share in [0.0, 0.4, 1.0] {
            let params = [0.2, 0.25, 1.0, 50.0, share];
            let (mut sum, steps) = (0.0, 40_000);
            let step = 20.0 * 0.2 / 0.25 / f64::from(steps);
            for k in 0..steps {
                let delta = (f64::from(k) + 0.5) * step;
                sum += Mixed.secant(delta, &params) * delta * step;
                if k % 1000 == 0 {
                    let work = Mixed.work(delta + 0.5 * step, &params);
                    assert!((sum - work).abs() < 1e-5, "share {share}, δ {delta}: {sum} for {work}");
                }
            }
            assert!((sum - 0.2).abs() < 1e-5, "{sum}");
        }
    }
}
