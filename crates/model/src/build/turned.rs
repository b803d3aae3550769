//! A bulk law whose axes lie otherwise in the model than the law takes them.
//!
//! Laws take y along the length of the piece, x along its width, z through its thickness. In a piece that is split in its
//! plane ([`Layout::Split`]) the model's axes are length, thickness, width; gradient and stress are turned by the cyclic
//! permutation, exactly.

use crate::effect::Bulk;
use constitutive::{Context, Describe, Energy, HistorySpec, Law, Offers, PointLaw, Response, Scalar};
use input::Layout;
use params::ParamSpec;
use std::sync::Arc;

/// Axis of the model on which each axis of the law lies.
const AXES: [usize; 3] = [2, 0, 1];

/// The law for a piece that lies so.
pub(super) fn turned(law: &Bulk, layout: Layout) -> Bulk {
    match layout {
        Layout::Sheet => law.clone(),
        Layout::Split => Arc::new(Turned { inner: law.clone() }),
    }
}

struct Turned {
    inner: Bulk,
}

/// Component of the model behind a component of the law.
const fn of(law: usize) -> usize {
    3 * AXES[law / 3] + AXES[law % 3]
}

fn to_law<X: Copy>(model: &[X; 9]) -> [X; 9] {
    std::array::from_fn(|c| model[of(c)])
}

fn to_model<X: Copy>(law: &[X; 9]) -> [X; 9] {
    let mut out = *law;
    for (c, x) in law.iter().enumerate() {
        out[of(c)] = *x;
    }
    out
}

impl<S: Scalar> Law<S, 9> for Turned
where
    dyn PointLaw<9>: Law<S, 9>,
{
    fn respond(
        &self,
        ctx: &Context,
        gradient: &[S; 9],
        params: &[S],
        old: &[S],
        new: &mut [S],
    ) -> Response<S, 9> {
        let r = Law::<S, 9>::respond(&*self.inner, ctx, &to_law(gradient), params, old, new);
        Response { force: to_model(&r.force), energy: r.energy }
    }
}

impl Describe<9> for Turned {
    fn parameters(&self) -> Vec<ParamSpec> {
        self.inner.parameters()
    }

    fn history(&self) -> Vec<HistorySpec> {
        self.inner.history()
    }

    fn rate_dependent(&self) -> bool {
        self.inner.rate_dependent()
    }

    fn energies(&self, ctx: &Context, f: &[f64; 9], params: &[f64], old: &[f64], new: &[f64]) -> Energy {
        self.inner.energies(ctx, &to_law(f), params, old, new)
    }

    fn analytic_tangent(
        &self,
        ctx: &Context,
        f: &[f64; 9],
        params: &[f64],
        old: &[f64],
        new: &mut [f64],
    ) -> Option<([f64; 9], [[f64; 9]; 9])> {
        let (force, tangent) = self.inner.analytic_tangent(ctx, &to_law(f), params, old, new)?;
        Some((to_model(&force), to_model(&tangent.map(|row| to_model(&row)))))
    }

    fn offers(&self) -> Offers {
        self.inner.offers()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stretching_the_model_along_x_is_stretching_the_law_along_y() {
        let model = [1.3, 0.0, 0.0, 0.0, 0.9, 0.0, 0.0, 0.0, 0.8];
        assert_eq!(to_law(&model), [0.8, 0.0, 0.0, 0.0, 1.3, 0.0, 0.0, 0.0, 0.9]);
        let any: [usize; 9] = std::array::from_fn(|c| c);
        assert_eq!(to_model(&to_law(&any)), any);
    }
}
