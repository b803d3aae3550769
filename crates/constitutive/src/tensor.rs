//! 3 × 3 tensors over a scalar, row-major in `[S; 9]`.

use crate::Scalar;

/// A second-order tensor, row-major.
pub type Tensor<S> = [S; 9];

/// The unit tensor.
pub fn identity<S: Scalar>() -> Tensor<S> {
    let (o, l) = (S::zero(), S::one());
    [l, o, o, o, l, o, o, o, l]
}

/// Determinant.
#[inline]
pub fn det<S: Scalar>(a: &Tensor<S>) -> S {
    a[0] * (a[4] * a[8] - a[5] * a[7]) - a[1] * (a[3] * a[8] - a[5] * a[6])
        + a[2] * (a[3] * a[7] - a[4] * a[6])
}

/// Cofactor, det(A) A⁻ᵀ = ∂det(A)/∂A; exists for singular tensors too.
#[inline]
pub fn cofactor<S: Scalar>(a: &Tensor<S>) -> Tensor<S> {
    [
        a[4] * a[8] - a[5] * a[7],
        a[5] * a[6] - a[3] * a[8],
        a[3] * a[7] - a[4] * a[6],
        a[2] * a[7] - a[1] * a[8],
        a[0] * a[8] - a[2] * a[6],
        a[1] * a[6] - a[0] * a[7],
        a[1] * a[5] - a[2] * a[4],
        a[2] * a[3] - a[0] * a[5],
        a[0] * a[4] - a[1] * a[3],
    ]
}

/// Inverse.
#[inline]
pub fn inverse<S: Scalar>(a: &Tensor<S>) -> Tensor<S> {
    let c = cofactor(a);
    let r = (a[0] * c[0] + a[1] * c[1] + a[2] * c[2]).recip();
    [c[0] * r, c[3] * r, c[6] * r, c[1] * r, c[4] * r, c[7] * r, c[2] * r, c[5] * r, c[8] * r]
}

/// A B.
#[inline]
pub fn mul<S: Scalar>(a: &Tensor<S>, b: &Tensor<S>) -> Tensor<S> {
    let mut c = [S::zero(); 9];
    for i in 0..3 {
        for j in 0..3 {
            c[3 * i + j] = a[3 * i] * b[j] + a[3 * i + 1] * b[3 + j] + a[3 * i + 2] * b[6 + j];
        }
    }
    c
}

/// Aᵀ.
#[inline]
pub fn transpose<S: Scalar>(a: &Tensor<S>) -> Tensor<S> {
    [a[0], a[3], a[6], a[1], a[4], a[7], a[2], a[5], a[8]]
}

/// A : B.
#[inline]
pub fn dot<S: Scalar>(a: &Tensor<S>, b: &Tensor<S>) -> S {
    let mut s = a[0] * b[0];
    for i in 1..9 {
        s += a[i] * b[i];
    }
    s
}

/// Trace.
#[inline]
pub fn trace<S: Scalar>(a: &Tensor<S>) -> S {
    a[0] + a[4] + a[8]
}

/// A v.
#[inline]
pub fn apply<S: Scalar>(a: &Tensor<S>, v: &[S; 3]) -> [S; 3] {
    [
        a[0] * v[0] + a[1] * v[1] + a[2] * v[2],
        a[3] * v[0] + a[4] * v[1] + a[5] * v[2],
        a[6] * v[0] + a[7] * v[1] + a[8] * v[2],
    ]
}

/// Right Cauchy–Green tensor FᵀF.
#[inline]
pub fn right_cauchy_green<S: Scalar>(f: &Tensor<S>) -> Tensor<S> {
    mul(&transpose(f), f)
}

/// Kirchhoff stress τ = P Fᵀ.
#[inline]
pub fn kirchhoff<S: Scalar>(p: &Tensor<S>, f: &Tensor<S>) -> Tensor<S> {
    mul(p, &transpose(f))
}
