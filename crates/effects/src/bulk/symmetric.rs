//! Symmetric 3 × 3 tensors [xx, yy, zz, xy, yz, xz] for stresses in the reference state.

use constitutive::{Over, Scalar, tensor};

pub type Sym<S> = [S; 6];

/// What the pull-back of a stress needs of F.
pub struct Frame<S> {
    /// J^(−2/3).
    pub m: S,
    /// C = FᵀF.
    pub c: Sym<S>,
    /// C⁻¹.
    c_inverse: Sym<S>,
    f_inverse: [S; 9],
}

impl<S: Scalar> Frame<S> {
    #[inline(always)]
    pub fn new(f: &[S; 9]) -> Self {
        let f_inverse = tensor::inverse(f);
        let root = tensor::det(f).cbrt();
        let column = |a: usize, b: usize| f[a] * f[b] + f[a + 3] * f[b + 3] + f[a + 6] * f[b + 6];
        let row = |a: usize, b: usize| {
            f_inverse[3 * a] * f_inverse[3 * b]
                + f_inverse[3 * a + 1] * f_inverse[3 * b + 1]
                + f_inverse[3 * a + 2] * f_inverse[3 * b + 2]
        };
        Self { m: (root * root).recip(), c: components(column), c_inverse: components(row), f_inverse }
    }

    /// Second Piola stress F⁻¹P of a first Piola stress that derives from an energy of C.
    #[inline(always)]
    pub fn second_piola<T: Scalar + Over<S>>(&self, p: &[T; 9]) -> Sym<T> {
        let f = &self.f_inverse;
        components(|a, b| p[b].times(f[3 * a]) + p[3 + b].times(f[3 * a + 1]) + p[6 + b].times(f[3 * a + 2]))
    }

    /// Deviator with respect to C: A − (A : C)/3 C⁻¹. What is left does no work on a change of volume.
    #[inline(always)]
    pub fn deviator<T: Scalar + Over<S>>(&self, a: &Sym<T>) -> Sym<T> {
        let mean = dot(a, &self.c) / 3.0;
        std::array::from_fn(|i| a[i] - mean.times(self.c_inverse[i]))
    }
}

#[inline(always)]
fn components<S>(at: impl Fn(usize, usize) -> S) -> Sym<S> {
    [at(0, 0), at(1, 1), at(2, 2), at(0, 1), at(1, 2), at(0, 2)]
}

/// A : B.
#[inline(always)]
pub fn dot<S: Scalar, T: Scalar + Over<S>>(a: &Sym<T>, b: &Sym<S>) -> T {
    let product = |i: usize| a[i].times(b[i]);
    product(0) + product(1) + product(2) + (product(3) + product(4) + product(5)) * 2.0
}

/// F A: the first Piola stress of a second one.
#[inline(always)]
pub fn pushed<S: Scalar, T: Scalar + Over<S>>(f: &[S; 9], a: &Sym<T>) -> [T; 9] {
    let full = [a[0], a[3], a[5], a[3], a[1], a[4], a[5], a[4], a[2]];
    std::array::from_fn(|r| {
        let (i, j) = (3 * (r / 3), r % 3);
        full[j].times(f[i]) + full[3 + j].times(f[i + 1]) + full[6 + j].times(f[i + 2])
    })
}
