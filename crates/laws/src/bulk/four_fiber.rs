//! Arterial wall with four families: two diagonal, one axial, one circumferential.

use super::invariants::{Function, InvariantLaw, Invariants, Terms};
use crate::entry::{LawCard, LawEntry, Settings};
use constitutive::{PointLaw, Scalar, StartGrid};
use params::{ParamSpec, Quantity, Transform};
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};
use std::sync::Arc;

const MU: usize = 0;
const K1: usize = 1;
const K2: usize = 2;
const GAMMA: usize = 3;
const K1_AXIAL: usize = 4;
const K2_AXIAL: usize = 5;
const K1_CIRC: usize = 6;
const K2_CIRC: usize = 7;
const D: usize = 8;
const ONSET: usize = 9;

static CARD: LawCard = LawCard {
    name: "four_fiber",
    summary: "Soft matrix with four families of aligned fibres: two at ±γ from the load axis, one across the load \
              (axial) and one along it (circumferential).",
    equation: "Ψ = U(J) + (μ/2)(Ī1 − 3) + Σ_f k1f/(2 k2f) (exp(k2f ⟨Ī4f − 1⟩²) − 1),  \
               f = ±γ, axial (x), circumferential (y, the load);  c1 of the paper is 2 k1, its c is μ",
    reference: "Baek, Gleason, Rajagopal & Humphrey 2007, Comput. Methods Appl. Mech. Eng. 196, 3070–3078, \
                doi:10.1016/j.cma.2006.06.018",
};

/// Four fibre families.
#[derive(Clone, Copy, Debug, Default)]
pub struct FourFiber;

impl LawEntry<9> for FourFiber {
    fn card(&self) -> &LawCard {
        &CARD
    }

    fn law(&self, _settings: &Settings) -> Arc<dyn PointLaw<9>> {
        Arc::new(Invariants(*self))
    }
}

/// Stiffness and stiffening of one family.
fn family(names: [&'static str; 2], symbols: [&'static str; 2], about: [&'static str; 2]) -> [ParamSpec; 2] {
    let [k1, k2] = names;
    [
        ParamSpec::new(k1, symbols[0], Quantity::Stress, (0.0, 1e5), 0.1, about[0])
            .transform(Transform::Log)
            .admissible(0.0, 1e7)
            .expected(0.1, 2.0),
        ParamSpec::new(k2, symbols[1], Quantity::Dimensionless, (0.0, 1e3), 5.0, about[1])
            .transform(Transform::Log)
            .admissible(0.0, 1e5)
            .expected(5.0, 1.5),
    ]
}

impl InvariantLaw for FourFiber {
    fn parameters(&self) -> Vec<ParamSpec> {
        let mu =
            ParamSpec::new("mu", "μ", Quantity::Stress, (1e-6, 1e4), 5e-3, "shear modulus μ of the matrix")
                .admissible(1e-9, 1e6)
                .expected(0.005, 1.0);
        let about = "angle γ of the two diagonal families to the load axis";
        let gamma = ParamSpec::new("gamma", "γ", Quantity::Angle, (0.0, FRAC_PI_2), FRAC_PI_4, about)
            .transform(Transform::Logit { lower: 0.0, upper: FRAC_PI_2 })
            .expected(0.79, 0.8);
        let mut all = vec![mu];
        all.extend(family(
            ["k1", "k2"],
            ["k1", "k2"],
            ["stiffness k1 of the diagonal families", "stiffening k2 of the diagonal families"],
        ));
        all.push(gamma);
        all.extend(family(
            ["k1_axial", "k2_axial"],
            ["k1x", "k2x"],
            ["stiffness of the axial family, across the load", "stiffening of the axial family"],
        ));
        all.extend(family(
            ["k1_circ", "k2_circ"],
            ["k1y", "k2y"],
            [
                "stiffness of the circumferential family, along the load",
                "stiffening of the circumferential family",
            ],
        ));
        all.extend([hgo::compliance(), hgo::fibre_onset()]);
        all
    }

    fn d(&self) -> usize {
        D
    }

    fn terms<S: Scalar>(&self, p: &[S]) -> Terms<S> {
        let (o, l, onset) = (S::zero(), S::one(), p[ONSET]);
        let fibre =
            |k1: usize, k2: usize| Function::SquareExponential { k1: p[k1], k2: p[k2], tension_only: true };
        let [x, y, z] = hgo::fibre_direction(p[GAMMA], 0);
        Terms::new()
            .isotropic(Function::Cubic([p[MU] * 0.5, o, o]))
            .fibre([x, y, z], onset, fibre(K1, K2))
            .fibre([-x, y, z], onset, fibre(K1, K2))
            .fibre([l, o, o], onset, fibre(K1_AXIAL, K2_AXIAL))
            .fibre([o, l, o], onset, fibre(K1_CIRC, K2_CIRC))
    }

    fn fibre_onset(&self) -> Option<usize> {
        Some(ONSET)
    }

    fn matrix_modulus(&self) -> fn(&[f64]) -> f64 {
        |params| params[MU]
    }

    fn starts(&self) -> Option<StartGrid> {
        let mut template = vec![0.0; 10];
        template[D] = 1.0;
        Some(StartGrid {
            template,
            axes: vec![
                (MU, 3),
                (K1, 3),
                (K2, 4),
                (GAMMA, 8),
                (K1_AXIAL, 1),
                (K2_AXIAL, 1),
                (K1_CIRC, 3),
                (K2_CIRC, 3),
            ],
            scaled: vec![MU, K1, K1_AXIAL, K1_CIRC],
            size: K1,
            apart: Some((GAMMA, 0.10)),
        })
    }
}
