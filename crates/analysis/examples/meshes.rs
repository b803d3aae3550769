//! How far the predicted curves of a case move with mesh and steps, and what a run costs:
//! `cargo run --release -p analysis --example meshes -- FILE` (values as the file gives them).

use analysis::{FeProblem, Measured};
use cpu_time::ProcessTime;
use inverse::Problem as _;
use model::{Discretisation, Model};
use std::sync::Arc;

/// Times as coarse as the file's mesh, steps of a tearing and of a uniaxial test; the first is the reference.
const TRIED: [(f64, (usize, usize)); 8] = [
    (1.0, (192, 80)),
    (1.0, (48, 20)),
    (1.0, (25, 11)),
    (2.0, (30, 14)),
    (2.0, (15, 8)),
    (3.0, (15, 8)),
    (4.0, (15, 8)),
    (6.0, (15, 8)),
];

fn main() {
    let catalogue = effects::catalogue();
    let go = || false;
    for path in std::env::args().skip(1) {
        let case =
            input::read_case(std::path::Path::new(&path), &catalogue).unwrap_or_else(|e| panic!("{e}"));
        let case = Arc::new(case);
        println!(
            "{path}: CPU seconds, root mean square from the first in % of the peak and in sd of the noise"
        );
        let mut reference: Option<nalgebra::DVector<f64>> = None;
        for (coarsen, steps) in TRIED {
            let how = Discretisation { coarsen, ..Discretisation::default() };
            let mut options = analysis::run_options(&case);
            (options.tearing_steps, options.uniaxial_steps) = steps;
            let Ok(model) = Model::new(case.clone(), &catalogue, how) else { continue };
            let measured = Measured::of(&model, &model.recorded()).expect("records");
            let (theta, slots) = (model.theta(), &measured.slots);
            let problem = FeProblem::new(&model, theta, Vec::new(), slots, options, &go);
            let begun = ProcessTime::now();
            let answer = problem.predict(&[], false);
            let seconds = begun.elapsed().as_secs_f64();
            match answer {
                Err(e) => println!("x{coarsen} {steps:?}: {e}"),
                Ok(p) => {
                    let from = reference.get_or_insert_with(|| p.values.clone());
                    println!(
                        "x{coarsen} {steps:?}: {seconds:.2} s{}",
                        away(&measured, &(&p.values - &*from))
                    );
                }
            }
        }
    }
}

fn away(measured: &Measured, difference: &nalgebra::DVector<f64>) -> String {
    let one = |b: &inverse::Block| {
        let rows = difference.rows(b.range.start, b.range.len());
        let rms = (rows.norm_squared() / b.range.len() as f64).sqrt();
        let peak = b.measured.iter().fold(0.0f64, |m, v| m.max(v.abs()));
        format!(", {} {:.3} % {:.2} sd", b.name, 100.0 * rms / peak, rms / b.noise.sd)
    };
    measured.data.blocks.iter().map(one).collect()
}
