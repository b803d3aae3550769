//! Traction, tangent, parameters and history belong together, on both branches.

use crate::common;

use cohesive::{Cohesive, GC, LAMBDA, PENALTY, SIGMA_C, delta_c, effective_opening, initial_stiffness};
use common::*;
use constitutive::{Context, Describe, Jet, Scalar, testing};
use proptest::prelude::*;

/// A largest opening so far, mm: below or above the present one by at least a tenth.
fn history(opening: &Opening, p: &Params, factor: f64) -> f64 {
    let delta = effective_opening(opening, p[LAMBDA]);
    delta * if factor < 1.0 { 0.9 * factor } else { 1.1 * factor }
}

proptest! {
    #[test]
    fn tangent_is_the_derivative_of_the_traction(p in parameters(), o in openings(), factor in 0.0f64..2.0) {
        prop_assume!(o[0].abs() > 1e-3 && o.iter().map(|x| x * x).sum::<f64>() > 1e-2);
        let o = scaled(&o, &p);
        let old = history(&o, &p, factor);
        let h = 1e-6 * delta_c(p[GC], p[SIGMA_C]);
        prop_assert!(testing::tangent_error_3(&Cohesive, &Context::default(), &o, &p, &[old], h) < 1e-6);
    }

    #[test]
    fn analytic_tangent_is_the_jet_tangent(p in parameters(), o in openings(), factor in 0.0f64..2.0) {
        let o = scaled(&o, &p);
        for old in [0.0, history(&o, &p, factor), effective_opening(&o, p[LAMBDA])] {
            let error = testing::analytic_tangent_error(
                &Cohesive, &Context::default(), &o, &p, &[old], by_jets(&o, &p, old),
            );
            prop_assert!(error.unwrap() < 1e-12);
            let mut new = [0.0];
            Cohesive.analytic_tangent(&Context::default(), &o, &p, &[old], &mut new);
            prop_assert_eq!(new[0], respond(&o, &p, old).1);
        }
    }

    #[test]
    fn tangent_is_symmetric(p in parameters(), o in openings(), factor in 0.0f64..2.0) {
        let o = scaled(&o, &p);
        let (_, a) = by_jets(&o, &p, history(&o, &p, factor));
        let scale = a.iter().flatten().fold(0.0f64, |m, x| m.max(x.abs()));
        for (i, j) in [(0, 1), (0, 2), (1, 2)] {
            prop_assert!((a[i][j] - a[j][i]).abs() <= 1e-14 * scale);
        }
    }

    #[test]
    fn traction_is_the_derivative_of_what_unloading_gives_back(p in parameters(), o in openings()) {
        prop_assume!(o[0].abs() > 1e-3);
        let o = scaled(&o, &p);
        let old = 1.5 * effective_opening(&o, p[LAMBDA]) + delta_c(p[GC], p[SIGMA_C]);
        let g: [Jet<3>; 3] = std::array::from_fn(|i| Jet::variable(o[i], i));
        let mut new = [Jet::constant(0.0)];
        let r = constitutive::Law::respond(
            &Cohesive, &Context::default(), &g, &p.map(Jet::constant), &[Jet::constant(old)], &mut new,
        );
        for i in 0..3 {
            prop_assert!((r.energy.eps[i] - r.force[i].re).abs() < 1e-13 * (1.0 + r.force[i].re.abs()));
        }
    }

    #[test]
    fn turning_the_tangential_frame_turns_the_traction(
        p in parameters(), o in openings(), angle in -3.0f64..3.0, factor in 0.0f64..2.0
    ) {
        let o = scaled(&o, &p);
        let old = history(&o, &p, factor);
        let (s, c) = angle.sin_cos();
        let turn = |v: &Opening| [v[0], c * v[1] - s * v[2], s * v[1] + c * v[2]];
        let (r, new) = respond(&o, &p, old);
        let (q, turned_new) = respond(&turn(&o), &p, old);
        let expected = turn(&r.force);
        let scale = expected.iter().fold(1e-12f64, |m, x| m.max(x.abs()));
        for (turned, wanted) in q.force.iter().zip(&expected) {
            prop_assert!((turned - wanted).abs() < 1e-12 * scale);
        }
        prop_assert!((new - turned_new).abs() <= 1e-14 * new);
        prop_assert!((r.energy - q.energy).abs() <= 1e-12 * r.energy);
    }

    /// Load, unload, reload below and beyond: the total derivative propagated by jets through the
    /// history against differences of the whole path.
    #[test]
    fn derivatives_through_the_history_are_those_of_the_path(
        p in parameters(),
        path in [0.2f64..2.0, 0.05..0.8, 0.3..0.9, 1.05..2.0, 0.1..0.9],
        direction in [0.1f64..1.0, -1.0..1.0, -1.0..1.0],
    ) {
        // The last three points are relative to the first, so that the branches are known.
        let dc = delta_c(p[GC], p[SIGMA_C]);
        let points = [path[0], path[0] * path[1], path[0] * path[2], path[0] * path[3], path[0] * path[4]]
            .map(|x| direction.map(|d| d * x * dc));
        let tractions = |p: &Params| {
            let mut old = 0.0;
            points.map(|o| {
                let (r, new) = respond(&o, p, old);
                old = new;
                r.force
            })
        };
        for k in [GC, SIGMA_C, LAMBDA, PENALTY] {
            let h = 1e-5 * p[k];
            let (mut up, mut down) = (p, p);
            up[k] += h;
            down[k] -= h;
            let (up, down) = (tractions(&up), tractions(&down));
            let mut old = Jet::constant(0.0);
            for (n, o) in points.iter().enumerate() {
                let (r, new) = seeded(o, &p, k, old);
                old = new;
                for i in 0..3 {
                    let fd = (up[n][i] - down[n][i]) / (2.0 * h);
                    let scale = p[SIGMA_C] / p[k];
                    prop_assert!((r.force[i].eps[0] - fd).abs() < 1e-7 * scale, "parameter {} point {}", k, n);
                }
            }
        }
    }
}

/// On the secant the traction answers to the history: with δmax = δmax(θ), dt/dθ has both terms.
#[test]
fn unloading_feels_the_derivative_of_the_history() {
    let p = [0.23, 0.2, 1.0, 10.0];
    let (o, old, slope, h) = ([0.1, 0.05, -0.02], 0.5, 0.7, 1e-6);
    let (r, new) = seeded(&o, &p, GC, Jet { re: old, eps: [slope] });
    assert_eq!(new, Jet { re: old, eps: [slope] });
    for i in 0..3 {
        let at = |s: f64| respond(&o, &[p[0] + s, p[1], p[2], p[3]], old + slope * s).0.force[i];
        let fd = (at(h) - at(-h)) / (2.0 * h);
        assert!((r.force[i].eps[0] - fd).abs() < 1e-8, "{i}");
    }
}

#[test]
fn the_tie_is_loading() {
    let p = [0.23, 0.2, 1.0, 10.0];
    let o = [0.3, 0.2, 0.1];
    let delta = effective_opening(&o, 1.0);
    let (_, tie) = by_jets(&o, &p, delta);
    let (_, loading) = by_jets(&o, &p, 0.0);
    assert_eq!(tie, loading);
    // And the history then moves with the opening, not with its old self.
    let (_, new) = seeded(&o, &p, LAMBDA, Jet::constant(delta));
    assert!(new.eps[0] > 0.0);
}

#[test]
fn zero_opening_has_the_initial_stiffness_and_no_nan() {
    for lambda in [0.0, 0.5, 1.0, 2.0] {
        let p = [0.23, 0.2, lambda, 10.0];
        let (force, a) = by_jets(&[0.0; 3], &p, 0.0);
        assert_eq!(force, [0.0; 3]);
        let k = initial_stiffness(p[GC], p[SIGMA_C]);
        let l2 = lambda * lambda;
        assert_eq!(a, [[k, 0.0, 0.0], [0.0, k * l2, 0.0], [0.0, 0.0, k * l2]]);
        for parameter in 0..4 {
            let (r, new) = seeded(&[0.0; 3], &p, parameter, Jet::constant(0.0));
            assert!(Scalar::is_finite(r.energy) && Scalar::is_finite(new));
            assert!(r.force.iter().all(|&x| x == Jet::constant(0.0)));
        }
        // The limit is the value nearby.
        let (_, near) = by_jets(&[1e-9, 1e-9, 0.0], &p, 0.0);
        assert!((near[0][0] / k - 1.0).abs() < 1e-6);
    }
}

/// At δn = 0 the tangent of the elements is that of the opening side, with and without shear; at zero there is no
/// direction to soften along, so nothing is divided by δ.
#[test]
fn the_analytic_tangent_at_first_contact_is_the_opening_side_and_finite() {
    let p = [0.23, 0.2, 0.7, 10.0];
    for o in [[0.0; 3], [0.0, 0.2, 0.1]] {
        for old in [0.0, 0.5] {
            let (force, a) = by_jets(&o, &p, old);
            assert!(a[0][0] != p[PENALTY], "the sides must differ for this to tell them apart");
            let (analytic, tangent) =
                Cohesive.analytic_tangent(&Context::default(), &o, &p, &[old], &mut [0.0]).unwrap();
            assert_eq!(analytic, force);
            for (x, want) in tangent.iter().flatten().zip(a.iter().flatten()) {
                assert!((x - want).abs() <= 1e-14 * a[0][0], "{tangent:?} {a:?}");
            }
        }
    }
}

#[test]
fn closing_is_the_penalty_alone_and_keeps_the_tangential_law() {
    let p = [0.23, 0.2, 1.0, 10.0];
    let (r, new) = respond(&[-0.01, 0.0, 0.0], &p, 0.0);
    assert_eq!((r.force, new), ([-0.1, 0.0, 0.0], 0.0));
    assert!((r.energy - 0.5 * 10.0 * 1e-4).abs() < 1e-18);
    let (_, a) = by_jets(&[-0.01, 0.0, 0.0], &p, 0.0);
    let k = initial_stiffness(p[GC], p[SIGMA_C]);
    assert_eq!(a, [[10.0, 0.0, 0.0], [0.0, k, 0.0], [0.0, 0.0, k]]);
    let (shear, _) = respond(&[0.0, 0.2, 0.1], &p, 0.0);
    let (pressed, _) = respond(&[-0.3, 0.2, 0.1], &p, 0.0);
    assert_eq!(shear.force[1..], pressed.force[1..]);
}

#[test]
fn bad_numbers_are_seen_not_thrown() {
    let p = [0.23, 0.2, 1.0, 10.0];
    let (r, new) = respond(&[f64::NAN, 0.0, 0.0], &p, 0.1);
    assert!(r.force[0].is_nan() && new == 0.1);
    let (r, _) = respond(&[0.1, 0.0, 0.0], &[0.0, 0.2, 1.0, 10.0], 0.0);
    assert!(!r.force[0].is_finite());
    // Openings far beyond separation are merely free of traction.
    assert_eq!(respond(&[1e4, 0.0, 0.0], &p, 0.0).0.force, [0.0; 3]);
}

#[test]
fn the_law_is_an_object_with_as_many_parameters_as_it_says() {
    let law: &dyn constitutive::PointLaw<3> = &Cohesive;
    let specs = law.parameters();
    assert_eq!(specs.len(), cohesive::PARAMETERS);
    assert_eq!(
        [&specs[GC].name, &specs[SIGMA_C].name, &specs[LAMBDA].name, &specs[PENALTY].name],
        ["gc", "sigma_c", "lambda", "penalty"]
    );
    assert_eq!(testing::virgin(law), [0.0]);
    assert!(!law.rate_dependent());
    for s in &specs {
        assert!(s.lower <= s.start && s.start <= s.upper, "{}", s.name);
    }
}
