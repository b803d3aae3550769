//! Segments, atlas, dependence and hold-out on a toy protocol.
#![allow(missing_docs)]

use diagnose::atlas::{atlas, structure_p};
use diagnose::dependence::{Variable, dependence, protocol_variables};
use diagnose::holdout::split;
use diagnose::segments::{RecordKind, Segment, SegmentKind, breaks, cut};
use inverse::Random;
use proptest::prelude::*;

/// Rates and points of each stretch; displacement noise `sd`.
fn protocol(steps: &[(f64, usize)], sd: f64) -> (Vec<f64>, Vec<f64>, Vec<usize>) {
    let (mut t, mut u, mut ends) = (vec![0.0], vec![0.0], Vec::new());
    for &(rate, n) in steps {
        for _ in 0..n {
            t.push(t[t.len() - 1] + 0.5);
            u.push(u[u.len() - 1] + 0.5 * rate);
        }
        ends.push(u.len() - 1);
    }
    let mut random = Random::new(11);
    let noisy = u.iter().map(|x| x + sd * random.normal()).collect();
    (t, noisy, ends)
}

const RICH: [(f64, usize); 7] =
    [(0.1, 40), (0.0, 40), (-0.1, 30), (0.1, 60), (0.0, 20), (1.0, 20), (-0.2, 60)];

fn names(s: &[Segment]) -> Vec<&str> {
    s.iter().map(|s| s.name.as_str()).collect()
}

#[test]
fn a_rich_protocol_is_cut_at_its_corners_with_and_without_displacement_noise() {
    for sd in [0.0, 0.005] {
        let (t, u, ends) = protocol(&RICH, sd);
        let force: Vec<f64> = u.iter().map(|x| 0.2 * x + (x / 2.0).powi(4)).collect();
        let s = cut(&t, &u, &force, RecordKind::Intact);
        let want = [
            "toe",
            "load 1",
            "hold 1",
            "unload 1",
            "reload 1",
            "load 2",
            "hold 2",
            "rate change 1",
            "unload 2",
        ];
        assert_eq!(names(&s), want, "displacement noise {sd}: {s:?}");
        assert_eq!(s[0].range.start, 0);
        assert!(s.windows(2).all(|w| w[0].range.end == w[1].range.start));
        assert_eq!(s[s.len() - 1].range.end, t.len());
        for b in breaks(&t, &u) {
            assert!(ends.iter().any(|&e| b.abs_diff(e + 1) <= 2), "a break at {b}, corners at {ends:?}");
        }
        assert_eq!(breaks(&t, &u).len(), 6);
    }
}

#[test]
fn a_tear_has_onset_peak_plateau_and_tail() {
    let (t, u, _) = protocol(&[(0.1, 200)], 0.0);
    let force: Vec<f64> = u
        .iter()
        .map(|&x| {
            if x < 3.0 {
                x / 3.0
            } else if x < 7.0 {
                1.0 - 0.1 * (x - 3.0)
            } else {
                (0.6 - 0.4 * (x - 7.0)).max(0.0)
            }
        })
        .collect();
    let s = cut(&t, &u, &force, RecordKind::Tearing);
    assert_eq!(names(&s), ["load 1", "onset", "peak", "plateau", "tail"], "{s:?}");
}

/// Up to 1 in a hundred steps and down again at the same rate: each share of the peak is met by a point exactly.
#[test]
fn the_parts_of_a_tear_begin_at_their_shares_of_the_peak() {
    let (t, u, _) = protocol(&[(0.1, 180)], 0.0);
    let force: Vec<f64> = (0..=180).map(|i: i32| f64::from(i.min(200 - i)) / 100.0).collect();
    let s = cut(&t, &u, &force, RecordKind::Tearing);
    let said: Vec<_> = s.iter().map(|s| (s.name.as_str(), s.range.clone())).collect();
    let want = [
        ("toe", 0..5),
        ("load 1", 5..80),
        ("onset", 80..95),
        ("peak", 95..106),
        ("plateau", 106..151),
        ("tail", 151..181),
    ];
    assert_eq!(said, want);
}

/// A reloading ends where the largest displacement so far is met to within 0.2 % of the range.
#[test]
fn a_reloading_ends_just_below_what_was_reached() {
    let (t, u, _) = protocol(&[(16.0, 16), (-2.0, 8), (0.125, 180)], 0.0);
    let top = u[16];
    let s = cut(&t, &u, &u, RecordKind::Intact);
    let again = (25..u.len()).find(|&i| u[i] >= top - 2e-3 * top).unwrap();
    assert!((again..u.len()).filter(|&i| u[i] < top).count() >= 4, "points between");
    let reload = s.iter().find(|s| s.kind == SegmentKind::Reload).unwrap();
    assert_eq!(reload.range, 25..again, "{s:?}");
}

/// Noise of a third of what a step moves: corners within a few points, and no further ones.
#[test]
fn noise_of_the_displacement_makes_no_corners() {
    let (t, u, ends) = protocol(&[(0.1, 60), (0.0, 60), (-0.1, 50), (0.1, 80)], 0.015);
    let found = breaks(&t, &u);
    assert_eq!(found.len(), 3, "{found:?}");
    for (b, e) in found.iter().zip(&ends) {
        assert!(b.abs_diff(e + 1) <= 3, "{found:?} {ends:?}");
    }
}

#[test]
fn corners_without_noise_are_found_exactly() {
    let (t, u, ends) = protocol(&RICH, 0.0);
    let exact: Vec<usize> = ends[..6].iter().map(|e| e + 1).collect();
    assert_eq!(breaks(&t, &u), exact);
    // A change of rate by less than a quarter or so is none.
    let steps = |rate: f64| {
        breaks(&protocol(&[(0.1, 60), (rate, 60)], 0.0).0, &protocol(&[(0.1, 60), (rate, 60)], 0.0).1)
    };
    assert_eq!((steps(0.125), steps(0.135)), (vec![], vec![61]));
}

#[test]
fn degenerate_records_give_no_segments_and_no_panic() {
    assert!(cut(&[], &[], &[], RecordKind::Intact).is_empty());
    assert!(cut(&[0.0], &[0.0], &[0.0], RecordKind::Tearing).is_empty());
    let t: Vec<f64> = (0..20).map(f64::from).collect();
    let rest = cut(&t, &[0.0; 20], &[0.0; 20], RecordKind::Tearing);
    assert_eq!(names(&rest), ["hold 1"]);
    assert!(!cut(&t[..2], &[0.0, 1.0], &[0.0, 1.0], RecordKind::Tearing).is_empty());
}

#[test]
fn the_atlas_puts_the_misfit_where_it_is() {
    let (t, u, _) = protocol(&RICH, 0.0);
    let s = cut(&t, &u, &u, RecordKind::Intact);
    let hold = s.iter().find(|s| s.name == "hold 1").unwrap().range.clone();
    let mut random = Random::new(2);
    let r: Vec<f64> =
        (0..t.len()).map(|i| 0.1 * random.normal() - if hold.contains(&i) { 1.0 } else { 0.0 }).collect();
    let rows = atlas(&r, &s);
    assert!((rows.iter().map(|r| r.share).sum::<f64>() - 1.0).abs() < 1e-12);
    let row = rows.iter().find(|r| r.segment == "hold 1").unwrap();
    assert!(row.share > 0.9 && row.sign == '-' && row.durbin_watson < 0.2 && row.runs_p < 1e-6, "{row:?}");
    assert!((row.mean + 1.0).abs() < 0.05);
    let other = rows.iter().find(|r| r.segment == "unload 2").unwrap();
    assert!(other.runs_p > 1e-3 && (other.durbin_watson - 2.0).abs() < 0.6, "{other:?}");
    assert!(diagnose::words::place(&rows).contains("hold 1"));
    assert!(structure_p(&r) < 1e-6);
    assert!(structure_p(Random::new(3).normals(400).as_slice()) > 1e-3);
}

#[test]
fn misfits_by_the_position_of_the_tear() {
    let position: Vec<f64> = [vec![1.0; 30], (1..=80).map(|i| 1.0 + 0.05 * f64::from(i)).collect()].concat();
    let misfit: Vec<f64> = position.iter().map(|x| if (2.6..3.9).contains(x) { 1.0 } else { 0.0 }).collect();
    let rows = diagnose::atlas::atlas_by(&misfit, &position, 4);
    assert_eq!(rows.iter().map(|r| r.1.points).collect::<Vec<_>>(), [30, 20, 20, 20, 20]);
    assert!((rows[0].0[1] - 1.0).abs() < 1e-12 && (rows[4].0[1] - 5.0).abs() < 1e-12);
    assert!(rows[2].1.share + rows[3].1.share > 0.999 && rows[3].1.sign == '+', "{rows:?}");
    assert!(diagnose::atlas::atlas_by(&misfit, &[2.0; 110], 4).is_empty(), "no tear goes nowhere");
}

#[test]
fn what_the_misfit_depends_on_is_told_from_what_goes_along_with_it() {
    let (t, u, _) = protocol(&RICH, 0.0);
    let mut variables = protocol_variables(&t, &u, &u, &breaks(&t, &u));
    variables.push(Variable::new("constant", vec![1.0; t.len()]));
    let since = variables.iter().find(|v| v.name == "time since the last turn").unwrap().values.clone();
    let mut random = Random::new(5);
    let r: Vec<f64> = since.iter().map(|s| (-s / 4.0).exp() - 0.3 + 0.1 * random.normal()).collect();
    let rows = dependence(&r, &variables);
    assert_eq!(rows[0].variable, "time since the last turn", "{rows:?}");
    assert!(rows[0].share_beyond > 0.1 && rows[0].p_value < 1e-6, "{rows:?}");
    assert!(diagnose::words::depends(&rows).contains("time since the last turn"));
    let noise: Vec<f64> = (0..t.len()).map(|_| random.normal()).collect();
    let rows = dependence(&noise, &variables);
    assert!(rows.iter().all(|d| d.p_value > 1e-3 && d.share_beyond < 0.1), "{rows:?}");
    assert!(dependence(&[], &variables).iter().all(|d| d.p_value == 1.0));
}

#[test]
fn whole_segments_are_held_out_and_every_kind_is_still_trained_on() {
    let (t, u, _) = protocol(&RICH, 0.0);
    let s = cut(&t, &u, &u, RecordKind::Intact);
    let h = split(&s, t.len(), 0.25);
    let kept = h.mask.iter().filter(|&&m| m).count() as f64 / t.len() as f64;
    assert!((0.1..0.35).contains(&kept), "{kept} {:?}", h.segments);
    for name in &h.segments {
        let held = s.iter().find(|s| &s.name == name).unwrap();
        assert!(s.iter().any(|o| o.kind == held.kind && !h.segments.contains(&o.name)));
        assert!(h.mask[held.range.clone()].iter().all(|&m| m));
    }
    assert_eq!(h, split(&s, t.len(), 0.25));
    let one = vec![Segment { name: "load 1".into(), range: 0..100, kind: SegmentKind::Load }];
    assert_eq!(split(&one, 100, 0.25).mask.iter().filter(|&&m| m).count(), 20);
    assert!(split(&one, 100, 0.0).segments.is_empty());
}

proptest! {
    /// Whatever the protocol and however rough the force: segments tile the record, and pieces of motion do.
    #[test]
    fn segments_tile_the_record(
        steps in prop::collection::vec((prop::sample::select(vec![-0.2, -0.1, 0.0, 0.1, 0.5]), 3usize..40), 1..8),
        roughness in 0.0..0.3f64,
        tearing: bool,
    ) {
        let (t, u, _) = protocol(&steps, 0.0);
        let mut random = Random::new(5);
        let force: Vec<f64> = u.iter().map(|x| x.sin() + roughness * random.normal()).collect();
        let kind = if tearing { RecordKind::Tearing } else { RecordKind::Intact };
        let s = cut(&t, &u, &force, kind);
        prop_assert_eq!((s[0].range.start, s[s.len() - 1].range.end), (0, t.len()));
        prop_assert!(s.windows(2).all(|w| w[0].range.end == w[1].range.start), "{:?}", s);
    }
}
