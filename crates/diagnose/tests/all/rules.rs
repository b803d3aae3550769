//! The rules of the search, one at a time: fits and screens are a table, so that each rule meets the numbers that it
//! is about, and what was fitted at all can be asked.
#![allow(missing_docs)]

use crate::tables;

use diagnose::*;
use std::collections::BTreeMap;
use tables::*;

/// χ² of each set of effects (joined by `+`, in alphabetical order), and what the screen at each says.
#[derive(Default)]
struct Table {
    chi2: BTreeMap<&'static str, f64>,
    findings: BTreeMap<&'static str, Vec<Finding>>,
    pairs: Vec<Pair>,
    leaning: bool,
    /// Reduced χ² with the record's noise alone, where it is another.
    raw: BTreeMap<&'static str, f64>,
    /// The promises of the effects that each fit was told of.
    hinted: Vec<(String, Vec<Option<f64>>)>,
}

impl Table {
    fn new(chi2: &[(&'static str, f64)]) -> Self {
        Self { chi2: chi2.iter().copied().collect(), ..Self::default() }
    }

    /// What the screen at `at` says: significant effects with the fall they promise.
    fn screen_at(mut self, at: &'static str, falls: &[(&str, f64)]) -> Self {
        self.findings.insert(at, falls.iter().map(|&(effect, fall)| finding(effect, fall)).collect());
        self
    }

    fn pair(mut self, a: &str, b: &str, joint_fall: f64) -> Self {
        let (a, b) = (a.to_owned(), b.to_owned());
        let (a_after_b, b_after_a) = (joint_fall, joint_fall);
        let (p_value, angle_degrees, alike) = (1e-9, 90.0, false);
        self.pairs.push(Pair { a, b, joint_fall, a_after_b, b_after_a, p_value, angle_degrees, alike });
        self
    }

    fn search(mut self, policy: &Policy) -> Discovery {
        discover(&mut self, policy, &mut |_| ()).expect("the base model is in the table")
    }
}

fn joined(effects: &[String]) -> String {
    let mut names = effects.to_vec();
    names.sort();
    names.join("+")
}

impl Ladder for Table {
    type Error = String;

    fn fit(&mut self, effects: &[String], hints: &Hints) -> Result<Rung, String> {
        let promises = effects.iter().map(|e| hints.get(e).map(|f| f.fall)).collect();
        self.hinted.push((joined(effects), promises));
        let chi2 = *self.chi2.get(joined(effects).as_str()).ok_or("not in the table")?;
        let parameters = 13 + effects.len();
        let names: Vec<&str> = effects.iter().map(String::as_str).collect();
        let plain = rung(&names, chi2, parameters);
        let raw = self.raw.get(joined(effects).as_str()).copied().unwrap_or(plain.reduced_chi2);
        Ok(Rung { reduced_chi2: if self.leaning { 3.0 } else { raw }, ..plain })
    }

    fn screen(&mut self, rung: &Rung) -> Result<Screen, String> {
        let at = joined(&rung.effects);
        if self.findings.get(at.as_str()).is_some_and(|f| f.iter().any(|f| f.effect == "(fails)")) {
            return Err("no screen here".into());
        }
        let findings = self.findings.get(at.as_str()).cloned().unwrap_or_default();
        let pairs = if at.is_empty() { self.pairs.clone() } else { vec![] };
        Ok(Screen { findings, pairs, chi2: rung.chi2_total, freedom: rung.freedom as usize })
    }
}

/// The sets that were fitted, the base left out.
fn tried(d: &Discovery) -> Vec<String> {
    d.tried[1..].iter().map(|r| joined(&r.effects)).collect()
}

#[test]
fn on_an_unexplained_record_a_name_needs_half_of_the_excess() {
    // With `a` an excess of 1294 stays, of which half is 647.
    let found = |both: f64| {
        Table::new(&[("", 4000.0), ("a", 2000.0), ("b", 3900.0), ("a+b", both)])
            .screen_at("", &[("a", 2000.0)])
            .screen_at("a", &[("b", 2000.0 - both)])
            .search(&Policy::default())
    };
    let little = found(1370.0);
    assert_eq!((little.found.join("+"), little.verdict), ("a".into(), Verdict::Unexplained));
    let enough = found(1340.0);
    assert_eq!((enough.found.join("+"), enough.verdict), ("a+b".into(), Verdict::Unexplained));
    let all = found(700.0);
    assert_eq!((all.found.join("+"), all.verdict), ("a+b".into(), Verdict::Explained));
    assert!(all.screen.findings.iter().all(|f| !f.set_aside), "only where nothing is missing");
}

#[test]
fn a_share_of_the_excess_counts_with_and_without_the_numerical_error() {
    let with = |chi2: f64, before: f64, raw: f64| {
        let mut table = Table::new(&[("", 4000.0), ("a", chi2)]).screen_at("", &[("a", 3000.0)]);
        table.raw = BTreeMap::from([("", before), ("a", raw)]);
        table.search(&Policy::default()).found
    };
    let found = |before: f64, raw: f64| with(3000.0, before, raw);
    // With the error `a` takes 1000 of 3294. Of the record's noise alone 80 are too much, of which half is 40.
    assert!(found(81.0, 41.5).is_empty());
    assert_eq!(found(81.0, 40.5), ["a"]);
    assert_eq!(found(3.0, 1.9), ["a"]);
    assert!(found(3.0, 2.1).is_empty());
    // Half of 3293 with the error is enough, whatever the record's noise alone says.
    assert_eq!(with(2300.0, 81.0, 80.0), ["a"]);
    assert!(with(2400.0, 81.0, 80.0).is_empty());
}

#[test]
fn on_an_explained_record_half_of_the_least_fall_must_be_promised() {
    let d = Table::new(&[("", 700.0), ("a", 675.0), ("b", 690.0)])
        .screen_at("", &[("a", 11.0), ("b", 9.0)])
        .search(&Policy::default());
    assert_eq!(tried(&d), ["a"]);
}

#[test]
fn a_fit_starts_from_what_the_latest_screen_says() {
    let mut table = Table::new(&[("", 4000.0), ("a", 2000.0), ("b", 3900.0), ("a+b", 700.0)])
        .screen_at("", &[("a", 2000.0), ("b", 50.0)])
        .screen_at("a", &[("b", 1300.0)]);
    discover(&mut table, &Policy::default(), &mut |_| ()).unwrap();
    let told = |set: &str| table.hinted.iter().find(|h| h.0 == set).unwrap().1.clone();
    assert_eq!((told("a"), told("a+b")), (vec![Some(2000.0)], vec![Some(2000.0), Some(1300.0)]));
}

#[test]
fn a_pair_is_taken_at_once_only_where_it_is_worth_two_names() {
    // One effect leaves an excess of 1294; the pair must take half of it, or explain the record.
    let steps = |both: f64| {
        let d = Table::new(&[("", 4000.0), ("a", 2000.0), ("b", 3900.0), ("a+b", both)])
            .screen_at("", &[("a", 2000.0), ("b", 100.0)])
            .pair("a", "b", 4000.0 - both)
            .search(&Policy::default());
        d.ladder.iter().map(|r| joined(&r.effects)).collect::<Vec<_>>()
    };
    assert_eq!(steps(1370.0), ["", "a"]);
    assert_eq!(steps(1340.0), ["", "a+b"]);
    assert_eq!(steps(720.0), ["", "a+b"]);
}

#[test]
fn two_effects_that_are_nothing_alone_are_found_as_a_pair() {
    let d = Table::new(&[("", 4000.0), ("a", 3999.0), ("b", 3999.0), ("a+b", 700.0)])
        .screen_at("", &[])
        .pair("a", "b", 3300.0)
        .search(&Policy::default());
    assert_eq!((d.found.join("+"), d.verdict), ("a+b".into(), Verdict::Explained));
}

#[test]
fn a_pair_is_fitted_when_it_promises_ten_more_than_any_single_effect() {
    let fitted = |joint: f64| {
        let d = Table::new(&[("", 4000.0), ("a", 2000.0), ("b", 3900.0), ("a+b", 700.0)])
            .screen_at("", &[("a", 2000.0), ("b", 100.0)])
            .pair("a", "b", joint)
            .search(&Policy::default());
        tried(&d).contains(&"a+b".to_owned())
    };
    assert_eq!([2010.5, 2009.5].map(fitted), [true, false]);
}

#[test]
fn an_effect_whose_derivative_tells_nothing_is_tried_where_nothing_else_explains() {
    let run = |a: f64| {
        let mut table = Table::new(&[("", 4000.0), ("a", a), ("dull", 690.0)])
            .screen_at("", &[("a", 3000.0), ("dull", 0.0)])
            .screen_at("a", &[]);
        let dull = &mut table.findings.get_mut("").unwrap()[1];
        (dull.refit_only, dull.significant) = (true, false);
        table.search(&Policy::default())
    };
    assert_eq!(run(2000.0).found, ["dull"]);
    // Where `a` explains the record `dull` is its rival only.
    let d = run(686.0);
    assert_eq!(d.groups, [["a", "dull"]]);
}

#[test]
fn what_many_effects_promise_alike_on_a_leaning_record_is_the_error_of_the_mesh() {
    let run = |others: f64| {
        let mut table = Table::new(&[("", 700.0), ("a", 600.0)])
            .screen_at("", &[("a", 100.0), ("b", others), ("c", others), ("d", others)])
            .screen_at("a", &[]);
        table.leaning = true;
        table.search(&Policy::default())
    };
    let many = run(51.0);
    assert!(many.found.is_empty() && tried(&many).is_empty() && many.failed.is_empty(), "{:?}", many.found);
    assert!(many.screen.findings.iter().all(|f| f.set_aside && !f.visible));
    assert_eq!(run(49.0).found, ["a"], "only one promises that much");
}

#[test]
fn where_the_mesh_explains_an_effect_may_not_lean_on_it_more() {
    let found = |after: f64| {
        let mut table = Table::new(&[("", 760.0), ("a", 700.0)]).screen_at("", &[("a", 60.0)]);
        table.raw = BTreeMap::from([("", 4.0), ("a", after)]);
        table.search(&Policy::default()).found
    };
    assert_eq!(found(3.9), ["a"]);
    assert!(found(4.1).is_empty());
}

#[test]
fn the_first_three_are_refitted_and_further_ones_that_promise_about_as_much() {
    let sets = [("", 4000.0), ("a", 2000.0), ("b", 3000.0), ("c", 3100.0), ("d", 3200.0), ("e", 3300.0)];
    let run = |d: f64| {
        let s = Table::new(&sets)
            .screen_at("", &[("a", 1000.0), ("b", 500.0), ("c", 400.0), ("d", d), ("e", 100.0)]);
        tried(&s.search(&Policy::default()))
    };
    assert_eq!(run(390.0), ["a", "b", "c"]);
    // All four promise more than 0.8 of the best.
    let s = Table::new(&sets)
        .screen_at("", &[("a", 1000.0), ("b", 950.0), ("c", 900.0), ("d", 810.0), ("e", 790.0)]);
    assert_eq!(tried(&s.search(&Policy::default())), ["a", "b", "c", "d"]);
}

#[test]
fn a_look_alike_is_fitted_along_when_it_promises_a_little_or_its_derivative_tells_nothing() {
    let sets = [("", 4000.0), ("a", 2000.0), ("b", 2001.0), ("c", 2002.0), ("d", 2003.0)];
    let mut table = Table::new(&sets).screen_at("", &[("a", 1000.0), ("b", 10.5), ("c", 9.5), ("d", 0.0)]);
    let findings = table.findings.get_mut("").unwrap();
    findings[0].look_alikes = ["b", "c", "d"].map(String::from).to_vec();
    findings[1..].iter_mut().for_each(|f| f.significant = false);
    findings[3].refit_only = true;
    // `d` belongs to the first lot's look-alikes; that it is tried later as well costs no second fit.
    assert_eq!(tried(&table.search(&Policy::default())), ["a", "b", "d"]);
}

#[test]
fn once_one_explains_only_its_equals_by_promise_are_fitted() {
    let run = |b: f64| {
        let s = Table::new(&[("", 4000.0), ("a", 700.0), ("b", 710.0), ("c", 720.0)])
            .screen_at("", &[("a", 1000.0), ("b", b), ("c", 500.0)]);
        tried(&s.search(&Policy::default()))
    };
    assert_eq!(run(810.0), ["a", "b"]);
    assert_eq!(run(780.0), ["a"]);
}

#[test]
fn a_rival_is_fitted_when_it_promises_four_fifths_less_nine_or_looks_alike() {
    let run = |b: f64, alike: bool| {
        let mut table =
            Table::new(&[("", 4000.0), ("a", 700.0), ("b", 701.0)]).screen_at("", &[("a", 100.0), ("b", b)]);
        if alike {
            table.findings.get_mut("").unwrap()[0].look_alikes.push("b".into());
        }
        table.findings.get_mut("").unwrap()[1].significant = false;
        table.search(&Policy::default()).groups
    };
    assert_eq!(run(71.5, false), [["a", "b"]]);
    assert_eq!(run(70.5, false), [["a"]]);
    assert_eq!(run(11.0, true), [["a", "b"]]);
    assert_eq!(run(9.0, true), [["a"]], "a look-alike that explains nothing is none");
}

#[test]
fn a_rival_that_promised_more_and_never_arrived_is_not_refuted() {
    let groups = |promise: f64, b: &[(&'static str, f64)]| {
        let chi2: Vec<_> = [("", 4000.0), ("a", 700.0)].iter().chain(b).copied().collect();
        Table::new(&chi2).screen_at("", &[("a", 3300.0), ("b", promise)]).search(&Policy::default()).groups
    };
    // No model is worse than the one that it holds as a special case.
    assert_eq!(groups(3400.0, &[("b", 4000.0)]), [["a", "b"]]);
    assert_eq!(groups(3400.0, &[]), [["a", "b"]], "no fit at all says as little");
    assert_eq!(groups(3400.0, &[("b", 3999.0)]), [["a"]]);
    assert_eq!(groups(3300.0, &[("b", 4000.0)]), [["a"]], "what promised less needs no fit to be second");
}

#[test]
fn an_effect_that_another_makes_needless_is_taken_back() {
    let found = |b: f64| {
        let d = Table::new(&[("", 4000.0), ("a", 2000.0), ("b", b), ("a+b", 700.0)])
            .screen_at("", &[("a", 2000.0)])
            .screen_at("a", &[("b", 1300.0)])
            .search(&Policy::default());
        d.found.join("+")
    };
    // One parameter is ln 720 = 6.58 of BIC: without `a` it is worse by less than 6 up to 12.58 of χ².
    assert_eq!(found(712.5), "b");
    assert_eq!(found(712.7), "a+b");
}

#[test]
fn a_search_ends_at_the_largest_number_of_effects_and_at_a_screen_that_fails() {
    let table = || {
        Table::new(&[("", 4000.0), ("a", 2000.0), ("b", 3900.0), ("a+b", 700.0)])
            .screen_at("", &[("a", 2000.0)])
            .screen_at("a", &[("b", 1300.0)])
    };
    let one = Policy { max_effects: 1, ..Policy::default() };
    let d = table().pair("a", "b", 3300.0).search(&one);
    assert_eq!((d.found.join("+"), tried(&d)), ("a".into(), vec!["a".into()]), "nor is a pair tried");
    let d = table().screen_at("a", &[("(fails)", 0.0)]).search(&Policy::default());
    assert_eq!((d.found.join("+"), d.verdict), ("a".into(), Verdict::Unexplained));
    assert_eq!(d.failed, [(vec!["a".to_owned()], "screen: no screen here".to_owned())]);
}

#[test]
fn progress_is_told_in_sentences() {
    let mut table = Table::new(&[("", 4000.0), ("a", 2000.0), ("b", 3900.0), ("a+b", 700.0)])
        .screen_at("", &[("a", 2000.0), ("c", 1900.0)])
        .screen_at("a", &[("b", 1300.0)]);
    let mut told = Vec::new();
    discover(&mut table, &Policy::default(), &mut |s| told.push(s.to_owned())).unwrap();
    for sentence in [
        "With a: χ² 2.83, BIC 2092.",
        "With c: no fit (not in the table).",
        "a is kept: χ² 2.83.",
        "a + b is kept: χ² 0.99.",
    ] {
        assert!(told.contains(&sentence.to_owned()), "{sentence} {told:?}");
    }
}
