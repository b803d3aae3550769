//! Numbers that can be worked out on paper: each figure of the atlas, the dependence, the screen and the ladder
//! against its closed form.
#![allow(missing_docs)]

use diagnose::atlas::{atlas, atlas_by, structure_p};
use diagnose::dependence::{Dependence, Variable, dependence, protocol_variables};
use diagnose::holdout::split;
use diagnose::tails::{chi2_sf, f_sf, normal_isf, normal_sf, power};
use diagnose::*;
use nalgebra::{DMatrix, DVector};

fn close(a: f64, b: f64) {
    assert!((a - b).abs() <= 1e-9 * b.abs().max(1e-300), "{a} {b}");
}

fn whole(n: usize) -> [Segment; 1] {
    [Segment { name: "load 1".into(), range: 0..n, kind: SegmentKind::Load }]
}

fn row(r: &[f64]) -> diagnose::atlas::SegmentMisfit {
    atlas(r, &whole(r.len()))[0].clone()
}

#[test]
fn a_row_of_the_atlas_is_its_textbook_formulas() {
    // Twenty signs in turn: 20 runs where 11 are expected, variance 10 · 9/19.
    let turn: Vec<f64> = (0..20).map(|i| if i % 2 == 0 { 2.0 } else { -2.0 }).collect();
    let a = row(&turn);
    assert_eq!((a.points, a.share, a.rms, a.mean, a.sign), (20, 1.0, 2.0, 0.0, '0'));
    close(a.autocorrelation, -19.0 / 20.0);
    close(a.durbin_watson, 19.0 * 4.0 / 20.0);
    close(a.runs_p, normal_sf((11.0 - 20.0) / (90.0f64 / 19.0).sqrt()));
    // Six up, fourteen down: 2 runs where 1 + 2 · 6 · 14/20 = 9.4 are expected.
    let halves: Vec<f64> = (0..20).map(|i| if i < 6 { 1.0 } else { -1.0 }).collect();
    let b = row(&halves);
    close(b.mean, -0.4);
    close(b.autocorrelation, (18.0 - 1.0) / 20.0);
    close(b.durbin_watson, 4.0 / 20.0);
    close(b.runs_p, normal_sf((9.4 - 2.0) / (8.4f64 * 7.4 / 19.0).sqrt()));
    // All on one side: 2⁻¹¹ that twelve signs agree with the first. Zeros have no sign; nine points tell nothing.
    close(row(&[1.0; 12]).runs_p, 0.5f64.powi(11));
    close(row(&[-1.0; 12]).runs_p, 0.5f64.powi(11));
    assert_eq!(row(&[1.0; 9]).runs_p, 1.0);
    assert_eq!(row(&[[1.0; 9].as_slice(), &[0.0; 5]].concat()).runs_p, 1.0);
    close(row(&[1.0; 10]).runs_p, 0.5f64.powi(9));
    let nothing = row(&[0.0; 12]);
    assert_eq!((nothing.share, nothing.durbin_watson, nothing.autocorrelation), (0.0, 2.0, 0.0));
}

#[test]
fn a_mean_has_a_sign_beyond_two_standard_errors_of_what_is_independent() {
    // a ± 1 in turn: sixteen independent points of sd 1, two standard errors are 1/2.
    let in_turn = |a: f64| -> Vec<f64> { (0..16).map(|i| a + if i % 2 == 0 { 1.0 } else { -1.0 }).collect() };
    assert_eq!([0.49, 0.51, -0.49, -0.51].map(|a| row(&in_turn(a)).sign), ['0', '+', '0', '-'],);
    // In pairs the lag-1 correlation is (15 a² + 1)/(16 (a² + 1)), at a = 0.55 0.27: 9.3 points, two errors are 0.66.
    let in_pairs =
        |a: f64| -> Vec<f64> { (0..16).map(|i| a + if i / 2 % 2 == 0 { 1.0 } else { -1.0 }).collect() };
    close(row(&in_pairs(0.55)).autocorrelation, (15.0 * 0.3025 + 1.0) / (16.0 * 1.3025));
    assert_eq!(row(&in_pairs(0.55)).sign, '0');
    assert_eq!(row(&in_pairs(0.9)).sign, '+');
}

#[test]
fn shares_of_segments_are_of_the_whole_record() {
    let r = [[1.0; 10], [2.0; 10], [0.0; 10]].concat();
    let segments: Vec<Segment> = (0..4)
        .map(|k| Segment { name: format!("{k}"), range: 10 * k..10 * k + 10, kind: SegmentKind::Load })
        .collect();
    let rows = atlas(&r, &segments);
    assert_eq!(rows.iter().map(|r| r.points).collect::<Vec<_>>(), [10, 10, 10, 0]);
    assert_eq!(rows.iter().map(|r| r.share).collect::<Vec<_>>(), [0.2, 0.8, 0.0, 0.0]);
    // By position 0 to 3 in three stretches: the least position, then (0, 1], (1, 2], (2, 3].
    let by = atlas_by(&[1.0, 1.0, 2.0, 0.0, 1.0], &[0.0, 0.5, 1.0, 2.5, 3.0], 3);
    let said: Vec<_> = by.iter().map(|(ends, r)| (*ends, r.segment.as_str(), r.points, r.share)).collect();
    let want = [
        ([0.0, 0.0], "0.00 mm", 1, 1.0 / 7.0),
        ([0.0, 1.0], "1.00 mm", 2, 5.0 / 7.0),
        ([2.0, 3.0], "3.00 mm", 2, 1.0 / 7.0),
    ];
    assert_eq!(said, want);
}

#[test]
fn structure_is_the_sum_of_five_lagged_products() {
    // Ones: 19 + 18 + 17 + 16 + 15 = 85 products of 1. Signs in turn: −19 + 18 − 17 + 16 − 15 = −17.
    let turn: Vec<f64> = (0..20).map(|i| if i % 2 == 0 { 3.0 } else { -3.0 }).collect();
    close(structure_p(&[3.0; 20]), normal_sf(85.0f64.sqrt()));
    close(structure_p(&turn), normal_sf(-17.0 / 85.0f64.sqrt()));
    assert_eq!((structure_p(&[3.0; 19]), structure_p(&[0.0; 20])), (1.0, 1.0));
}

#[test]
fn variables_of_a_protocol_are_what_their_names_say() {
    // Up five, down five (a second step on the way), up four, one point a second.
    let u = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 4.0, 3.0, 2.0, 1.0, 0.0, 1.0, 2.0, 3.0, 4.0];
    let t: Vec<f64> = (0..16).map(f64::from).collect();
    let force = u.map(|x| 10.0 * x);
    let all = protocol_variables(&t, &u, &force, &[6, 8, 11]);
    let of = |name: &str| all.iter().find(|v| v.name == name).unwrap().values.clone();
    assert_eq!(of("displacement"), u);
    assert_eq!(of("force"), force);
    assert_eq!(of("clock time"), t[..15]);
    let since = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 1.0, 2.0, 1.0, 2.0, 3.0, 1.0, 2.0, 3.0, 4.0];
    assert_eq!(of("time since the last turn"), since);
    // Over two points on either side, fewer at the ends.
    let rate = [1.0, 1.0, 1.0, 1.0, 0.5, 0.0, -0.5, -1.0, -1.0, -0.5, 0.0, 0.5, 1.0, 1.0, 1.0];
    assert_eq!(of("rate"), rate);
    assert_eq!(
        of("largest displacement so far"),
        [[0.0, 1.0, 2.0, 3.0, 4.0].as_slice(), &[5.0; 10]].concat()
    );
    assert_eq!(of("cycle number"), [[0.0; 11].as_slice(), &[1.0; 4]].concat());
    // A hold on the way up is no cycle.
    let u: Vec<f64> = (0..20).map(|i: i32| f64::from(i.min(5) + (i - 12).max(0))).collect();
    let t: Vec<f64> = (0..20).map(f64::from).collect();
    let all = protocol_variables(&t, &u, &u, &[8, 15]);
    assert_eq!(all.iter().find(|v| v.name == "cycle number").unwrap().values, [0.0; 20]);
}

/// ±1, changing every `length` points.
fn waves(n: usize, length: usize) -> Vec<f64> {
    (0..n).map(|i| if (i / length).is_multiple_of(2) { -1.0 } else { 1.0 }).collect()
}

fn of<'a>(rows: &'a [Dependence], name: &str) -> &'a Dependence {
    rows.iter().find(|d| d.variable == name).unwrap()
}

#[test]
fn dependence_is_an_analysis_of_variance() {
    // Two variables of two levels and a rest, all orthogonal: squares 0.09, 0.16 and 1 a point.
    let n = 64;
    let (x, y) = (waves(n, 1), waves(n, 2));
    let rest = |length: usize| -> Vec<f64> {
        let z = waves(n, length);
        (0..n).map(|i| 0.3 * x[i] + 0.4 * y[i] + z[i]).collect()
    };
    let variables = [Variable::new("x", x.clone()), Variable::new("y", y.clone())];
    // A rest in blocks of four is correlated by (48 − 15)/64: so few points are independent.
    let rows = dependence(&rest(4), &variables);
    assert_eq!(rows[0].variable, "y", "most first");
    let rho = 33.0 / 64.0;
    let left = 64.0 * (1.0 - rho) / (1.0 + rho) - 3.0;
    for (name, square) in [("x", 0.09), ("y", 0.16)] {
        let d = of(&rows, name);
        close(d.share_alone, square / 1.25);
        close(d.share_beyond, square / 1.25);
        close(d.p_value, f_sf(square * left, 1.0, left));
    }
    // In blocks of 32 hardly two of them are: no test is left.
    assert!(dependence(&rest(32), &variables).iter().all(|d| d.p_value == 1.0));
    // What goes along with another explains alone and not beyond it.
    let twins =
        [Variable::new("x", x.clone()), Variable::new("twin", x.iter().map(|v| 5.0 - 2.0 * v).collect())];
    for d in dependence(&rest(4), &twins) {
        close(d.share_alone, 0.09 / 1.25);
        assert!(d.share_beyond < 1e-12 && d.p_value == 1.0, "{d:?}");
    }
}

#[test]
fn many_values_are_a_spline_with_knots_at_fifths() {
    let x: Vec<f64> = (0..21).map(|i| 3.0 + 2.0 * f64::from(i)).collect();
    let explained = |r: Vec<f64>| dependence(&r, &[Variable::new("x", x.clone())])[0].share_alone;
    let bent_at = |k: f64| x.iter().map(|v| (v - k).max(0.0)).collect::<Vec<_>>();
    for k in [3.0, 11.0, 19.0, 27.0, 35.0] {
        close(explained(bent_at(k)), 1.0);
    }
    assert!(explained(bent_at(15.0)) < 1.0 - 1e-5, "no knot there");
    // Six values are levels: any number for each is explained. Seven are not.
    let levels = |n: usize| -> (Vec<f64>, Vec<f64>) {
        (0..70).map(|i| ((i % n) as f64, ((i % n) as f64 * 2.3).sin())).unzip()
    };
    let share = |(x, r): (Vec<f64>, Vec<f64>)| dependence(&r, &[Variable::new("x", x)])[0].share_alone;
    close(share(levels(6)), 1.0);
    assert!(share(levels(7)) < 1.0 - 1e-3);
}

fn segments(kinds: &[(SegmentKind, usize)]) -> (Vec<Segment>, usize) {
    let mut at = 0;
    let cut = kinds.iter().enumerate().map(|(k, &(kind, length))| {
        at += length;
        Segment { name: format!("{} {k}", kind.word()), range: at - length..at, kind }
    });
    (cut.collect(), kinds.iter().map(|k| k.1).sum())
}

#[test]
fn the_last_segments_that_fit_are_kept_back() {
    use SegmentKind::{Hold, Load, Onset, Toe, Unload};
    let (s, n) = segments(&[(Load, 20), (Hold, 20), (Load, 20), (Hold, 20), (Load, 20)]);
    let held = |share: f64| split(&s, n, share).segments;
    assert_eq!(held(0.25), ["load 4"]);
    assert_eq!(held(0.4), ["hold 3", "load 4"]);
    assert_eq!(held(0.31), ["hold 3", "load 4"], "up to 1.3 times the goal");
    assert_eq!(held(0.3), ["load 4"], "and not beyond it");
    let mask = split(&s, n, 0.4).mask;
    assert!(mask.iter().enumerate().all(|(i, &m)| m == (i >= 60)));
    // Toe and onset stay, whatever follows; so does what occurs once.
    let (s, n) =
        segments(&[(Toe, 20), (Load, 20), (Onset, 20), (Toe, 20), (Unload, 20), (Onset, 20), (Load, 20)]);
    assert_eq!(split(&s, n, 0.5).segments, ["load 6"]);
    // Nothing occurs twice: the third fifth of what has fifteen points.
    let (s, n) = segments(&[(Load, 15), (Hold, 14), (Unload, 30)]);
    let h = split(&s, n, 0.25);
    let kept: Vec<usize> = (0..n).filter(|&i| h.mask[i]).collect();
    assert_eq!(kept, [(6..9).collect::<Vec<_>>(), (29 + 12..29 + 18).collect()].concat());
    assert!(h.segments.contains(&"middle of load 0".to_owned()) && h.segments.len() == 2);
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
    assert_eq!((f.fall, f.p_value, f.amplitudes[0].1), (0.0, 1.0, 0.0));
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
    c.shapes =
        shapes.iter().map(|s| Shape { parameters: vec![], columns: DMatrix::from_columns(s) }).collect();
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
fn a_misfit_of_zero_promises_nothing() {
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

fn rung(chi2: f64, freedom: f64) -> Rung {
    Rung {
        effects: vec![],
        parameters: 3,
        points: 1000,
        rms: 1.0,
        reduced_chi2: 1.0,
        chi2_total: chi2,
        freedom,
        bic: chi2,
        aicc: chi2,
        held_out_chi2: None,
        held_out_points: 0,
        held_out_rms: None,
        structure_p: 1.0,
    }
}

#[test]
fn a_rung_is_explained_up_to_four_sigmas_or_a_fifth() {
    let policy = Policy::default();
    let explained = |chi2: f64, freedom: f64| rung(chi2, freedom).explained(&policy);
    // √(2/200) = 0.1: up to 1.4. √(2/80 000) = 0.005: the fifth holds.
    assert_eq!([279.0, 281.0].map(|c| explained(c, 200.0)), [true, false]);
    assert_eq!([95_900.0, 96_100.0].map(|c| explained(c, 80_000.0)), [true, false]);
    assert!(
        !Rung { structure_p: 0.9e-6, ..rung(100.0, 200.0) }.explained(&policy),
        "structure, whatever χ² says"
    );
    assert_eq!((rung(250.0, 200.0).excess(), rung(150.0, 200.0).excess()), (50.0, 0.0));
    close(rung(250.0, 200.0).reduced_chi2_total(), 1.25);
    let leaning = Rung { reduced_chi2: 2.1, ..rung(200.0, 200.0) };
    assert!(
        leaning.leans_on_the_mesh() && !Rung { reduced_chi2: LEANS, ..leaning.clone() }.leans_on_the_mesh()
    );
    let least = [rung(400.0, 200.0), rung(200.0, 200.0), leaning].map(|r| r.least_fall(&policy));
    assert_eq!(least, [0.0, policy.min_fall_explained, policy.min_fall_leaning]);
}

#[test]
fn an_effect_pays_in_bic_in_excess_and_on_what_was_held_out() {
    let policy = Policy::default();
    let pays = |before: &Rung, after: &Rung| diagnose::pays(before, after, &policy);
    // Excess 500, of which a twentieth is 25.
    let before = rung(1000.0, 500.0);
    let after = |gain: f64, bic: f64| Rung { bic: before.bic - bic, ..rung(1000.0 - gain, 499.0) };
    assert_eq!([25.0, 24.9].map(|gain| pays(&before, &after(gain, 50.0))), [true, false]);
    assert_eq!([10.0, 9.9].map(|bic| pays(&before, &after(50.0, bic))), [true, false]);
    // Where noise explains the record, at least 20.
    let calm = rung(500.0, 500.0);
    let less = |gain: f64| Rung { bic: calm.bic - 50.0, ..rung(500.0 - gain, 499.0) };
    assert_eq!([20.0, 19.9].map(|gain| pays(&calm, &less(gain))), [true, false]);
    // 200 points that were not seen: two sigmas are 0.2.
    let seen = before.clone().held_out(2.0, 200, 0.1);
    let held = |chi2: f64| after(50.0, 50.0).held_out(chi2, 200, 0.2);
    assert_eq!([2.19, 2.21].map(|y| pays(&seen, &held(y))), [true, false]);
    assert!(pays(&before, &held(9.0)), "nothing to compare with");
    let h = held(2.19);
    assert_eq!((h.held_out_chi2, h.held_out_points, h.held_out_rms), (Some(2.19), 200, Some(0.2)));
    let w = weights(&[10.0, 10.0 + 2.0 * 2f64.ln()]);
    close(w[0], 2.0 / 3.0);
    close(w[1], 1.0 / 3.0);
}
