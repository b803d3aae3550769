//! Start values are no beliefs: wrong by a factor of thirty either way, in every stiffness, toughness and strength, they lead to
//! the same end.

use crate::small;

use analysis::{Control, identify};
use input::Case;
use inverse::Random;
use model::Catalogue;
use std::sync::Arc;

/// Noise as a share of each record's peak.
const NOISE: f64 = 0.01;

/// The strip with its start values so many times too large; those in brackets are the tissue that made the records.
fn strip(catalogue: &Catalogue, mesh: &str, times: [f64; 4], held: bool) -> Case {
    let [mu, k1, gc, sigma_c] = times;
    let text = format!(
        "[mesh]\n{mesh}\n[bulk]\nmu_kPa = {}\nk1_kPa = {}\nk2 = {{ start = 2.0, fixed = {held} }}\n\
         gamma_deg = {{ start = 40.0, fixed = {held} }}\nkappa = {{ start = 0.2, fixed = {held} }}\n\
         [interface]\ngc_N_per_mm = {}\nsigma_c_MPa = {}\n",
        20.0 * mu,
        50.0 * k1,
        0.05 * gc,
        0.05 * sigma_c
    );
    let root = tempfile::tempdir().expect("a folder");
    small::write_records(root.path(), true);
    let path = root.path().join("case.toml");
    std::fs::write(&path, [small::STRIP, &text].concat()).expect("a config");
    input::read_case(&path, catalogue).unwrap_or_else(|e| panic!("{e}"))
}

/// χ² that `identify` comes to on records of the tissue, from start values that are so many times too large.
fn ends(mesh: &str, (held, intact): (bool, bool), wrong: &[[f64; 4]]) -> Vec<f64> {
    let catalogue = effects::catalogue();
    let mut truth = strip(&catalogue, mesh, [1.0; 4], held);
    let clean = small::forces(&truth, &catalogue);
    small::record(&mut truth, &clean, NOISE, &mut Random::new(3));
    let one = |times: &[f64; 4]| {
        let mut case = strip(&catalogue, mesh, *times, held);
        case.tests.clone_from(&truth.tests);
        case.tests.retain(|t| intact || t.kind.tears);
        let control = Control { progress: &|_| {}, cancelled: &|| false, journal: &analysis::NoJournal };
        let found =
            identify(Arc::new(case), &catalogue, &control).unwrap_or_else(|e| panic!("{times:?}: {e}"));
        let blocks: Vec<f64> = found.quality.blocks.iter().map(|b| b.chi2).collect();
        println!("{mesh:?} {times:?}: χ² {blocks:?} {:?}", &found.fit.theta);
        found.quality.chi2
    };
    wrong.iter().map(one).collect()
}

const FAR: [f64; 2] = [30.0, 1.0 / 30.0];

fn same(ends: &[f64]) {
    let least = ends.iter().fold(f64::INFINITY, |m, f| m.min(*f));
    assert!(ends.iter().all(|f| f - least < 0.5), "{ends:?}");
}

#[test]
fn a_strip_and_its_tear_on_elements_of_a_size() {
    let [up, down] = FAR;
    same(&ends(
        "bulk_size_mm = 0.5\npath_size_mm = 0.2\nlayers = 1",
        (false, true),
        &[[1.0; 4], [up; 4], [down; 4], [up, down, down, up], [down, up, up, down]],
    ));
}

#[test]
fn a_strip_and_its_tear_on_given_divisions() {
    let [up, down] = FAR;
    same(&ends(
        "divisions = [12, 8, 1]",
        (true, true),
        &[[1.0; 4], [up; 4], [down; 4], [up, down, down, up]],
    ));
}

#[test]
fn a_tear_alone() {
    let [up, down] = FAR;
    same(&ends(
        "bulk_size_mm = 0.5\npath_size_mm = 0.2\nlayers = 1",
        (true, false),
        &[[1.0; 4], [up; 4], [down; 4]],
    ));
}
