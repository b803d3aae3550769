//! The load steps of a search carry the curve of every effect: corners that a law has lie on steps, or close by.

use crate::small;

use analysis::{FeProblem, Measured};
use inverse::Problem as _;
use model::{Catalogue, Discretisation, Model, RunOptions};
use std::fmt::Write as _;
use std::path::Path;
use std::sync::Arc;

/// What the steps of a search may be off by, root mean square in shares of the peak: a third of the noise of a good record.
/// Without steps of their own by a turn, backlash is off by 0.6 %.
const OFF: f64 = 0.003;

/// Rows of a way from corner to corner.
const ROWS: usize = 50;

/// Records of two cycles to the same end and of one that goes beyond; their forces only give sizes.
fn write_records(folder: &Path) {
    for (name, end) in [("uniaxial.csv", 1.2), ("tearing.csv", 1.5)] {
        let ends = [0.0, end, 0.1 * end, end, 0.4 * end, 1.2 * end];
        let mut text = String::from("time_s,displacement_mm,force_N\n0,0,0\n");
        let mut time = 0.0;
        for w in ends.windows(2) {
            for i in 1..=ROWS {
                let way = (w[1] - w[0]) / ROWS as f64;
                time += 20.0 * way.abs();
                let u = w[0] + way * i as f64;
                let _ = writeln!(text, "{time},{u},{}", 0.3 * u);
            }
        }
        std::fs::write(folder.join(name), text).expect("a record");
    }
}

/// Predicted forces by so many steps for each that a search takes, test by test.
fn forces(file: &Path, catalogue: &Catalogue, finer: usize) -> Vec<Vec<f64>> {
    let case = input::read_case(file, catalogue).unwrap_or_else(|e| panic!("{e}"));
    let model = Model::new(Arc::new(case), catalogue, Discretisation::default()).expect("a model");
    let measured = Measured::of(&model, &model.recorded()).expect("records");
    let full = RunOptions::default();
    let options = RunOptions {
        tearing_steps: finer * (full.tearing_steps / 2 + 1),
        uniaxial_steps: finer * (full.uniaxial_steps / 2 + 1),
        ..full
    };
    let problem = FeProblem::new(&model, model.theta(), Vec::new(), &measured.slots, options, &|| false);
    let all = problem.predict(&[], false).unwrap_or_else(|e| panic!("{:?}: {e}", model.effects())).values;
    measured.data.blocks.iter().map(|b| b.range.clone().map(|i| all[i]).collect()).collect()
}

/// What a search's steps are off by, the test that they are off by most.
fn off(coarse: &[Vec<f64>], fine: &[Vec<f64>]) -> f64 {
    let one = |(a, b): (&Vec<f64>, &Vec<f64>)| {
        let peak = b.iter().fold(0.0f64, |m, f| m.max(f.abs()));
        let square: f64 = a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum();
        (square / b.len() as f64).sqrt() / peak
    };
    coarse.iter().zip(fine).map(one).fold(0.0, f64::max)
}

#[test]
fn the_steps_of_a_search_carry_every_effect() {
    let catalogue = effects::catalogue();
    let folder = tempfile::tempdir().expect("a folder");
    write_records(folder.path());
    // Stiffening as tissue does, and so tough that it does not tear through.
    let model = (small::FIT.replace("[8, 8, 1]", "[4, 3, 1]"))
        .replace("gc_N_per_mm = 0.03", "gc_N_per_mm = 0.3")
        .replace("k2 = 8.0", "k2 = 20.0");
    for effect in catalogue.iter() {
        let name = effect.card().name;
        let file = folder.path().join("case.toml");
        let text = [small::STRIP, &model, &format!("[effects.{name}]\n")].concat();
        std::fs::write(&file, text).expect("written");
        let by = |finer| forces(&file, &catalogue, finer);
        let off = off(&by(1), &by(4));
        println!("{name}: {:.3} %", 100.0 * off);
        assert!(
            off < OFF,
            "{name}: by the steps of a search {:.2} % of the peak beside four times as many",
            100.0 * off
        );
    }
}
