//! The screen and the ladder against closed forms: axes, Pythagoras, independent shapes, criteria.
#![allow(missing_docs)]

use crate::tables;

use diagnose::tails::{chi2_sf, normal_isf, normal_sf, power};
use diagnose::*;
use nalgebra::{DMatrix, DVector};

fn close(a: f64, b: f64) {
    assert!((a - b).abs() <= 1e-9 * b.abs().max(1e-300), "{a} {b}");
}

fn along(weights: &[(usize, f64)]) -> DVector<f64> {
    let mut v = DVector::zeros(8);
    for &(i, w) in weights {
        v[i] = w;
    }
    v
}

/// Misfit 3 along axis 0 and 4 along axis 1; the base model moves axis 7.
fn screened(candidates: &[Candidate]) -> Screen {
    let base = DMatrix::from_columns(&[along(&[(7, 5.0)])]);
    score(&along(&[(0, 3.0), (1, 4.0)]), &base, candidates, &Policy::default()).unwrap()
}

#[test]
fn a_score_on_axes_is_pythagoras() {
    let one = Candidate::simple("one", Side::Positive, 7.0, along(&[(0, 2.0), (7, 2.0)]));
    let other = Candidate::simple("other", Side::Both, 1.0, along(&[(1, -1.0)]));
    let wrong = Candidate::simple("wrong", Side::Negative, 1.0, along(&[(0, 1.0)]));
    let mut both = Candidate::simple("both", Side::Both, 1.0, along(&[]));
    both.amplitudes.push(both.amplitudes[0].clone());
    both.shapes[0].columns = DMatrix::from_columns(&[along(&[(0, 1.0)]), along(&[(1, 2.0)])]);
    let s = screened(&[one, other, wrong, both]);
    assert_eq!((s.chi2, s.freedom), (25.0, 7));
    let f = s.finding("one").unwrap();
    for (x, want) in [
        (f.fall, 9.0),
        (f.expected_fall, 9.0 / 25.0),
        (f.amplitudes[0].1, 1.5),
        (f.std_errors[0], 0.5),
        (f.visibility, 0.5f64.sqrt()),
        (f.snr, 14.0),
        (f.p_value, normal_sf(3.0)),
        (f.p_bonferroni, normal_sf(3.0)),
        // Second smallest but one of four.
        (f.q_value, 4.0 / 3.0 * normal_sf(3.0)),
    ] {
        close(x, want);
    }
    assert!(f.visible && !f.significant, "a fall of 9 is below 10");
    let f = s.finding("other").unwrap();
    close(f.p_value, 2.0 * normal_sf(4.0));
    close(f.amplitudes[0].1, -4.0);
    assert!(f.significant && !f.visible, "1 standard deviation is below 10");
    let f = s.finding("wrong").unwrap();
    assert_eq!((f.fall, f.p_value, f.p_bonferroni, f.amplitudes[0].1), (0.0, 1.0, 1.0, 0.0));
    let f = s.finding("both").unwrap();
    close(f.fall, 25.0);
    close(f.p_value, chi2_sf(25.0, 2.0));
    close(f.amplitudes[1].1, 2.0);
    close(f.std_errors[1], 0.5);
}

#[test]
fn pairs_on_axes_are_pythagoras() {
    let half = 0.5f64.sqrt();
    let list = [
        Candidate::simple("x", Side::Both, 20.0, along(&[(0, 1.0)])),
        Candidate::simple("y", Side::Both, 20.0, along(&[(1, 2.0)])),
        Candidate::simple("between", Side::Both, 20.0, along(&[(0, half), (2, half)])),
        Candidate::simple("up", Side::Positive, 20.0, along(&[(0, half), (2, -half)])),
        Candidate::simple("down", Side::Negative, 20.0, along(&[(0, 1.0)])),
    ];
    let s = screened(&list);
    assert_eq!(s.pairs.len(), 10, "each with each other, none with itself");
    let p = s.pair("x", "y").unwrap();
    close(p.joint_fall, 25.0);
    close(p.a_after_b, 9.0);
    close(p.b_after_a, 16.0);
    close(p.angle_degrees, 90.0);
    close(p.p_value, chi2_sf(25.0, 2.0));
    assert!(!p.alike);
    close(s.pair("x", "between").unwrap().angle_degrees, 45.0);
    close(s.pair("between", "x").unwrap().joint_fall, 9.0);
    close(s.pair("up", "down").unwrap().angle_degrees, 90.0);
    // One that has a sign and one that has none.
    close(s.pair("x", "up").unwrap().angle_degrees, 45.0);
    close(s.pair("up", "y").unwrap().angle_degrees, 90.0);
    close(s.pair("x", "down").unwrap().angle_degrees, 0.0);
    // What is left between a column and its rivals, beyond the base.
    let (base, rival) = (along(&[(7, 3.0)]), along(&[(0, 5.0)]));
    let columns = |v: &DVector<f64>| DMatrix::from_columns(std::slice::from_ref(v));
    close(
        separation(&columns(&base), &along(&[(0, 2.0), (3, 6.0), (4, 8.0), (7, 1.0)]), &columns(&rival)),
        10.0,
    );
}

/// Two effects that this misfit does not hold are alike when closer than 45° and too faint for the sine between them.
#[test]
fn faint_effects_are_alike_by_angle_and_signal() {
    // At 30° a quarter of a signal of 35 is below nine, of 37 above; at 50° 0.587 of 14 is below, and they are apart.
    let alike = |degrees: f64, signal: f64| {
        let (sin, cos) = degrees.to_radians().sin_cos();
        let s = screened(&[
            Candidate::simple("x", Side::Both, signal.sqrt(), along(&[(3, 1.0)])),
            Candidate::simple("y", Side::Both, signal.sqrt(), along(&[(3, cos), (4, sin)])),
        ]);
        close(s.pair("x", "y").unwrap().angle_degrees, degrees);
        s.pair("x", "y").unwrap().alike
    };
    assert_eq!([alike(30.0, 35.0), alike(30.0, 37.0), alike(50.0, 14.0)], [true, false, false]);
}

/// One effect with the given shapes (columns of each), and the screen's p-value against `misfit`.
fn p_value(misfit: &DVector<f64>, sides: &[Side], shapes: &[&[DVector<f64>]]) -> Finding {
    let mut c = Candidate::simple("sup", sides[0], 1.0, along(&[]));
    c.amplitudes = sides.iter().map(|&side| Amplitude { side, ..c.amplitudes[0].clone() }).collect();
    c.shapes = shapes
        .iter()
        .map(|s| ShapeColumns { parameters: vec![], columns: DMatrix::from_columns(s) })
        .collect();
    let base = DMatrix::from_columns(&[along(&[(7, 5.0)])]);
    score(misfit, &base, &[c], &Policy::default()).unwrap().findings[0].clone()
}

#[test]
fn far_out_neighbouring_shapes_pay_for_the_angle_between_them() {
    let (angle, fall) = (0.1f64, 36.0);
    let shapes =
        |sign: f64| [[along(&[(0, 1.0)])], [along(&[(0, sign * angle.cos()), (2, sign * angle.sin())])]];
    let p = |side: Side, sign: f64| {
        let [x, y] = shapes(sign);
        let f = p_value(&along(&[(0, 6.0)]), &[side], &[&x, &y]);
        close(f.fall, fall);
        (f.p_value, f.p_bonferroni)
    };
    let (one, crossing) = (normal_sf(6.0), angle / std::f64::consts::TAU * (-0.5 * fall).exp());
    close(p(Side::Positive, 1.0).0, one + crossing);
    close(p(Side::Positive, 1.0).1, 2.0 * one);
    // The other way round is another shape for one side, the same for both.
    close(p(Side::Positive, -1.0).0, 2.0 * one);
    close(p(Side::Both, -1.0).0, 2.0 * (one + crossing));
    close(p(Side::Both, 1.0).1, 4.0 * one);
}

/// Orthogonal shapes are independent, so the law of the maximum is known; 20,000 draws of it are within 0.01.
#[test]
fn simulated_tails_are_those_of_independent_shapes() {
    let axis = |k: usize| along(&[(k, 1.0 + k as f64)]);
    let near = |f: &Finding, p: f64| {
        assert!((f.p_value - p).abs() < 0.01, "{} {p}", f.p_value);
        let share = f.p_value * 20_001.0;
        assert!((share - share.round()).abs() < 1e-6, "one of the draws is the record itself: {share}");
    };
    let misfit = along(&[(0, 2.0)]);
    for (side, tail) in [(Side::Both, 2.0 * normal_sf(2.0)), (Side::Positive, normal_sf(2.0))] {
        near(&p_value(&misfit, &[side], &[&[axis(0)], &[axis(1)]]), 1.0 - (1.0 - tail).powi(2));
    }
    let down = p_value(&-&misfit, &[Side::Negative], &[&[axis(0)], &[axis(1)]]);
    near(&down, 1.0 - (1.0 - normal_sf(2.0)).powi(2));
    let both = [Side::Both; 2];
    let twice = p_value(&misfit, &both, &[&[axis(0), axis(1)], &[axis(2), axis(3)]]);
    near(&twice, 1.0 - (1.0 - chi2_sf(4.0, 2.0)).powi(2));
    // One shape of unsigned amplitudes needs no draws.
    close(p_value(&misfit, &both, &[&[axis(0), axis(1)]]).p_value, chi2_sf(4.0, 2.0));
    // Ten times the same shape: about ten draws of 20,000 reach 15.2, too few to count, and the bound is ten times
    // the truth. Fewer than twenty and the record itself is what can be said.
    let same: Vec<[DVector<f64>; 2]> = (0..10).map(|_| [axis(0), axis(1)]).collect();
    let same: Vec<&[DVector<f64>]> = same.iter().map(|s| s.as_slice()).collect();
    close(p_value(&along(&[(0, 3.9)]), &both, &same).p_value, 21.0 / 20_001.0);
    // One signed amplitude of two: half the time it is at zero.
    let signed = p_value(&misfit, &[Side::Positive, Side::Both], &[&[axis(0), axis(1)]]);
    near(&signed, 0.5 * (chi2_sf(4.0, 1.0) + chi2_sf(4.0, 2.0)));
}

#[test]
fn what_the_base_does_itself_predicts_nothing() {
    let hidden = |side: Side| Candidate::simple("hidden", side, 7.0, along(&[(7, 2.0)]));
    let mut twice = hidden(Side::Both);
    twice.amplitudes.push(twice.amplitudes[0].clone());
    twice.shapes[0].columns = DMatrix::from_columns(&[along(&[(7, 2.0)]), along(&[(0, 1.0)])]);
    for c in [hidden(Side::Both), hidden(Side::Positive)] {
        let f = screened(&[c]).findings[0].clone();
        assert_eq!((f.fall, f.p_value, f.p_bonferroni, f.visibility), (0.0, 1.0, 1.0, 0.0));
        assert_eq!((f.amplitudes[0].1, f.std_errors[0], f.snr), (0.0, 1e150, 0.0));
    }
    let f = screened(&[twice]).findings[0].clone();
    close(f.fall, 9.0);
    assert_eq!((f.amplitudes[0].1, f.amplitudes[1].1, f.std_errors[0]), (0.0, 3.0, 1e150));
    close(f.std_errors[1], 1.0);
    // Nothing at all is none either.
    let f = screened(&[Candidate::simple("none", Side::Both, 7.0, along(&[]))]).findings[0].clone();
    assert_eq!((f.fall, f.p_value, f.visibility), (0.0, 1.0, 0.0));
}

#[test]
fn three_amplitudes_of_one_effect_share_what_each_explains() {
    let sides = |third: Side| {
        let axis = |k: usize, w: f64| along(&[(k, w)]);
        let misfit = along(&[(0, 3.0), (1, 4.0), (2, -5.0)]);
        p_value(&misfit, &[Side::Both, Side::Both, third], &[&[axis(0, 1.0), axis(1, 2.0), axis(2, 1.0)]])
    };
    let all = sides(Side::Both);
    close(all.fall, 50.0);
    for ((_, a), want) in all.amplitudes.iter().zip([3.0, 2.0, -5.0]) {
        close(*a, want);
    }
    // The third one may not be negative.
    let two = sides(Side::Positive);
    close(two.fall, 25.0);
    assert_eq!(two.amplitudes[2].1, 0.0);
}

#[test]
fn a_misfit_of_zero_predicts_nothing() {
    let f = p_value(&along(&[]), &[Side::Both], &[&[along(&[(0, 1.0)])]]);
    assert_eq!((f.fall, f.expected_fall, f.p_value), (0.0, 0.0, 1.0));
}

#[test]
fn sides_and_limits_cut_an_estimate() {
    let admitted = |side: Side| [-1.0, 0.0, 1.0].map(|a| side.admits(a));
    assert_eq!(admitted(Side::Both), [true, true, true]);
    assert_eq!(admitted(Side::Positive), [false, true, true]);
    assert_eq!(admitted(Side::Negative), [true, true, false]);
    let a = Amplitude { name: "a".into(), side: Side::Both, plausible: 1.0, limits: (2.0, 0.5) };
    assert_eq!(
        [-8.0, -2.0, -1.0, 0.0, 0.25, 0.5, 2.0].map(|x| a.admitted(x)),
        [0.25, 1.0, 1.0, 1.0, 1.0, 1.0, 0.25]
    );
}

#[test]
fn a_two_sided_test_sees_either_side() {
    let c = normal_isf(0.025);
    close(power(2.0, 0.05, false), normal_sf(c - 2.0) + normal_sf(c + 2.0));
    close(power(c, 0.05, false), 0.5 + normal_sf(2.0 * c));
}

fn fitted_model(chi2: f64, freedom: f64) -> FittedModel {
    FittedModel { freedom, bic: chi2, reduced_chi2: 1.0, ..tables::fitted_model(&[], chi2, 3) }
}

#[test]
fn a_model_is_explained_up_to_four_sigmas_or_a_fifth() {
    let policy = Policy::default();
    let explained = |chi2: f64, freedom: f64| fitted_model(chi2, freedom).explained(&policy);
    // √(2/200) = 0.1: up to 1.4. √(2/80 000) = 0.005: the fifth holds.
    assert_eq!([279.0, 281.0].map(|c| explained(c, 200.0)), [true, false]);
    assert_eq!([95_900.0, 96_100.0].map(|c| explained(c, 80_000.0)), [true, false]);
    assert!(
        !FittedModel { structure_p: 0.9e-6, ..fitted_model(100.0, 200.0) }.explained(&policy),
        "structure, whatever χ² says"
    );
    close(fitted_model(250.0, 200.0).reduced_chi2_total(), 1.25);
}

#[test]
fn weights_of_a_criterion_sum_to_one() {
    let w = weights(&[10.0, 10.0 + 2.0 * 2f64.ln()]);
    close(w[0], 2.0 / 3.0);
    close(w[1], 1.0 / 3.0);
}

/// Another screen's p-values go by name, whatever their order; what decides stays.
#[test]
fn p_values_of_the_noise_as_estimated_stand_beside() {
    let one = Candidate::simple("one", Side::Positive, 7.0, along(&[(0, 2.0)]));
    let other = Candidate::simple("other", Side::Both, 1.0, along(&[(1, 1.0)]));
    let mut conservative = screened(&[one.clone(), other.clone()]);
    let was = conservative.clone();
    assert_eq!(was.findings[0].effect, "other");
    assert!(was.findings.iter().all(|f| f.p_estimated.is_none() && f.p_shown() == f.p_value));
    // Half the noise along axis 0.
    let base = DMatrix::from_columns(&[along(&[(7, 5.0)])]);
    let louder = score(&along(&[(0, 6.0), (1, 4.0)]), &base, &[one], &Policy::default()).unwrap();
    conservative.beside(&louder);
    let [f, g] = ["one", "other"].map(|name| conservative.finding(name).unwrap());
    close(f.p_estimated.unwrap(), normal_sf(6.0));
    close(f.p_shown(), normal_sf(6.0));
    close(f.p_value, normal_sf(3.0));
    assert_eq!((g.p_estimated, g.p_shown()), (None, g.p_value));
    assert_eq!(
        conservative.findings.iter().map(|f| (f.q_value, f.significant)).collect::<Vec<_>>(),
        was.findings.iter().map(|f| (f.q_value, f.significant)).collect::<Vec<_>>()
    );
}
