//! An isotropic solid that stiffens: a cubic in Ī1 − 3.

use super::invariants::{Function, InvariantLaw, Invariants, Terms};
use crate::entry::{LawCard, LawEntry, Settings};
use constitutive::{PointLaw, Scalar, StartGrid};
use params::{ParamSpec, Quantity, Transform};
use std::sync::Arc;

const C1: usize = 0;
const C2: usize = 1;
const C3: usize = 2;
const D: usize = 3;

static CARD: LawCard = LawCard {
    name: "yeoh",
    summary: "Isotropic, stiffening at large stretch: filled rubber, isotropic tissue.",
    equation: "Ψ = U(J) + c1 (Ī1 − 3) + c2 (Ī1 − 3)² + c3 (Ī1 − 3)³;  initial shear modulus 2 c1",
    reference: "Yeoh 1993, Rubber Chem. Technol. 66, 754–771, doi:10.5254/1.3538343",
};

/// Yeoh's cubic.
#[derive(Clone, Copy, Debug, Default)]
pub struct Yeoh;

impl LawEntry<9> for Yeoh {
    fn card(&self) -> &LawCard {
        &CARD
    }

    fn law(&self, _settings: &Settings) -> Arc<dyn PointLaw<9>> {
        Arc::new(Invariants(*self))
    }
}

impl InvariantLaw for Yeoh {
    fn parameters(&self) -> Vec<ParamSpec> {
        let stress = |name, symbol, lower, start, about| {
            ParamSpec::new(name, symbol, Quantity::Stress, (lower, 1e4), start, about)
                .transform(Transform::Log)
        };
        vec![
            stress("c1", "c1", 1e-6, 0.01, "coefficient c1 of Ī1 − 3; half the initial shear modulus")
                .admissible(1e-9, 1e6)
                .expected(0.02, 2.0),
            // Zero is admissible: the law without that power.
            stress("c2", "c2", 0.0, 0.01, "coefficient c2 of (Ī1 − 3)²")
                .admissible(0.0, 1e6)
                .expected(0.02, 2.5),
            stress("c3", "c3", 0.0, 0.01, "coefficient c3 of (Ī1 − 3)³")
                .admissible(0.0, 1e6)
                .expected(0.02, 2.5),
            hgo::compliance(),
        ]
    }

    fn d(&self) -> usize {
        D
    }

    fn terms<S: Scalar>(&self, params: &[S]) -> Terms<S> {
        Terms::new().isotropic(Function::Cubic([params[C1], params[C2], params[C3]]))
    }

    fn matrix_modulus(&self) -> fn(&[f64]) -> f64 {
        |params| 2.0 * params[C1]
    }

    fn starts(&self) -> Option<StartGrid> {
        Some(StartGrid {
            template: vec![0.0, 0.0, 0.0, 1.0],
            axes: vec![(C1, 7), (C2, 7), (C3, 7)],
            scaled: vec![C1, C2, C3],
            size: C1,
            apart: None,
        })
    }
}
