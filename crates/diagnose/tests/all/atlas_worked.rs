//! Numbers that can be worked out on paper: each figure of the atlas, the dependence and the hold-out against its closed form.
#![allow(missing_docs)]

use diagnose::atlas::{atlas, atlas_by, structure_p};
use diagnose::dependence::{Dependence, Variable, dependence, protocol_variables};
use diagnose::holdout::split;
use diagnose::tails::{f_sf, normal_sf};
use diagnose::*;

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
    // By position 1 to 7 in three stretches: the least position, then (1, 3], (3, 5], (5, 7].
    let by = atlas_by(&[1.0, 1.0, 2.0, 0.0, 1.0], &[1.0, 2.0, 3.0, 6.0, 7.0], 3);
    let said: Vec<_> = by.iter().map(|(ends, r)| (*ends, r.segment.as_str(), r.points, r.share)).collect();
    let want = [
        ([1.0, 1.0], "1.00 mm", 1, 1.0 / 7.0),
        ([1.0, 3.0], "3.00 mm", 2, 5.0 / 7.0),
        ([5.0, 7.0], "7.00 mm", 2, 1.0 / 7.0),
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
fn a_misfit_of_zero_depends_on_nothing() {
    let x: Vec<f64> = (0..30).map(f64::from).collect();
    for row in dependence(&[0.0; 30], &[Variable::new("x", x.clone()), Variable::new("short", vec![1.0])]) {
        assert_eq!((row.share_alone, row.share_beyond, row.p_value), (0.0, 0.0, 1.0), "{}", row.variable);
    }
    assert_eq!(dependence(&[], &[Variable::new("x", vec![])]).len(), 1);
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
