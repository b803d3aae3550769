//! Orthotropic myocardium: matrix, fibres, sheets, and the shear between them.

use super::invariants::{Function, InvariantLaw, Invariants, Terms};
use crate::entry::{LawCard, LawEntry, Settings, choice, word};
use constitutive::{PointLaw, Scalar, StartGrid};
use input::OptionSpec;
use params::{ParamSpec, Quantity, Transform};
use std::sync::Arc;

const A: usize = 0;
const B: usize = 1;
const A_F: usize = 2;
const B_F: usize = 3;
const A_S: usize = 4;
const B_S: usize = 5;
const A_FS: usize = 6;
const B_FS: usize = 7;
const D: usize = 8;
const ONSET: usize = 9;

static CARD: LawCard = LawCard {
    name: "holzapfel_ogden",
    summary: "Orthotropic tissue in layers, as myocardium: a stiffening matrix, fibres f, sheets s, and their shear. \
              f lies along the load and s along the tear, or (fibres = \"tear\") the other way round.",
    equation: "Ψ = U(J) + a/(2b) (exp(b (Ī1 − 3)) − 1) + Σ_{i=f,s} a_i/(2b_i) (exp(b_i ⟨Ī4i − 1⟩²) − 1) \
               + a_fs/(2b_fs) (exp(b_fs Ī8fs²) − 1)",
    reference: "Holzapfel & Ogden 2009, Phil. Trans. R. Soc. A 367, 3445–3475, doi:10.1098/rsta.2009.0091",
};

/// Holzapfel–Ogden.
#[derive(Clone, Copy, Debug, Default)]
pub struct HolzapfelOgden;

impl LawEntry<9> for HolzapfelOgden {
    fn card(&self) -> &LawCard {
        &CARD
    }

    fn options(&self) -> Vec<OptionSpec> {
        vec![choice("fibres", &["load", "tear"], "the fibre axis lies along the load, or along the tear")]
    }

    fn law(&self, settings: &Settings) -> Arc<dyn PointLaw<9>> {
        Arc::new(Invariants(Orthotropic { across: word(settings, "fibres", "load") == "tear" }))
    }
}

/// The law with its fibre axis along the load y, or across it.
#[derive(Clone, Copy, Debug)]
struct Orthotropic {
    across: bool,
}

impl InvariantLaw for Orthotropic {
    /// Starts are the values of the source's Table 1 for simple shear of myocardium.
    fn parameters(&self) -> Vec<ParamSpec> {
        let stress = |name, symbol, lower, start: f64, about| {
            ParamSpec::new(name, symbol, Quantity::Stress, (lower, 1e4), start, about)
                .transform(Transform::Log)
                .admissible(lower.min(1e-9), 1e6)
                .expected(start, 1.5)
        };
        let number = |name, symbol, start: f64, about| {
            ParamSpec::new(name, symbol, Quantity::Dimensionless, (0.0, 1e3), start, about)
                .transform(Transform::Log)
                .admissible(0.0, 1e5)
                .expected(start, 1.0)
        };
        vec![
            stress("a", "a", 1e-6, 0.059e-3, "stiffness a of the matrix, its initial shear modulus"),
            number("b", "b", 8.023, "stiffening b of the matrix"),
            stress("a_f", "a_f", 0.0, 18.472e-3, "stiffness a_f of the fibres"),
            number("b_f", "b_f", 16.026, "stiffening b_f of the fibres"),
            stress("a_s", "a_s", 0.0, 2.481e-3, "stiffness a_s of the sheets"),
            number("b_s", "b_s", 11.120, "stiffening b_s of the sheets"),
            stress("a_fs", "a_fs", 0.0, 0.216e-3, "stiffness a_fs of the shear between fibres and sheets"),
            number("b_fs", "b_fs", 11.436, "stiffening b_fs of that shear"),
            hgo::compliance(),
            hgo::fibre_onset(),
        ]
    }

    fn d(&self) -> usize {
        D
    }

    fn terms<S: Scalar>(&self, p: &[S]) -> Terms<S> {
        let (o, l) = (S::zero(), S::one());
        let (x, y) = ([l, o, o], [o, l, o]);
        let (f, s) = if self.across { (x, y) } else { (y, x) };
        let square = |k1: usize, k2: usize, tension_only: bool| Function::SquareExponential {
            k1: p[k1],
            k2: p[k2],
            tension_only,
        };
        Terms::new()
            .isotropic(Function::Exponential { a: p[A], b: p[B] })
            .fibre(f, p[ONSET], square(A_F, B_F, true))
            .fibre(s, p[ONSET], square(A_S, B_S, true))
            .coupling(f, s, square(A_FS, B_FS, false))
    }

    fn fibre_onset(&self) -> Option<usize> {
        Some(ONSET)
    }

    fn matrix_modulus(&self) -> fn(&[f64]) -> f64 {
        |params| params[A]
    }

    fn starts(&self) -> Option<StartGrid> {
        let mut template = vec![0.0; 10];
        template[D] = 1.0;
        Some(StartGrid {
            template,
            axes: vec![(A, 5), (B, 4), (A_F, 4), (B_F, 5), (A_S, 2), (B_S, 1), (A_FS, 1), (B_FS, 1)],
            scaled: vec![A, A_F, A_S, A_FS],
            size: A_F,
            apart: None,
        })
    }
}
