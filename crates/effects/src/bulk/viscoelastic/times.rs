//! Relaxation times and strengths of the branches: each its own, or a continuous spectrum of Fung's box.
//!
//! The box has the same strength C in every unit of ln τ between τ₁ and τ₂ (Fung 1993; Puso & Weiss 1998):
//!
//! ```text
//! G(t)/G(∞) = 1 + C ∫ e^{−t/τ} d ln τ = 1 + C [E₁(t/τ₂) − E₁(t/τ₁)],   G(0)/G(∞) = 1 + C ln(τ₂/τ₁)
//! ```
//!
//! Eight branches at the Gauss–Legendre points of ln τ stand for the integral. Of the whole relaxing stress C ln(τ₂/τ₁) they are
//! off by at most 1e-5 over two decades, 2e-4 over three, 1e-3 over four, 5e-3 over six.

use constitutive::Scalar;
use params::{ParamSpec, Quantity};

/// Branches that stand for the spectrum.
const POINTS: usize = 8;

/// Gauss–Legendre points and weights on (−1, 1), the positive half.
const HALF: [(f64, f64); POINTS / 2] = [
    (0.183_434_642_495_649_8, 0.362_683_783_378_362),
    (0.525_532_409_916_329, 0.313_706_645_877_887_3),
    (0.796_666_477_413_626_7, 0.222_381_034_453_374_5),
    (0.960_289_856_497_536_3, 0.101_228_536_290_376_26),
];

pub(super) const TAU_BOUNDS: (f64, f64) = (1e-2, 1e5);

/// What relaxation times a tissue has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Times {
    /// So many branches, each with its own strength and time.
    Branches(usize),
    /// The same strength at every logarithm of the time between two times.
    Spectrum,
}

impl Times {
    /// Number of branches.
    pub const fn count(self) -> usize {
        match self {
            Self::Branches(n) => n,
            Self::Spectrum => POINTS,
        }
    }

    /// Strength and time of a branch.
    #[inline(always)]
    pub fn of<S: Scalar>(self, own: &[S], branch: usize) -> (S, S) {
        if let Self::Branches(_) = self {
            return (own[2 * branch], own[2 * branch + 1]);
        }
        let (x, weight) = HALF[branch / 2];
        let x = if branch.is_multiple_of(2) { x } else { -x };
        let length = (own[2] / own[1]).ln();
        // Which of the two times is the longer does not matter.
        let size = if length.value() < 0.0 { -length } else { length };
        (own[0] * size * (0.5 * weight), own[1] * (length * (0.5 * (1.0 + x))).exp())
    }

    /// Parameters, amplitude first.
    pub fn parameters(self) -> Vec<ParamSpec> {
        match self {
            Self::Branches(n) => (0..n).flat_map(branch_parameters).collect(),
            Self::Spectrum => spectrum_parameters(),
        }
    }
}

fn tau(name: &'static str, symbol: &'static str, start: f64, about: &'static str) -> ParamSpec {
    ParamSpec::new(name, symbol, Quantity::Time, TAU_BOUNDS, start, about)
}

fn spectrum_parameters() -> Vec<ParamSpec> {
    let about = "relaxing stress over long-term stress, per unit of ln τ";
    vec![
        ParamSpec::new("c", "C", Quantity::Dimensionless, (0.0, 2.0), 0.05, about).neutral(0.0),
        tau("tau1", "τ₁", 1.0, "shortest relaxation time of the spectrum"),
        tau("tau2", "τ₂", 100.0, "longest relaxation time of the spectrum"),
    ]
}

fn branch_parameters(b: usize) -> [ParamSpec; 2] {
    let about = "instantaneous over long-term stress, less one";
    let g = ParamSpec::new("g", "g", Quantity::Dimensionless, (0.0, 5.0), 0.2, about).neutral(0.0);
    let mut pair = [g, tau("tau", "τ", 10f64.powi(b as i32 + 1), "relaxation time of the branch")];
    if b > 0 {
        for p in &mut pair {
            p.name = format!("{}{}", p.name, b + 1).into();
            p.symbol = format!("{}{}", p.symbol, ['₂', '₃', '₄'][b - 1]).into();
        }
    }
    pair
}
