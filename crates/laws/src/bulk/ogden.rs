//! Rubber in principal stretches, one to three terms; equal stretches are no special case.

use super::sym::strain;
use crate::entry::{LawCard, LawEntry, Settings};
use constitutive::spectral::{power_difference, principal};
use constitutive::{
    BulkParts, Context, Describe, Energy, HistorySpec, Law, Offers, PointLaw, Response, Scalar, StartGrid,
    part, tensor,
};
use hgo::Volumetric;
use input::{OptionKind, OptionSpec, OptionValue};
use params::{ParamSpec, Quantity};
use std::sync::Arc;

const MOST_TERMS: usize = 3;

static CARD: LawCard = LawCard {
    name: "ogden",
    summary: "Isotropic, one to three powers of the principal stretches (terms = 1, 2 or 3): rubber to large \
              stretches, brain and other isotropic soft tissue.",
    equation: "Ψ = U(J) + Σ_p 2 μp/αp² (λ̄1^αp + λ̄2^αp + λ̄3^αp − 3),  λ̄ = J^(−1/3) λ;  initial shear modulus Σ μp \
               (μp of the source is 2 μp/αp here)",
    reference: "Ogden 1972, Proc. R. Soc. A 326, 565–584, doi:10.1098/rspa.1972.0026",
};

/// Ogden's law.
#[derive(Clone, Copy, Debug, Default)]
pub struct Ogden;

impl LawEntry<9> for Ogden {
    fn card(&self) -> &LawCard {
        &CARD
    }

    fn options(&self) -> Vec<OptionSpec> {
        vec![OptionSpec {
            name: "terms".into(),
            kind: OptionKind::Integer { min: 1, max: MOST_TERMS as i64 },
            default: Some(OptionValue::Integer(1)),
            description: "number of powers; the second is mu2, alpha2, and so on".into(),
        }]
    }

    fn law(&self, settings: &Settings) -> Arc<dyn PointLaw<9>> {
        let terms = match settings.get("terms") {
            Some(OptionValue::Integer(n)) => (*n).clamp(1, MOST_TERMS as i64) as usize,
            _ => 1,
        };
        Arc::new(Principal { terms })
    }
}

/// The point law. Parameters μ1, α1, μ2, α2, …, D; gradient F, force P (MPa, row-major), energy Ψ (MPa), no history.
///
/// The stress is written in the principal frame of C; its derivatives by F and by the exponents come from there too,
/// with divided differences in which equal stretches lose no digit.
#[derive(Clone, Copy, Debug)]
struct Principal {
    terms: usize,
}

/// Sums over the terms at principal values x of C (squares of the stretches) that carry derivatives.
struct Principals<S> {
    /// Kirchhoff principal stresses without the volume's, MPa.
    beta: [S; 3],
    /// Σ 2μ/α times the mean of λ̄^α.
    mean: S,
    energy: S,
}

impl Principal {
    const fn d(self) -> usize {
        2 * self.terms
    }

    /// `ln_stretch`: logarithms of λ̄.
    fn principals<S: Scalar>(self, params: &[S], ln_stretch: &[S; 3]) -> Principals<S> {
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
    fn differences(self, params: &[f64], ln_j: f64, x: f64, y: f64, shift: f64) -> f64 {
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
            let mut c = super::sym::matrix(&strain(gradient));
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

impl Describe<9> for Principal {
    fn parameters(&self) -> Vec<ParamSpec> {
        // Powers of alternating sign: two terms of one sign are hardly told apart.
        const NAMES: [[&str; 4]; MOST_TERMS] =
            [["mu1", "μ1", "alpha1", "α1"], ["mu2", "μ2", "alpha2", "α2"], ["mu3", "μ3", "alpha3", "α3"]];
        const STARTS: [(f64, f64); MOST_TERMS] = [(0.05, 4.0), (0.01, -4.0), (0.001, 12.0)];
        let mut all = Vec::new();
        for ([mu, symbol, alpha, power], (start, exponent)) in NAMES.into_iter().zip(STARTS).take(self.terms)
        {
            let about = "contribution of this term to the initial shear modulus";
            all.push(
                ParamSpec::new(mu, symbol, Quantity::Stress, (1e-9, 1e4), start, about)
                    .admissible(1e-12, 1e6)
                    .expected(start, 2.5),
            );
            let (bounds, about) = match exponent > 0.0 {
                true => ((0.2, 100.0), "power of this term, positive"),
                false => ((-100.0, -0.2), "power of this term, negative"),
            };
            let spec = ParamSpec::new(alpha, power, Quantity::Dimensionless, bounds, exponent, about);
            all.push(if exponent > 0.0 { spec.expected(exponent, 1.0) } else { spec });
        }
        all.push(hgo::compliance());
        all
    }

    fn history(&self) -> Vec<HistorySpec> {
        Vec::new()
    }

    fn rate_dependent(&self) -> bool {
        false
    }

    fn energies(
        &self,
        ctx: &Context,
        gradient: &[f64; 9],
        params: &[f64],
        _old: &[f64],
        _new: &[f64],
    ) -> Energy {
        Energy { stored: self.respond(ctx, gradient, params, &[], &mut []).energy, dissipated: 0.0 }
    }

    fn hand_tangent(
        &self,
        _ctx: &Context,
        gradient: &[f64; 9],
        params: &[f64],
        _old: &[f64],
        _new: &mut [f64],
    ) -> Option<([f64; 9], [[f64; 9]; 9])> {
        Some(self.spectral_tangent(gradient, params))
    }

    fn offers(&self) -> Offers {
        let mut template = vec![0.0; self.d() + 1];
        template[self.d()] = 1.0;
        let starts = StartGrid {
            template,
            axes: (0..self.terms).flat_map(|p| [(2 * p, 3), (2 * p + 1, 6)]).collect(),
            scaled: (0..self.terms).map(|p| 2 * p).collect(),
            size: 0,
            apart: None,
        };
        let bulk = BulkParts {
            volumetric: Some(part(Volumetric { d: self.d() })),
            rest_is_isochoric: true,
            fibres: Vec::new(),
            fibre_onset: None,
            matrix_modulus: |params| params[..params.len() - 1].iter().step_by(2).sum(),
            starts: Some(starts),
            mirrors: true,
        };
        Offers { bulk: Some(bulk), cohesion: None }
    }
}

impl Principal {
    /// P and ∂P/∂F in the principal frame, F = Σ λa na⊗Na (Ogden 1997, Non-Linear Elastic Deformations, ch. 6):
    /// entries ∂²Ψ/∂λa∂λb on the axes, (τa − τb)/(xa − xb) and λaλb (τa/xa − τb/xb)/(xa − xb) in shear.
    fn spectral_tangent(self, f: &[f64; 9], params: &[f64]) -> ([f64; 9], [[f64; 9]; 9]) {
        let (x, q) = principal(&tensor::right_cauchy_green(f));
        let j = tensor::det(f);
        let j = if j > 0.0 { j } else { f64::NAN };
        let (ln_j, pressure) = (j.ln(), (j * j - 1.0) / params[self.d()]);
        let s = self.principals(params, &x.map(|x| 0.5 * x.ln() - ln_j / 3.0));
        let stretch = x.map(f64::sqrt);
        let tau = s.beta.map(|b| b + pressure);
        // The columns of F Q are λa na.
        let pushed = tensor::mul(f, &q);
        let dyad = |a: usize, b: usize| -> [f64; 9] {
            std::array::from_fn(|k| pushed[3 * (k / 3) + a] / stretch[a] * q[3 * (k % 3) + b])
        };
        let mut out = ([0.0; 9], [[0.0; 9]; 9]);
        for a in 0..3 {
            let along = dyad(a, a);
            for (p, d) in out.0.iter_mut().zip(&along) {
                *p += tau[a] / stretch[a] * d;
            }
            for b in 0..3 {
                let slope = self.axial(params, &x, ln_j, a, b) + 2.0 * j * j / params[self.d()]
                    - if a == b { tau[a] } else { 0.0 };
                add_product(&mut out.1, slope / (stretch[a] * stretch[b]), &along, &dyad(b, b));
                if a == b {
                    continue;
                }
                let shear = self.differences(params, ln_j, x[a], x[b], 0.0);
                let turned =
                    self.differences(params, ln_j, x[a], x[b], -1.0) - (pressure - s.mean) / (x[a] * x[b]);
                add_product(&mut out.1, shear, &dyad(a, b), &dyad(a, b));
                add_product(&mut out.1, stretch[a] * stretch[b] * turned, &dyad(a, b), &dyad(b, a));
            }
        }
        out
    }

    /// ∂β_a/∂ln λ_b = Σ 2μ (λ̄a^α (δab − ⅓) − ⅓ (λ̄b^α − mean)).
    fn axial(self, params: &[f64], x: &[f64; 3], ln_j: f64, a: usize, b: usize) -> f64 {
        let term = |pair: &[f64]| {
            let (mu, alpha) = (pair[0], pair[1]);
            let power = x.map(|x| (alpha * (0.5 * x.ln() - ln_j / 3.0)).exp());
            let mean = (power[0] + power[1] + power[2]) / 3.0;
            let unit = if a == b { 1.0 } else { 0.0 };
            2.0 * mu * (power[a] * (unit - 1.0 / 3.0) - (power[b] - mean) / 3.0)
        };
        params[..self.d()].chunks_exact(2).map(term).sum()
    }
}

/// to += factor · a⊗b.
fn add_product(to: &mut [[f64; 9]; 9], factor: f64, a: &[f64; 9], b: &[f64; 9]) {
    for (row, a) in to.iter_mut().zip(a) {
        for (t, b) in row.iter_mut().zip(b) {
            *t += factor * a * b;
        }
    }
}
