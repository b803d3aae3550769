//! Crimped fibres that carry load only beyond a strain of their own.

use crate::decorator::{Call, Decoration, Tangent, decorate, with_changed};
use crate::numeric::plus;
use constitutive::{Capability, Energy, Law, PointLaw, Response, Scalar};
use model::{Action, Card, Effect, Options, Piece, Scales, Screening, Sided, Site};
use params::{ParamSpec, Quantity};
use std::sync::Arc;

static CARD: Card = Card {
    name: "fiber_recruitment",
    site: Site::Bulk,
    rank: 60,
    summary: "Fibres are crimped at rest and begin to carry load only beyond a recruitment strain: \
              a longer soft toe before the curve stiffens.",
    law: "Ψ_f = k1/(2 k2) (exp(k2 ⟨E_f − E_r⟩²) − 1) in place of ⟨E_f⟩, for both families and for \
          every effect that looks at fibres",
    reference: "fibre-recruitment models of arteries, for instance Hill et al. 2012, J. Biomech. 45; \
                Holzapfel, Gasser & Ogden 2000 for the fibre term, doi:10.1023/A:1010835316564",
    shows_in: &["toe", "load"],
    look_alikes: &["compliance"],
    separated_by: "a camera on the clamped edges (grip_displacement_mm), or two tests of different force level: \
                   compliance scales with force, recruitment with strain",
    ordinary: "E_r of a tenth of the record's largest fibre strain: fibres that are still wavy at the start",
    excludes: &[],
    needs: &[],
    screening: Screening::Score(Sided::Positive),
    negative_control: false,
    breaks_half_height: false,
};

/// A fibre strain at which fibres begin to carry load.
#[derive(Clone, Copy, Debug, Default)]
pub struct FiberRecruitment;

fn own_parameters() -> Vec<ParamSpec> {
    vec![
        ParamSpec::new(
            "onset",
            "E_r",
            Quantity::Dimensionless,
            (0.0, 1.0),
            0.02,
            "fibre strain at recruitment",
        )
        .neutral(0.0),
    ]
}

impl Effect for FiberRecruitment {
    fn card(&self) -> &Card {
        &CARD
    }

    fn parameters(&self, _options: &Options) -> Vec<ParamSpec> {
        own_parameters()
    }

    fn asks(&self, _options: &Options) -> Vec<Capability> {
        vec![Capability::FibreOnset]
    }

    fn shapes(&self, _scales: &Scales) -> Vec<Vec<f64>> {
        vec![vec![0.0]]
    }

    fn start(&self, scales: &Scales) -> Vec<f64> {
        vec![(0.1 * scales.fibre_strain).clamp(0.0, 1.0)]
    }

    fn act(&self, _options: &Options, _piece: &Piece) -> Action {
        Action::Bulk(Box::new(|inner| {
            let at = inner.offers().bulk.and_then(|b| b.fibre_onset);
            Arc::new(decorate(inner, Recruitment { at }))
        }))
    }
}

/// The outermost decorator of the tissue: everything inside sees the recruited fibre strain.
struct Recruitment {
    /// Index of the base law's fibre onset; a law without one is left as it is.
    at: Option<usize>,
}

impl Recruitment {
    fn shifted<S: Scalar, R>(&self, base: &[S], onset: S, f: impl FnOnce(&[S]) -> R) -> R {
        match self.at {
            Some(at) => with_changed(base, |p| p[at] = plus(p[at], onset), f),
            None => f(base),
        }
    }
}

impl Decoration<9> for Recruitment {
    const NAME: &'static str = "fiber_recruitment";

    fn parameters(&self) -> Vec<ParamSpec> {
        own_parameters()
    }

    fn respond<S: Scalar>(&self, call: &Call<'_, S, 9>, inner_new: &mut [S], _new: &mut [S]) -> Response<S, 9>
    where
        dyn PointLaw<9>: Law<S, 9>,
    {
        self.shifted(call.base, call.own[0], |p| call.inner_at(call.gradient, p, inner_new))
    }

    fn energies(&self, call: &Call<'_, f64, 9>, inner_new: &[f64], _new: &[f64]) -> Energy {
        self.shifted(call.base, call.own[0], |p| call.inner_energies(call.gradient, p, inner_new))
    }

    fn analytic_tangent(
        &self,
        call: &Call<'_, f64, 9>,
        inner_new: &mut [f64],
        _new: &mut [f64],
    ) -> Option<Tangent<9>> {
        self.shifted(call.base, call.own[0], |p| call.inner_tangent(call.gradient, p, inner_new))
    }
}
