//! What a term needs of F, and its stress.

use super::super::sym::{Sym, dot, pushed, strain};
use super::terms::Term;
use constitutive::{Response, Scalar, tensor};

/// F and what follows from it.
pub(super) struct Kinematics<S> {
    pub f: [S; 9],
    pub cof: [S; 9],
    pub j: S,
    pub m: S,
    strain: Sym<S>,
}

impl<S: Scalar> Kinematics<S> {
    #[inline(always)]
    pub(super) fn new(f: &[S; 9]) -> Self {
        let (mut f, mut cof) = (*f, tensor::cofactor(f));
        let mut j = f[0] * cof[0] + f[1] * cof[1] + f[2] * cof[2];
        let in_domain = j.value() > 0.0;
        if !in_domain {
            let nan = S::from(f64::NAN);
            (f, cof, j) = ([nan; 9], [nan; 9], nan);
        }
        let root = j.cbrt();
        Self { f, cof, j, m: (root * root).recip(), strain: strain(&f) }
    }

    /// H : C and the excess e of a term.
    #[inline(always)]
    pub(super) fn invariant(&self, term: &Term<S>) -> (S, S) {
        let excess = dot(&term.h, &self.strain);
        (excess + term.trace, self.m * excess + (self.m - 1.0) * term.trace - term.onset)
    }

    /// Stress and energy of one term.
    pub(super) fn of_term(&self, term: &Term<S>) -> Response<S, 9> {
        let (x, e) = self.invariant(term);
        if !term.function.is_active(e) {
            return Response { force: [S::zero(); 9], energy: S::zero() };
        }
        let (energy, slope) = term.function.value_and_slope(e);
        let stiffness = slope * self.m * 2.0;
        let across = -(stiffness * (x / 3.0) / self.j);
        let along = pushed(&self.f, &term.h.map(|h| h * stiffness));
        let force = std::array::from_fn(|i| along[i] + self.cof[i] * across);
        Response { force, energy }
    }
}
