//! Long records averaged: corners and holds exact, nothing lost, means as sure as the record's noise allows.

use analysis::{Measured, condensed};
use input::{Case, Record};
use inverse::Random;
use model::{Discretisation, Model, corners_of_record};
use std::fmt::Write as _;
use std::path::Path;
use std::sync::Arc;

const LEGS: [(f64, f64); 6] = [(0.0, 0.0), (20.0, 1.0), (80.0, 1.0), (90.0, 0.4), (100.0, 1.0), (140.0, 2.5)];
const SD: f64 = 0.01;

fn force(t: f64, u: f64) -> f64 {
    0.3 * ((0.8 * u).exp() - 1.0)
        + if (20.0..80.0).contains(&t) { 0.1 * (-(t - 20.0) / 15.0).exp() } else { 0.0 }
}

/// A case with one record of `n` rows; the noise of the force is that of `independent` rows, the rest interpolated.
fn case(folder: &Path, n: usize, independent: usize, frames: usize) -> Arc<Case> {
    let mut random = Random::new(12);
    let errors: Vec<f64> = (0..independent + 1).map(|_| SD * random.normal()).collect();
    let mut csv = String::from("time_s,displacement_mm,force_N,grip_displacement_mm\n");
    for i in 0..n {
        let t = 140.0 * i as f64 / (n - 1) as f64;
        let leg = LEGS.windows(2).find(|w| t <= w[1].0).expect("a leg");
        let u = leg[0].1 + (t - leg[0].0) / (leg[1].0 - leg[0].0) * (leg[1].1 - leg[0].1);
        let place = i as f64 * (independent - 1) as f64 / (n - 1) as f64;
        let (k, s) = (place.floor() as usize, place.fract());
        let error = (1.0 - s) * errors[k] + s * errors[k + 1];
        let shake = if i == 0 { 0.0 } else { 2e-4 * random.normal() };
        let camera = if i % frames == 0 { format!("{}", 0.9 * u) } else { String::new() };
        let _ = writeln!(csv, "{t:.8},{:.8},{:.8},{camera}", u + shake, force(t, u) + error);
    }
    std::fs::write(folder.join("u.csv"), csv).expect("written");
    let text = "name = \"x\"\n[geometry]\nlength_mm = 6.0\nwidth_mm = 4.0\nthickness_mm = 0.8\ncut_mm = 1.0\n\
                [[tests]]\nkind = \"uniaxial\"\ndata = \"u.csv\"\ngrip_displacement_sd_mm = 0.01\n[mesh]\ndivisions = [4, 4, 1]\n";
    std::fs::write(folder.join("c.toml"), text).expect("written");
    Arc::new(input::read_case(&folder.join("c.toml"), &effects::catalogue()).expect("a good file"))
}

fn record(case: &Case) -> &Record {
    case.tests[0].record.as_ref().expect("a record")
}

fn noise(case: &Arc<Case>) -> inverse::NoiseModel {
    let model = Model::new(case.clone(), &effects::catalogue(), Discretisation::default()).expect("a model");
    Measured::of(&model, &[true]).expect("data").data.blocks[0].noise.clone()
}

#[test]
fn short_records_stay_as_they_are() {
    let folder = tempfile::tempdir().expect("a folder");
    let short = case(folder.path(), 800, 800, 1);
    assert!(Arc::ptr_eq(&short, &condensed(&short)));
}

#[test]
fn corners_and_holds_are_exact_and_every_row_counts_once() {
    let folder = tempfile::tempdir().expect("a folder");
    let whole = case(folder.path(), 30_000, 30_000, 1);
    let points = condensed(&whole);
    let r = record(&points);
    assert!((380..600).contains(&r.len()), "{}", r.len());
    let averaged = r.averaged.as_ref().expect("averaged");
    assert_eq!((averaged.rows, averaged.channels[0].readings.iter().sum::<usize>()), (30_000, 30_000));
    let corners: Vec<(f64, f64)> = corners_of_record(r).iter().map(|c| (c.time, c.displacement)).collect();
    assert_eq!(corners.len(), LEGS.len(), "{corners:?}");
    for (c, leg) in corners.iter().zip(LEGS) {
        assert!((c.0 - leg.0).abs() < 0.05 && (c.1 - leg.1).abs() < 1e-3, "{c:?} {leg:?}");
    }
    let held: Vec<f64> =
        (0..r.len()).filter(|&i| (20.1..79.9).contains(&r.time[i])).map(|i| r.displacement[i]).collect();
    assert!(held.len() > 20 && held.iter().all(|u| *u == held[0]));
    // Twice is once.
    assert!(Arc::ptr_eq(&points, &condensed(&points)));
}

#[test]
fn means_are_as_sure_as_the_noise_allows() {
    let folder = tempfile::tempdir().expect("a folder");
    let white = condensed(&case(folder.path(), 30_000, 30_000, 1));
    let r = record(&white);
    let found = noise(&white);
    let usual = found.readings.iter().position(|x| *x == 1.0).expect("a usual point");
    let readings = r.averaged.as_ref().expect("averaged").channels[0].readings[usual] as f64;
    assert!((found.sd / (SD / readings.sqrt()) - 1.0).abs() < 0.15, "{} for {readings} readings", found.sd);
    // Each point misses the truth by its own sd.
    let square: f64 = (0..r.len())
        .map(|i| ((r.force[i] - force(r.time[i], r.displacement[i])) / found.sd_of(i)).powi(2))
        .sum();
    let n = r.len() as f64;
    assert!((square / n - 1.0).abs() < 0.25, "{}", square / n);
    // Errors that 300 rows would have do not average out.
    let slow = noise(&condensed(&case(folder.path(), 30_000, 300, 1)));
    assert!(slow.sd > 0.5 * SD, "{}", slow.sd);
}

#[test]
fn a_slow_camera_is_read_at_the_times_of_the_points() {
    let folder = tempfile::tempdir().expect("a folder");
    let points = condensed(&case(folder.path(), 30_000, 30_000, 37));
    let r = record(&points);
    let camera = r.grip_displacement.as_ref().expect("a camera");
    let seen: Vec<(f64, f64)> =
        camera.iter().zip(&r.displacement).filter_map(|(c, u)| c.map(|c| (c, 0.9 * u))).collect();
    assert!(seen.len() > 300, "{}", seen.len());
    let worst = seen.iter().fold(0.0f64, |m, (c, u)| m.max((c - u).abs()));
    assert!(worst < 3e-3, "{worst}");
}
