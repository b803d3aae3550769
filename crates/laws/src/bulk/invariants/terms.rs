//! The terms of an energy: functions of pseudo-invariants.

use super::super::sym::{Sym, product, spherical};
use constitutive::Scalar;

/// Most terms of one law.
pub const MOST_TERMS: usize = 6;

/// The energy w of one pseudo-invariant's excess e.
#[derive(Clone, Copy, Debug)]
pub enum Function<S> {
    /// c₁ e + c₂ e² + c₃ e³.
    Cubic([S; 3]),
    /// a/(2b) (exp(b e) − 1); a e/2 at b = 0.
    Exponential {
        /// Stiffness a, MPa.
        a: S,
        /// Stiffening b.
        b: S,
    },
    /// k₁/(2k₂) (exp(k₂ e²) − 1); k₁ e²/2 at k₂ = 0.
    SquareExponential {
        /// Stiffness k₁, MPa.
        k1: S,
        /// Stiffening k₂.
        k2: S,
        /// ⟨e⟩ in place of e: fibres carry tension only.
        tension_only: bool,
    },
}

impl<S: Scalar> Function<S> {
    /// w and w′.
    #[inline]
    pub(super) fn value_and_slope(&self, e: S) -> (S, S) {
        match *self {
            Self::Cubic([a, b, c]) => ((a + (b + c * e) * e) * e, a + (b * 2.0 + c * e * 3.0) * e),
            Self::Exponential { a, b } => {
                let (exp, ratio) = exp_and_ratio(b * e);
                (a * e * ratio * 0.5, a * exp * 0.5)
            }
            Self::SquareExponential { k1, k2, .. } => {
                let (exp, ratio) = exp_and_ratio(k2 * e * e);
                (k1 * e * e * ratio * 0.5, k1 * e * exp)
            }
        }
    }

    /// Whether the term takes part at e. A NaN takes part, so that it is seen.
    pub(super) fn is_active(&self, e: S) -> bool {
        !matches!(self, Self::SquareExponential { tension_only: true, .. } if e.value() <= 0.0)
    }
}

impl Function<f64> {
    /// w″.
    pub(super) fn curvature(&self, e: f64) -> f64 {
        match *self {
            Self::Cubic([_, b, c]) => 2.0 * b + 6.0 * c * e,
            Self::Exponential { a, b } => 0.5 * a * b * (b * e).exp(),
            Self::SquareExponential { k1, k2, .. } => k1 * (k2 * e * e).exp() * (1.0 + 2.0 * k2 * e * e),
        }
    }
}

/// eˣ and (eˣ − 1)/x, which is 1 + x/2 + x²/6 near 0.
fn exp_and_ratio<S: Scalar>(x: S) -> (S, S) {
    let v = x.value();
    let (em1, exp) = (v.exp_m1(), v.exp());
    if v.abs() < 1e-3 {
        let ratio = 1.0 + v / 2.0 * (1.0 + v / 3.0 * (1.0 + v / 4.0 * (1.0 + v / 5.0)));
        let slope = 0.5 + v / 3.0 + v * v / 8.0 + v * v * v / 30.0 + v.powi(4) / 144.0;
        return (x.chain(exp, exp), x.chain(ratio, slope));
    }
    let ratio = em1 / v;
    (x.chain(exp, exp), x.chain(ratio, (exp - ratio) / v))
}

/// One term of the energy.
#[derive(Clone, Copy, Debug)]
pub struct Term<S> {
    pub(super) h: Sym<S>,
    pub(super) trace: S,
    pub(super) onset: S,
    pub(super) function: Function<S>,
    pub(super) is_fibre: bool,
}

/// The terms of a law at given parameters.
#[derive(Clone, Copy, Debug)]
pub struct Terms<S> {
    pub(super) list: [Option<Term<S>>; MOST_TERMS],
    len: usize,
}

impl<S: Scalar> Terms<S> {
    /// None yet.
    pub fn new() -> Self {
        Self { list: [None; MOST_TERMS], len: 0 }
    }

    fn push(mut self, term: Term<S>) -> Self {
        debug_assert!(self.len < MOST_TERMS, "a law of more than {MOST_TERMS} terms");
        self.list[self.len] = Some(term);
        self.len += 1;
        self
    }

    /// A function of Ī1 − 3.
    pub fn isotropic(self, function: Function<S>) -> Self {
        let (h, trace) = (spherical(S::one()), S::from(3.0));
        self.push(Term { h, trace, onset: S::zero(), function, is_fibre: false })
    }

    /// A fibre family along the unit vector `a`: a function of Ī4 − 1 − `onset`.
    pub fn fibre(self, a: [S; 3], onset: S, function: Function<S>) -> Self {
        self.push(Term { h: product(a, a), trace: S::one(), onset, function, is_fibre: true })
    }

    /// A function of Ī8 = a·C̄b for orthogonal unit vectors.
    pub fn coupling(self, a: [S; 3], b: [S; 3], function: Function<S>) -> Self {
        self.push(Term { h: product(a, b), trace: S::zero(), onset: S::zero(), function, is_fibre: false })
    }

    pub(super) fn iter(&self) -> impl Iterator<Item = &Term<S>> {
        self.list.iter().flatten()
    }
}

impl<S: Scalar> Default for Terms<S> {
    fn default() -> Self {
        Self::new()
    }
}
