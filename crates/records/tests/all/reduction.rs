//! Long records become few points that say the same, with a noise that is that of the points.

use crate::common;

use common::import;
use records::Test;
use std::fmt::Write;

/// Numbers like noise, the same every time.
fn noise(n: usize) -> Vec<f64> {
    let mut seed = 42_u64;
    let mut uniform = || {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (seed >> 11) as f64 / (1_u64 << 53) as f64
    };
    (0..n).map(|_| (0..12).map(|_| uniform()).sum::<f64>() - 6.0).collect()
}

/// Displacement and force without noise: up in 40 s, 60 s of relaxation, down in 40 s.
fn truth(t: f64) -> (f64, f64) {
    let u = if t < 40.0 {
        0.05 * t
    } else if t < 100.0 {
        2.0
    } else {
        2.0 - 0.05 * (t - 100.0)
    };
    let elastic = 0.05 * ((1.5 * u).exp() - 1.0);
    let relaxed = if t < 40.0 { 1.0 } else { 0.8 + 0.2 * (-(t - 40.0) / 12.0).exp() };
    (u, elastic * relaxed)
}

/// A record with `rate` rows a second, and its import.
fn imported(rate: f64, sd: f64, points: &str) -> (Vec<[f64; 3]>, Test) {
    let n = (140.0 * rate) as usize + 1;
    let errors = noise(2 * n);
    let mut text = String::from("Time [s],Extension [mm],Load [N]\n");
    let mut rows = Vec::new();
    for i in 0..n {
        let t = i as f64 / rate;
        let (u, f) = truth(t);
        let row = [t, u + 2e-4 * errors[n + i], f + sd * errors[i]];
        let _ = writeln!(text, "{},{},{}", row[0], row[1], row[2]);
        rows.push(row);
    }
    let mut read = import("a.csv", text.as_bytes(), &[("points", points)]).expect("read");
    (rows, read.tests.remove(0))
}

/// A column that counts rows names no segments; one that counts the legs of a protocol does.
#[test]
fn a_count_of_rows_is_no_name() {
    let segments = |leg: usize| {
        let mut text = String::from("Time [s],Extension [mm],Load [N],Step\n");
        for i in 0..2500_usize {
            let t = i as f64 / 25.0;
            let _ = writeln!(text, "{t},{},{},{}", 0.02 * t, 0.001 * t, i / leg + 1);
        }
        import("a.csv", text.as_bytes(), &[]).expect("read").tests[0].segments.clone()
    };
    assert_eq!(segments(1000), ["1", "2", "3"]);
    assert!(segments(1).is_empty());
}

#[test]
fn points_keep_turns_and_average_the_rest() {
    let sd = 0.004;
    let (rows, test) = imported(150.0, sd, "400");
    let (points, made) = (test.reduced.as_ref().expect("reduced"), test.reduction.as_ref().expect("reduced"));
    assert!((300..=400).contains(&points.time.len()), "{made:?}");
    assert_eq!(test.full.time.len(), rows.len());
    assert!(points.time.windows(2).all(|w| w[1] > w[0]));
    // Turns and the ends of the hold are rows of the file.
    for corner in [0.0, 40.0, 100.0, 140.0] {
        let is_row = |k: usize| rows.iter().any(|r| r[0] == points.time[k] && r[1] == points.displacement[k]);
        let near = |k: &usize| (points.time[*k] - corner).abs() < 0.15;
        assert!((0..points.time.len()).filter(near).any(is_row), "{corner}");
    }
    // The hold is spaced by the logarithm of its time.
    let hold: Vec<f64> = points.time.iter().copied().filter(|t| *t > 40.2 && *t < 99.8).collect();
    assert!(hold.len() >= 20 && hold.len() <= 60, "{} {made:?} {hold:?}", hold.len());
    assert!(hold[1] - hold[0] < 0.2 * (hold[hold.len() - 1] - hold[hold.len() - 2]), "{hold:?}");
    // One standard deviation for all points, and it is theirs.
    let declared = test.force_sd_of_points.expect("reduced");
    assert!((test.force_sd_of_rows / sd - 1.0).abs() < 0.05, "{}", test.force_sd_of_rows);
    assert!((declared / (sd / (made.rows_per_point as f64).sqrt()) - 1.0).abs() < 0.2, "{declared}");
    let misfit = |k: usize| (points.force[k] - truth(points.time[k]).1) / declared;
    let chi2 = (0..points.time.len()).map(|k| misfit(k).powi(2)).sum::<f64>() / points.time.len() as f64;
    assert!((0.75..1.3).contains(&chi2), "reduced χ² {chi2} of the points against the truth");
    let worst = (0..points.time.len()).map(misfit).fold(0.0_f64, |m, x| m.max(x.abs()));
    assert!(worst < 5.0, "a point is {worst} standard deviations off");
}

/// Points go where the displacement and the force change, half by each; what stands long takes no rows from a mean.
#[test]
fn points_go_where_something_changes() {
    // Two legs of equal length, nine tenths of the force in the first; between them a rest as long as both.
    let row = |i: usize| match i {
        0..=2000 => (i as f64 / 1000.0, 9.0 * i as f64 / 2000.0),
        2001..=5999 => (2.0, 9.0),
        _ => (2.0 + (i - 6000) as f64 / 1000.0, 9.0 + (i - 6000) as f64 / 2000.0),
    };
    let mut text = String::from("Time [s],Extension [mm],Load [N]\n");
    for i in 0..=8000 {
        let (u, f) = row(i);
        let _ = writeln!(text, "{},{u},{f}", i as f64 / 10.0);
    }
    let test = import("a.csv", text.as_bytes(), &[("points", "200")]).expect("read").tests.remove(0);
    let (points, made) = (test.reduced.expect("reduced"), test.reduction.expect("reduced"));
    let between = |a: f64, b: f64| points.time.iter().filter(|t| **t > a && **t < b).count() as f64;
    let (first, last) = (between(1.0, 199.0), between(601.0, 799.0));
    // 0.7 and 0.3 of the points for motions; the first leg has rows for 80 means at most.
    assert!((75.0..=81.0).contains(&first) && (38.0..50.0).contains(&last), "{first} and {last} points");
    // 4000 rows in motion fill what holds leave of 200 points; an even share of all would be 40.
    assert!((20..=30).contains(&made.rows_per_point), "{made:?}");
}

#[test]
fn short_records_stay_as_they_are() {
    let (rows, test) = imported(2.0, 0.004, "400");
    assert!(test.reduced.is_none() && test.force_sd_of_points.is_none());
    assert_eq!(test.full.force, rows.iter().map(|r| r[2]).collect::<Vec<_>>());
    // A little longer: rows are picked, not averaged.
    let (rows, test) = imported(4.0, 0.004, "400");
    let points = test.reduced.expect("reduced");
    assert!(points.force.iter().all(|f| rows.iter().any(|r| r[2] == *f)));
    assert_eq!(test.force_sd_of_points, Some(test.force_sd_of_rows));
}

#[test]
fn a_tear_stays_sharp() {
    let mut text = String::from("Time [s],Extension [mm],Load [N]\n");
    let errors = noise(30_000);
    for i in 0..30_000_i32 {
        let t = f64::from(i) / 100.0;
        let f = if i < 20_000 { t } else { 10.0 + 0.01 * t };
        let _ = writeln!(text, "{t},{},{}", 0.01 * t, f + 0.1 * errors[i as usize]);
    }
    let read = import("a.csv", text.as_bytes(), &[("points", "400")]).expect("read");
    let points = read.tests[0].reduced.as_ref().expect("reduced");
    let between = points.force.iter().filter(|f| **f > 62.0 && **f < 198.0);
    let on_the_ramp =
        points.time.iter().zip(&points.force).filter(|(t, f)| **f > 62.0 && (**t - **f).abs() < 0.2).count();
    assert_eq!(between.count(), points.time.iter().filter(|t| **t > 62.0 && **t < 198.0).count());
    assert!(on_the_ramp > 100);
    assert!(points.force.iter().any(|f| (*f - 200.0).abs() < 0.3), "the peak is cut off");
}

/// Times: `just long-records`.
#[test]
#[ignore = "a million rows: run by `just long-records`"]
fn a_million_rows_take_seconds() {
    let started = std::time::Instant::now();
    let (_, test) = imported(7_200.0, 0.004, "400");
    println!(
        "{} rows, {} points: {:?} with the writing of the test",
        test.full.time.len(),
        test.reduced.expect("reduced").time.len(),
        started.elapsed()
    );
    assert!(started.elapsed().as_secs() < 20);
}
