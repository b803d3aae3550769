//! Laws that are sums over pseudo-invariants: stress, analytic tangent and parts from the energy's terms alone.
//!
//! ```text
//! Ψ = (1/D)((J² − 1)/2 − ln J) + Σ_a w_a(e_a),   e_a = H_a : C̄ − tr H_a − onset,   C̄ = J^(−2/3) C
//! ```
//!
//! H = I gives Ī1 − 3, H = a⊗a gives Ī4 − 1, H = ½(a⊗b + b⊗a) with orthogonal a, b gives Ī8. A law states its terms
//! ([`InvariantLaw::terms`]) and is done: with m = J^(−2/3), x = H : C, c = cof F the stress is P = F s + p c,
//! s = Σ 2 m w′ H, p = U′ − Σ 2 m w′ x/(3J), and its derivative by F is
//!
//! ```text
//! A = δ_ik s_JL + p ∂c/∂F + c⊗y + y⊗c + Σ w″ g⊗g
//! y = ½ (U″ − 5 p_iso/(3J)) c − 2/(3J) F s,      g = ∂(m x)/∂F = 2m F H − 2m x/(3J) c
//! ```

use super::sym::{Sym, dot, matrix, product, pushed, spherical, strain};
use constitutive::{
    BulkPart, BulkParts, Context, Describe, Energy, FibreFamily, HistorySpec, Law, Offers, Response, Scalar,
    StartGrid, part, tensor,
};
use hgo::Volumetric;
use params::ParamSpec;

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
    fn value_and_slope(&self, e: S) -> (S, S) {
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
    fn is_active(&self, e: S) -> bool {
        !matches!(self, Self::SquareExponential { tension_only: true, .. } if e.value() <= 0.0)
    }
}

impl Function<f64> {
    /// w″.
    fn curvature(&self, e: f64) -> f64 {
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
    h: Sym<S>,
    trace: S,
    onset: S,
    function: Function<S>,
    is_fibre: bool,
}

/// The terms of a law at given parameters.
#[derive(Clone, Copy, Debug)]
pub struct Terms<S> {
    list: [Option<Term<S>>; MOST_TERMS],
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

    fn iter(&self) -> impl Iterator<Item = &Term<S>> {
        self.list.iter().flatten()
    }
}

impl<S: Scalar> Default for Terms<S> {
    fn default() -> Self {
        Self::new()
    }
}

/// What a law of this form states.
pub trait InvariantLaw: Clone + Send + Sync + 'static {
    /// The parameters, one of them D ([`hgo::compliance`]).
    fn parameters(&self) -> Vec<ParamSpec>;

    /// Index of D.
    fn d(&self) -> usize;

    /// The terms of the isochoric energy.
    fn terms<S: Scalar>(&self, params: &[S]) -> Terms<S>;

    /// Index of the parameter from which fibre strains count, where there is one.
    fn fibre_onset(&self) -> Option<usize> {
        None
    }

    /// Initial shear modulus of the matrix, MPa.
    fn matrix_modulus(&self) -> fn(&[f64]) -> f64;

    /// Where a search may start.
    fn starts(&self) -> Option<StartGrid> {
        None
    }
}

/// The point law of such a statement. Parameters are the statement's; gradient F, force P (MPa, row-major), energy Ψ
/// (MPa), no history. det F ≤ 0 and an overflow give non-finite answers.
#[derive(Clone, Copy, Debug, Default)]
pub struct Invariants<L>(pub L);

/// F and what follows from it.
struct Kinematics<S> {
    f: [S; 9],
    cof: [S; 9],
    j: S,
    m: S,
    strain: Sym<S>,
}

impl<S: Scalar> Kinematics<S> {
    #[inline(always)]
    fn new(f: &[S; 9]) -> Self {
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
    fn invariant(&self, term: &Term<S>) -> (S, S) {
        let excess = dot(&term.h, &self.strain);
        (excess + term.trace, self.m * excess + (self.m - 1.0) * term.trace - term.onset)
    }

    /// Stress and energy of one term.
    fn of_term(&self, term: &Term<S>) -> Response<S, 9> {
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

impl<S: Scalar, L: InvariantLaw> Law<S, 9> for Invariants<L> {
    fn respond(
        &self,
        _ctx: &Context,
        gradient: &[S; 9],
        params: &[S],
        _old: &[S],
        _new: &mut [S],
    ) -> Response<S, 9> {
        let kin = Kinematics::new(gradient);
        let mut sum = hgo::volumetric(gradient, params[self.0.d()]);
        for term in self.0.terms(params).iter() {
            let r = kin.of_term(term);
            sum.energy += r.energy;
            for (p, x) in sum.force.iter_mut().zip(&r.force) {
                *p += *x;
            }
        }
        sum
    }
}

impl<L: InvariantLaw> Describe<9> for Invariants<L> {
    fn parameters(&self) -> Vec<ParamSpec> {
        self.0.parameters()
    }

    fn history(&self) -> Vec<HistorySpec> {
        Vec::new()
    }

    fn rate_dependent(&self) -> bool {
        false
    }

    fn energies(
        &self,
        ctx: &Context,
        gradient: &[f64; 9],
        params: &[f64],
        _old: &[f64],
        _new: &[f64],
    ) -> Energy {
        Energy { stored: self.respond(ctx, gradient, params, &[], &mut []).energy, dissipated: 0.0 }
    }

    fn hand_tangent(
        &self,
        _ctx: &Context,
        gradient: &[f64; 9],
        params: &[f64],
        _old: &[f64],
        _new: &mut [f64],
    ) -> Option<([f64; 9], [[f64; 9]; 9])> {
        let kin = Kinematics::new(gradient);
        let mut sum = hgo::volumetric_tangent(gradient, params[self.0.d()]);
        add_tangent(&mut sum, &kin, self.0.terms(params).iter());
        Some(sum)
    }

    fn offers(&self) -> Offers {
        let law = &self.0;
        let params: Vec<f64> = law.parameters().iter().map(|p| p.start).collect();
        let terms = law.terms(&params);
        let families = terms.iter().enumerate().filter(|(_, t)| t.is_fibre).map(|(index, _)| {
            let one = || OneTerm { law: law.clone(), index };
            FibreFamily { response: part(one()), isochoric: part(one()), fictitious: part(Fictitious(one())) }
        });
        let bulk = BulkParts {
            volumetric: Some(part(Volumetric { d: law.d() })),
            rest_is_isochoric: true,
            fibres: families.collect(),
            fibre_onset: law.fibre_onset(),
            matrix_modulus: law.matrix_modulus(),
            starts: law.starts(),
            mirrors: true,
        };
        Offers { bulk: Some(bulk), cohesion: None }
    }
}

type Tangent = ([f64; 9], [[f64; 9]; 9]);

/// Adds stress and tangent of terms.
fn add_tangent<'a>(sum: &mut Tangent, kin: &Kinematics<f64>, terms: impl Iterator<Item = &'a Term<f64>>) {
    let third = 1.0 / (3.0 * kin.j);
    let (mut s, mut p) = ([0.0; 6], 0.0);
    for term in terms {
        let (x, e) = kin.invariant(term);
        if !term.function.is_active(e) {
            continue;
        }
        let (_, slope) = term.function.value_and_slope(e);
        let stiffness = 2.0 * slope * kin.m;
        for (s, h) in s.iter_mut().zip(&term.h) {
            *s += stiffness * h;
        }
        p -= stiffness * x * third;
        let mut g = pushed(&kin.f, &term.h.map(|h| 2.0 * kin.m * h));
        for (g, c) in g.iter_mut().zip(&kin.cof) {
            *g -= 2.0 * kin.m * x * third * c;
        }
        let curvature = term.function.curvature(e);
        for (row, gi) in sum.1.iter_mut().zip(&g) {
            for (a, gj) in row.iter_mut().zip(&g) {
                *a += curvature * gi * gj;
            }
        }
    }
    let along = pushed(&kin.f, &s);
    let y: [f64; 9] = std::array::from_fn(|i| -2.5 * third * p * kin.cof[i] - 2.0 * third * along[i]);
    for i in 0..9 {
        sum.0[i] += along[i] + p * kin.cof[i];
        for j in 0..9 {
            sum.1[i][j] += kin.cof[i] * y[j] + y[i] * kin.cof[j];
        }
    }
    add_second_gradient(&mut sum.1, &kin.f, &s, p);
}

/// δ_ik s_JL + p ∂c_iJ/∂F_kL. The block (i, k) of ∂c/∂F, k the row after i, is the axial matrix of the third row of F;
/// the block (k, i) is its transpose.
fn add_second_gradient(a: &mut [[f64; 9]; 9], f: &[f64; 9], s: &Sym<f64>, p: f64) {
    let full = matrix(s);
    for i in 0..3 {
        let r = 3 * i;
        for j in 0..3 {
            for l in 0..3 {
                a[r + j][r + l] += full[3 * j + l];
            }
        }
        let (k, m) = (3 * ((i + 1) % 3), 3 * ((i + 2) % 3));
        let v = [p * f[m], p * f[m + 1], p * f[m + 2]];
        for (row, col, value) in
            [(0, 1, v[2]), (0, 2, -v[1]), (1, 0, -v[2]), (1, 2, v[0]), (2, 0, v[1]), (2, 1, -v[0])]
        {
            a[r + row][k + col] += value;
            a[k + col][r + row] += value;
        }
    }
}

/// One term as a part.
struct OneTerm<L> {
    law: L,
    index: usize,
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
struct Fictitious<L>(OneTerm<L>);

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
