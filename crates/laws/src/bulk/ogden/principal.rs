//! Stress and energy in the principal frame of C.

use super::super::sym::strain;
use constitutive::spectral::{power_difference, principal};
use constitutive::{Context, Law, Response, Scalar, tensor};

/// The point law. Parameters μ1, α1, μ2, α2, …, D; gradient F, force P (MPa, row-major), energy Ψ (MPa), no history.
///
/// The stress is written in the principal frame of C; its derivatives by F and by the exponents come from there too,
/// with divided differences in which equal stretches lose no digit.
#[derive(Clone, Copy, Debug)]
pub(super) struct Principal {
    pub terms: usize,
}

/// Sums over the terms at principal values x of C (squares of the stretches) that carry derivatives.
pub(super) struct Principals<S> {
    /// Kirchhoff principal stresses without the volume's, MPa.
    pub beta: [S; 3],
    /// Σ 2μ/α times the mean of λ̄^α.
    pub mean: S,
    pub energy: S,
}

impl Principal {
    /// Index of D.
    pub const fn d(self) -> usize {
        2 * self.terms
    }

    /// `ln_stretch`: logarithms of λ̄.
    pub fn principals<S: Scalar>(self, params: &[S], ln_stretch: &[S; 3]) -> Principals<S> {
        let mut out = Principals { beta: [S::zero(); 3], mean: S::zero(), energy: S::zero() };
        for pair in params[..self.d()].chunks_exact(2) {
            let (mu, alpha) = (pair[0], pair[1]);
            let weight = mu * 2.0 / alpha;
            // λ̄^α − 1: exact near the reference state.
            let power = ln_stretch.map(|l| (alpha * l).exp_m1());
            let mean = (power[0] + power[1] + power[2]) / 3.0;
            for (beta, p) in out.beta.iter_mut().zip(&power) {
                *beta += weight * (*p - mean);
            }
            out.mean += weight * (mean + 1.0);
            out.energy += weight / alpha * mean * 3.0;
        }
        out
    }

    /// Σ 2μ/α J^(−α/3) (x^q − y^q)/(x − y) with q = α/2 + `shift`.
    pub fn differences(self, params: &[f64], ln_j: f64, x: f64, y: f64, shift: f64) -> f64 {
        let term = |pair: &[f64]| {
            let (mu, alpha) = (pair[0], pair[1]);
            2.0 * mu / alpha * (-alpha * ln_j / 3.0).exp() * power_difference(x, y, 0.5 * alpha + shift)
        };
        params[..self.d()].chunks_exact(2).map(term).sum()
    }
}

impl<S: Scalar> Law<S, 9> for Principal {
    fn respond(
        &self,
        _ctx: &Context,
        gradient: &[S; 9],
        params: &[S],
        _old: &[S],
        _new: &mut [S],
    ) -> Response<S, 9> {
        let mut sum = hgo::volumetric(gradient, params[self.d()]);
        let j = tensor::det(gradient);
        let plain = gradient.map(Scalar::value);
        let (x, q) = principal(&tensor::right_cauchy_green(&plain));
        let ln_j = j.ln();
        // C in the principal frame, its values taken off: what is left are the derivatives alone.
        let moved = {
            let mut c = super::super::sym::matrix(&strain(gradient));
            c.iter_mut().for_each(|c| *c = *c - c.value());
            let axes = q.map(S::from);
            tensor::mul(&tensor::transpose(&axes), &tensor::mul(&c, &axes))
        };
        let ln_stretch: [S; 3] =
            std::array::from_fn(|a| (moved[4 * a] / x[a] + x[a].ln()) * 0.5 - ln_j / 3.0);
        let s = self.principals(params, &ln_stretch);
        let values: Vec<f64> = params.iter().map(|p| p.value()).collect();
        let mut frame = [S::zero(); 9];
        for a in 0..3 {
            frame[4 * a] = s.beta[a] / (moved[4 * a] + x[a]);
            for b in (0..3).filter(|b| *b != a) {
                let slope = self.differences(&values, ln_j.value(), x[a], x[b], -1.0)
                    + s.mean.value() / (x[a] * x[b]);
                frame[3 * a + b] = moved[3 * a + b] * slope;
            }
        }
        let axes = q.map(S::from);
        let second = tensor::mul(&axes, &tensor::mul(&frame, &tensor::transpose(&axes)));
        for (p, s) in sum.force.iter_mut().zip(tensor::mul(gradient, &second)) {
            *p += s;
        }
        sum.energy += s.energy;
        sum
    }
}
