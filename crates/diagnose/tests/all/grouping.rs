//! Who shares a group with the effect that was named: fits and screens are written down here, so that each rule is
//! met by the numbers that it is about.
#![allow(missing_docs)]

use crate::tables;

use diagnose::*;
use std::collections::BTreeMap;
use tables::*;

/// Fits as a table: effects joined by `+`, χ² and number of parameters.
struct Table {
    rungs: BTreeMap<String, Rung>,
    findings: Vec<Finding>,
    /// Pairs that the records cannot tell apart.
    untold: Option<[&'static str; 2]>,
}

impl Ladder for Table {
    type Error = String;

    fn fit(&mut self, effects: &[String], _: &Hints) -> Result<Rung, String> {
        self.rungs.get(&effects.join("+")).cloned().ok_or_else(|| "not in the table".into())
    }

    fn screen(&mut self, rung: &Rung) -> Result<Screen, String> {
        let more = rung.effects.is_empty() || self.untold.is_some();
        let new = |f: &&Finding| more && !rung.effects.contains(&f.effect);
        let findings = self.findings.iter().filter(new).cloned().collect();
        Ok(Screen { findings, pairs: vec![], chi2: rung.chi2_total, freedom: rung.freedom as usize })
    }

    fn untold(&self, effect: &str) -> Vec<String> {
        let pair = self.untold.iter().find(|pair| pair.contains(&effect));
        pair.map_or(Vec::new(), |pair| pair.iter().filter(|e| **e != effect).map(|e| (*e).into()).collect())
    }
}

/// The base model and two effects, the second with two parameters more, by their χ².
fn group(base: f64, plain: f64, rich: f64) -> Vec<Vec<String>> {
    let rungs = [rung(&[], base, 13), rung(&["plain"], plain, 14), rung(&["rich"], rich, 16)];
    let rungs = rungs.map(|r| (r.effects.join("+"), r)).into();
    let findings = vec![finding("plain", base - plain), finding("rich", base - rich)];
    let mut table = Table { rungs, findings, untold: None };
    let found =
        discover(&mut table, &Policy::default(), &mut |_| ()).expect("the base model is in the table");
    assert_eq!(found.found, ["plain"]);
    found.groups
}

#[test]
fn parameters_tell_no_rivals_apart_on_records_that_noise_explains() {
    // BIC is 7 to 18 apart, the fits are not.
    assert_eq!(group(700.0, 670.0, 664.0), [["plain", "rich"]]);
    assert_eq!(group(700.0, 670.0, 675.0), [["plain", "rich"]]);
}

#[test]
fn a_rival_that_fits_worse_stays_out() {
    assert_eq!(group(720.0, 670.0, 680.0), [["plain"]]);
}

#[test]
fn a_rival_that_would_not_be_named_itself_stays_out() {
    assert_eq!(group(691.0, 670.0, 673.0), [["plain"]]);
}

#[test]
fn where_something_is_missing_a_parameter_must_pay() {
    assert_eq!(group(1400.0, 670.0, 668.0), [["plain"]]);
    assert_eq!(group(1400.0, 670.0, 660.0), [["plain", "rich"]]);
}

/// A record without what tells two effects apart, by the χ² of the base model, the better one and the other.
fn group_untold(base: f64, better: f64, other: f64) -> (Verdict, Vec<Vec<String>>) {
    let rungs = [rung(&[], base, 13), rung(&["lag"], better, 14), rung(&["viscoelastic"], other, 16)];
    let rungs = rungs.map(|r| (r.effects.join("+"), r)).into();
    let findings = vec![finding("lag", base - better), finding("viscoelastic", base - other)];
    let mut table = Table { rungs, findings, untold: Some(["lag", "viscoelastic"]) };
    let found =
        discover(&mut table, &Policy::default(), &mut |_| ()).expect("the base model is in the table");
    (found.verdict, found.groups)
}

#[test]
fn a_better_fit_is_no_proof_where_the_records_lack_what_would_tell() {
    let both = vec![vec!["lag".to_owned(), "viscoelastic".to_owned()]];
    assert_eq!(group_untold(1700.0, 700.0, 1190.0), (Verdict::Ambiguous, both));
    assert_eq!(group_untold(1700.0, 700.0, 1210.0), (Verdict::Explained, vec![vec!["lag".to_owned()]]));
}

/// Both are found: each may be the other.
#[test]
fn two_that_cannot_be_told_apart_stand_in_each_others_group() {
    let rungs = [
        rung(&[], 9000.0, 13),
        rung(&["lag"], 1500.0, 14),
        rung(&["viscoelastic"], 5000.0, 16),
        rung(&["lag", "viscoelastic"], 700.0, 17),
    ];
    let rungs = rungs.map(|r| (r.effects.join("+"), r)).into();
    let findings = vec![finding("lag", 7000.0), finding("viscoelastic", 4000.0)];
    let mut table = Table { rungs, findings, untold: Some(["lag", "viscoelastic"]) };
    let found =
        discover(&mut table, &Policy::default(), &mut |_| ()).expect("the base model is in the table");
    assert_eq!(found.verdict, Verdict::Ambiguous);
    assert_eq!(found.groups, [["lag", "viscoelastic"], ["viscoelastic", "lag"]]);
}
