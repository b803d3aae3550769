//! A strip whose record is known, and files that say other things of it.

use super::*;
use crate::{Control, FeProblem, NoJournal, run_options};
use model::{Channel, Discretisation};
use std::collections::BTreeSet;
use std::fmt::Write as _;
use std::path::Path;
use std::sync::Mutex;

/// A strip that tears, its stiffness, toughness and strength so many times what its record was made with; with more than one
/// area each has a toughness of its own.
fn strip(folder: &Path, times: f64, areas: usize) -> Arc<Case> {
    let [mu, k1, gc, sigma_c] = [6.0, 300.0, 0.03, 0.06].map(|v| times * v);
    let gc = if areas > 1 { format!("{:?}", vec![gc; areas]) } else { gc.to_string() };
    let text = format!(
        "name = \"strip\"\n[geometry]\nlength_mm = 4.0\nwidth_mm = 3.0\nthickness_mm = 0.8\ncut_mm = 1.0\n\
         [[tests]]\nkind = \"tearing\"\ndata = \"tearing.csv\"\nforce_sd_N = 0.001\n[mesh]\ndivisions = [8, 8, 1]\n\
         [bulk]\nmu_kPa = {mu}\nk1_kPa = {k1}\nk2 = {{ start = 8.0, fixed = true }}\n\
         gamma_deg = {{ start = 42.0, fixed = true }}\nkappa = {{ start = 0.2, fixed = true }}\n\
         [interface]\nareas = {areas}\ngc_N_per_mm = {gc}\nsigma_c_MPa = {sigma_c}\n"
    );
    std::fs::write(folder.join("c.toml"), text).expect("a config");
    Arc::new(input::read_case(&folder.join("c.toml"), &effects::catalogue()).expect("a case"))
}

fn on_its_mesh(case: &Arc<Case>) -> Model {
    Model::new(case.clone(), &effects::catalogue(), Discretisation::default()).expect("a model")
}

/// A folder with the record of the strip as it is, on its own mesh.
fn recorded() -> tempfile::TempDir {
    recorded_on([8, 8, 1])
}

fn recorded_on(divisions: [usize; 3]) -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    let write = |force: &dyn Fn(usize) -> f64| {
        let mut rows = String::from("time_s,displacement_mm,force_N\n");
        for i in 0..30 {
            let _ = writeln!(rows, "{i},{},{}", 0.1 * i as f64, force(i));
        }
        std::fs::write(folder.path().join("tearing.csv"), rows).expect("a record");
    };
    write(&|i| 0.01 * i as f64);
    let mut case = (*strip(folder.path(), 1.0, 1)).clone();
    case.mesh.divisions = Some(divisions);
    let case = Arc::new(case);
    let model = on_its_mesh(&case);
    let slots = [crate::DataBlock { test: 0, channel: Channel::Force, rows: (0..30).collect() }];
    let problem = FeProblem::new(&model, model.theta(), Vec::new(), &slots, run_options(&case), &|| false);
    let values = problem.predict(&[], false).expect("a run").values;
    write(&|i| values[i]);
    folder
}

/// What a search of a case's record says, from what is known.
fn starts_of(case: &Arc<Case>, known: &[Arc<Start>]) -> (Vec<Arc<Start>>, BTreeSet<&'static str>) {
    let stages = Mutex::new(BTreeSet::new());
    let progress = |p: &crate::Progress| {
        stages.lock().expect("stages").insert(p.stage.word());
    };
    let control = Control { progress: &progress, cancelled: &|| false, journal: &NoJournal };
    let mut work = Work::new(case, on_its_mesh(case).theta(), run_options(case), &control);
    work.again = crate::identify::Again { starts: known, below: f64::INFINITY };
    let starts = torn_starts(case, &effects::catalogue(), &mut work).expect("runs").expect("a start");
    (starts, stages.into_inner().expect("stages"))
}

/// The first start of a case, on its own mesh.
fn first_start(case: &Arc<Case>) -> Option<Vec<f64>> {
    let control = Control { progress: &|_| (), cancelled: &|| false, journal: &NoJournal };
    let model = on_its_mesh(case);
    let mut work = Work::new(case, model.theta(), run_options(case), &control);
    let starts = torn_starts(case, &effects::catalogue(), &mut work).expect("runs");
    let left = (&work.theta, work.coarse_noise, work.by_record, work.budget);
    assert_eq!(left, (&model.theta(), 0.0, false, TRIAL_BUDGET));
    starts.map(|s| s[0].spread_from(&model, &model.theta()))
}

/// An arm that bends needs its few elements; where there are many, half of them do.
#[test]
fn a_coarse_mesh_keeps_what_bending_needs() {
    let folder = recorded();
    let mut case = (*strip(folder.path(), 1.0, 1)).clone();
    for (given, coarse) in [([8, 8, 1], [4, 8, 1]), ([8, 4, 1], [4, 4, 1]), ([8, 20, 1], [4, 10, 1])] {
        case.mesh.divisions = Some(given);
        let model = part_of(&case, 1.0, &effects::catalogue()).expect("a model");
        assert_eq!(model.case.mesh.divisions, Some(coarse));
    }
}

#[test]
fn a_start_is_the_records_whatever_the_file_says() {
    let folder = recorded();
    for times in [0.1, 10.0] {
        let case = strip(folder.path(), times, 1);
        let (model, start) = (on_its_mesh(&case), first_start(&case).expect("a start"));
        let truth = [
            ("bulk.mu", 6e-3),
            ("bulk.k1", 0.3),
            ("interface.area[1].gc", 0.03),
            ("interface.area[1].sigma_c", 0.06),
        ];
        for (path, truth) in truth {
            let ratio = start[model.find(path).expect("a parameter")] / truth;
            assert!((0.7..1.4).contains(&ratio), "{path} is {ratio} times the strip's, from {times} times");
        }
    }
}

/// The record is of the mesh on which starts are told apart.
#[test]
fn a_file_that_says_it_better_than_the_record_is_kept_to() {
    let case = strip(recorded_on([4, 8, 1]).path(), 1.0, 1);
    let (model, start) = (on_its_mesh(&case), first_start(&case).expect("a start"));
    let bulk = model.free_on(Site::Bulk);
    assert!(!bulk.is_empty() && bulk.iter().all(|&i| start[i] == model.theta()[i]), "{start:?}");
}

#[test]
fn values_of_each_area_with_which_the_record_can_be_followed_are_the_start() {
    assert_eq!(first_start(&strip(recorded().path(), 1.0, 2)), None);
}

#[test]
fn a_softer_bulk_is_softer_by_its_stresses() {
    let folder = recorded();
    strip(folder.path(), 1.0, 1);
    let file = folder.path().join("c.toml");
    let free = std::fs::read_to_string(&file).expect("a config").replace("fixed = true", "fixed = false");
    std::fs::write(&file, free).expect("a config");
    let case = Arc::new(input::read_case(&file, &effects::catalogue()).expect("a case"));
    let model = on_its_mesh(&case);
    assert!(model.free_on(Site::Bulk).len() > 2);
    let mut theta = model.theta();
    soften(&model, 0.25, &mut theta);
    for (i, p) in model.parameters.iter().enumerate() {
        let share = if ["bulk.mu", "bulk.k1"].contains(&p.path.as_str()) { 0.25 } else { 1.0 };
        assert_eq!(theta[i], share * model.theta()[i], "{}", p.path);
    }
}

#[test]
fn of_the_paths_that_a_record_tells_the_one_that_misses_it_least_is_taken() {
    let case = strip(recorded().path(), 1.0, 1);
    let control = Control { progress: &|_| (), cancelled: &|| false, journal: &NoJournal };
    let model = on_its_mesh(&case);
    let mut work = Work::new(&case, model.theta(), run_options(&case), &control);
    // A strength of the strip's is 4 times this, its toughness half of that.
    assert!(looked_for(&model, (0.06, 0.015), TEARS, &mut work).expect("runs"));
    let at = |path: &str| work.theta[model.find(path).expect("a parameter")];
    assert_eq!((at("interface.area[1].gc"), at("interface.area[1].sigma_c")), (0.03, 0.06));
    // The weakest of them may be the one.
    assert!(looked_for(&model, (0.0303, 0.0606), TEARS, &mut work).expect("runs"));
    // Where all of them hold, none tears; it is taken where that is all there is.
    let before = work.theta.clone();
    assert!(!looked_for(&model, (10.0, 10.0), TEARS, &mut work).expect("runs"));
    assert_eq!(work.theta, before);
    assert!(looked_for(&model, (10.0, 10.0), f64::INFINITY, &mut work).expect("runs"));
    assert_ne!(work.theta, before);
}

/// A record that ends before the strip tears has starts whose paths hold: no other is there.
#[test]
fn a_record_without_a_tear_tells_its_stiffness() {
    let folder = recorded();
    let mut case = (*strip(folder.path(), 10.0, 1)).clone();
    for r in case.tests.iter_mut().filter_map(|t| t.record.as_mut()) {
        r.truncate(6);
        // Of this all paths miss the same.
        r.force.iter_mut().enumerate().for_each(|(i, f)| *f += if i % 2 == 0 { 2e-3 } else { -2e-3 });
    }
    let case = Arc::new(case);
    let (model, theta) = (on_its_mesh(&case), first_start(&case).expect("a start"));
    let k1 = theta[model.find("bulk.k1").expect("a stiffness")];
    assert!((0.05..1.0).contains(&k1), "{k1}");
}

/// Where a base's search began, the same record's with an effect begins; nothing but the fit of bulk and path is made again.
#[test]
fn what_a_record_told_once_is_not_asked_again() {
    let folder = recorded();
    let case = strip(folder.path(), 10.0, 1);
    let (known, stages) = starts_of(&case, &[]);
    assert_eq!(stages, BTreeSet::from(["bulk", "joint"]));
    let file = folder.path().join("c.toml");
    let text = std::fs::read_to_string(&file).expect("a config") + "[effects.gain]\ng = 0.25\n";
    std::fs::write(&file, text).expect("a config");
    let stronger = Arc::new(input::read_case(&file, &effects::catalogue()).expect("a case"));
    let (found, stages) = starts_of(&stronger, &known);
    assert_eq!(stages, BTreeSet::from(["joint"]));
    // A sensor that shows a quarter too much has a path that is weaker by that.
    let at = |s: &Start| s.theta[s.model.find("interface.area[1].gc").expect("a toughness")];
    let ratio = at(&found[0]) / at(&known[0]);
    assert!((ratio - 0.8).abs() < 0.04, "{ratio}");
}
