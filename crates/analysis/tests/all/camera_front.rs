//! A camera that sees the tear: a front that has not begun stands at the end of the cut.

// Records are of its own.
#[allow(dead_code)]
use crate::small;

use analysis::{FeProblem, Measured, SimulateControl, Simulated, run_options, simulate};
use input::Case;
use inverse::{Noise, Problem as _, Random, Whitener};
use model::{Discretisation, Model};
use std::fmt::Write as _;
use std::path::Path;
use std::sync::Arc;

const CUT: f64 = 1.0;
const SD: f64 = 0.05;
const MODEL: &str = r#"
[mesh]
divisions = [8, 8, 1]
[bulk]
mu_kPa = 20.0
k1_kPa = 400.0
k2 = 2.0
gamma_deg = 40.0
kappa = 0.2
[interface]
gc_N_per_mm = 0.05
sigma_c_MPa = 0.1
[solver]
step_mm = 0.02
"#;

fn read(folder: &Path, text: &str) -> Case {
    let file = folder.join("case.toml");
    std::fs::write(&file, text).expect("written");
    input::read_case(&file, &effects::catalogue()).expect("a good file")
}

fn torn(folder: &Path) -> Simulated {
    let strip =
        small::STRIP.replace("data = \"uniaxial.csv\"", "protocol = [{ to_mm = 0.2, rate_mm_per_s = 0.05 }]");
    let strip = strip.replace("data = \"tearing.csv\"", "protocol = [{ to_mm = 2.0, rate_mm_per_s = 0.05 }]");
    let control = SimulateControl { progress: &|_, _| {}, cancelled: &|| false };
    let case = read(folder, &format!("{strip}{MODEL}"));
    simulate(Arc::new(case), &effects::catalogue(), &control).expect("a run")
}

#[test]
fn a_right_camera_is_not_punished_before_the_tear_begins() {
    let folder = tempfile::tempdir().expect("a folder");
    let run = torn(folder.path());
    let tear = &run.tests[1];
    let begun = tear.tear_front.iter().position(|x| *x > CUT).expect("it tears");
    assert!(begun > 5 && tear.tear_front.last().is_some_and(|x| *x > CUT + 0.5), "{:?}", tear.tear_front);
    assert!(tear.tear_front[..begun].iter().all(|x| *x == CUT), "{:?}", &tear.tear_front[..begun]);

    // What a camera writes that follows the contract.
    let mut random = Random::new(3);
    let mut csv = String::from("time_s,displacement_mm,force_N,tear_front_mm\n");
    for i in 0..tear.time.len() {
        // What the solver needed besides has no time of its own.
        if tear.run.steps[i].target.is_none() {
            continue;
        }
        let (t, u, f) = (tear.time[i], tear.displacement[i], tear.force[i] + 0.001 * random.normal());
        let front = tear.tear_front[i].max(CUT) + SD * random.normal();
        let _ = writeln!(csv, "{t},{u},{f},{front}");
    }
    std::fs::write(folder.path().join("tearing.csv"), csv).expect("written");
    let strip =
        small::STRIP.replace("data = \"uniaxial.csv\"", "protocol = [{ to_mm = 0.2, rate_mm_per_s = 0.05 }]");
    let strip =
        strip.replace("data = \"tearing.csv\"", &format!("data = \"tearing.csv\"\ntear_front_sd_mm = {SD}"));
    let case = Arc::new(read(folder.path(), &format!("{strip}{MODEL}")));
    let model = Model::new(case.clone(), &effects::catalogue(), Discretisation::default()).expect("a model");
    let measured = Measured::of(&model, &[false, true]).expect("data");
    let go = || false;
    let problem = FeProblem::new(&model, model.theta(), Vec::new(), &measured.slots, run_options(&case), &go);
    let prediction = problem.predict(&[], false).expect("a run");
    let block = measured.data.blocks.iter().find(|b| b.name == "tearing.tear_front").expect("a camera");
    let white = Whitener::with_points(&measured.data, |i| block.range.contains(&i), Noise::Record);
    let chi2 = white.apply(&measured.data.misfit(&prediction.values)).norm_squared();
    let n = block.range.len() as f64;
    assert!((chi2 / n - 1.0).abs() < 4.0 * (2.0 / n).sqrt(), "χ² {:.2} per point", chi2 / n);
}
