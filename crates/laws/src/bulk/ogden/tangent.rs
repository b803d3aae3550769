//! The analytic tangent in the principal frame.

use super::principal::Principal;
use constitutive::spectral::principal;
use constitutive::tensor;

impl Principal {
    /// P and ∂P/∂F in the principal frame, F = Σ λa na⊗Na (Ogden 1997, Non-Linear Elastic Deformations, ch. 6):
    /// entries ∂²Ψ/∂λa∂λb on the axes, (τa − τb)/(xa − xb) and λaλb (τa/xa − τb/xb)/(xa − xb) in shear.
    pub fn spectral_tangent(self, f: &[f64; 9], params: &[f64]) -> ([f64; 9], [[f64; 9]; 9]) {
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
