//! Analytic tangents of what decorators do with the stress inside: the hot path of their finite
//! elements. Derived in docs/theory.md; held equal to the jets by tests/all/tangents.rs.

use super::symmetric::{Sym, dot, pushed};
use crate::decorator::Tangent;
use constitutive::{Part, part_tangent, tensor};

/// The tangent without the volumetric part of the base law.
pub fn isochoric_tangent(
    volumetric: Option<&Part>,
    gradient: &[f64; 9],
    base: &[f64],
    whole: &Tangent<9>,
) -> Tangent<9> {
    let mut out = *whole;
    if let Some(part) = volumetric {
        add(&mut out, -1.0, &part_tangent(part, gradient, base));
    }
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

/// F⁻ᵀ as a matrix by components, g_iL g_kJ at (r = iJ, kL): what F⁻ᵀ varies by, with the other sign.
fn crossed(g: &[f64; 9], r: usize) -> [f64; 9] {
    let (i, j) = (3 * (r / 3), r % 3);
    std::array::from_fn(|s| g[i + s % 3] * g[3 * (s / 3) + j])
}

/// to += stress and tangent of m F Dev K for a constant symmetric K, m = J^(−2/3): the gradient and the
/// second gradient of ½ m K : C. `g` is F⁻ᵀ.
pub fn add_constant(to: &mut Tangent<9>, f: &[f64; 9], g: &[f64; 9], m: f64, c: &Sym<f64>, k: &Sym<f64>) {
    let (b, q) = (pushed(f, k), dot(k, c));
    let full = [k[0], k[3], k[5], k[3], k[1], k[4], k[5], k[4], k[2]].map(|x| m * x);
    let (third, squares) = (m * q / 3.0, 2.0 / 9.0 * m * q);
    for (r, row) in to.1.iter_mut().enumerate() {
        to.0[r] += m * b[r] - third * g[r];
        let (of_g, of_b) = (squares * g[r] - 2.0 / 3.0 * m * b[r], -2.0 / 3.0 * m * g[r]);
        let cross = crossed(g, r);
        for s in 0..9 {
            row[s] += of_g * g[s] + of_b * b[s] + third * cross[s];
        }
        let (i, j) = (3 * (r / 3), 3 * (r % 3));
        for l in 0..3 {
            row[i + l] += full[j + l];
        }
    }
}

/// to += factor · stress and tangent of F Dev S = P − ⅓ (P : F) F⁻ᵀ for P = F S with its tangent `x`. A part of
/// P that comes of the volume alone drops out. `g` is F⁻ᵀ.
pub fn add_deviatoric(to: &mut Tangent<9>, factor: f64, f: &[f64; 9], g: &[f64; 9], x: &Tangent<9>) {
    let (p, a) = x;
    let mut slope = *p;
    for (row, f) in a.iter().zip(f) {
        for s in 0..9 {
            slope[s] += f * row[s];
        }
    }
    let third = factor / 3.0 * p.iter().zip(f).map(|(p, f)| p * f).sum::<f64>();
    for (r, row) in to.1.iter_mut().enumerate() {
        to.0[r] += factor * p[r] - third * g[r];
        let (of_slope, cross) = (factor / 3.0 * g[r], crossed(g, r));
        for s in 0..9 {
            row[s] += factor * a[r][s] - of_slope * slope[s] + third * cross[s];
        }
    }
}
