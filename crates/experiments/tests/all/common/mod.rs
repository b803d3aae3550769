//! Runs a file, and what a neo-Hookean, incompressible piece answers in closed form.

use analysis::{SimulateControl, SimulatedTest, simulate};
use std::sync::Arc;

/// The first test of a file's text, simulated to its end.
pub fn run(text: &str) -> SimulatedTest {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("case.toml");
    std::fs::write(&path, text).expect("written");
    let catalogue = effects::catalogue();
    let case = input::read_case(&path, &catalogue).unwrap_or_else(|e| panic!("{e}"));
    let control = SimulateControl { progress: &|_, _| (), cancelled: &never };
    let done = simulate(Arc::new(case), &catalogue, &control).unwrap_or_else(|e| panic!("{e}"));
    let test = done.tests.into_iter().next().expect("one test");
    assert_eq!(test.failure, None, "at {:?} mm", test.displacement.last());
    test
}

/// The case of a file's text, and the catalogue it was read with.
pub fn case_of(text: &str) -> (input::Case, model::Catalogue) {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("case.toml");
    std::fs::write(&path, text).expect("written");
    let catalogue = effects::catalogue();
    let case = input::read_case(&path, &catalogue).unwrap_or_else(|e| panic!("{e}"));
    (case, catalogue)
}

/// What is said of a file that cannot be read.
pub fn fault(text: &str) -> String {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("case.toml");
    std::fs::write(&path, text).expect("written");
    match input::read_case(&path, &effects::catalogue()) {
        Ok(_) => panic!("the file was read"),
        Err(e) => e.to_string(),
    }
}

fn never() -> bool {
    false
}

/// Nominal stress (MPa) of an incompressible neo-Hookean bar at a stretch.
pub fn stress(mu: f64, stretch: f64) -> f64 {
    mu * (stretch - stretch.powi(-2))
}

/// Its energy per reference volume, MPa.
pub fn energy(mu: f64, stretch: f64) -> f64 {
    0.5 * mu * (stretch.powi(2) + 2.0 / stretch - 3.0)
}

/// The stretch at which it bears this nominal stress, by bisection.
pub fn stretch_at(mu: f64, nominal: f64) -> f64 {
    let (mut low, mut high) = (1.0, 10.0);
    for _ in 0..80 {
        let middle = 0.5 * (low + high);
        if stress(mu, middle) < nominal { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}
