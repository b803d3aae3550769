//! What the doctor promises of parameters, held against an identification of the same record.

use crate::small;

use analysis::{Control, Expected, doctor, identify};
use inverse::Random;
use std::sync::Arc;

fn case(folder: &std::path::Path, areas: usize, divisions: &str) -> input::Case {
    small::write_records(folder, true);
    let text = small::STRIP.to_owned() + small::FIT;
    let text =
        text.replace("[interface]", &format!("[interface]\nareas = {areas}")).replace("[8, 8, 1]", divisions);
    let file = folder.join("case.toml");
    std::fs::write(&file, text).expect("a config");
    input::read_case(&file, &effects::catalogue()).unwrap_or_else(|e| panic!("{e}"))
}

/// The record is made on another mesh than the file's.
fn promised_and_found(areas: usize) -> Vec<(String, Expected)> {
    let catalogue = effects::catalogue();
    let folder = tempfile::tempdir().expect("a folder");
    let forces = small::forces(&case(folder.path(), areas, "[14, 10, 1]"), &catalogue);
    let mut fitted = case(folder.path(), areas, "[8, 8, 1]");
    small::record(&mut fitted, &forces, 0.004, &mut Random::new(4));
    let fitted = Arc::new(fitted);
    let shows = doctor(&fitted, &catalogue, true, &|| false).shows.expect("a look");
    assert!(shows.counts_mesh);
    assert!(shows.parameters.iter().all(|k| k.relative_error >= k.by_noise));
    let control = Control { progress: &|_| {}, cancelled: &|| false, journal: &analysis::NoJournal };
    let found = identify(fitted, &catalogue, &control).expect("an identification");
    for e in &found.uncertainty.estimates {
        let promised = shows.parameters.iter().find(|k| k.path == e.path).expect("the same parameters");
        let error = e.std_error.map(|sd| sd / e.value);
        let fixed = promised.expected == Expected::Fixed;
        println!(
            "{}: {:?} promised {:.3}, found {error:?}",
            e.path, promised.expected, promised.relative_error
        );
        assert!(e.identifiable || !fixed, "{}: called fixed, not identified", e.path);
        assert!(
            !e.identifiable || promised.expected != Expected::Open,
            "{}: called open, identified",
            e.path
        );
        let over = error.map_or(f64::INFINITY, |e| e / promised.relative_error);
        assert!(!fixed || (0.5..2.0).contains(&over), "{}: {over} of the promise", e.path);
    }
    shows.parameters.into_iter().map(|k| (k.path, k.expected)).collect()
}

#[test]
fn what_is_called_fixed_is_identified() {
    let fixed = |list: &[(String, Expected)], name: &str| {
        list.iter().filter(|(path, e)| path.ends_with(name) && *e == Expected::Fixed).count()
    };
    let one = promised_and_found(1);
    assert_eq!((one.len(), fixed(&one, "].gc"), fixed(&one, "].sigma_c")), (4, 1, 1), "{one:?}");
    // Every area of the file, not those of a rough fit; four are too many for this record.
    let four = promised_and_found(4);
    assert_eq!((four.len(), fixed(&four, "k1")), (10, 1), "{four:?}");
    assert!(fixed(&four, "].gc") < 4, "{four:?}");
}
