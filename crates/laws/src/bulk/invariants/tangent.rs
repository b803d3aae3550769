//! The analytic tangent of a sum of terms, as the head of the module writes it.

use super::super::sym::{Sym, matrix, pushed};
use super::kinematics::Kinematics;
use super::terms::Term;

/// First Piola stress and its derivative by F.
pub(super) type Tangent = ([f64; 9], [[f64; 9]; 9]);

/// Adds stress and tangent of terms.
pub(super) fn add_tangent<'a>(
    sum: &mut Tangent,
    kin: &Kinematics<f64>,
    terms: impl Iterator<Item = &'a Term<f64>>,
) {
    let third = 1.0 / (3.0 * kin.j);
    let (mut s, mut p) = ([0.0; 6], 0.0);
    for term in terms {
        let (x, e) = kin.invariant(term);
        if !term.function.is_active(e) {
            continue;
        }
        let (_, slope) = term.function.value_and_slope(e);
        let stiffness = 2.0 * slope * kin.m;
        for (s, h) in s.iter_mut().zip(&term.h) {
            *s += stiffness * h;
        }
        p -= stiffness * x * third;
        let mut g = pushed(&kin.f, &term.h.map(|h| 2.0 * kin.m * h));
        for (g, c) in g.iter_mut().zip(&kin.cof) {
            *g -= 2.0 * kin.m * x * third * c;
        }
        let curvature = term.function.curvature(e);
        for (row, gi) in sum.1.iter_mut().zip(&g) {
            for (a, gj) in row.iter_mut().zip(&g) {
                *a += curvature * gi * gj;
            }
        }
    }
    let along = pushed(&kin.f, &s);
    let y: [f64; 9] = std::array::from_fn(|i| -2.5 * third * p * kin.cof[i] - 2.0 * third * along[i]);
    for i in 0..9 {
        sum.0[i] += along[i] + p * kin.cof[i];
        for j in 0..9 {
            sum.1[i][j] += kin.cof[i] * y[j] + y[i] * kin.cof[j];
        }
    }
    add_second_gradient(&mut sum.1, &kin.f, &s, p);
}

/// δ_ik s_JL + p ∂c_iJ/∂F_kL. The block (i, k) of ∂c/∂F, k the row after i, is the axial matrix of the third row of F;
/// the block (k, i) is its transpose.
fn add_second_gradient(a: &mut [[f64; 9]; 9], f: &[f64; 9], s: &Sym<f64>, p: f64) {
    let full = matrix(s);
    for i in 0..3 {
        let r = 3 * i;
        for j in 0..3 {
            for l in 0..3 {
                a[r + j][r + l] += full[3 * j + l];
            }
        }
        let (k, m) = (3 * ((i + 1) % 3), 3 * ((i + 2) % 3));
        let v = [p * f[m], p * f[m + 1], p * f[m + 2]];
        for (row, col, value) in
            [(0, 1, v[2]), (0, 2, -v[1]), (1, 0, -v[2]), (1, 2, v[0]), (2, 0, v[1]), (2, 1, -v[0])]
        {
            a[r + row][k + col] += value;
            a[k + col][r + row] += value;
        }
    }
}
