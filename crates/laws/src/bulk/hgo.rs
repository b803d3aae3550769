//! The paper's law; crate `hgo` has it.

use crate::entry::{LawCard, LawEntry, Settings, choice, word};
use constitutive::PointLaw;
use hgo::{FibreInvariants, Hgo};
use input::{OptionKind, OptionSpec, OptionValue};
use std::sync::Arc;

static CARD: LawCard = LawCard {
    name: "hgo",
    summary: "Soft matrix with two families of dispersed fibres at ±γ from the load axis, in the plane of the strip.",
    equation: "Ψ = U(J) + (μ/2)(Ī1 − 3) + Σ_f k1/(2 k2) (exp(k2 ⟨E_f⟩²) − 1),  E_f = κ Ī1 + (1 − 3κ) Ī4f − 1",
    reference: "Gasser, Ogden & Holzapfel 2006, J. R. Soc. Interface 3, 15–35, doi:10.1098/rsif.2005.0073",
};

/// Holzapfel–Gasser–Ogden with dispersion.
#[derive(Clone, Copy, Debug, Default)]
pub struct HolzapfelGasserOgden;

impl LawEntry<9> for HolzapfelGasserOgden {
    fn card(&self) -> &LawCard {
        &CARD
    }

    fn options(&self) -> Vec<OptionSpec> {
        vec![
            OptionSpec {
                name: "tension_only".into(),
                kind: OptionKind::Bool,
                default: Some(OptionValue::Bool(true)),
                description: "fibres carry tension only".into(),
            },
            choice("fibre_invariants", &["isochoric", "full"], "fibres see C̄ or C"),
        ]
    }

    fn law(&self, settings: &Settings) -> Arc<dyn PointLaw<9>> {
        let full = word(settings, "fibre_invariants", "isochoric") == "full";
        Arc::new(Hgo {
            tension_only: settings.get("tension_only") != Some(&OptionValue::Bool(false)),
            fibre_invariants: if full { FibreInvariants::Full } else { FibreInvariants::Isochoric },
        })
    }
}
