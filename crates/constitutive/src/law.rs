//! What a law is, and the object-safe list of scalars it is called with.

use crate::{Jet, Offers, Scalar};
use params::ParamSpec;
use std::borrow::Cow;

/// How many derivatives are propagated at once by the sensitivity sweeps.
pub const WIDTH: usize = 8;

/// Where and when a law is asked.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Context {
    /// Time since the last converged step, s. Zero: an instantaneous change.
    pub dt: f64,
    /// Clock at the end of the step, s, running through the tests of a piece of tissue.
    pub time: f64,
    /// Position along the tear path, 0 at the cut, 1 at the far edge (interface points only).
    pub path_position: f64,
}

impl Default for Context {
    fn default() -> Self {
        Self { dt: 1.0, time: 0.0, path_position: 0.5 }
    }
}

/// What a law answers.
#[derive(Clone, Copy, Debug)]
pub struct Response<S, const G: usize> {
    /// Conjugate force: ∂(virtual work)/∂(gradient).
    pub force: [S; G],
    /// Stored (free) energy the law can give back, per volume or area.
    pub energy: S,
}

/// A law over the scalar `S` with a gradient of `G` components.
pub trait Law<S: Scalar, const G: usize> {
    /// The response to `gradient` after `old`; writes every entry of `new`.
    ///
    /// `params` is ordered as [`Describe::parameters`], `old` and `new` as [`Describe::history`].
    /// Out-of-domain input (det F ≤ 0, overflow) gives non-finite numbers, never a panic; the
    /// caller checks.
    fn respond(
        &self,
        ctx: &Context,
        gradient: &[S; G],
        params: &[S],
        old: &[S],
        new: &mut [S],
    ) -> Response<S, G>;
}

/// One entry of a law's memory.
#[derive(Clone, Debug, PartialEq)]
pub struct HistorySpec {
    /// Name, for fields and messages: `delta_max`.
    pub name: Cow<'static, str>,
    /// Value in virgin tissue.
    pub initial: f64,
}

/// Recoverable and lost energy per volume or area.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Energy {
    /// What unloading would give back.
    pub stored: f64,
    /// What was lost since the virgin state.
    pub dissipated: f64,
}

/// What a law says of itself, and its plain-number services.
pub trait Describe<const G: usize> {
    /// The parameters, in the order [`Law::respond`] takes them.
    fn parameters(&self) -> Vec<ParamSpec>;

    /// The memory, in the order [`Law::respond`] takes it.
    fn history(&self) -> Vec<HistorySpec>;

    /// Whether `dt` or `time` change the answer.
    fn rate_dependent(&self) -> bool;

    /// Energies at a converged state: `old` and `new` are the histories before and after.
    fn energies(
        &self,
        ctx: &Context,
        gradient: &[f64; G],
        params: &[f64],
        old: &[f64],
        new: &[f64],
    ) -> Energy;

    /// Force and tangent ∂force/∂gradient, coded analytically where a law does so; it must agree with the
    /// jets. `None`: the caller differentiates by jets.
    fn analytic_tangent(
        &self,
        _ctx: &Context,
        _gradient: &[f64; G],
        _params: &[f64],
        _old: &[f64],
        _new: &mut [f64],
    ) -> Option<([f64; G], [[f64; G]; G])> {
        None
    }

    /// The new history, as [`Law::respond`] writes it over plain numbers, and its derivative ∂new/∂gradient, a row per
    /// entry, coded analytically where a law does so; it must agree with the jets. `false`, with nothing of use
    /// written: the caller differentiates by jets.
    fn history_tangent(
        &self,
        _ctx: &Context,
        _gradient: &[f64; G],
        _params: &[f64],
        _old: &[f64],
        _new: &mut [f64],
        _rows: &mut [[f64; G]],
    ) -> bool {
        false
    }

    /// What the law offers beyond its answer: parts, scales, starts. A decorator passes on what the law inside offers.
    fn offers(&self) -> Offers {
        Offers::default()
    }
}

/// A law as an object: the closed list of scalars it is called with. Implemented for every type
/// that has the parts; a decorator holds its inner law as `Box<dyn PointLaw<G>>` and is generic
/// with the bound `dyn PointLaw<G>: Law<S, G>`.
pub trait PointLaw<const G: usize>:
    Law<f64, G>
    + Law<Jet<1>, G>
    + Law<Jet<3>, G>
    + Law<Jet<WIDTH>, G>
    + Law<Jet<9>, G>
    + Describe<G>
    + Send
    + Sync
{
}

impl<T, const G: usize> PointLaw<G> for T where
    T: Law<f64, G>
        + Law<Jet<1>, G>
        + Law<Jet<3>, G>
        + Law<Jet<WIDTH>, G>
        + Law<Jet<9>, G>
        + Describe<G>
        + Send
        + Sync
        + ?Sized
{
}

/// Largest number of parameters or history entries of one composed law that fits the stack
/// buffers of the tangent helpers; larger ones go to the heap.
const SMALL: usize = 32;

macro_rules! tangent_by_jets {
    ($name:ident, $g:literal) => {
        /// Force and tangent of a law by forward-mode jets; writes the new history.
        pub fn $name(
            law: &dyn PointLaw<$g>,
            ctx: &Context,
            gradient: &[f64; $g],
            params: &[f64],
            old: &[f64],
            new: &mut [f64],
        ) -> ([f64; $g], [[f64; $g]; $g]) {
            let mut g = [Jet::<$g>::constant(0.0); $g];
            for i in 0..$g {
                g[i] = Jet::variable(gradient[i], i);
            }
            let r = with_lifted(params, |p| {
                with_lifted(old, |o| {
                    let mut small = [Jet::<$g>::constant(0.0); SMALL];
                    let mut large;
                    let n: &mut [Jet<$g>] = if new.len() <= SMALL {
                        &mut small[..new.len()]
                    } else {
                        large = vec![Jet::constant(0.0); new.len()];
                        &mut large
                    };
                    let r = law.respond(ctx, &g, p, o, n);
                    for (out, j) in new.iter_mut().zip(n.iter()) {
                        *out = j.re;
                    }
                    r
                })
            });
            let mut force = [0.0; $g];
            let mut tangent = [[0.0; $g]; $g];
            for i in 0..$g {
                force[i] = r.force[i].re;
                tangent[i] = r.force[i].eps;
            }
            (force, tangent)
        }
    };
}
tangent_by_jets!(tangent_by_jets_9, 9);
tangent_by_jets!(tangent_by_jets_3, 3);
tangent_by_jets!(tangent_by_jets_1, 1);

/// New history of a law and its derivative by the gradient, a row per entry: analytic where the law has it, by
/// forward-mode jets elsewhere. What a law keeps for the ledger alone, and leaves over jets, is left then, too.
pub fn history_tangent_9(
    law: &dyn PointLaw<9>,
    ctx: &Context,
    gradient: &[f64; 9],
    params: &[f64],
    old: &[f64],
    new: &mut [f64],
    rows: &mut [[f64; 9]],
) {
    if law.history_tangent(ctx, gradient, params, old, new, rows) {
        return;
    }
    let g: [Jet<9>; 9] = std::array::from_fn(|i| Jet::variable(gradient[i], i));
    with_lifted(params, |p| {
        with_lifted(old, |o| {
            let mut after: Vec<Jet<9>> = o.to_vec();
            law.respond(ctx, &g, p, o, &mut after);
            for ((value, row), j) in new.iter_mut().zip(rows.iter_mut()).zip(&after) {
                (*value, *row) = (j.re, j.eps);
            }
        });
    });
}

fn with_lifted<const N: usize, R>(plain: &[f64], f: impl FnOnce(&[Jet<N>]) -> R) -> R {
    if plain.len() <= SMALL {
        let mut buffer = [Jet::constant(0.0); SMALL];
        for (b, p) in buffer.iter_mut().zip(plain) {
            b.re = *p;
        }
        f(&buffer[..plain.len()])
    } else {
        f(&plain.iter().map(|&p| Jet::constant(p)).collect::<Vec<_>>())
    }
}
