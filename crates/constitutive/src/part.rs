//! Parts of a bulk law, and how they become laws.

use crate::{Context, Describe, Energy, HistorySpec, Law, Part, Response, Scalar};
use params::ParamSpec;
use std::sync::Arc;

/// A part of an elastic bulk law: F and the whole law's parameter list in, stress and energy out.
pub trait BulkPart: Send + Sync + 'static {
    /// First Piola stress (MPa, row-major) and energy (MPa).
    fn respond<S: Scalar>(&self, gradient: &[S; 9], params: &[S]) -> Response<S, 9>;

    /// Stress and its derivative by F, analytic; `None`: by jets.
    fn tangent(&self, gradient: &[f64; 9], params: &[f64]) -> Option<([f64; 9], [[f64; 9]; 9])> {
        let _ = (gradient, params);
        None
    }
}

/// A part as a law of its own.
pub fn part<T: BulkPart>(part: T) -> Part {
    Arc::new(AsLaw(part))
}

struct AsLaw<T>(T);

impl<S: Scalar, T: BulkPart> Law<S, 9> for AsLaw<T> {
    #[inline]
    fn respond(&self, _: &Context, gradient: &[S; 9], params: &[S], _: &[S], _: &mut [S]) -> Response<S, 9> {
        self.0.respond(gradient, params)
    }
}

impl<T: BulkPart> Describe<9> for AsLaw<T> {
    /// None of its own: it takes the whole law's list.
    fn parameters(&self) -> Vec<ParamSpec> {
        Vec::new()
    }

    fn history(&self) -> Vec<HistorySpec> {
        Vec::new()
    }

    fn rate_dependent(&self) -> bool {
        false
    }

    fn energies(&self, _: &Context, gradient: &[f64; 9], params: &[f64], _: &[f64], _: &[f64]) -> Energy {
        Energy { stored: self.0.respond(gradient, params).energy, dissipated: 0.0 }
    }

    fn analytic_tangent(
        &self,
        _: &Context,
        gradient: &[f64; 9],
        params: &[f64],
        _: &[f64],
        _: &mut [f64],
    ) -> Option<([f64; 9], [[f64; 9]; 9])> {
        self.0.tangent(gradient, params)
    }
}

/// Stress and tangent of a part, analytic where it has them.
pub fn part_tangent(part: &Part, gradient: &[f64; 9], params: &[f64]) -> ([f64; 9], [[f64; 9]; 9]) {
    let ctx = Context::default();
    part.analytic_tangent(&ctx, gradient, params, &[], &mut [])
        .unwrap_or_else(|| crate::tangent_by_jets_9(&**part, &ctx, gradient, params, &[], &mut []))
}

/// The answer of a part.
#[inline]
pub fn part_response<S: Scalar>(part: &Part, gradient: &[S; 9], params: &[S]) -> Response<S, 9>
where
    dyn crate::PointLaw<9>: Law<S, 9>,
{
    Law::<S, 9>::respond(&**part, &Context::default(), gradient, params, &[], &mut [])
}
