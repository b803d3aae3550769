//! What all decorators share: an inner law, and parameters and history laid out as inner ++ own.
//!
//! A decoration says only what it adds. [`Decorated`] does the bookkeeping once, so that the state
//! of the second of two composed effects cannot be lost and names cannot clash.

pub use crate::lists::with_changed;
use crate::lists::{MOST, constants};
use constitutive::{Context, Describe, Energy, HistorySpec, Law, Offers, PointLaw, Response, Scalar};
use params::ParamSpec;
use std::sync::Arc;

/// One call of a decorated law, with the parts that belong to the inner law and the own ones.
pub struct Call<'a, S, const G: usize> {
    inner: &'a (dyn PointLaw<G> + 'static),
    /// Where and when.
    pub ctx: &'a Context,
    /// Gradient.
    pub gradient: &'a [S; G],
    /// Parameters of the inner law; the base law's come first.
    pub base: &'a [S],
    /// Own parameters, amplitude first.
    pub own: &'a [S],
    /// History of the inner law at the last converged step; the base law's comes first.
    pub inner_old: &'a [S],
    /// Own history at the last converged step.
    pub old: &'a [S],
}

impl<S: Scalar, const G: usize> Call<'_, S, G>
where
    dyn PointLaw<G>: Law<S, G>,
{
    /// The inner law's answer.
    #[inline]
    pub fn inner(&self, new: &mut [S]) -> Response<S, G> {
        self.inner_at(self.gradient, self.base, new)
    }

    /// The inner law's answer to another gradient or other parameters.
    #[inline]
    pub fn inner_at(&self, gradient: &[S; G], params: &[S], new: &mut [S]) -> Response<S, G> {
        if !S::PLAIN
            && let Some(response) = self.without_jets(gradient, params, new)
        {
            return response;
        }
        Law::<S, G>::respond(self.inner, self.ctx, gradient, params, self.inner_old, new)
    }

    /// The inner law's answer in jets without a call in jets, where neither its parameters nor its memory have
    /// derivatives: plain at a constant gradient; along the analytic tangent where there is one and the law is elastic, so
    /// that its energy varies by the force. `None` where it takes jets.
    fn without_jets(&self, gradient: &[S; G], params: &[S], new: &mut [S]) -> Option<Response<S, G>> {
        let (p, old, h) = (constants(params)?, constants(self.inner_old)?, self.inner_old.len());
        let f = gradient.map(S::value);
        let mut after = [0.0; MOST];
        let plain = |after: &mut [f64; MOST]| {
            Law::<f64, G>::respond(self.inner, self.ctx, &f, &p[..params.len()], &old[..h], &mut after[..h])
        };
        if gradient.iter().all(S::is_constant) {
            let r = plain(&mut after);
            new.iter_mut().zip(&after).for_each(|(to, x)| *to = S::from(*x));
            return Some(Response { force: r.force.map(S::from), energy: S::from(r.energy) });
        }
        if h > 0 {
            return None;
        }
        let (force, tangent) = self.inner.analytic_tangent(self.ctx, &f, &p[..params.len()], &[], &mut [])?;
        let change: [S; G] = std::array::from_fn(|j| gradient[j] - f[j]);
        let along = |value: f64, slopes: &[f64; G]| {
            let mut sum = S::from(value);
            change.iter().zip(slopes).for_each(|(d, slope)| sum += *d * *slope);
            sum
        };
        let energy = along(plain(&mut after).energy, &force);
        Some(Response { force: std::array::from_fn(|i| along(force[i], &tangent[i])), energy })
    }
}

impl<const G: usize> Call<'_, f64, G> {
    /// Energies of the inner law at another gradient or other parameters.
    pub fn inner_energies(&self, gradient: &[f64; G], params: &[f64], new: &[f64]) -> Energy {
        self.inner.energies(self.ctx, gradient, params, self.inner_old, new)
    }

    /// Analytic tangent of the inner law at another gradient or other parameters.
    pub fn inner_tangent(&self, gradient: &[f64; G], params: &[f64], new: &mut [f64]) -> Option<Tangent<G>> {
        self.inner.analytic_tangent(self.ctx, gradient, params, self.inner_old, new)
    }

    /// The inner law's new history and its derivative by the gradient, a row per entry; nothing of a law without memory.
    pub fn inner_history_tangent(&self, to: Memory<'_, G>) -> bool {
        let (ctx, old) = (self.ctx, self.inner_old);
        old.is_empty() || self.inner.history_tangent(ctx, self.gradient, self.base, old, to.new, to.rows)
    }

    /// The answer of the inner law at the same history for another gradient: nothing is recorded.
    pub fn inner_probe(&self, gradient: &[f64; G], history: &[f64]) -> Response<f64, G> {
        let mut scratch = history.to_vec();
        Law::<f64, G>::respond(self.inner, self.ctx, gradient, self.base, history, &mut scratch)
    }
}

/// Force and its derivative by the gradient.
pub type Tangent<const G: usize> = ([f64; G], [[f64; G]; G]);

/// A history to be written, and its derivative by the gradient.
pub struct Memory<'a, const G: usize> {
    /// An entry each.
    pub new: &'a mut [f64],
    /// A row per entry.
    pub rows: &'a mut [[f64; G]],
}

/// What a decorator adds to the law inside.
pub trait Decoration<const G: usize>: Send + Sync + 'static {
    /// Name of the effect, prefix of its parameter and history names.
    const NAME: &'static str;

    /// Own parameters, amplitude first.
    fn parameters(&self) -> Vec<ParamSpec>;

    /// Own history: name and value in virgin tissue.
    fn history(&self) -> Vec<(String, f64)> {
        Vec::new()
    }

    /// Whether `dt` or `time` change what is added.
    fn rate_dependent(&self) -> bool {
        false
    }

    /// The decorated response. `inner_new` must be written by calling the inner law.
    fn respond<S: Scalar>(&self, call: &Call<'_, S, G>, inner_new: &mut [S], new: &mut [S]) -> Response<S, G>
    where
        dyn PointLaw<G>: Law<S, G>;

    /// Energies at a converged state.
    fn energies(&self, call: &Call<'_, f64, G>, inner_new: &[f64], new: &[f64]) -> Energy;

    /// The new history and its derivative by the gradient, a row per entry, where that is cheaper than jets; the rows of
    /// the inner law's history by [`Call::inner_history_tangent`]. `false`: by jets.
    fn history_tangent(&self, _call: &Call<'_, f64, G>, _inner: Memory<'_, G>, _own: Memory<'_, G>) -> bool {
        false
    }

    /// Tangent from the inner law's analytic tangent, where that is cheap.
    fn analytic_tangent(
        &self,
        _call: &Call<'_, f64, G>,
        _inner_new: &mut [f64],
        _new: &mut [f64],
    ) -> Option<Tangent<G>> {
        None
    }
}

/// An inner law with a decoration around it.
pub struct Decorated<D, const G: usize> {
    inner: Arc<dyn PointLaw<G>>,
    params: usize,
    history: usize,
    decoration: D,
}

/// Puts a decoration around a law.
pub fn decorate<D: Decoration<G>, const G: usize>(
    inner: Arc<dyn PointLaw<G>>,
    decoration: D,
) -> Decorated<D, G> {
    Decorated { params: inner.parameters().len(), history: inner.history().len(), inner, decoration }
}

impl<D, const G: usize> Decorated<D, G> {
    #[inline]
    fn call<'a, S>(
        &'a self,
        ctx: &'a Context,
        gradient: &'a [S; G],
        params: &'a [S],
        old: &'a [S],
    ) -> Call<'a, S, G> {
        let (base, own) = params.split_at(self.params);
        let (inner_old, old) = old.split_at(self.history);
        Call { inner: &*self.inner, ctx, gradient, base, own, inner_old, old }
    }
}

impl<S: Scalar, D: Decoration<G>, const G: usize> Law<S, G> for Decorated<D, G>
where
    dyn PointLaw<G>: Law<S, G>,
{
    fn respond(
        &self,
        ctx: &Context,
        gradient: &[S; G],
        params: &[S],
        old: &[S],
        new: &mut [S],
    ) -> Response<S, G> {
        let (inner_new, new) = new.split_at_mut(self.history);
        self.decoration.respond(&self.call(ctx, gradient, params, old), inner_new, new)
    }
}

impl<D: Decoration<G>, const G: usize> Describe<G> for Decorated<D, G> {
    fn parameters(&self) -> Vec<ParamSpec> {
        let mut all = self.inner.parameters();
        all.extend(self.decoration.parameters().into_iter().map(|mut p| {
            p.name = format!("{}.{}", D::NAME, p.name).into();
            p
        }));
        all
    }

    fn history(&self) -> Vec<HistorySpec> {
        let mut all = self.inner.history();
        all.extend(
            self.decoration
                .history()
                .into_iter()
                .map(|(name, initial)| HistorySpec { name: format!("{}.{name}", D::NAME).into(), initial }),
        );
        all
    }

    fn rate_dependent(&self) -> bool {
        self.inner.rate_dependent() || self.decoration.rate_dependent()
    }

    fn offers(&self) -> Offers {
        self.inner.offers()
    }

    fn energies(
        &self,
        ctx: &Context,
        gradient: &[f64; G],
        params: &[f64],
        old: &[f64],
        new: &[f64],
    ) -> Energy {
        let (inner_new, new) = new.split_at(self.history);
        self.decoration.energies(&self.call(ctx, gradient, params, old), inner_new, new)
    }

    fn analytic_tangent(
        &self,
        ctx: &Context,
        gradient: &[f64; G],
        params: &[f64],
        old: &[f64],
        new: &mut [f64],
    ) -> Option<Tangent<G>> {
        let (inner_new, new) = new.split_at_mut(self.history);
        self.decoration.analytic_tangent(&self.call(ctx, gradient, params, old), inner_new, new)
    }

    fn history_tangent(
        &self,
        ctx: &Context,
        gradient: &[f64; G],
        params: &[f64],
        old: &[f64],
        new: &mut [f64],
        rows: &mut [[f64; G]],
    ) -> bool {
        let (inner_new, new) = new.split_at_mut(self.history);
        let (inner_rows, rows) = rows.split_at_mut(self.history);
        let inner = Memory { new: inner_new, rows: inner_rows };
        self.decoration.history_tangent(&self.call(ctx, gradient, params, old), inner, Memory { new, rows })
    }
}
