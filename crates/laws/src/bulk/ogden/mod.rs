//! Rubber in principal stretches, one to three terms; equal stretches are no special case.

mod principal;
mod tangent;

use crate::entry::{LawCard, LawEntry, Settings};
use constitutive::{
    BulkParts, Context, Describe, Energy, HistorySpec, Law, Offers, PointLaw, StartGrid, part,
};
use hgo::Volumetric;
use input::{OptionKind, OptionSpec, OptionValue};
use params::{ParamSpec, Quantity};
use principal::Principal;
use std::sync::Arc;

const MOST_TERMS: usize = 3;

static CARD: LawCard = LawCard {
    name: "ogden",
    summary: "Isotropic, one to three powers of the principal stretches (terms = 1, 2 or 3): rubber to large \
              stretches, brain and other isotropic soft tissue.",
    equation: "Ψ = U(J) + Σ_p 2 μp/αp² (λ̄1^αp + λ̄2^αp + λ̄3^αp − 3),  λ̄ = J^(−1/3) λ;  initial shear modulus Σ μp \
               (μp of the source is 2 μp/αp here)",
    reference: "Ogden 1972, Proc. R. Soc. A 326, 565–584, doi:10.1098/rspa.1972.0026",
};

/// Ogden's law.
#[derive(Clone, Copy, Debug, Default)]
pub struct Ogden;

impl LawEntry<9> for Ogden {
    fn card(&self) -> &LawCard {
        &CARD
    }

    fn options(&self) -> Vec<OptionSpec> {
        vec![OptionSpec {
            name: "terms".into(),
            kind: OptionKind::Integer { min: 1, max: MOST_TERMS as i64 },
            default: Some(OptionValue::Integer(1)),
            description: "number of powers; the second is mu2, alpha2, and so on".into(),
        }]
    }

    fn law(&self, settings: &Settings) -> Arc<dyn PointLaw<9>> {
        let terms = match settings.get("terms") {
            Some(OptionValue::Integer(n)) => (*n).clamp(1, MOST_TERMS as i64) as usize,
            _ => 1,
        };
        Arc::new(Principal { terms })
    }
}

impl Describe<9> for Principal {
    fn parameters(&self) -> Vec<ParamSpec> {
        // Powers of alternating sign: two terms of one sign are hardly told apart.
        const NAMES: [[&str; 4]; MOST_TERMS] =
            [["mu1", "μ1", "alpha1", "α1"], ["mu2", "μ2", "alpha2", "α2"], ["mu3", "μ3", "alpha3", "α3"]];
        const STARTS: [(f64, f64); MOST_TERMS] = [(0.05, 4.0), (0.01, -4.0), (0.001, 12.0)];
        let mut all = Vec::new();
        for ([mu, symbol, alpha, power], (start, exponent)) in NAMES.into_iter().zip(STARTS).take(self.terms)
        {
            let about = "contribution of this term to the initial shear modulus";
            all.push(
                ParamSpec::new(mu, symbol, Quantity::Stress, (1e-9, 1e4), start, about)
                    .admissible(1e-12, 1e6)
                    .expected(start, 2.5),
            );
            let (bounds, about) = match exponent > 0.0 {
                true => ((0.2, 100.0), "power of this term, positive"),
                false => ((-100.0, -0.2), "power of this term, negative"),
            };
            let spec = ParamSpec::new(alpha, power, Quantity::Dimensionless, bounds, exponent, about);
            all.push(if exponent > 0.0 { spec.expected(exponent, 1.0) } else { spec });
        }
        all.push(hgo::compliance());
        all
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
        Some(self.spectral_tangent(gradient, params))
    }

    fn offers(&self) -> Offers {
        let mut template = vec![0.0; self.d() + 1];
        template[self.d()] = 1.0;
        let starts = StartGrid {
            template,
            axes: (0..self.terms).flat_map(|p| [(2 * p, 3), (2 * p + 1, 6)]).collect(),
            scaled: (0..self.terms).map(|p| 2 * p).collect(),
            size: 0,
            apart: None,
        };
        let bulk = BulkParts {
            volumetric: Some(part(Volumetric { d: self.d() })),
            rest_is_isochoric: true,
            fibres: Vec::new(),
            fibre_onset: None,
            matrix_modulus: |params| params[..params.len() - 1].iter().step_by(2).sum(),
            starts: Some(starts),
            mirrors: true,
        };
        Offers { bulk: Some(bulk), cohesion: None }
    }
}
