//! The simplest rubber: one modulus.

use super::invariants::{Function, InvariantLaw, Invariants, Terms};
use crate::entry::{LawCard, LawEntry, Settings};
use constitutive::{PointLaw, Scalar, StartGrid};
use params::{ParamSpec, Quantity};
use std::sync::Arc;

const MU: usize = 0;
const D: usize = 1;

static CARD: LawCard = LawCard {
    name: "neo_hooke",
    summary: "Isotropic, one shear modulus: gels, elastomers at moderate stretch, tissue without fibres.",
    equation: "Ψ = U(J) + (μ/2)(Ī1 − 3)",
    reference: "Treloar 1943, Trans. Faraday Soc. 39, 36–41, doi:10.1039/TF9433900036",
};

/// Neo-Hooke.
#[derive(Clone, Copy, Debug, Default)]
pub struct NeoHooke;

impl LawEntry<9> for NeoHooke {
    fn card(&self) -> &LawCard {
        &CARD
    }

    fn law(&self, _settings: &Settings) -> Arc<dyn PointLaw<9>> {
        Arc::new(Invariants(*self))
    }
}

impl InvariantLaw for NeoHooke {
    fn parameters(&self) -> Vec<ParamSpec> {
        vec![
            ParamSpec::new("mu", "μ", Quantity::Stress, (1e-6, 1e4), 0.05, "shear modulus μ")
                .admissible(1e-9, 1e6)
                .expected(0.05, 2.0),
            hgo::compliance(),
        ]
    }

    fn d(&self) -> usize {
        D
    }

    fn terms<S: Scalar>(&self, params: &[S]) -> Terms<S> {
        let (mu, o) = (params[MU], S::zero());
        Terms::new().isotropic(Function::Cubic([mu * 0.5, o, o]))
    }

    fn matrix_modulus(&self) -> fn(&[f64]) -> f64 {
        |params| params[MU]
    }

    fn starts(&self) -> Option<StartGrid> {
        let template = vec![0.0, 1.0];
        Some(StartGrid { template, axes: vec![(MU, 1)], scaled: vec![MU], size: MU, apart: None })
    }
}
