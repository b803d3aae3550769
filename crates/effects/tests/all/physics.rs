//! What each law must do in a case with a known answer.

use crate::battery;

use battery::*;
use constitutive::{Context, PointLaw};
use model::{Bulk, Interface};
use std::sync::Arc;

fn bulk(name: &str) -> Bulk {
    wrap_bulk(&*named(name), Arc::new(hgo::Hgo::default())).unwrap()
}

fn tear(name: &str) -> Interface {
    wrap_interface(&*named(name), Arc::new(cohesive::Cohesive)).unwrap()
}

fn stretched(stretch: f64) -> [f64; 9] {
    let lateral = 1.0 / stretch.sqrt();
    [lateral, 0.0, 0.0, 0.0, stretch, 0.0, 0.0, 0.0, lateral]
}

fn at<const G: usize>(steps: &[(f64, [f64; G])]) -> Steps<G> {
    let mut time = 0.0;
    steps
        .iter()
        .map(|&(dt, g)| {
            time += dt;
            (Context { dt, time, path_position: 0.5 }, g)
        })
        .collect()
}

/// Stress along the load without the pressure that holds the volume: P_yy λ − P_xx λ^(−½).
fn difference(p: &[f64; 9], stretch: f64) -> f64 {
    p[4] * stretch - p[0] / stretch.sqrt()
}

#[test]
fn a_relaxation_is_one_exponential_and_does_not_ask_for_small_steps() {
    let law = bulk("viscoelastic");
    let params = [&TISSUE[..], &[0.4, 7.0]].concat();
    let base = drive(&hgo::Hgo::default(), &TISSUE, &at(&[(0.0, stretched(1.15))])).force[0];
    let slow = difference(&base, 1.15);
    let hold = |steps: usize| {
        let mut list = vec![(0.0, stretched(1.15))];
        list.extend((0..steps).map(|_| (10.0 / steps as f64, stretched(1.15))));
        let f = drive(&*law, &params, &at(&list)).force;
        (difference(&f[0], 1.15) / slow, difference(f.last().unwrap(), 1.15) / slow)
    };
    for steps in [1, 10, 100] {
        let (instantaneous, relaxed) = hold(steps);
        assert!((instantaneous - 1.4).abs() < 1e-12);
        assert!((relaxed - 1.0 - 0.4 * (-10.0f64 / 7.0).exp()).abs() < 1e-12, "{steps} steps: {relaxed}");
    }
}

/// Exponential integral E₁ (Abramowitz & Stegun 5.1.11 and 5.1.22).
fn e1(x: f64) -> f64 {
    if x > 700.0 {
        return 0.0;
    }
    if x <= 1.5 {
        let terms = (1..60).scan(1.0, |t, k| {
            *t *= -x / f64::from(k);
            Some(*t / f64::from(k))
        });
        return -0.577_215_664_901_532_9 - x.ln() - terms.sum::<f64>();
    }
    let tail = (1..300).rev().fold(0.0, |f, k| f64::from(k) / (1.0 + f64::from(k) / (x + f)));
    (-x).exp() / (x + tail)
}

/// Fung's reduced relaxation function, one step to each time or many, over four decades and two around them.
#[test]
fn a_spectrum_relaxes_by_exponential_integrals() {
    assert!(
        (e1(1.0) - 0.219_383_934_395_520_3).abs() < 1e-14
            && (e1(2.0) - 0.048_900_510_708_061_1).abs() < 1e-13
    );
    let word = |s: &str| input::OptionValue::Text(s.into());
    let options = model::Options::from([("relaxation".to_owned(), word("spectrum"))]);
    let law = wrap_bulk_with(&*named("viscoelastic"), &options, Arc::new(hgo::Hgo::default())).unwrap();
    let base = drive(&hgo::Hgo::default(), &TISSUE, &at(&[(0.0, stretched(1.15))])).force[0];
    let slow = difference(&base, 1.15);
    for (own, decades, tolerance) in
        [([0.12, 0.05, 500.0], 4.0, 1e-3), ([0.12, 500.0, 0.05], 4.0, 1e-3), ([0.3, 1.0, 100.0], 2.0, 1e-5)]
    {
        let params = [&TISSUE[..], &own].concat();
        let (short, long) = (f64::min(own[1], own[2]), f64::max(own[1], own[2]));
        let whole = own[0] * decades * 10f64.ln();
        let ends: Vec<f64> =
            (0..60).map(|i| short * 10f64.powf(-1.0 + (decades + 2.0) * f64::from(i) / 59.0)).collect();
        let mut many = vec![(0.0, stretched(1.15))];
        many.extend(
            ends.iter().scan(0.0, |from, &t| Some((t - std::mem::replace(from, t), stretched(1.15)))),
        );
        let trace = drive(&*law, &params, &at(&many)).force;
        let at_once = difference(&trace[0], 1.15) / slow;
        assert!((at_once - 1.0 - whole).abs() < 1e-12, "{at_once}");
        for (t, f) in ends.iter().zip(&trace[1..]) {
            let want = 1.0 + own[0] * (e1(t / long) - e1(t / short));
            let got = difference(f, 1.15) / slow;
            assert!((got - want).abs() < tolerance * whole, "{own:?} at {t}: {got} {want}");
            let one = drive(&*law, &params, &at(&[(0.0, stretched(1.15)), (*t, stretched(1.15))])).force;
            assert!((difference(&one[1], 1.15) / slow - got).abs() < 1e-12);
        }
    }
}

/// Strength and both times are differentiated through the whole history, at neutral too.
#[test]
fn a_spectrum_knows_its_sensitivities() {
    let word = |s: &str| input::OptionValue::Text(s.into());
    for relaxing in ["all", "fibres"] {
        let options = model::Options::from([
            ("relaxation".to_owned(), word("spectrum")),
            ("relaxing".to_owned(), word(relaxing)),
        ]);
        let law = wrap_bulk_with(&*named("viscoelastic"), &options, Arc::new(hgo::Hgo::default())).unwrap();
        let steps = off_switches(stretching(3));
        for own in [[0.1, 0.5, 60.0], [0.0, 0.5, 60.0], [0.1, 60.0, 0.5]] {
            let params = [&TISSUE[..], &own].concat();
            for (k, h) in [(0, 1e-4), (1, 1e-3 * own[1]), (2, 1e-3 * own[2])] {
                if own[0] == 0.0 && k > 0 {
                    continue;
                }
                let error = column_error(&*law, &params, &steps, TISSUE.len() + k, &[0.0; 9], h);
                assert!(error < 1e-5, "{relaxing} {own:?} parameter {k}: {error:e}");
            }
        }
        // Without strength it is the inner law's to the bit.
        let params = [&TISSUE[..], &[0.0, 0.5, 60.0]].concat();
        let (with, base) = (drive(&*law, &params, &steps), drive(&hgo::Hgo::default(), &TISSUE, &steps));
        for (a, b) in with.force.iter().zip(&base.force) {
            assert_eq!(bits(a), bits(b));
        }
    }
}

#[test]
fn a_long_rest_empties_the_branches_wherever_the_strip_goes() {
    let law = bulk("viscoelastic");
    let params = [&TISSUE[..], &[0.4, 7.0]].concat();
    let steps = at(&[(0.0, stretched(1.2)), (1e9, stretched(1.02)), (1e9, stretched(1.1))]);
    let (with, without) =
        (drive(&*law, &params, &steps).force, drive(&hgo::Hgo::default(), &TISSUE, &steps).force);
    for s in 1..3 {
        for i in 0..9 {
            assert!((with[s][i] - without[s][i]).abs() < 1e-6 * without[s][4].abs());
        }
    }
}

#[test]
fn viscous_stress_adds_no_pressure() {
    let law = bulk("viscoelastic");
    let params = [&TISSUE[..], &[0.8, 7.0]].concat();
    let steps = stretching(8);
    let (with, without) =
        (drive(&*law, &params, &steps).force, drive(&hgo::Hgo::default(), &TISSUE, &steps).force);
    for (s, (_, f)) in steps.iter().enumerate() {
        let added: [f64; 9] = std::array::from_fn(|i| with[s][i] - without[s][i]);
        let kirchhoff = constitutive::tensor::kirchhoff(&added, f);
        let trace = constitutive::tensor::trace(&kirchhoff).abs();
        let size = kirchhoff.iter().fold(1e-6f64, |m, x| m.max(x.abs()));
        assert!(trace < 1e-10 * size, "step {s}: {trace:e} of {size:e}");
    }
}

#[test]
fn mullins_softens_below_the_maximum_only_and_by_the_error_function() {
    let law = bulk("mullins");
    let own = [0.217, 1.3e-5, 0.3];
    let params = [&TISSUE[..], &own].concat();
    let steps = at(&[(1.0, stretched(1.2)), (1.0, stretched(1.1)), (1.0, stretched(1.25))]);
    let (with, base) = (drive(&*law, &params, &steps), drive(&hgo::Hgo::default(), &TISSUE, &steps));
    assert_eq!(bits(&with.force[0]), bits(&base.force[0]));
    assert_eq!(bits(&with.force[2]), bits(&base.force[2]));
    // The volume is kept, so that the whole energy is isochoric.
    let (psi, max) = (base.energy[1], base.energy[0]);
    let x = (max - psi) / (own[1] + own[2] * max);
    let eta = 1.0 - own[0] * erf(x);
    let ratio = difference(&with.force[1], 1.1) / difference(&base.force[1], 1.1);
    assert!((ratio - eta).abs() < 1e-9, "{ratio} {eta}");
}

/// erf by its series, independent of the code under test.
fn erf(x: f64) -> f64 {
    let (mut term, mut sum) = (x, x);
    for n in 1..200 {
        term *= -x * x / n as f64;
        sum += term / (2 * n + 1) as f64;
    }
    std::f64::consts::FRAC_2_SQRT_PI * sum
}

#[test]
fn permanent_set_leaves_the_strip_free_of_stress_at_its_residual_stretch() {
    let law = bulk("permanent_set");
    let params = [&TISSUE[..], &[0.1]].concat();
    let steps = at(&[(1.0, stretched(1.2)), (1.0, stretched(1.02))]);
    let f = drive(&*law, &params, &steps).force;
    assert!(f[1].iter().all(|p| p.abs() < 1e-12), "{:?}", f[1]);
}

#[test]
fn fibre_damage_takes_the_right_fibre_term_off_whatever_the_brackets_and_invariants() {
    for tension_only in [true, false] {
        for fibre_invariants in [hgo::FibreInvariants::Isochoric, hgo::FibreInvariants::Full] {
            let base = hgo::Hgo { tension_only, fibre_invariants };
            let law = wrap_bulk(&*named("fiber_damage"), Arc::new(base)).unwrap();
            // Complete, abrupt damage up to the bound: 5 % of each fibre stress are left.
            let params = [&TISSUE[..], &[0.95, 0.0, 1e-8]].concat();
            let mut f = stretched(1.15);
            f[0] *= 1.05;
            let steps = at(&[(1.0, f)]);
            let damaged = drive(&*law, &params, &steps).force[0];
            let weak = [TISSUE[0], 0.05 * TISSUE[1], TISSUE[2], TISSUE[3], TISSUE[4], TISSUE[5], 0.0];
            let expected = drive(&base, &weak, &steps).force[0];
            for i in 0..9 {
                assert!((damaged[i] - expected[i]).abs() < 1e-12, "{base:?}: {damaged:?} {expected:?}");
            }
        }
    }
}

#[test]
fn every_law_shape_has_the_same_peak_and_work_and_loses_energy_only() {
    let law = tear("law_shape");
    for n in [0.4, 0.7, 1.0, 1.2, 1.7, 3.0] {
        let params = [&TEAR[..], &[n]].concat();
        let count = 60_000;
        let far = if n < 0.6 { 200.0 } else { 30.0 };
        // Finer near zero, where a blunt law rises steeply.
        let list: Vec<_> =
            (0..=count).map(|i| (1.0, [far * (i as f64 / count as f64).powi(3), 0.0, 0.0])).collect();
        let steps = at(&list);
        let rows = ledger(&*law, &params, &steps);
        let peak = drive(&*law, &params, &steps).force.iter().fold(0.0f64, |m, f| m.max(f[0]));
        let work = rows.last().unwrap()[0];
        assert!((peak / TEAR[1] - 1.0).abs() < 2e-4, "n = {n}: peak {peak}");
        assert!((work / TEAR[0] - 1.0).abs() < 2e-3, "n = {n}: work {work}");
        for pair in rows.windows(2) {
            assert!(pair[1][2] - pair[0][2] > -1e-12, "n = {n}: dissipation falls");
            assert!((pair[1][0] - pair[1][1] - pair[1][2]).abs() < 1e-5 * TEAR[0], "n = {n}: {:?}", pair[1]);
        }
        // Partial unloadings give back what was stored, from early and late openings.
        for top in [0.02, 0.1, 0.3, 1.5] {
            let mut list: Vec<_> = (0..=2000).map(|i| (1.0, [top * i as f64 / 2000.0, 0.0, 0.0])).collect();
            list.extend((0..=2000).rev().map(|i| (1.0, [top * i as f64 / 2000.0, 0.0, 0.0])));
            let end = *ledger(&*law, &params, &at(&list)).last().unwrap();
            assert!(end[0] > -1e-6 && (end[0] - end[2]).abs() < 2e-4 * TEAR[0], "n = {n} to {top}: {end:?}");
        }
    }
}

#[test]
fn bridging_adds_its_own_work() {
    let law = tear("bridging");
    let params = [&TEAR[..], &[0.02, 2.5]].concat();
    let list: Vec<_> = (0..=20_000).map(|i| (1.0, [60.0 * i as f64 / 20_000.0, 0.0, 0.0])).collect();
    let work = ledger(&*law, &params, &at(&list)).last().unwrap()[0];
    assert!((work - TEAR[0] - std::f64::consts::E * 0.02 * 2.5).abs() < 1e-4, "{work}");
}

/// The law with the longer opening bridges; the other one's traction and work are the file's law's.
#[test]
fn laws_that_exchange_their_roles_respond_alike() {
    let (law, bridging) = (tear("bridging"), named("bridging"));
    // Opened, closed half, opened farther and aside.
    let path = [0.0, 0.02, 0.1, 0.4, 0.2, 0.6, 1.5, 3.0].map(|u| (1.0, [u, 0.3 * u, 0.1 * u]));
    let (gc, sigma_c) = (TEAR[0], TEAR[1]);
    let delta_c = gc / (std::f64::consts::E * sigma_c);
    let own = [2.0 * sigma_c, 0.1 * delta_c];
    let (now, exchanged) = bridging.exchanged("exponential", [gc, sigma_c], &own).expect("roles exchanged");
    assert_eq!((now[1], exchanged[0]), (own[0], sigma_c));
    let response = |tear: [f64; 2], own: &[f64]| {
        let params = [&tear[..], &TEAR[2..], own].concat();
        (drive(&*law, &params, &at(&path)).force, *ledger(&*law, &params, &at(&path)).last().unwrap())
    };
    let (before, after) = (response([gc, sigma_c], &own), response(now, &exchanged));
    for (a, b) in before.0.iter().flatten().zip(after.0.iter().flatten()) {
        assert!((a - b).abs() < 1e-12 * sigma_c, "{a} {b}");
    }
    for (a, b) in before.1.iter().zip(after.1) {
        assert!((a - b).abs() < 1e-10 * gc, "{a} {b}");
    }
    // As the card means it, of another form, or none at all: nothing to exchange.
    assert_eq!(bridging.exchanged("exponential", now, &exchanged), None);
    assert_eq!(bridging.exchanged("bilinear", [gc, sigma_c], &own), None);
    assert_eq!(bridging.exchanged("exponential", [gc, sigma_c], &[0.0, own[1]]), None);
    assert_eq!(named("law_shape").exchanged("exponential", [gc, sigma_c], &own), None);
}

#[test]
fn the_rate_rise_is_the_logarithm_and_outlives_an_instantaneous_change() {
    let law = tear("rate_dependent_strength");
    let params = [&TEAR[..], &[0.05, 1e-3]].concat();
    let list =
        [(1.0, [0.1, 0.0, 0.0]), (0.0, [0.3, 0.0, 0.0]), (5.0, [0.2, 0.0, 0.0]), (10.0, [0.25, 0.0, 0.0])];
    let (with, base) = (drive(&*law, &params, &at(&list)), drive(&cohesive::Cohesive, &TEAR, &at(&list)));
    let rise = |s: usize| with.force[s][0] / base.force[s][0];
    let fast = 1.0 + 0.05 * (1.0f64 + 0.1 / 1e-3).ln();
    assert!((rise(0) - fast).abs() < 1e-12);
    assert!((rise(1) - fast).abs() < 1e-12, "a jump keeps the last rate");
    assert_eq!(rise(2), 1.0, "closing has no rise");
    assert!((rise(3) - 1.0 - 0.05 * (1.0f64 + 0.005 / 1e-3).ln()).abs() < 1e-12, "reopening below δmax has");
}

#[test]
fn fatigue_grows_on_reloading_alone_and_stays_below_its_limit() {
    let law = tear("fatigue");
    let damage = |a: f64, cycles: usize| {
        let params = [&TEAR[..], &[a]].concat();
        let mut list = vec![(1.0, [0.3, 0.0, 0.0]), (1.0, [0.8, 0.0, 0.0])];
        let monotone = drive(&*law, &params, &at(&list)).force[1][0];
        for _ in 0..cycles {
            list.push((1.0, [0.1, 0.0, 0.0]));
            list.push((1.0, [0.8, 0.0, 0.0]));
        }
        let base = drive(&cohesive::Cohesive, &TEAR, &at(&list)).force[1][0];
        assert_eq!(monotone, base, "monotone opening does no fatigue");
        1.0 - drive(&*law, &params, &at(&list)).force.last().unwrap()[0] / base
    };
    assert!(damage(0.05, 1) > 0.0 && damage(0.05, 4) > damage(0.05, 2));
    assert!((damage(20.0, 50) - 0.99).abs() < 1e-12);
}

#[test]
fn a_reloading_that_ends_on_the_envelope_wears_the_tear_as_two_steps_do() {
    let law = tear("fatigue");
    let params = [&TEAR[..], &[0.5]].concat();
    let start = [(1.0, [0.8, 0.0, 0.0]), (1.0, [0.1, 0.0, 0.0])];
    let one = [&start[..], &[(1.0, [1.2, 0.0, 0.0])]].concat();
    let two = [&start[..], &[(1.0, [0.8, 0.0, 0.0]), (1.0, [1.2, 0.0, 0.0])]].concat();
    let last = |list: &[(f64, [f64; 3])]| drive(&*law, &params, &at(list)).force.last().unwrap()[0];
    assert!((last(&one) - last(&two)).abs() < 1e-12);
}

#[test]
fn residual_opening_unloads_to_its_share_of_the_largest() {
    let law = tear("residual_opening");
    let params = [&TEAR[..], &[0.25]].concat();
    let list =
        [(1.0, [0.8, 0.0, 0.0]), (1.0, [0.5, 0.0, 0.0]), (1.0, [0.2, 0.0, 0.0]), (1.0, [0.1, 0.0, 0.0])];
    let f = drive(&*law, &params, &at(&list)).force;
    assert!((f[1][0] / f[0][0] - 0.5).abs() < 1e-12);
    assert!(f[2][0].abs() < 1e-12 && f[3][0] == 0.0);
}

#[test]
fn strength_varies_along_the_path_by_the_field() {
    let law = tear("heterogeneity");
    let peak = |params: &[f64], place: f64| {
        (0..4000).fold(0.0f64, |m, i| {
            let ctx = Context { path_position: place, ..Context::default() };
            let steps: Steps<3> = vec![(ctx, [i as f64 * 1e-3, 0.0, 0.0])];
            m.max(drive(&*law as &dyn PointLaw<3>, params, &steps).force[0][0])
        })
    };
    let params = [&TEAR[..], &[0.3, 1.0]].concat();
    assert!((peak(&params, 0.0) / (0.7 * TEAR[1]) - 1.0).abs() < 1e-5);
    assert!((peak(&params, 1.0) / (1.3 * TEAR[1]) - 1.0).abs() < 1e-5);
    assert!((peak(&params, 0.5) / TEAR[1] - 1.0).abs() < 1e-5);
}

#[test]
fn closed_faces_stick_then_slide_and_open_ones_do_not_rub() {
    let law = tear("crack_friction");
    let params = [&TEAR[..], &[0.5]].concat();
    let base = |list: &Steps<3>| drive(&cohesive::Cohesive, &TEAR, list).force;
    let list = at(&[
        (1.0, [-0.1, 0.0, 0.0]),
        (1.0, [-0.1, 0.01, 0.0]),
        (1.0, [-0.1, 0.4, 0.0]),
        (1.0, [0.1, 0.5, 0.0]),
    ]);
    let f = drive(&*law, &params, &list).force;
    let friction = |s: usize| f[s][1] - base(&list)[s][1];
    assert!((friction(1) - 10.0 * 0.01).abs() < 1e-12, "sticks with K");
    assert!((friction(2) - 0.5 * 10.0 * 0.1).abs() < 1e-12, "slides at μ p");
    assert_eq!(friction(3), 0.0);
}

#[test]
fn a_drying_tissue_keeps_a_positive_stiffness_however_long() {
    let law = bulk("stiffness_drift");
    for time in [0.0, 50.0, 1e4] {
        let ctx = Context { dt: 1.0, time, path_position: 0.5 };
        let params = [&TISSUE[..], &[-0.05]].concat();
        let base = drive(&hgo::Hgo::default(), &TISSUE, &vec![(ctx, stretched(1.1))]).force[0][4];
        let with = drive(&*law, &params, &vec![(ctx, stretched(1.1))]).force[0][4];
        assert!(with >= 0.0 && with <= base);
    }
}
