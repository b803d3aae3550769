//! The whole search on toy curves: single effects, pairs, none, look-alikes, and effects that the catalogue does not
//! hold. `-- --nocapture` prints the confusion table.
#![allow(missing_docs)]

use crate::toy_ladder;

use diagnose::*;
use toy_ladder::{ToyLadder, record};

fn run(truth: &[(&str, f64)], seed: u64) -> Discovery {
    let mut ladder = ToyLadder::new(record(truth, seed));
    let policy = Policy { draws: 4000, ..Policy::default() };
    let d = discover(&mut ladder, &policy, &mut |_| ()).expect("the base model can be fitted");
    assert!(d.ladder.windows(2).all(|w| w[1].bic < w[0].bic));
    assert!(words::verdict(&d, &policy).ends_with('.'));
    assert_eq!(d.groups.len(), d.found.len());
    assert!(d.groups.iter().zip(&d.found).all(|(g, f)| &g[0] == f));
    d
}

/// How often, over seeds: (right, in a group, wrong, nothing).
fn tally(truth: &[(&str, f64)], repeats: u64) -> (usize, usize, usize, usize) {
    let (mut right, mut grouped, mut wrong, mut none) = (0, 0, 0, 0);
    for seed in 0..repeats {
        let d = run(truth, seed + 7);
        let hit = |e: &str| d.groups.iter().any(|g| g.iter().any(|x| x == e));
        let all = truth.iter().all(|(e, _)| hit(e));
        if d.found.is_empty() {
            none += 1;
        } else if all && d.found.len() == truth.len() {
            if d.groups.iter().all(|g| g.len() == 1) { right += 1 } else { grouped += 1 }
        } else {
            wrong += 1;
        }
    }
    println!("{truth:?}: right {right}, in a group {grouped}, wrong {wrong}, none {none}");
    (right, grouped, wrong, none)
}

#[test]
fn nothing_is_found_where_nothing_is_missing() {
    let (_, _, wrong, none) = tally(&[], 40);
    assert!(wrong <= 1, "{wrong} false alarms in 40");
    assert!(none >= 39);
    let mut d = run(&[], 3);
    assert_eq!(d.verdict, Verdict::NothingMissing);
    // What only the mesh's error explains is not called noise.
    let said = |d: &Discovery| words::verdict(d, &Policy::default());
    assert!(said(&d).contains("the misfit is noise"), "{}", said(&d));
    d.ladder[0].reduced_chi2 = 7.1;
    assert!(said(&d).contains("7.1 with the noise alone"), "{}", said(&d));
}

#[test]
fn single_effects_are_named() {
    for truth in [("memory", 0.3), ("drift", 0.01), ("softening", 0.15), ("rate", 0.05)] {
        let (right, grouped, wrong, _) = tally(&[truth], 15);
        assert!(right + grouped >= 14 && wrong <= 1, "{truth:?}");
    }
    let d = run(&[("memory", 0.3)], 1);
    assert_eq!(d.found, ["memory"]);
    assert!(matches!(d.verdict, Verdict::Explained | Verdict::Ambiguous));
}

#[test]
fn look_alikes_are_given_as_a_group() {
    let (right, grouped, wrong, _) = tally(&[("kink", 0.2)], 15);
    assert!(grouped >= 13 && wrong <= 1 && right <= 2);
    let d = run(&[("kink", 0.2)], 2);
    assert_eq!(d.verdict, Verdict::Ambiguous);
    assert!(d.groups[0].contains(&"kink".to_owned()) && d.groups[0].contains(&"twin_kink".to_owned()));
}

#[test]
fn pairs_are_found_together() {
    for truth in [
        [("memory", 0.3), ("drift", 0.01)],
        [("softening", 0.15), ("drift", -0.01)],
        [("rate", 0.05), ("softening", 0.2)],
    ] {
        let (right, grouped, _, _) = tally(&truth, 10);
        assert!(right + grouped >= 8, "{truth:?}");
    }
}

#[test]
fn what_the_catalogue_does_not_hold_is_said_to_be_unexplained() {
    let mut abstained = 0;
    for seed in 0..15 {
        let d = run(&[("outside", 0.06)], seed);
        abstained += usize::from(matches!(d.verdict, Verdict::Unexplained | Verdict::Ambiguous));
    }
    println!("outside: unexplained or ambiguous in {abstained} of 15");
    assert!(abstained >= 13);
}

#[test]
fn what_base_parameters_imitate_is_not_named() {
    for seed in 0..10 {
        let d = run(&[("stiffer", 0.4)], seed);
        assert_eq!(d.verdict, Verdict::NothingMissing, "{:?}", d.found);
        assert!(!d.screen.finding("stiffer").unwrap().visible);
    }
}

#[test]
fn a_ladder_that_fails_or_is_stopped_gives_an_honest_answer() {
    let policy = Policy { draws: 2000, ..Policy::default() };
    let mut broken = ToyLadder::new(record(&[("memory", 0.3)], 1));
    broken.unfittable = Some("memory".into());
    let d = discover(&mut broken, &policy, &mut |_| ()).unwrap();
    assert!(
        !d.found.contains(&"memory".to_owned())
            && d.failed.iter().any(|(e, _)| e.contains(&"memory".to_owned()))
    );
    assert_ne!(d.verdict, Verdict::NothingMissing);
    let mut stopped = ToyLadder::new(record(&[("memory", 0.3)], 1));
    stopped.fits_allowed = 1;
    let d = discover(&mut stopped, &policy, &mut |_| ()).unwrap();
    assert!(d.interrupted && d.found.is_empty() && d.verdict == Verdict::Unexplained);
    assert!(words::verdict(&d, &policy).contains("stopped"));
}

#[test]
fn weights_favour_the_lowest_criterion() {
    let w = weights(&[100.0, 102.0, 130.0]);
    assert!((w.iter().sum::<f64>() - 1.0).abs() < 1e-12 && w[0] > w[1] && w[1] > 1e3 * w[2]);
}
