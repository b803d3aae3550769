//! Records that end with a fall which no effect meets: the search goes on without it, says so, and only then.
#![allow(missing_docs)]

use crate::small;

use analysis::{DiscoverAnswer, Measured, NoJournal, discover};
use input::Case;
use inverse::Random;
use model::{Catalogue, Discretisation, Model};
use std::sync::{Arc, Mutex};

/// Points of the test that tears, and of those the last that no model meets.
const POINTS: usize = 5 * small::LEG + 1;
const LAST: usize = 2;
/// A toughness at which it does not tear through by itself, one at which it does; the noise.
const TOUGH: (f64, f64) = (0.1, 0.01);
const BRITTLE: (f64, f64) = (0.03, 0.002);

/// Few effects: what is seen here does not hang on them.
fn few() -> Catalogue {
    let all = effects::catalogue();
    Catalogue::new(["compliance", "drift"].iter().filter_map(|e| all.get(e).cloned()).collect())
        .with_laws(all.laws().clone())
        .with_experiments(all.experiments().clone())
}

/// Records of a base model of some toughness with noise of a share of the peak, its forces in the tear changed.
fn recorded(
    catalogue: &Catalogue,
    (toughness, noise): (f64, f64),
    change: impl Fn(usize, f64) -> f64,
) -> (tempfile::TempDir, Case) {
    let folder = tempfile::tempdir().unwrap();
    small::write_records(folder.path(), false);
    let file = folder.path().join("case.toml");
    let text = small::STRIP.to_owned()
        + &small::FIT.replace("[8, 8, 1]", "[4, 4, 1]").replace("= 0.03", &format!("= {toughness}"));
    std::fs::write(&file, text).unwrap();
    let mut case = input::read_case(&file, catalogue).unwrap();
    let mut forces = small::forces(&case, catalogue);
    assert_eq!(forces[1].len(), POINTS);
    forces[1].iter_mut().enumerate().for_each(|(i, f)| *f = change(i, *f));
    small::record(&mut case, &forces, noise, &mut Random::new(11));
    (folder, case)
}

/// The answer, and what the search said on its way.
fn found(case: &Case, catalogue: &Catalogue) -> (DiscoverAnswer, Vec<String>) {
    let said = Mutex::new(Vec::new());
    let note = |line: &str| said.lock().unwrap().push(line.to_owned());
    let answer = discover(Arc::new(case.clone()), catalogue, &note, &|| false, &NoJournal).unwrap();
    (answer, said.into_inner().unwrap())
}

#[test]
fn an_end_that_no_model_meets_is_left_out_and_said_to_be() {
    let catalogue = few();
    let torn = |i: usize, f: f64| if i + LAST >= POINTS { 0.2 * f } else { f };
    let (_folder, case) = recorded(&catalogue, TOUGH, torn);
    let (answer, _) = found(&case, &catalogue);
    assert_eq!(answer.verdict, "nothing_missing", "{:?}", answer.words);
    let [out] = answer.left_out.as_slice() else { panic!("{:?}", answer.left_out) };
    assert_eq!((out.test.as_str(), out.points, out.of), ("tearing", LAST, POINTS));
    let said = "without the last 2 of 61 points of tearing";
    assert!(answer.words[1].contains(said), "{:?}", answer.words);
    // The case for its curves has all rows, of which these count for nothing.
    let model = Model::new(answer.case.clone(), &catalogue, Discretisation::default()).unwrap();
    let measured = Measured::of(&model, &[true, true]).unwrap().data;
    let all = measured.points();
    assert_eq!(all, 2 * POINTS);
    let unused: Vec<usize> = (0..all).filter(|&i| !measured.is_used(i)).collect();
    assert_eq!(unused, [all - 2, all - 1]);
}

#[test]
fn a_record_that_is_met_or_met_nowhere_is_searched_whole() {
    let catalogue = few();
    let whole = |strip: (f64, f64), change: &dyn Fn(usize, f64) -> f64| {
        let (_folder, case) = recorded(&catalogue, strip, change);
        let (answer, notes) = found(&case, &catalogue);
        assert!(answer.left_out.is_empty(), "{:?}", answer.left_out);
        assert!(answer.case.tests.iter().all(|t| t.weights.is_empty()));
        assert!(!answer.words.iter().any(|w| w.contains("whole records")), "{:?}", answer.words);
        let again = |n: &&String| n.contains("drift: once more from where the record's own start is");
        let tried = notes.iter().any(|n| n.contains("no effect comes near"));
        (answer.verdict, tried, notes.iter().filter(again).count())
    };
    assert_eq!(whole(TOUGH, &|_, f| f), ("nothing_missing".to_owned(), false, 0));
    // The last points fall by 5 sd and more, as the model says.
    assert_eq!(whole(BRITTLE, &|_, f| f), ("nothing_missing".to_owned(), false, 0));
    // A saw in the middle, too, which neither effect makes.
    let nowhere = |i: usize, f: f64| match i {
        20..40 if i % 4 < 2 => 1.5 * f,
        _ if i + LAST >= POINTS => 0.2 * f,
        _ => f,
    };
    let (verdict, tried, again) = whole(TOUGH, &nowhere);
    assert_ne!(verdict, "nothing_missing");
    // The search without the end did all it could, and so did that of the whole.
    assert!(tried && again == 2, "{tried} {again}");
}
