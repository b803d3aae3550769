//! Whether 95 % intervals hold the truth in 95 % of repeats, and whether p-values of the screen are uniform where no
//! effect is hidden, with finite elements from records to intervals: `just coverage`, or
//! `cargo run --release -p analysis --example coverage -- 200` for 200 repeats each of white and AR(1) noise; a second
//! number is the noise as a share of each record's peak (0.01), a third the elements along and across the strip (12), a
//! fourth the strength in MPa (0.08): a weaker tear has a longer process zone, which the mesh resolves better.
//!
//! A repeat is a record of the fit's own model at the truth plus drawn noise plus the drawn multiple of its
//! numerical error (difference to a mesh twice as coarse) that the intervals assume. Noise levels are estimated
//! from each record. The means of a screen's priors are drawn as these assume: what the file gives for the tissue, and
//! priors of each area. A Kolmogorov–Smirnov test judges the p-values below 0.45: a one-sided test answers 1 whenever
//! the sign is wrong. They are judged twice, with the noise as estimated and with the sceptic's that a search assumes.
use analysis::{Control, FeLadder, FeProblem, Identified, Measured};
use diagnose::{Hints, Ladder, Policy, Screen};
use input::{Case, Prior};
use inverse::{Noise, Problem, Random, Whitened};
use model::{Discretisation, Model};
use nalgebra::DVector;
use params::Quantity;
use rayon::prelude::*;
use statrs::distribution::Uniform;
use statrs::statistics::Statistics;
use statrs::stats_tests::NaNPolicy;
use statrs::stats_tests::ks_test::{KSOneSampleAlternativeMethod, ks_onesample};
use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::Path;
use std::sync::Arc;

const CONFIG: &str = r#"
name = "coverage"
provenance = "synthetic"
[geometry]
length_mm = 8.0
width_mm = 6.0
thickness_mm = 0.8
cut_mm = 1.5
[[tests]]
kind = "uniaxial"
data = "uniaxial.csv"
[[tests]]
kind = "tearing"
data = "tearing.csv"
[mesh]
divisions = [DIVISIONS, DIVISIONS, 1]
[bulk]
mu_kPa = { start = 6.0, fixed = true }
k1_kPa = 700.0
k2 = 15.0
gamma_deg = { start = 42.0, fixed = true }
kappa = { start = 0.22, fixed = true }
[interface]
areas = 2
gc_N_per_mm = 0.15
sigma_c_MPa = STRENGTH
[identify]
mode = "joint"
"#;

/// Elements along and across the strip, unless the command line says otherwise.
const DIVISIONS: usize = 12;

/// Of the tear the file of a fit gives this share of the truth.
const START: f64 = 0.8;
/// What it gives of the tissue is drawn around the truth, with the spread of a screen's priors.
const TISSUE: [(&str, f64); 2] = [("k1_kPa", 700.0), ("k2", 15.0)];
const SPREAD: f64 = 0.5;
/// Strength, MPa, unless the command line says otherwise.
const STRENGTH: f64 = 0.08;

/// Noise of each record as a share of its peak, unless the command line says otherwise.
const NOISE: f64 = 0.01;
/// Correlations of the noise.
const AR1: [f64; 2] = [0.0, 0.5];

/// Displacement corners of the two protocols, and points of each leg.
const UNIAXIAL: &[f64] = &[0.0, 1.0, 0.2, 2.0];
const TEARING: &[f64] = &[0.0, 2.0, 1.0, 3.5, 1.5, 5.0];
const POINTS: usize = 60;

fn schedule(corners: &[f64]) -> Vec<f64> {
    let leg =
        |w: &[f64]| (0..POINTS).map(|i| w[0] + (w[1] - w[0]) * i as f64 / POINTS as f64).collect::<Vec<_>>();
    corners.windows(2).flat_map(leg).chain(corners.last().copied()).collect()
}

/// The case with these forces, tests one after the other.
fn case(folder: &Path, forces: &[f64], config: &str) -> Case {
    let mut at = 0;
    for (name, corners) in [("uniaxial.csv", UNIAXIAL), ("tearing.csv", TEARING)] {
        let mut text = String::from("time_s,displacement_mm,force_N\n");
        let mut clock = 0.0;
        let u = schedule(corners);
        for (i, x) in u.iter().enumerate() {
            clock += if i > 0 { (x - u[i - 1]).abs() / 0.05 } else { 0.0 };
            let _ = writeln!(text, "{clock},{x},{:.17e}", forces[at]);
            at += 1;
        }
        std::fs::write(folder.join(name), text).expect("a record");
    }
    std::fs::write(folder.join("case.toml"), config).expect("a config");
    input::read_case(&folder.join("case.toml"), &effects::catalogue()).unwrap_or_else(|e| panic!("{e}"))
}

/// The model of a file, and its forces at the values there.
fn clean(case: &Case) -> (Model, DVector<f64>) {
    let model = Model::new(Arc::new(case.clone()), &effects::catalogue(), Discretisation::default())
        .expect("a model");
    let measured = Measured::of(&model, &[true, true]).expect("data");
    let options = analysis::run_options(case);
    let problem = FeProblem::new(&model, model.theta(), Vec::new(), &measured.slots, options, &|| false);
    let forces = problem.predict(&[], false).expect("a run").values;
    drop(problem);
    (model, forces)
}

fn identify(case: &Case) -> Identified {
    let control = Control { progress: &|_| {}, cancelled: &|| false };
    analysis::identify(Arc::new(case.clone()), &effects::catalogue(), &control)
        .unwrap_or_else(|e| panic!("{e}"))
}

/// What one repeat says: per identifiable parameter whether its interval holds the truth and how far it is from it, per
/// effect its p-value.
struct Said {
    holds: Vec<(String, bool)>,
    /// Distances from the truth in standard errors.
    distances: Vec<(String, f64)>,
    /// With the noise as estimated, and with a sceptic's.
    p_values: [Vec<(String, f64)>; 2],
    alarm: bool,
}

/// What is studied.
struct Study {
    noise: f64,
    divisions: usize,
    strength: f64,
}

impl Study {
    fn of_command_line() -> Self {
        let number = |n: usize| std::env::args().nth(n).and_then(|n| n.parse().ok());
        Self {
            noise: number(2).unwrap_or(NOISE),
            divisions: number(3).map_or(DIVISIONS, |n| n as usize),
            strength: number(4).unwrap_or(STRENGTH),
        }
    }

    /// The config with the tear at a share of the truth and the tissue so many standard deviations from it.
    fn config(&self, tear: f64, off: [f64; 2]) -> String {
        let text = CONFIG
            .replace("DIVISIONS", &self.divisions.to_string())
            .replace("STRENGTH", &(self.strength * tear).to_string())
            .replace("gc_N_per_mm = 0.15", &format!("gc_N_per_mm = {}", 0.15 * tear));
        TISSUE.iter().zip(off).fold(text, |text, ((key, truth), z)| {
            text.replace(&format!("{key} = {truth:.1}"), &format!("{key} = {}", truth * (SPREAD * z).exp()))
        })
    }
}

/// Gives each area of a tear priors, drawn as they assume.
fn draw_priors(case: &mut Case, truth: &BTreeMap<String, f64>, random: &mut Random) {
    for (path, truth) in truth.iter().filter(|(path, _)| path.starts_with("interface.")) {
        let mean = truth * (SPREAD * random.normal()).exp();
        let relative_sd = (SPREAD * SPREAD).exp_m1().sqrt();
        let quantity = if path.ends_with("gc") { Quantity::FractureEnergy } else { Quantity::Stress };
        case.identify.priors.given.insert(path.clone(), Prior { mean, relative_sd, quantity });
    }
}

fn repeat(
    seed: u64,
    (study, ar1): (&Study, f64),
    clean: &DVector<f64>,
    error: &DVector<f64>,
    truth: &BTreeMap<String, f64>,
) -> Said {
    let mut random = Random::new(seed);
    let mut forces = clean.clone();
    let (n, m) = (schedule(UNIAXIAL).len(), schedule(TEARING).len());
    for (start, len) in [(0, n), (n, m)] {
        let sd = study.noise * clean.rows(start, len).amax();
        let factor = random.normal();
        let drawn = random.ar1(len, sd, ar1) + factor * error.rows(start, len);
        let mut rows = forces.rows_mut(start, len);
        rows += drawn;
    }
    let folder = tempfile::tempdir().expect("a folder");
    let off = [random.normal(), random.normal()];
    let mut case = case(folder.path(), forces.as_slice(), &study.config(START, off));
    let found = identify(&case);
    let estimates = &found.uncertainty.estimates;
    let holds = found
        .frees
        .iter()
        .zip(estimates)
        .filter(|(_, e)| e.identifiable)
        .map(|(f, e)| {
            (f.path.clone(), e.interval_95[0] <= truth[&f.path] && truth[&f.path] <= e.interval_95[1])
        })
        .collect();
    let distances = found
        .frees
        .iter()
        .zip(estimates)
        .filter(|(_, e)| e.identifiable)
        .filter_map(|(f, e)| Some((f.path.clone(), (e.value - truth[&f.path]) / e.std_error?)))
        .collect();
    if std::env::var("V").is_ok() {
        let own = (&found.numerical_error - error).norm() / error.norm();
        println!("own error differs {own:.2}; intervals led by it: {:?}", found.led_by_mesh);
        println!("repeat {seed}: chi2 {:.3} stops {:?}", found.quality.reduced_chi2_total, found.stopped);
        for ((f, e), i) in found.frees.iter().zip(estimates).zip(&found.free) {
            println!(
                "   {} {:.5e} {:?} truth {:.5e}",
                f.path, found.theta[*i], e.interval_95, truth[&f.path]
            );
        }
    }
    let values: Vec<(String, f64)> =
        found.frees.iter().zip(&found.free).map(|(f, &i)| (f.path.clone(), found.theta[i])).collect();
    analysis::start_at(&mut case, values.iter().map(|(p, v)| (p.as_str(), *v)));
    draw_priors(&mut case, truth, &mut random);
    let catalogue = effects::catalogue();
    let quiet = |_: &str| {};
    let mut ladder = FeLadder::new(
        Arc::new(case),
        analysis::How {
            catalogue: &catalogue,
            policy: Policy::default(),
            progress: &quiet,
            cancelled: &|| false,
        },
    )
    .expect("a ladder");
    let base = ladder.fit(&[], &Hints::new()).unwrap_or_else(|e| panic!("{e}"));
    let screen = ladder.screen(&base).unwrap_or_else(|e| panic!("{e}"));
    let p_values = [&trusting(&ladder), &screen].map(|screen| {
        screen.findings.iter().filter(|f| !f.refit_only).map(|f| (f.effect.clone(), f.p_value)).collect()
    });
    Said { holds, distances, p_values, alarm: screen.findings.iter().any(|f| f.significant) }
}

/// The latest screen again, with the noise as estimated from the record instead of a sceptic's.
fn trusting(ladder: &FeLadder) -> Screen {
    let base = &ladder.rungs[&Vec::new()];
    let estimated = Measured::of(&base.model, &base.model.recorded()).expect("data").data;
    let mut data = ladder.measured.data.clone();
    for (block, estimate) in data.blocks.iter_mut().zip(&estimated.blocks) {
        (block.noise.sd, block.noise.ar1) = (estimate.noise.sd, estimate.noise.ar1);
    }
    let white = Whitened::new(&data, &base.frees, &base.fit.theta, &base.fit.prediction, Noise::Total);
    diagnose::screen(&white, &base.fit.at_bound, &ladder.candidates, data.points(), &Policy::default())
        .expect("a screen")
}

/// Number of p-values below `top`, and the Kolmogorov–Smirnov p-value that they are uniform there.
fn ks(p: &[f64], top: f64) -> (usize, f64) {
    let below: Vec<f64> = p.iter().copied().filter(|&v| v < top).collect();
    let uniform = Uniform::new(0.0, top).expect("an interval");
    let method = KSOneSampleAlternativeMethod::TwoSidedAsymptotic;
    let n = below.len();
    (n, ks_onesample(below, &uniform, method, NaNPolicy::Error).map_or(f64::NAN, |(_, p)| p))
}

fn main() {
    let repeats: u64 = std::env::args().nth(1).and_then(|n| n.parse().ok()).unwrap_or(200);
    let study = Study::of_command_line();
    let folder = tempfile::tempdir().expect("a folder");
    let points = schedule(UNIAXIAL).len() + schedule(TEARING).len();
    let placeholder: Vec<f64> = (0..points).map(|i| 1.0 + (i % 7) as f64).collect();
    let (model, clean) = clean(&case(folder.path(), &placeholder, &study.config(1.0, [0.0; 2])));
    let known = identify(&case(folder.path(), clean.as_slice(), &study.config(START, [-0.7, -0.4])));
    let at = |f: &inverse::Free| model.find(&f.path).map(|i| (f.path.clone(), model.theta()[i]));
    let truth: BTreeMap<String, f64> = known.frees.iter().filter_map(at).collect();
    for (start, len) in [(0, schedule(UNIAXIAL).len()), (schedule(UNIAXIAL).len(), schedule(TEARING).len())] {
        let sd = study.noise * clean.rows(start, len).amax();
        let rms = known.numerical_error.rows(start, len).norm() / (len as f64).sqrt();
        println!("numerical error: {:.2} of the noise (root mean square)", rms / sd);
    }
    for ar1 in AR1 {
        let said: Vec<Said> = (0..repeats)
            .into_par_iter()
            .map(|k| repeat(1000 + k, (&study, ar1), &clean, &known.numerical_error, &truth))
            .collect();
        println!(
            "noise {} % of peak, AR(1) {ar1}, {1} × {1} elements, strength {2} MPa, {repeats} repeats",
            100.0 * study.noise,
            study.divisions,
            study.strength
        );
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
        println!("  records with a significant effect: {}", said.iter().filter(|s| s.alarm).count());
        for (which, name) in ["estimated noise", "a sceptic's noise"].iter().enumerate() {
            println!("  p-values with {name}:");
            print_p_values(&said, which);
        }
    }
}

/// Each effect's p-values against the uniform distribution.
fn print_p_values(said: &[Said], which: usize) {
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
