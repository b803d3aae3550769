//! Which noise and which standard errors an identification and a screen assume.
#![allow(missing_docs)]

use crate::small;

use analysis::{Control, Identified, Measured, identify};
use inverse::{Random, Z95};
use model::{Discretisation, Model};
use nalgebra::DVector;
use std::sync::Arc;

/// Everything is fitted at once.
const JOINT: &str = "[identify]\nmode = \"joint\"\n";

fn case(folder: &std::path::Path, noise: &str) -> input::Case {
    small::write_records(folder, true);
    let file = folder.join("case.toml");
    std::fs::write(&file, small::STRIP.replace("force_sd_N = 0.001", noise) + small::FIT + JOINT).unwrap();
    input::read_case(&file, &effects::catalogue()).unwrap()
}

#[test]
fn the_noise_as_estimated_replaces_conservative_noise_and_leaves_the_meshs_error() {
    let folder = tempfile::tempdir().unwrap();
    case(folder.path(), "");
    for (seed, name) in [(3, "uniaxial.csv"), (4, "tearing.csv")] {
        let noise = Random::new(seed).ar1(200, 0.01, 0.4);
        let line = |i: usize| format!("{i},{},{}\n", 0.005 * i as f64, 0.001 * i as f64 + noise[i]);
        let text = String::from("time_s,displacement_mm,force_N\n") + &(0..200).map(line).collect::<String>();
        std::fs::write(folder.path().join(name), text).unwrap();
    }
    let case = input::read_case(&folder.path().join("case.toml"), &effects::catalogue()).unwrap();
    let model = Model::new(Arc::new(case), &effects::catalogue(), Discretisation::default()).unwrap();
    let estimated = Measured::of(&model, &[true, true]).unwrap();
    let error = DVector::from_fn(estimated.data.points(), |i, _| 1e-3 * (i % 5) as f64);
    let conservative = Measured::conservative(&model, &[true, true]).unwrap().with_numerical_error(&error);
    let back = conservative.as_estimated(&model).unwrap();
    for ((b, c), e) in back.data.blocks.iter().zip(&conservative.data.blocks).zip(&estimated.data.blocks) {
        assert!(c.noise.ar1 > e.noise.ar1, "{} {}", c.noise.ar1, e.noise.ar1);
        assert_eq!((b.noise.sd, b.noise.ar1), (e.noise.sd, e.noise.ar1));
        assert_eq!((&b.noise.nuisance, &b.measured), (&c.noise.nuisance, &c.measured));
    }
    assert_eq!(back.slots, conservative.slots);
}

fn identified(case: input::Case) -> Identified {
    let control = Control { progress: &|_| {}, cancelled: &|| false, journal: &analysis::NoJournal };
    identify(Arc::new(case), &effects::catalogue(), &control).unwrap()
}

/// The strip's records with noise of 4 mN and a distortion that no parameter makes: a wave of a share of each peak.
fn distorted(wave: f64) -> input::Case {
    let folder = tempfile::tempdir().unwrap();
    let mut case = case(folder.path(), "force_sd_N = 0.004");
    let truth = Model::new(Arc::new(case.clone()), &effects::catalogue(), Discretisation::default()).unwrap();
    let measured = Measured::of(&truth, &[true, true]).unwrap();
    let options = analysis::run_options(&case);
    let forces = inverse::Problem::predict(
        &analysis::FeProblem::new(&truth, truth.theta(), Vec::new(), &measured.slots, options, &|| false),
        &[],
        false,
    )
    .unwrap()
    .values;
    let noise = Random::new(5).normals(forces.len());
    let mut noisy =
        forces.iter().zip(noise.iter()).map(|(f, n)| f + 0.004 * n).collect::<Vec<_>>().into_iter();
    for test in &mut case.tests {
        let force = &mut test.record.as_mut().unwrap().force;
        let (points, peak) = (force.len() as f64, force.iter().fold(0.0f64, |m, f| m.max(f.abs())));
        for (i, f) in force.iter_mut().enumerate() {
            *f = noisy.next().unwrap() + wave * peak * (20.0 * i as f64 / points).sin();
        }
    }
    case
}

/// A softening zone as small as the elements is known less towards higher strength: that side is the longer one, and no
/// side is shorter than the standard error at the answer makes it.
#[test]
fn sides_of_an_interval_follow_what_the_mesh_can_tell() {
    let found = identified(distorted(0.0));
    let sides: Vec<[f64; 2]> = (0..found.free_parameters.len())
        .map(|k| {
            let (f, e) = (&found.free_parameters[k], &found.uncertainty.estimates[k]);
            let sd = found.uncertainty.covariance_z[(k, k)].sqrt();
            e.interval_95_if_right.map(|end| (f.forward(end) - f.forward(e.value)).abs() / (Z95 * sd))
        })
        .collect();
    println!("{sides:.3?}");
    for e in &found.uncertainty.estimates {
        // Allowing for the rest takes nothing away.
        let [a, b] = e.interval_95_if_right;
        assert!(e.interval_95[0] <= a && b <= e.interval_95[1], "{e:?}");
    }
    for ((f, side), e) in found.free_parameters.iter().zip(&sides).zip(&found.uncertainty.estimates) {
        for (a, end) in side.iter().zip(e.interval_95_if_right) {
            // Bounds cut.
            let cut = end <= f.lower || end >= f.upper;
            assert!(cut || (1.0 - 1e-9..=2.0 + 1e-9).contains(a), "{} {side:?}", f.path);
        }
        assert!(side[0].min(side[1]) < 1.0 + 1e-9, "{} {side:?}", f.path);
    }
    let strength = found.free_parameters.iter().position(|f| f.path == "interface.area[1].sigma_c").unwrap();
    assert!(sides[strength][1] > 1.02, "{sides:?}");
}

/// A wave of 4 % of the peak is a rest of some 3 %, which intervals allow for and noise does not; without it nothing is left.
#[test]
fn what_the_model_leaves_widens_intervals() {
    let (clean, off) = (identified(distorted(0.0)), identified(distorted(0.04)));
    let left = |of: &Identified| of.left.clone().unwrap();
    let wider = |of: &Identified| -> Vec<f64> {
        let width = |[a, b]: [f64; 2]| b - a;
        let all = of.uncertainty.estimates.iter().filter(|e| !e.at_bound && e.identifiable);
        all.map(|e| width(e.interval_95) / width(e.interval_95_if_right)).collect()
    };
    println!("{:?} {:?}", left(&clean), left(&off));
    println!("{:.2?} {:.2?}", wider(&clean), wider(&off));
    assert_eq!(left(&clean).explained_to, evidence::ExplainedTo::Noise);
    assert_eq!(left(&off).explained_to, evidence::ExplainedTo::Not);
    let share = left(&off).rest.all;
    let wave = 0.04 / 2f64.sqrt();
    assert!(share.interval_95[0] < wave && wave < share.interval_95[1], "{share:?}");
    assert!(wider(&clean).iter().all(|w| *w < 1.5), "{:?}", wider(&clean));
    assert!(wider(&off).iter().any(|w| *w > 1.5), "{:?}", wider(&off));
}
