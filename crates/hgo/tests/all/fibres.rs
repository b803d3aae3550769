//! The fibre switch, the onset, k2 → 0, overflow, and moduli at the reference.

use crate::common;

use common::*;
use constitutive::{Context, Jet, Law, tensor};
use hgo::{
    D, FIBRE_ONSET, FibreInvariants, GAMMA, Hgo, K1, K2, KAPPA, MU, PARAMETERS, fibre_response, fibre_strain,
};
use proptest::prelude::*;

const BASE: Params = [5e-3, 1.0, 5.0, 0.7, 0.1, 0.1, 0.0];

fn literal() -> Hgo {
    Hgo { tension_only: false, ..Hgo::default() }
}

fn without_fibres(p: &Params) -> Params {
    let mut p = *p;
    p[K1] = 0.0;
    p
}

/// Isochoric uniaxial stretch along y.
fn pulled(stretch: f64) -> [f64; 9] {
    let side = stretch.powf(-0.5);
    stretches(side, stretch, side)
}

proptest! {
    #[test]
    fn a_shortened_family_carries_nothing_unless_asked(f in deformations(), p in parameters(), family in 0usize..2) {
        let law = Hgo::default();
        let strain = fibre_strain(&law, &f, &p, family);
        prop_assume!(strain.abs() > 1e-3 && p[K1] > 1e-3);
        let r = fibre_response(&law, &f, &p, family);
        prop_assert_eq!(largest(&r.force) > 0.0, strain > 0.0);
        prop_assert_eq!(r.energy > 0.0, strain > 0.0);
        prop_assert!(largest(&fibre_response(&literal(), &f, &p, family).force) > 0.0);
    }

    #[test]
    fn with_both_families_off_the_law_is_its_matrix(
        q in rotations(), pushed in 0.7f64..0.99, mut p in parameters(), gamma in 0.0f64..0.6, kappa in 0.0f64..0.05
    ) {
        // Pushed along the fibres: both families are shorter.
        (p[GAMMA], p[KAPPA]) = (gamma, kappa);
        let (law, f) = (Hgo::default(), tensor::mul(&q, &pulled(pushed)));
        prop_assert!((0..2).all(|k| fibre_strain(&law, &f, &p, k) < 0.0));
        let (whole, matrix) = (respond(&law, &f, &p), respond(&law, &f, &without_fibres(&p)));
        prop_assert_eq!(whole.force, matrix.force);
        prop_assert_eq!(whole.energy, matrix.energy);
    }

    #[test]
    fn an_onset_of_zero_leaves_every_bit(law in laws(), f in deformations(), mut p in parameters()) {
        // The strain without the parameter, written out: subtracting 0.0 is exact.
        p[FIBRE_ONSET] = 0.0;
        let bare = fibre_strain(&law, &f, &p, 0);
        p[FIBRE_ONSET] = 0.0625;
        let shifted = fibre_strain(&law, &f, &p, 0);
        prop_assert_eq!(bare - 0.0625, shifted);
        prop_assert_eq!((bare - 0.0).to_bits(), bare.to_bits());
    }

    #[test]
    fn the_onset_delays_the_fibres(f in deformations(), mut p in parameters(), onset in 0.0f64..0.3) {
        let law = Hgo::default();
        p[FIBRE_ONSET] = 0.0;
        let strain = fibre_strain(&law, &f, &p, 0);
        p[FIBRE_ONSET] = onset;
        let r = fibre_response(&law, &f, &p, 0);
        prop_assert_eq!(fibre_strain(&law, &f, &p, 0), strain - onset);
        let e = (strain - onset).max(0.0);
        let w = if p[K2] > 1e-3 { (p[K2] * e * e).exp_m1() / p[K2] } else { e * e * (1.0 + p[K2] * e * e / 2.0) };
        prop_assert!((r.energy - 0.5 * p[K1] * w).abs() < 1e-6 * (1e-9 + r.energy));
    }

    #[test]
    fn k2_to_zero_is_the_quadratic_fibre(f in deformations(), mut p in parameters()) {
        let law = Hgo::default();
        p[K2] = 0.0;
        let (at_zero, e) = (respond(&law, &f, &p), [0, 1].map(|k| fibre_strain(&law, &f, &p, k).max(0.0)));
        let quadratic = 0.5 * p[K1] * (e[0] * e[0] + e[1] * e[1]);
        let matrix = respond(&law, &f, &without_fibres(&p)).energy;
        prop_assert!((at_zero.energy - matrix - quadratic).abs() < 1e-13 * (1.0 + at_zero.energy));
        p[K2] = 1e-12;
        let near = respond(&law, &f, &p);
        prop_assert!(difference(&near.force, &at_zero.force, p[K1] + p[MU]) < 1e-10);
    }

    #[test]
    fn k2_has_its_derivative_at_zero(law in laws(), f in deformations(), mut p in parameters()) {
        let seeded = |k2: f64| {
            let mut q = p.map(Jet::<1>::constant);
            q[K2] = Jet::variable(k2, 0);
            law.respond(&Context::default(), &f.map(Jet::constant), &q, &[], &mut [])
        };
        let r = seeded(0.0);
        let h = 1e-4;
        p[K2] = h;
        let up = respond(&law, &f, &p);
        p[K2] = 2.0 * h;
        let upper = respond(&law, &f, &p);
        p[K2] = 0.0;
        let here = respond(&law, &f, &p);
        // One-sided, second order: k2 < 0 is outside the domain.
        let slope = |a: f64, b: f64, c: f64| (4.0 * b - c - 3.0 * a) / (2.0 * h);
        let fd = slope(here.energy, up.energy, upper.energy);
        prop_assert!((r.energy.eps[0] - fd).abs() < 1e-6 * (1.0 + fd.abs()) * (1.0 + p[K1]));
        let scale = 1.0 + largest(r.force.iter().map(|x| &x.eps[0]));
        for i in 0..9 {
            let fd = slope(here.force[i], up.force[i], upper.force[i]);
            prop_assert!((r.force[i].eps[0] - fd).abs() < 1e-5 * scale * (1.0 + p[K1]));
        }
    }

    #[test]
    fn nothing_is_nan_at_the_reference(law in laws(), p in parameters()) {
        let r = respond_in_jets(&law, &tensor::identity(), &p);
        prop_assert!(constitutive::Scalar::is_finite(r.energy));
        prop_assert!(r.force.iter().all(|&x| constitutive::Scalar::is_finite(x)));
    }
}

/// In isochoric tension of aligned fibres along y, E = λ² − 1: both sides of the switch.
#[test]
fn stress_is_continuous_and_tangent_jumps_at_the_switch() {
    let law = Hgo::default();
    let mut p = BASE;
    (p[GAMMA], p[KAPPA]) = (0.0, 0.0);
    let matrix = without_fibres(&p);
    let fibre_modulus = |e: f64| {
        let f = pulled(1.0 + e);
        let (_, a) = by_jets(&law, &f, &p);
        let (_, m) = by_jets(&law, &f, &matrix);
        a[4][4] - m[4][4]
    };
    // w'' (∂E/∂F_yy)² for two coinciding families, with the deviatoric ∂E/∂F_yy = 2 − 2/3.
    let jump = 2.0 * p[K1] * (4.0f64 / 3.0).powi(2);
    for e in [1e-4, 1e-6, 1e-9] {
        let fibre_stress = difference(
            &respond(&law, &pulled(1.0 + e), &p).force,
            &respond(&law, &pulled(1.0 + e), &matrix).force,
            1.0,
        );
        assert!(fibre_stress > 0.0 && fibre_stress < 8.0 * e, "{fibre_stress} at {e}");
        assert_eq!(respond(&law, &pulled(1.0 - e), &p).force, respond(&law, &pulled(1.0 - e), &matrix).force);
        assert!((fibre_modulus(e) - jump).abs() < 30.0 * e * jump + 1e-6);
        assert_eq!(fibre_modulus(-e), 0.0);
    }
    // Exactly on the switch the family is off: a definite answer, the same analytic and by jets.
    assert_eq!(fibre_strain(&law, &tensor::identity(), &p, 0), 0.0);
    assert_eq!(fibre_modulus(0.0), 0.0);
}

/// Beyond the angle with cos²γ = 1/3 (54.7°) aligned fibres shorten in uniaxial tension; the
/// dispersion term alone recruits them.
#[test]
fn steep_fibres_are_recruited_by_dispersion_alone() {
    let law = Hgo::default();
    for degrees in [57.01f64, 66.69, 73.56, 90.0] {
        let mut p = BASE;
        (p[GAMMA], p[KAPPA]) = (degrees.to_radians(), 0.0);
        // Small stretches: at large ones λ² cos²γ wins again.
        let f = pulled(1.02);
        assert!(fibre_strain(&law, &f, &p, 0) < 0.0, "{degrees}");
        assert_eq!(respond(&law, &f, &p).force, respond(&law, &f, &without_fibres(&p)).force);
        p[KAPPA] = 0.333;
        assert!(fibre_strain(&law, &f, &p, 0) > 0.0, "{degrees}");
        assert!(respond(&law, &f, &p).force[4] > respond(&law, &f, &without_fibres(&p)).force[4]);
        // Eq. 3 to the letter loads them in compression.
        p[KAPPA] = 0.0;
        assert!(largest(&fibre_response(&literal(), &f, &p, 0).force) > 0.0);
    }
    let mut p = BASE;
    (p[GAMMA], p[KAPPA]) = (54.0f64.to_radians(), 0.0);
    assert!(fibre_strain(&law, &pulled(1.02), &p, 0) > 0.0);
}

#[test]
fn isochoric_fibres_ignore_dilatation_and_full_ones_feel_it() {
    let f = stretches(1.1, 1.1, 1.1);
    assert!(fibre_strain(&Hgo::default(), &f, &BASE, 0).abs() < 1e-15);
    let full = Hgo { fibre_invariants: FibreInvariants::Full, ..Hgo::default() };
    assert!((fibre_strain(&full, &f, &BASE, 0) - (1.21 - 1.0)).abs() < 1e-14);
    // On an isochoric path both see the same strain, not the same stress (its deviator).
    let strains = [Hgo::default(), full].map(|law| fibre_strain(&law, &pulled(1.2), &BASE, 0));
    assert!((strains[0] - strains[1]).abs() < 1e-14);
}

#[test]
fn overflow_and_inverted_elements_answer_non_finite_without_panic() {
    let mut p = BASE;
    p[K2] = 1000.0;
    for fibre_invariants in [FibreInvariants::Isochoric, FibreInvariants::Full] {
        for tension_only in [true, false] {
            let law = Hgo { tension_only, fibre_invariants };
            for f in [
                pulled(3.0),
                stretches(-1.0, 1.0, 1.0),
                stretches(0.0, 1.0, 1.0),
                [0.0; 9],
                stretches(f64::NAN, 1.0, 1.0),
                stretches(1e200, 1e200, 1e200),
            ] {
                let r = respond(&law, &f, &p);
                assert!(r.force.iter().any(|x| !x.is_finite()), "{f:?}");
                let (force, a) = by_jets(&law, &f, &p);
                assert!(force.iter().any(|x| !x.is_finite()));
                assert!(a.iter().flatten().any(|x| !x.is_finite()));
                let (force, a) =
                    constitutive::Describe::analytic_tangent(&law, &Context::default(), &f, &p, &[], &mut [])
                        .unwrap();
                assert!(force.iter().chain(a.iter().flatten()).any(|x| !x.is_finite()));
            }
            let inverted = fibre_response(&law, &stretches(-1.0, 1.0, 1.0), &p, 0);
            assert!(inverted.energy.is_nan() && inverted.force[4].is_nan());
        }
    }
}

#[test]
fn the_initial_bulk_modulus_is_two_over_d() {
    for d in [0.02, 0.1, 3.0] {
        let mut p: [f64; PARAMETERS] = BASE;
        p[D] = d;
        // Hydrostatic Cauchy pressure P_yy/λ² at J = λ³; isochoric fibres do not answer.
        let stress = |j: f64| {
            let l = j.cbrt();
            respond(&Hgo::default(), &stretches(l, l, l), &p).force[4] / (l * l)
        };
        let h = 1e-5;
        let modulus = (stress(1.0 + h) - stress(1.0 - h)) / (2.0 * h);
        assert!((modulus / hgo::bulk_modulus(d) - 1.0).abs() < 1e-8, "{modulus}");
        assert!((hgo::d_of(hgo::bulk_modulus(d)) - d).abs() < 1e-15);
    }
}

/// Small strains: out of the fibre plane the shear modulus is μ; in it, the family that a shear
/// stretches adds k1 (2 (1 − 3κ) sin γ cos γ)², and eq. 3 to the letter adds it twice.
#[test]
fn the_linearised_shear_stiffness_is_the_matrix_and_the_stretched_families() {
    let p = BASE;
    let per_family = p[K1] * (2.0 * (1.0 - 3.0 * p[KAPPA]) * p[GAMMA].sin() * p[GAMMA].cos()).powi(2);
    let shear = |law: &Hgo, i: usize| {
        let (mut f, h) = (tensor::identity::<f64>(), 1e-7);
        f[i] = h;
        respond(law, &f, &p).force[i] / h
    };
    let close = |a: f64, b: f64| assert!((a / b - 1.0).abs() < 1e-5, "{a} {b}");
    for law in [Hgo::default(), literal()] {
        close(shear(&law, 5), p[MU]);
        close(shear(&law, 7), p[MU]);
        close(shear(&law, 2), p[MU]);
    }
    close(shear(&Hgo::default(), 1), p[MU] + per_family);
    close(shear(&literal(), 1), p[MU] + 2.0 * per_family);
}
