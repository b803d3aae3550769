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

mod kinematics;
mod parts;
mod tangent;
mod terms;

pub use terms::{Function, MOST_TERMS, Term, Terms};

use constitutive::{
    BulkParts, Context, Describe, Energy, FibreFamily, HistorySpec, Law, Offers, Response, Scalar, StartGrid,
    part,
};
use hgo::Volumetric;
use kinematics::Kinematics;
use params::ParamSpec;
use parts::{Fictitious, OneTerm};
use tangent::add_tangent;

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

    fn analytic_tangent(
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
