//! Shares of intervals that hold, and p-values against the uniform distribution.

use crate::Coverage;
use statrs::distribution::Uniform;
use statrs::statistics::Statistics;
use statrs::stats_tests::NaNPolicy;
use statrs::stats_tests::ks_test::{KSOneSampleAlternativeMethod, ks_onesample};
use std::collections::BTreeMap;

/// Per identifiable parameter the share of intervals that hold the truth.
pub fn intervals(said: &[Coverage]) {
    let mut holds: BTreeMap<&str, Vec<bool>> = BTreeMap::new();
    said.iter().flat_map(|s| &s.holds).for_each(|(p, h)| holds.entry(p).or_default().push(*h));
    let mut distances: BTreeMap<&str, Vec<f64>> = BTreeMap::new();
    said.iter().flat_map(|s| &s.distances).for_each(|(p, z)| distances.entry(p).or_default().push(*z));
    let (mut all, mut within) = (0, 0);
    for (path, h) in &holds {
        let inside = h.iter().filter(|h| **h).count();
        (all, within) = (all + h.len(), within + inside);
        let z = distances.get(path).map_or(&[][..], Vec::as_slice);
        println!(
            "  {path:32} {inside:4} of {:4} ({:.1} %); in standard errors from the truth: mean {:.2}, sd {:.2}",
            h.len(),
            100.0 * inside as f64 / h.len() as f64,
            z.mean(),
            z.std_dev()
        );
    }
    println!("  all identifiable parameters: {:.1} %", 100.0 * within as f64 / all as f64);
}

/// Number of p-values below `top`, and the Kolmogorov–Smirnov p-value that they are uniform there.
fn ks(p: &[f64], top: f64) -> (usize, f64) {
    let below: Vec<f64> = p.iter().copied().filter(|&v| v < top).collect();
    let uniform = Uniform::new(0.0, top).expect("an interval");
    let method = KSOneSampleAlternativeMethod::TwoSidedAsymptotic;
    let n = below.len();
    (n, ks_onesample(below, &uniform, method, NaNPolicy::Error).map_or(f64::NAN, |(_, p)| p))
}

/// Each effect's p-values against the uniform distribution.
pub fn p_values(said: &[Coverage], which: usize) {
    let mut p: BTreeMap<&str, Vec<f64>> = BTreeMap::new();
    said.iter().flat_map(|s| &s.p_values[which]).for_each(|(e, v)| p.entry(e).or_default().push(*v));
    let (mut tested, mut uniform) = (0, 0);
    for (effect, values) in &p {
        let small = values.iter().filter(|v| **v <= 0.05).count() as f64 / values.len() as f64;
        let (n, ks) = ks(values, 0.45);
        if ks.is_finite() {
            (tested, uniform) = (tested + 1, uniform + usize::from(ks >= 0.05));
        }
        println!("    {effect:26} p ≤ 0.05 in {:4.1} %; below 0.45: {n:3}, KS p = {ks:.3}", 100.0 * small);
    }
    println!("    {uniform} of {tested} pass the Kolmogorov–Smirnov test at 0.05");
}
