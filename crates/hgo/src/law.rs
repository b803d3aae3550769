//! The law itself: energy, stress, parameters.

use crate::fibre::Family;
use crate::kinematics::{Kinematics, Part, Planar};
use crate::tangent;
use constitutive::{Context, Describe, Energy, HistorySpec, Law, Offers, Over, Response, Scalar};
use params::{ParamSpec, Quantity, Reciprocal, Transform};
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};

/// Index of μ, shear modulus of the matrix, MPa.
pub const MU: usize = 0;
/// Index of k1, fibre stiffness, MPa.
pub const K1: usize = 1;
/// Index of k2, fibre stiffening.
pub const K2: usize = 2;
/// Index of γ, angle of the families to the load axis y, rad.
pub const GAMMA: usize = 3;
/// Index of κ, fibre dispersion, 0 (aligned) to 1/3 (isotropic).
pub const KAPPA: usize = 4;
/// Index of D, volumetric compliance, 1/MPa; the initial bulk modulus is 2/D.
pub const D: usize = 5;
/// Index of E_r, the fibre strain at which fibres begin to carry load; 0 is the paper's law.
pub const FIBRE_ONSET: usize = 6;
/// Number of parameters.
pub const PARAMETERS: usize = 7;

/// Which invariants the fibre strain is built from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum FibreInvariants {
    /// Ī1, Ī4 of C̄ = J^(−2/3) C, as the paper's eqs. 1–3 are written.
    #[default]
    Isochoric,
    /// I1, I4 of C: fibres that see dilatation (Nolan et al. 2014, 10.1016/j.jmbbm.2014.06.016).
    Full,
}

/// The Holzapfel–Gasser–Ogden law with dispersion (paper eqs. 1–3; Gasser, Ogden & Holzapfel
/// 2006, 10.1098/rsif.2005.0073).
///
/// ```text
/// Ψ = (1/D)((J² − 1)/2 − ln J) + (μ/2)(Ī1 − 3) + Σ_f k1/(2 k2) (exp(k2 ⟨E_f − E_r⟩²) − 1)
/// E_f = κ Ī1 + (1 − 3κ) Ī4f − 1,   a_f = (± sin γ, cos γ, 0)
/// ```
///
/// Parameters: [`MU`], [`K1`], [`K2`], [`GAMMA`], [`KAPPA`], [`D`], [`FIBRE_ONSET`]. Gradient: F,
/// row-major `[S; 9]`. Force: first Piola stress P, MPa, row-major. Energy: Ψ, MPa. No history.
///
/// The stress is continuous, the tangent jumps where a family switches on (E = 0); at E = 0 exactly
/// the family is off. det F ≤ 0 and an overflow of the exponential give non-finite answers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Hgo {
    /// Fibres carry tension only (Macaulay bracket). `false` is the paper's eq. 3 to the letter.
    pub tension_only: bool,
    /// Invariants in the fibre strain.
    pub fibre_invariants: FibreInvariants,
}

impl Default for Hgo {
    fn default() -> Self {
        Self { tension_only: true, fibre_invariants: FibreInvariants::Isochoric }
    }
}

/// D of a law with the volumetric term of the paper's eq. 1: fixed at 0.1/MPa unless freed, or given as the initial
/// bulk modulus 2/D.
pub fn compliance() -> ParamSpec {
    let about = "the paper's D, instead of bulk_modulus; fixed unless freed";
    ParamSpec::new("d", "D", Quantity::InverseStress, (1e-7, 1e3), 0.1, about)
        .admissible(2e-7, 2e9)
        .reciprocal(Reciprocal {
            name: "bulk_modulus",
            quantity: Quantity::Stress,
            numerator: 2.0,
            description: "initial bulk modulus 2/D; fixed unless freed",
        })
        .fixed()
}

/// E_r, from which the fibre strains of a law count: 0, moved by an effect only.
pub fn fibre_onset() -> ParamSpec {
    let about = "fibre strain at which fibres begin to carry load";
    ParamSpec::new("fibre_onset", "E_r", Quantity::Dimensionless, (-1.0, 10.0), 0.0, about)
        .neutral(0.0)
        .internal()
}

/// Initial bulk modulus K0 = 2/D, MPa, of the volumetric term of the paper's eq. 1.
///
/// The paper calls 1/D the bulk modulus; the second derivative of its energy at J = 1 is 2/D.
pub fn bulk_modulus(d: f64) -> f64 {
    2.0 / d
}

/// D, 1/MPa, of an initial bulk modulus, MPa.
pub fn d_of(bulk_modulus: f64) -> f64 {
    2.0 / bulk_modulus
}

#[inline(always)]
fn volumetric_part<X: Scalar, S: Scalar + Over<X>>(kin: &Kinematics<X>, d: S) -> Part<S> {
    let x = kin.j - 1.0;
    // (J² − 1)/2 − ln J, with x = J − 1 so that small volume changes keep their digits.
    let energy = S::lift(x * (x + 2.0) * 0.5 - x.ln_1p()) / d;
    Part { along: Planar::zero(), across: S::lift(kin.j - kin.j.recip()) / d, energy }
}

#[inline(always)]
fn matrix_part<X: Scalar, S: Scalar + Over<X>>(kin: &Kinematics<X>, mu: S) -> Part<S> {
    let excess = kin.i1_minus_3();
    let stiffness = mu.times(kin.m);
    Part {
        along: Planar::spherical(stiffness),
        // Written so that P is exactly zero at F = I.
        across: -(stiffness.times(excess / 3.0 + 1.0).over(kin.j)),
        energy: mu.times(kin.m * excess + (kin.m - 1.0) * 3.0) * 0.5,
    }
}

/// Volumetric stress (MPa) and energy (MPa), the first term of the paper's eq. 1; `d` in 1/MPa.
pub fn volumetric<S: Scalar>(f: &[S; 9], d: S) -> Response<S, 9> {
    let kin = Kinematics::new(f);
    volumetric_part::<S, S>(&kin, d).response(&kin)
}

/// Stress (MPa) and energy (MPa) of the isochoric neo-Hookean matrix, the second term of the
/// paper's eq. 1; `mu` in MPa.
pub fn matrix_response<S: Scalar>(f: &[S; 9], mu: S) -> Response<S, 9> {
    let kin = Kinematics::new(f);
    matrix_part::<S, S>(&kin, mu).response(&kin)
}

impl<S: Scalar> Law<S, 9> for Hgo {
    #[inline]
    fn respond(
        &self,
        _ctx: &Context,
        gradient: &[S; 9],
        params: &[S],
        _old: &[S],
        _new: &mut [S],
    ) -> Response<S, 9> {
        match at_rest(gradient) {
            Some(f) => self.sum(&Kinematics::new(&f), params),
            None => self.sum(&Kinematics::new(gradient), params),
        }
    }
}

/// The gradient in plain numbers, if it is constant and only parameters carry derivatives.
#[inline(always)]
pub(crate) fn at_rest<S: Scalar>(gradient: &[S; 9]) -> Option<[f64; 9]> {
    (!S::PLAIN && gradient.iter().all(S::is_constant)).then(|| gradient.map(S::value))
}

impl Hgo {
    #[inline(always)]
    fn sum<X: Scalar, S: Scalar + Over<X>>(&self, kin: &Kinematics<X>, params: &[S]) -> Response<S, 9> {
        let mut sum = volumetric_part(kin, params[D]).plus(matrix_part(kin, params[MU]));
        for fibre in &Family::both(self, kin, params) {
            if fibre.active(self) {
                sum = sum.plus(fibre.part(self, kin, params));
            }
        }
        sum.response(kin)
    }
}

impl Describe<9> for Hgo {
    fn parameters(&self) -> Vec<ParamSpec> {
        use Quantity::{Angle, Dimensionless, Stress};
        let angle = Transform::Logit { lower: 0.0, upper: FRAC_PI_2 };
        let dispersion = Transform::Logit { lower: 0.0, upper: 1.0 / 3.0 };
        // What is expected: medians and spreads over arterial tissue as the paper collects them (Table 1, section 6).
        vec![
            ParamSpec::new("mu", "μ", Stress, (1e-6, 1e4), 5e-3, "shear modulus μ of the matrix")
                .admissible(1e-9, 1e6)
                .expected(0.005, 0.6),
            // Zero is admissible for k1 (no fibres) and k2 (quadratic fibres), but a search is
            // over orders of magnitude.
            ParamSpec::new("k1", "k1", Stress, (0.0, 1e5), 1.0, "fibre stiffness k1")
                .transform(Transform::Log)
                .admissible(0.0, 1e7)
                .expected(1.0, 1.0),
            ParamSpec::new("k2", "k2", Dimensionless, (0.0, 1e3), 30.0, "fibre stiffening k2")
                .transform(Transform::Log)
                .admissible(0.0, 1e5)
                .expected(30.0, 0.7),
            ParamSpec::new(
                "gamma",
                "γ",
                Angle,
                (0.0, FRAC_PI_2),
                FRAC_PI_4,
                "angle γ of the two fibre families to the load axis",
            )
            .transform(angle)
            .expected(0.87, 0.8),
            ParamSpec::new(
                "kappa",
                "κ",
                Dimensionless,
                (0.0, 1.0 / 3.0),
                0.2,
                "fibre dispersion κ: 0 aligned, 1/3 isotropic",
            )
            .transform(dispersion)
            .expected(0.23, 1.0),
            compliance(),
            fibre_onset(),
        ]
    }

    fn history(&self) -> Vec<HistorySpec> {
        Vec::new()
    }

    fn rate_dependent(&self) -> bool {
        false
    }

    fn offers(&self) -> Offers {
        self.offered()
    }

    fn energies(
        &self,
        ctx: &Context,
        gradient: &[f64; 9],
        params: &[f64],
        _old: &[f64],
        _new: &[f64],
    ) -> Energy {
        let stored = self.respond(ctx, gradient, params, &[], &mut []).energy;
        Energy { stored, dissipated: 0.0 }
    }

    fn analytic_tangent(
        &self,
        _ctx: &Context,
        gradient: &[f64; 9],
        params: &[f64],
        _old: &[f64],
        _new: &mut [f64],
    ) -> Option<([f64; 9], [[f64; 9]; 9])> {
        let mut answer = Some(([0.0; 9], [[0.0; 9]; 9]));
        if let Some((stress, a)) = &mut answer {
            tangent::stress_and_tangent(self, gradient, params, stress, a);
        }
        answer
    }
}
