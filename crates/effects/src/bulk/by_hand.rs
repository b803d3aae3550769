//! Tangents by hand of what decorators do with the stress inside: the hot path of their finite
//! elements. Derived in docs/theory.md; held equal to the jets by tests/decorators.rs.

use super::symmetric::{Sym, dot, pushed};
use crate::decorator::Tangent;
use constitutive::tensor;

/// The tangent without the volumetric term of the base law.
pub fn isochoric_tangent(gradient: &[f64; 9], base: &[f64], whole: &Tangent<9>) -> Tangent<9> {
    let (p, a) = hgo::volumetric_tangent(gradient, base[hgo::D]);
    let mut out = *whole;
    add(&mut out, -1.0, &(p, a));
    out
}

/// to += factor · x, stress and modulus alike.
pub fn add(to: &mut Tangent<9>, factor: f64, x: &Tangent<9>) {
    for i in 0..9 {
        to.0[i] += factor * x.0[i];
        for j in 0..9 {
            to.1[i][j] += factor * x.1[i][j];
        }
    }
}

/// modulus += factor · p⊗p.
pub fn add_square(modulus: &mut [[f64; 9]; 9], factor: f64, p: &[f64; 9]) {
    for i in 0..9 {
        for j in 0..9 {
            modulus[i][j] += factor * p[i] * p[j];
        }
    }
}

/// F⁻ᵀ.
pub fn inverse_transposed(f: &[f64; 9]) -> [f64; 9] {
    let inverse = tensor::inverse(f);
    std::array::from_fn(|k| inverse[3 * (k % 3) + k / 3])
}

/// Stress and tangent of m F Dev K for a constant symmetric K, m = J^(−2/3): the gradient and the
/// second gradient of ½ m K : C.
pub fn constant_stress(f: &[f64; 9], m: f64, c: &Sym<f64>, k: &Sym<f64>) -> Tangent<9> {
    let (b, g, q) = (pushed(f, k), inverse_transposed(f), dot(k, c));
    let full = [k[0], k[3], k[5], k[3], k[1], k[4], k[5], k[4], k[2]];
    let stress = std::array::from_fn(|i| m * (b[i] - q / 3.0 * g[i]));
    let mut a = [[0.0; 9]; 9];
    for (r, row) in a.iter_mut().enumerate() {
        let (i, j) = (r / 3, r % 3);
        for (s, x) in row.iter_mut().enumerate() {
            let (n, l) = (s / 3, s % 3);
            let same = if i == n { full[3 * j + l] } else { 0.0 };
            *x = m
                * (same - 2.0 / 3.0 * (b[r] * g[s] + g[r] * b[s])
                    + q * (2.0 / 9.0 * g[r] * g[s] + g[3 * i + l] * g[3 * n + j] / 3.0));
        }
    }
    (stress, a)
}

/// Stress and tangent of F Dev S = P − ⅓ (P : F) F⁻ᵀ for P = F S with its tangent.
pub fn deviatoric(f: &[f64; 9], x: &Tangent<9>) -> Tangent<9> {
    let (p, a) = x;
    let g = inverse_transposed(f);
    let trace: f64 = p.iter().zip(f).map(|(p, f)| p * f).sum();
    let mut slope = *p;
    for (row, f) in a.iter().zip(f) {
        for (s, a) in slope.iter_mut().zip(row) {
            *s += f * a;
        }
    }
    let mut out = *x;
    for (r, (stress, row)) in out.0.iter_mut().zip(&mut out.1).enumerate() {
        let (i, j) = (r / 3, r % 3);
        *stress -= trace / 3.0 * g[r];
        for (s, x) in row.iter_mut().enumerate() {
            let (n, l) = (s / 3, s % 3);
            *x -= (g[r] * slope[s] - trace * g[3 * i + l] * g[3 * n + j]) / 3.0;
        }
    }
    out
}
