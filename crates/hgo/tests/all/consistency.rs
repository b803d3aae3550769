//! Energy, stress and tangent belong together: over random F, all variants of the law.

use crate::common;

use common::*;
use constitutive::{Context, Jet, tensor, testing};
use hgo::{
    D, FAMILIES, FIBRE_ONSET, Hgo, K1, KAPPA, MU, PARAMETERS, fibre_response, fibre_strain, matrix_response,
    volumetric,
};
use proptest::prelude::*;

/// Distance of either family from its switch, where the tangent jumps.
fn distance_to_switch(law: &Hgo, f: &[f64; 9], params: &Params) -> f64 {
    (0..FAMILIES).map(|k| fibre_strain(law, f, params, k).abs()).fold(f64::MAX, f64::min)
}

proptest! {
    #[test]
    fn stress_is_the_derivative_of_the_energy(law in laws(), f in deformations(), p in parameters()) {
        let r = respond_in_jets(&law, &f, &p);
        let force = r.force.map(|x| x.re);
        let floor = 1e-6 * largest(r.force.iter().flat_map(|x| &x.eps));
        prop_assert!(difference(&r.energy.eps, &force, floor) < 1e-10);
    }

    #[test]
    fn plain_numbers_are_the_values_of_the_jets(law in laws(), f in deformations(), p in parameters()) {
        let (plain, jets) = (respond(&law, &f, &p), respond_in_jets(&law, &f, &p));
        prop_assert!(difference(&plain.force, &jets.force.map(|x| x.re), 0.0) < 1e-14);
        prop_assert!((plain.energy - jets.energy.re).abs() <= 1e-14 * plain.energy.abs());
    }

    #[test]
    fn tangent_is_the_derivative_of_the_stress(law in laws(), f in deformations(), p in parameters()) {
        prop_assume!(distance_to_switch(&law, &f, &p) > 1e-4);
        prop_assert!(testing::tangent_error_9(&law, &Context::default(), &f, &p, &[], 1e-6) < 1e-7);
    }

    #[test]
    fn analytic_tangent_is_the_jet_tangent(law in laws(), f in deformations(), p in parameters()) {
        let error = testing::analytic_tangent_error(&law, &Context::default(), &f, &p, &[], by_jets(&law, &f, &p));
        prop_assert!(error.unwrap() < 1e-12, "{error:?}");
    }

    #[test]
    fn tangent_has_major_symmetry(law in laws(), f in deformations(), p in parameters()) {
        let (_, a) = by_jets(&law, &f, &p);
        let scale = largest(a.iter().flatten());
        let transposed: [[f64; 9]; 9] = std::array::from_fn(|i| a.map(|row| row[i]));
        for (row, column) in a.iter().zip(&transposed) {
            prop_assert!(difference(row, column, scale) < 1e-12);
        }
    }

    #[test]
    fn parameter_derivatives_are_differences(law in laws(), f in deformations(), p in parameters()) {
        // Inside the bounds, so that differences are central, and away from the switch.
        let p = [p[0], p[1] + 0.1, p[2] + 0.1, p[3], p[4], p[5], p[6]];
        prop_assume!(distance_to_switch(&law, &f, &p) > 1e-3);
        for k in 0..PARAMETERS {
            let seeded = std::array::from_fn(|i| if i == k { Jet::variable(p[i], 0) } else { Jet::constant(p[i]) });
            let exact = respond_over::<Jet<1>>(&law, &f.map(Jet::constant), &seeded).force;
            let h = 1e-5 * p[k].max(1e-2);
            let (mut up, mut down) = (p, p);
            up[k] += h;
            down[k] -= h;
            let (up, down) = (respond(&law, &f, &up).force, respond(&law, &f, &down).force);
            // Differences see the rounding of the whole force, 1e-15, over the step.
            let noise = 1e-13 * largest(&up).max(1.0 / p[D]) / h;
            let scale = largest(exact.iter().map(|x| &x.eps[0]));
            for i in 0..9 {
                let fd = (up[i] - down[i]) / (2.0 * h);
                prop_assert!((exact[i].eps[0] - fd).abs() < 1e-5 * scale + noise, "parameter {}", k);
            }
        }
    }

    #[test]
    fn stress_is_objective(law in laws(), f in deformations(), q in rotations(), p in parameters()) {
        let (force, a) = by_jets(&law, &f, &p);
        let floor = 1e-6 * largest(a.iter().flatten());
        let (turned, _) = by_jets(&law, &tensor::mul(&q, &f), &p);
        prop_assert!(difference(&turned, &tensor::mul(&q, &force), floor) < 1e-9);
        let energy = respond(&law, &f, &p).energy;
        prop_assert!((respond(&law, &tensor::mul(&q, &f), &p).energy - energy).abs() < 1e-12 * (1.0 + energy));
    }

    #[test]
    fn angular_momentum_balances(law in laws(), f in deformations(), p in parameters()) {
        let (force, a) = by_jets(&law, &f, &p);
        let tau = tensor::kirchhoff(&force, &f);
        let scale = largest(&tau).max(1e-3 * largest(a.iter().flatten()));
        prop_assert!(difference(&tensor::transpose(&tau), &tau, scale) < 1e-12);
    }

    #[test]
    fn the_parts_add_up(law in laws(), f in deformations(), p in parameters()) {
        let whole = respond(&law, &f, &p);
        let mut sum = volumetric(&f, p[D]);
        for part in [matrix_response(&f, p[MU]), fibre_response(&law, &f, &p, 0), fibre_response(&law, &f, &p, 1)] {
            sum.energy += part.energy;
            for i in 0..9 {
                sum.force[i] += part.force[i];
            }
        }
        prop_assert!((sum.energy - whole.energy).abs() < 1e-13 * (1.0 + whole.energy));
        let (_, a) = by_jets(&law, &f, &p);
        prop_assert!(difference(&sum.force, &whole.force, 1e-3 * largest(a.iter().flatten())) < 1e-12);
    }

    #[test]
    fn swapping_the_families_changes_nothing(law in laws(), f in deformations(), mut p in parameters()) {
        let force = respond(&law, &f, &p).force;
        p[hgo::GAMMA] = -p[hgo::GAMMA];
        prop_assert!(difference(&respond(&law, &f, &p).force, &force, 0.0) < 1e-12);
    }

    #[test]
    fn mirrors_and_half_turns_of_the_reference_change_nothing(
        law in laws(), f in deformations(), p in parameters(), axis in 0usize..3
    ) {
        let mut m = tensor::identity::<f64>();
        m[4 * axis] = -1.0;
        let mirror = |x: &[f64; 9]| tensor::mul(&m, &tensor::mul(x, &m));
        let (force, a) = by_jets(&law, &f, &p);
        let floor = 1e-6 * largest(a.iter().flatten());
        prop_assert!(difference(&respond(&law, &mirror(&f), &p).force, &mirror(&force), floor) < 1e-9);
    }

    #[test]
    fn full_dispersion_is_isotropic(law in laws(), f in deformations(), q in rotations(), mut p in parameters()) {
        p[KAPPA] = 1.0 / 3.0;
        // Isotropy: P(F Q) = P(F) Q.
        let (force, a) = by_jets(&law, &f, &p);
        let floor = 1e-6 * largest(a.iter().flatten());
        let turned = respond(&law, &tensor::mul(&f, &q), &p).force;
        prop_assert!(difference(&turned, &tensor::mul(&force, &q), floor) < 1e-9);
        let strains = [0, 1].map(|k| fibre_strain(&law, &f, &p, k));
        prop_assert!((strains[0] - strains[1]).abs() < 1e-14);
    }

    #[test]
    fn the_reference_is_free_of_stress_in_every_orientation(law in laws(), q in rotations(), mut p in parameters()) {
        p[FIBRE_ONSET] = 0.0;
        prop_assert_eq!(respond(&law, &tensor::identity(), &p).force, [0.0; 9]);
        let (force, a) = by_jets(&law, &q, &p);
        prop_assert!(largest(&force) < 1e-14 * largest(a.iter().flatten()));
        prop_assert!(respond(&law, &q, &p).energy.abs() < 1e-14 * largest(a.iter().flatten()));
    }
}

#[test]
fn laminate_and_soft_tissue_scales_both_hold() {
    let f = [1.1, 0.2, 0.0, -0.1, 1.2, 0.1, 0.05, 0.0, 0.9];
    for p in [
        [2288.0, 15000.0, 3.0, 0.7, 0.1, 2e-6, 0.0],
        [1e-6, 1e-6, 1e-6, 0.7, 0.1, 1e3, 0.0],
        [5e-3, 1.0, 0.0, 0.7, 0.1, 0.1, 0.0],
    ] {
        let law = Hgo::default();
        let error =
            testing::analytic_tangent_error(&law, &Context::default(), &f, &p, &[], by_jets(&law, &f, &p));
        assert!(error.unwrap() < 1e-12, "{p:?}: {error:?}");
    }
}

#[test]
fn the_law_is_an_object_with_as_many_parameters_as_it_says() {
    let law: &dyn constitutive::PointLaw<9> = &Hgo::default();
    let specs = law.parameters();
    assert_eq!(specs.len(), hgo::PARAMETERS);
    assert_eq!(specs[K1].name, "k1");
    assert_eq!(specs[FIBRE_ONSET].neutral, Some(0.0));
    for s in &specs {
        assert!(s.lower <= s.start && s.start <= s.upper, "{}", s.name);
        let z = s.transform.forward(s.start);
        assert!((s.transform.backward(z) - s.start).abs() < 1e-12, "{}", s.name);
    }
    assert!(law.history().is_empty() && !law.rate_dependent());
    let f = stretches(1.0, 1.1, 0.95);
    let start: Vec<f64> = specs.iter().map(|s| s.start).collect();
    let e = law.energies(&Context::default(), &f, &start, &[], &[]);
    assert!(e.stored > 0.0 && e.dissipated == 0.0);
}
