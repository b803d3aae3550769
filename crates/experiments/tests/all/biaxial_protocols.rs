//! The five protocols of the sample: ratios of the stretches 1:1, 1:0.75, 0.75:1, 1:0.5, 0.5:1. Its records and the forces
//! of the model against the closed form of the homogeneous HGO sheet, slightly compressible as the model is.

use crate::common::run;
use experiments::{Biaxial, Experiment, Sample};

/// The tissue that the sample's records were made of: μ and k1 (MPa), k2, γ (°), κ, 2/D (MPa).
const TISSUE: [f64; 6] = [5.1e-3, 0.0388, 8.0, 35.0, 0.15, 20.0];
/// Length and width, thickness, mm.
const SHEET: [f64; 2] = [10.0, 1.0];
/// Largest displacement of the axis that goes farther, mm.
const FARTHEST: f64 = 2.0;
/// Noise of the sample, share of each peak force.
const NOISE: f64 = 0.005;
/// Name of the sample's record, and displacements of y and x as shares of the farthest.
const PROTOCOLS: [(&str, f64, f64); 5] = [
    ("y100_x100", 1.0, 1.0),
    ("y100_x75", 1.0, 0.75),
    ("y75_x100", 0.75, 1.0),
    ("y100_x50", 1.0, 0.5),
    ("y50_x100", 0.5, 1.0),
];

fn sample() -> Sample {
    Biaxial.sample().expect("a sample")
}

/// Derivatives of the energy per reference volume by the stretches along x, y and z, MPa: Gasser, Ogden & Holzapfel
/// 2006 with Ī1 and Ī4, and U(J) = (1/D)((J² − 1)/2 − ln J). Two families at ±γ to y in the plane.
fn slopes(stretches: [f64; 3]) -> [f64; 3] {
    let [mu, k1, k2, gamma, kappa, bulk] = TISSUE;
    let (sin, cos) = gamma.to_radians().sin_cos();
    let direction = [sin * sin, cos * cos, 0.0];
    let j: f64 = stretches.iter().product();
    let shrink = j.powf(-2.0 / 3.0);
    let i1: f64 = stretches.iter().map(|l| l * l).sum();
    let i4: f64 = stretches.iter().zip(direction).map(|(l, n)| l * l * n).sum();
    let e = (kappa * shrink * i1 + (1.0 - 3.0 * kappa) * shrink * i4 - 1.0).max(0.0);
    let fibres = 2.0 * k1 * e * (k2 * e * e).exp();
    std::array::from_fn(|i| {
        let l = stretches[i];
        let di1 = shrink * (2.0 * l - 2.0 / 3.0 * i1 / l);
        let di4 = shrink * (2.0 * l * direction[i] - 2.0 / 3.0 * i4 / l);
        let volume = 0.5 * bulk * (j * j - 1.0) / l;
        volume + 0.5 * mu * di1 + fibres * (kappa * di1 + (1.0 - 3.0 * kappa) * di4)
    })
}

/// Forces along y and x at displacements along y and x, N: the thickness is free of stress, by bisection.
fn closed_form([along, across]: [f64; 2]) -> [f64; 2] {
    let [side, thickness] = SHEET;
    let (x, y) = (1.0 + across / side, 1.0 + along / side);
    let (mut low, mut high) = (0.9 / (x * y), 1.1 / (x * y));
    for _ in 0..100 {
        let z = 0.5 * (low + high);
        if slopes([x, y, z])[2] > 0.0 { high = z } else { low = z }
    }
    let [px, py, _] = slopes([x, y, 0.5 * (low + high)]);
    [py, px].map(|stress| stress * side * thickness)
}

/// The numbers of a record, row by row: t, u, F, u_x, F_x.
fn rows(record: &str) -> Vec<[f64; 5]> {
    let numbers = record.lines().filter(|l| l.starts_with(|c: char| c.is_ascii_digit()));
    let row = |l: &str| -> Vec<f64> { l.split(',').map(|v| v.parse().expect("a number")).collect() };
    numbers.map(|l| row(l).try_into().expect("five columns")).collect()
}

#[test]
fn both_forces_of_every_protocol_are_those_of_the_closed_form() {
    let [mu, k1, k2, gamma, kappa, bulk] = TISSUE;
    let [side, thickness] = SHEET;
    for (name, y, x) in PROTOCOLS {
        let text = format!(
            "name = \"sheet\"\n[geometry]\nlength_mm = {side}\nwidth_mm = {side}\nthickness_mm = {thickness}\n\
             [[tests]]\nkind = \"biaxial\"\nprotocol = [{{ to_mm = {}, rate_mm_per_s = 0.05 }}]\nratio_x = {}\n\
             [bulk]\nmu_MPa = {mu}\nk1_MPa = {k1}\nk2 = {k2}\ngamma_deg = {gamma}\nkappa = {kappa}\n\
             bulk_modulus_MPa = {bulk}\n",
            y * FARTHEST,
            x / y
        );
        let test = run(&text);
        let [across, force_x] = &test.across;
        let largest = closed_form([y * FARTHEST, x * FARTHEST]);
        let mut worst = [0.0f64; 2];
        for k in 0..test.force.len() {
            let exact = closed_form([test.displacement[k], across[k]]);
            for (i, found) in [test.force[k], force_x[k]].into_iter().enumerate() {
                worst[i] = worst[i].max((found - exact[i]).abs() / largest[i]);
            }
        }
        println!("{name}: largest forces {largest:.4?} N, off by {:.0e} and {:.0e}", worst[0], worst[1]);
        assert!(worst.iter().all(|w| *w < 1e-6), "{name}: {worst:?}");
    }
}

#[test]
fn the_records_of_the_sample_are_the_closed_form_and_their_noise() {
    let sample = sample();
    assert_eq!(sample.records.len(), PROTOCOLS.len());
    for ((file, record), (name, y, x)) in sample.records.iter().zip(PROTOCOLS) {
        assert_eq!(*file, format!("{name}.csv"));
        assert!(sample.specimen.contains(&format!("data = \"{file}\"")), "{file}");
        let rows = rows(record);
        let farthest = rows.iter().fold(0.0f64, |m, r| m.max(r[1]));
        assert!((farthest - y * FARTHEST).abs() < 1e-6, "{file}: {farthest}");
        assert!(rows.iter().all(|r| (r[3] - r[1] * x / y).abs() < 1e-6), "{file}: one ratio");
        let peaks = closed_form([y * FARTHEST, x * FARTHEST]);
        for (axis, peak) in peaks.into_iter().enumerate() {
            let off = |r: &[f64; 5]| (r[2 + 2 * axis] - closed_form([r[1], r[3]])[axis]) / (NOISE * peak);
            let squares: f64 = rows.iter().map(|r| off(r).powi(2)).sum();
            let share = (squares / rows.len() as f64).sqrt();
            println!("{file}, {}: rms {share:.2} of the noise over {} rows", ["y", "x"][axis], rows.len());
            // Three standard deviations of the rms of so many normal deviates.
            assert!((share - 1.0).abs() < 3.0 / (2.0 * rows.len() as f64).sqrt(), "{file}: {share}");
        }
    }
}
