//! Single terms as laws of their own.

use super::super::sym::matrix;
use super::InvariantLaw;
use super::kinematics::Kinematics;
use super::tangent::{Tangent, add_tangent};
use constitutive::{BulkPart, Response, Scalar};

/// One term as a part.
pub(super) struct OneTerm<L> {
    pub law: L,
    pub index: usize,
}

impl<L: InvariantLaw> BulkPart for OneTerm<L> {
    fn respond<S: Scalar>(&self, gradient: &[S; 9], params: &[S]) -> Response<S, 9> {
        let kin = Kinematics::new(gradient);
        match &self.law.terms(params).list[self.index] {
            Some(term) => kin.of_term(term),
            None => Response { force: [S::zero(); 9], energy: S::zero() },
        }
    }

    fn tangent(&self, gradient: &[f64; 9], params: &[f64]) -> Option<Tangent> {
        let mut sum = ([0.0; 9], [[0.0; 9]; 9]);
        let terms = self.law.terms(params);
        add_tangent(&mut sum, &Kinematics::new(gradient), terms.list[self.index].iter());
        Some(sum)
    }
}

/// 2 ∂Ψ_a/∂C̄ = 2 w′ H of one term.
pub(super) struct Fictitious<L>(pub OneTerm<L>);

impl<L: InvariantLaw> BulkPart for Fictitious<L> {
    fn respond<S: Scalar>(&self, gradient: &[S; 9], params: &[S]) -> Response<S, 9> {
        let none = Response { force: [S::zero(); 9], energy: S::zero() };
        let kin = Kinematics::new(gradient);
        let Some(term) = &self.0.law.terms(params).list[self.0.index] else { return none };
        let (_, e) = kin.invariant(term);
        if !term.function.is_active(e) {
            return none;
        }
        let (energy, slope) = term.function.value_and_slope(e);
        Response { force: matrix(&term.h.map(|h| h * slope * 2.0)), energy }
    }
}
