//! Whether 95 % intervals hold the truth in 95 % of repeats, and whether p-values of the screen are uniform where no
//! effect is hidden, with finite elements from records to intervals: `just coverage`, or
//! `cargo run --release -p analysis --example coverage -- 200` for 200 repeats each of white and AR(1) noise; a second
//! number is the noise as a share of each record's peak (0.01), a third the elements along and across the strip (12), a
//! fourth the strength in MPa (0.08): a weaker tear has a longer process zone, which the mesh resolves better; a fifth the
//! displacement in mm that the tear is pulled to (5), which a weaker one needs more of; a sixth
//! one correlation of the noise instead of both.
//!
//! A repeat is a record of the fit's own model at the truth plus drawn noise plus the drawn multiple of its
//! numerical error (difference to a mesh twice as coarse) that the intervals assume. Noise levels are estimated
//! from each record. The means of a screen's priors are drawn as these assume: what the file gives for the tissue, and
//! priors of each area. A Kolmogorov–Smirnov test judges the p-values below 0.45: a one-sided test answers 1 whenever
//! the sign is wrong. They are judged twice, with the noise as estimated (shown to users)
//! and with the conservative one that a search decides by.
mod printed;
mod study;

use analysis::{Control, FeLadder, FeProblem, Identified, Measured};
use diagnose::{Finding, Policy};
use input::Case;
use inverse::{Problem, Random};
use model::{Discretisation, Model};
use nalgebra::DVector;
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::sync::Arc;
use study::{START, Study, draw_priors};

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
    let control = Control { progress: &|_| {}, cancelled: &|| false, journal: &analysis::NoJournal };
    analysis::identify(Arc::new(case.clone()), &effects::catalogue(), &control)
        .unwrap_or_else(|e| panic!("{e}"))
}

/// What one repeat says: per identifiable parameter whether its interval holds the truth and how far it is from it, per
/// effect its p-value.
struct Coverage {
    holds: Vec<(String, bool)>,
    /// Distances from the truth in standard errors.
    distances: Vec<(String, f64)>,
    /// With the noise as estimated, and with the conservative one.
    p_values: [Vec<(String, f64)>; 2],
    alarm: bool,
}

fn repeat(
    seed: u64,
    (study, ar1): (&Study, f64),
    clean: &DVector<f64>,
    error: &DVector<f64>,
    truth: &BTreeMap<String, f64>,
) -> Coverage {
    let mut random = Random::new(seed);
    let mut forces = clean.clone();
    for range in study.ranges() {
        let (start, len) = (range.start, range.len());
        let sd = study.noise * clean.rows(start, len).amax();
        let factor = random.normal();
        let drawn = random.ar1(len, sd, ar1) + factor * error.rows(start, len);
        let mut rows = forces.rows_mut(start, len);
        rows += drawn;
    }
    let folder = tempfile::tempdir().expect("a folder");
    let off = [random.normal(), random.normal()];
    let mut case = study.case(folder.path(), forces.as_slice(), START, off);
    let found = identify(&case);
    let estimates = &found.uncertainty.estimates;
    let holds = found
        .free_parameters
        .iter()
        .zip(estimates)
        .filter(|(_, e)| e.identifiable)
        .map(|(f, e)| {
            (f.path.clone(), e.interval_95[0] <= truth[&f.path] && truth[&f.path] <= e.interval_95[1])
        })
        .collect();
    let distances = found
        .free_parameters
        .iter()
        .zip(estimates)
        .filter(|(_, e)| e.identifiable)
        .filter_map(|(f, e)| Some((f.path.clone(), (e.value - truth[&f.path]) / e.std_error?)))
        .collect();
    if std::env::var("V").is_ok() {
        let own = (&found.numerical_error - error).norm() / error.norm();
        println!("own error differs {own:.2}; intervals dominated by it: {:?}", found.mesh_dominated);
        println!("repeat {seed}: chi2 {:.3} stops {:?}", found.quality.reduced_chi2_total, found.stopped);
        for ((f, e), i) in found.free_parameters.iter().zip(estimates).zip(&found.free) {
            println!(
                "   {} {:.5e} {:?} truth {:.5e}",
                f.path, found.theta[*i], e.interval_95, truth[&f.path]
            );
        }
    }
    let values: Vec<(String, f64)> = found
        .free_parameters
        .iter()
        .zip(&found.free)
        .map(|(f, &i)| (f.path.clone(), found.theta[i]))
        .collect();
    analysis::start_at(&mut case, values.iter().map(|(p, v)| (p.as_str(), *v)));
    draw_priors(&mut case, truth, &mut random);
    let catalogue = effects::catalogue();
    let quiet = |_: &str| {};
    let mut ladder = FeLadder::weighing(
        Arc::new(case),
        analysis::LadderSettings {
            catalogue: &catalogue,
            policy: Policy::default(),
            progress: &quiet,
            cancelled: &|| false,
            journal: &analysis::NoJournal,
        },
    )
    .expect("a ladder");
    let screen = ladder.weighed_by_columns().unwrap_or_else(|e| panic!("{e}")).discovery.screen;
    let of = |p: fn(&Finding) -> f64| -> Vec<(String, f64)> {
        screen.findings.iter().filter(|f| !f.refit_only).map(|f| (f.effect.clone(), p(f))).collect()
    };
    let p_values = [of(Finding::p_shown), of(|f| f.p_value)];
    Coverage { holds, distances, p_values, alarm: screen.findings.iter().any(|f| f.significant) }
}

fn main() {
    let study = Study::of_command_line();
    let folder = tempfile::tempdir().expect("a folder");
    let placeholder: Vec<f64> = (0..study.ranges()[1].end).map(|i| 1.0 + (i % 7) as f64).collect();
    let (model, clean) = clean(&study.case(folder.path(), &placeholder, 1.0, [0.0; 2]));
    let known = identify(&study.case(folder.path(), clean.as_slice(), START, [-0.7, -0.4]));
    let at = |f: &inverse::Free| model.find(&f.path).map(|i| (f.path.clone(), model.theta()[i]));
    let truth: BTreeMap<String, f64> = known.free_parameters.iter().filter_map(at).collect();
    for range in study.ranges() {
        let (start, len) = (range.start, range.len());
        let sd = study.noise * clean.rows(start, len).amax();
        let rms = known.numerical_error.rows(start, len).norm() / (len as f64).sqrt();
        println!("numerical error: {:.2} of the noise (root mean square)", rms / sd);
    }
    for &ar1 in &study.ar1 {
        let said: Vec<Coverage> = (0..study.repeats)
            .into_par_iter()
            .map(|k| repeat(5000 + k, (&study, ar1), &clean, &known.numerical_error, &truth))
            .collect();
        println!(
            "noise {} % of peak, AR(1) {ar1}, {1} × {1} elements, strength {2} MPa, to {3} mm, {4} repeats",
            100.0 * study.noise,
            study.divisions,
            study.strength,
            study.end,
            study.repeats
        );
        printed::intervals(&said);
        println!("  records with a significant effect: {}", said.iter().filter(|s| s.alarm).count());
        for (which, name) in ["estimated noise", "conservative noise"].iter().enumerate() {
            println!("  p-values with {name}:");
            printed::p_values(&said, which);
        }
    }
}
