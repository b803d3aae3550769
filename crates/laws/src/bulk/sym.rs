//! Symmetric tensors [xx, yy, zz, xy, yz, xz] of the reference state.

use constitutive::Scalar;

/// A symmetric tensor.
pub type Sym<S> = [S; 6];

/// a · I.
pub fn spherical<S: Scalar>(a: S) -> Sym<S> {
    let o = S::zero();
    [a, a, a, o, o, o]
}

/// ½ (a⊗b + b⊗a).
pub fn product<S: Scalar>(a: [S; 3], b: [S; 3]) -> Sym<S> {
    let mixed = |i: usize, j: usize| (a[i] * b[j] + a[j] * b[i]) * 0.5;
    [mixed(0, 0), mixed(1, 1), mixed(2, 2), mixed(0, 1), mixed(1, 2), mixed(0, 2)]
}

/// A : B.
#[inline(always)]
pub fn dot<S: Scalar>(a: &Sym<S>, b: &Sym<S>) -> S {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + (a[3] * b[3] + a[4] * b[4] + a[5] * b[5]) * 2.0
}

/// F A.
#[inline(always)]
pub fn pushed<S: Scalar>(f: &[S; 9], a: &Sym<S>) -> [S; 9] {
    let full = matrix(a);
    constitutive::tensor::mul(f, &full)
}

/// Row-major.
#[inline(always)]
pub fn matrix<S: Scalar>(a: &Sym<S>) -> [S; 9] {
    [a[0], a[3], a[5], a[3], a[1], a[4], a[5], a[4], a[2]]
}

/// C − I of a deformation gradient: exactly zero at F = I.
#[inline(always)]
pub fn strain<S: Scalar>(f: &[S; 9]) -> Sym<S> {
    let column = |a: usize, b: usize| f[a] * f[b] + f[a + 3] * f[b + 3] + f[a + 6] * f[b + 6];
    [column(0, 0) - 1.0, column(1, 1) - 1.0, column(2, 2) - 1.0, column(0, 1), column(1, 2), column(0, 2)]
}
