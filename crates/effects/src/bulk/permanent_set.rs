//! Residual stretch that grows with the largest stretch seen.

use crate::decorator::{Call, Decoration, Tangent, decorate};
use constitutive::{Energy, Law, PointLaw, Response, Scalar};
use model::{Action, Card, Effect, Options, Piece, Scales, Screening, Sided, Site};
use params::{ParamSpec, Quantity};
use std::sync::Arc;

static CARD: Card = Card {
    name: "permanent_set",
    site: Site::Bulk,
    rank: 50,
    summary: "The tissue does not return to its length after being stretched: a residual stretch \
              grows with the largest stretch it has seen.",
    law: "F = F_e F_p,  F_p = diag(λ_p^−½, λ_p, λ_p^−½),  λ_p = 1 + a (λmax − 1),  λmax = largest |F e_y| \
          up to the last converged step;  P = P(F_e) F_p⁻ᵀ",
    reference: "Maher et al. 2012, inelastic (residual-strain) models of arterial tissue; volume-preserving set along the load",
    shows_in: &["unload", "reload", "cycle k", "toe"],
    look_alikes: &["grip_slip", "slack"],
    separated_by: "a camera on the clamped edges (grip_displacement_mm): slip and slack are outside them, set is inside; \
                   or a remount between two tests: slip starts anew, set stays",
    ordinary: "a = 5 % of the largest stretch stays",
    excludes: &[],
    // A second test of the same piece shows it without unloading segments, and so does the tissue
    // behind a tear.
    needs: &[],
    screening: Screening::Score(Sided::Positive),
    negative_control: false,
    breaks_half_height: false,
};

/// Residual stretch along the load.
#[derive(Clone, Copy, Debug, Default)]
pub struct PermanentSet;

fn own_parameters() -> Vec<ParamSpec> {
    vec![
        ParamSpec::new(
            "a",
            "a",
            Quantity::Dimensionless,
            (0.0, 0.8),
            0.05,
            "residual share of the largest stretch",
        )
        .neutral(0.0),
    ]
}

impl Effect for PermanentSet {
    fn card(&self) -> &Card {
        &CARD
    }

    fn parameters(&self, _options: &Options) -> Vec<ParamSpec> {
        own_parameters()
    }

    fn shapes(&self, _scales: &Scales) -> Vec<Vec<f64>> {
        vec![vec![0.0]]
    }

    fn start(&self, _scales: &Scales) -> Vec<f64> {
        vec![0.05]
    }

    fn act(&self, _options: &Options, _piece: &Piece) -> Action {
        Action::Bulk(Box::new(|inner| Arc::new(decorate(inner, Set))))
    }
}

struct Set;

const STRETCH: usize = 0;
const LN_SET: usize = 1;
const DRIVE: usize = 2;
const LOST: usize = 3;

/// Diagonal of F_p⁻¹ and ln λ_p. λmax is that of the last converged step: an implicit λmax would
/// make the tangent unsymmetric, and this solver has an LBLᵀ.
fn inverse_set<S: Scalar>(a: S, lambda_max: S) -> ([S; 3], S) {
    let p = (lambda_max - 1.0) * a + 1.0;
    let root = p.sqrt();
    ([root, p.recip(), root], p.ln())
}

fn scale_columns<S: Scalar>(f: &[S; 9], by: &[S; 3]) -> [S; 9] {
    std::array::from_fn(|i| f[i] * by[i % 3])
}

/// Work conjugate of ln λ_p: the deviatoric Mandel stress along the load.
fn drive<S: Scalar>(f_e: &[S; 9], p_e: &[S; 9]) -> S {
    let m = |c: usize| f_e[c] * p_e[c] + f_e[c + 3] * p_e[c + 3] + f_e[c + 6] * p_e[c + 6];
    m(1) - (m(0) + m(2)) * 0.5
}

fn remember<S: Scalar>(call: &Call<'_, S, 9>, ln_set: S, drive: S, new: &mut [S]) {
    let f = call.gradient;
    let stretch = (f[1] * f[1] + f[4] * f[4] + f[7] * f[7]).sqrt();
    new[STRETCH] = stretch.max_of(call.old[STRETCH]);
    new[LN_SET] = ln_set;
    new[DRIVE] = drive;
    new[LOST] = call.old[LOST] + (drive + call.old[DRIVE]) * 0.5 * (ln_set - call.old[LN_SET]);
}

impl Decoration<9> for Set {
    const NAME: &'static str = "permanent_set";

    fn parameters(&self) -> Vec<ParamSpec> {
        own_parameters()
    }

    fn history(&self) -> Vec<(String, f64)> {
        vec![("lambda_max".into(), 1.0), ("ln_set".into(), 0.0), ("drive".into(), 0.0), ("lost".into(), 0.0)]
    }

    fn respond<S: Scalar>(&self, call: &Call<'_, S, 9>, inner_new: &mut [S], new: &mut [S]) -> Response<S, 9>
    where
        dyn PointLaw<9>: Law<S, 9>,
    {
        let (by, ln_set) = inverse_set(call.own[0], call.old[STRETCH]);
        let f_e = scale_columns(call.gradient, &by);
        let r = call.inner_at(&f_e, call.base, inner_new);
        remember(call, ln_set, drive(&f_e, &r.force), new);
        Response { force: scale_columns(&r.force, &by), energy: r.energy }
    }

    fn energies(&self, call: &Call<'_, f64, 9>, inner_new: &[f64], new: &[f64]) -> Energy {
        let (by, _) = inverse_set(call.own[0], call.old[STRETCH]);
        let inner = call.inner_energies(&scale_columns(call.gradient, &by), call.base, inner_new);
        Energy { dissipated: inner.dissipated + new[LOST], ..inner }
    }

    fn analytic_tangent(
        &self,
        call: &Call<'_, f64, 9>,
        inner_new: &mut [f64],
        new: &mut [f64],
    ) -> Option<Tangent<9>> {
        let (by, ln_set) = inverse_set(call.own[0], call.old[STRETCH]);
        let f_e = scale_columns(call.gradient, &by);
        let (p, mut a) = call.inner_tangent(&f_e, call.base, inner_new)?;
        remember(call, ln_set, drive(&f_e, &p), new);
        for (i, row) in a.iter_mut().enumerate() {
            for (j, x) in row.iter_mut().enumerate() {
                *x *= by[i % 3] * by[j % 3];
            }
        }
        Some((scale_columns(&p, &by), a))
    }
}
