//! The analytic tangent, in invariants: the hot path of the finite elements.
//!
//! With Ψ a function of J and x_a = H_a : C (matrix: H = I; two families), m = J^(−2/3), c = cof F,
//! w_a the energy of x̄_a = m x_a, the parts of the stress are P = F·s + p c, and
//!
//! ```text
//! A = δ_ik s_JL + p ∂c/∂F + c⊗y + y⊗c + Σ_f w_f'' g_f⊗g_f
//! y = ½ (U'' − 5 p_iso/(3J)) c − 2/(3J) F·s_iso,       g_f = ∂x̄_f/∂F
//! ```
//!
//! because m' = −2m/(3J) and m'' = −5m'/(3J). With full invariants a family has no part in
//! s_iso and p_iso and g_f = 2 F·H_f.

use crate::fibre::{FAMILIES, Family};
use crate::kinematics::{Kinematics, Planar};
use crate::law::{D, FibreInvariants, Hgo, K1, K2, MU, PARAMETERS};

/// Writes P and A = ∂P/∂F. Filled in place: each copy of the 720 bytes costs a tenth of the call.
#[inline(always)]
pub(crate) fn stress_and_tangent(
    law: &Hgo,
    f: &[f64; 9],
    params: &[f64],
    stress: &mut [f64; 9],
    a: &mut [[f64; 9]; 9],
) {
    sum_of_parts(law, f, params, [true; FAMILIES], stress, a);
}

/// First Piola stress (MPa) and tangent (MPa) of one fibre family, the counterpart of
/// [`crate::fibre_response`].
pub fn fibre_tangent(law: &Hgo, f: &[f64; 9], params: &[f64], family: usize) -> ([f64; 9], [[f64; 9]; 9]) {
    let mut alone = [0.0; PARAMETERS];
    alone.copy_from_slice(&params[..PARAMETERS]);
    (alone[MU], alone[D]) = (0.0, f64::INFINITY);
    let mut answer = ([0.0; 9], [[0.0; 9]; 9]);
    let which = std::array::from_fn(|k| k == family);
    sum_of_parts(law, f, &alone, which, &mut answer.0, &mut answer.1);
    answer
}

/// Volumetric stress (MPa) and tangent (MPa), the counterpart of [`crate::volumetric`]; `d` in 1/MPa.
pub fn volumetric_tangent(f: &[f64; 9], d: f64) -> ([f64; 9], [[f64; 9]; 9]) {
    let kin = Kinematics::new(f);
    let inverse_j = 1.0 / kin.j;
    let (p, u2) = ((kin.j - inverse_j) / d, (1.0 + inverse_j * inverse_j) / d);
    let none = [[0.0; 9]; FAMILIES];
    let mut a = [[0.0; 9]; 9];
    set_rank_updates(&mut a, &kin.cof, &kin.cof.map(|c| 0.5 * u2 * c), &none, &[0.0; FAMILIES]);
    add_second_gradient(&mut a, &kin.f, &Planar::zero(), p);
    (kin.cof.map(|c| p * c), a)
}

#[inline(always)]
fn sum_of_parts(
    law: &Hgo,
    f: &[f64; 9],
    params: &[f64],
    which: [bool; FAMILIES],
    stress: &mut [f64; 9],
    a: &mut [[f64; 9]; 9],
) {
    let kin = Kinematics::new(f);
    let inverse_j = 1.0 / kin.j;
    let third = inverse_j / 3.0;
    let stiffness = params[MU] * kin.m;
    let mut s_iso = Planar::spherical(stiffness);
    let mut s_full = Planar::zero();
    let mut p_iso = -stiffness * (kin.i1_minus_3() / 3.0 + 1.0) * inverse_j;
    let mut curvature = [0.0; FAMILIES];
    let mut g = [[0.0; 9]; FAMILIES];

    for (family, fibre) in Family::both(law, &kin, params).iter().enumerate() {
        if !which[family] || !fibre.active(law) {
            continue;
        }
        let x = params[K2] * fibre.strain * fibre.strain;
        let exp = params[K1] * x.exp();
        let slope = 2.0 * exp * fibre.strain;
        curvature[family] = exp * (1.0 + 2.0 * x);
        match law.fibre_invariants {
            FibreInvariants::Isochoric => {
                s_iso = s_iso.plus(fibre.h.scaled(slope * kin.m));
                p_iso -= slope * kin.m * fibre.invariant * third;
                g[family] = fibre.h.scaled(2.0 * kin.m).pushed(&kin.f);
                axpy(&mut g[family], -2.0 * kin.m * fibre.invariant * third, &kin.cof);
            }
            FibreInvariants::Full => {
                s_full = s_full.plus(fibre.h.scaled(slope));
                g[family] = fibre.h.scaled(2.0).pushed(&kin.f);
            }
        }
    }

    let p = p_iso + (kin.j - inverse_j) / params[D];
    let u2 = (1.0 + inverse_j * inverse_j) / params[D];
    let along_iso = s_iso.pushed(&kin.f);
    let mut y = [0.0; 9];
    axpy(&mut y, -2.0 * third, &along_iso);
    axpy(&mut y, 0.5 * (u2 - 5.0 * third * p_iso), &kin.cof);

    *stress = along_iso;
    if law.fibre_invariants == FibreInvariants::Full {
        axpy(stress, 1.0, &s_full.pushed(&kin.f));
    }
    axpy(stress, p, &kin.cof);
    set_rank_updates(a, &kin.cof, &y, &g, &curvature);
    add_second_gradient(a, &kin.f, &s_iso.plus(s_full), p);
}

#[inline(always)]
fn axpy(to: &mut [f64; 9], a: f64, x: &[f64; 9]) {
    for (t, x) in to.iter_mut().zip(x) {
        *t += a * x;
    }
}

/// c⊗y + y⊗c + Σ w'' g⊗g. Whole rows rather than one triangle: rows vectorise.
#[inline(always)]
fn set_rank_updates(
    a: &mut [[f64; 9]; 9],
    c: &[f64; 9],
    y: &[f64; 9],
    g: &[[f64; 9]; FAMILIES],
    curvature: &[f64; FAMILIES],
) {
    for i in 0..9 {
        let (ci, yi) = (c[i], y[i]);
        let (g0, g1) = (curvature[0] * g[0][i], curvature[1] * g[1][i]);
        for j in 0..9 {
            a[i][j] = ci * y[j] + yi * c[j] + g0 * g[0][j] + g1 * g[1][j];
        }
    }
}

/// δ_ik s_JL + p ∂c_iJ/∂F_kL. The block (i, k) of ∂c/∂F, k the row after i, is the axial matrix
/// of the third row of F; the block (k, i) is its transpose.
#[inline(always)]
fn add_second_gradient(a: &mut [[f64; 9]; 9], f: &[f64; 9], s: &Planar<f64>, p: f64) {
    for i in 0..3 {
        let r = 3 * i;
        a[r][r] += s.xx;
        a[r + 1][r + 1] += s.yy;
        a[r + 2][r + 2] += s.zz;
        a[r][r + 1] += s.xy;
        a[r + 1][r] += s.xy;

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
