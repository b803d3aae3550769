//! Who shares a group with the effect that was named: fits and screens are written down here, so that each rule is
//! met by the numbers that it is about.
#![allow(missing_docs)]

mod tables;

use diagnose::*;
use std::collections::BTreeMap;
use tables::*;

/// Fits as a table: effects joined by `+`, χ² and number of parameters.
struct Table {
    rungs: BTreeMap<String, Rung>,
    findings: Vec<Finding>,
}

impl Ladder for Table {
    type Error = String;

    fn fit(&mut self, effects: &[String], _: &Hints) -> Result<Rung, String> {
        self.rungs.get(&effects.join("+")).cloned().ok_or_else(|| "not in the table".into())
    }

    fn screen(&mut self, rung: &Rung) -> Result<Screen, String> {
        let new = |f: &&Finding| rung.effects.is_empty() && !rung.effects.contains(&f.effect);
        let findings = self.findings.iter().filter(new).cloned().collect();
        Ok(Screen { findings, pairs: vec![], chi2: rung.chi2_total, freedom: rung.freedom as usize })
    }
}

/// The base model and two effects, the second with two parameters more, by their χ².
fn group(base: f64, plain: f64, rich: f64) -> Vec<Vec<String>> {
    let rungs = [rung(&[], base, 13), rung(&["plain"], plain, 14), rung(&["rich"], rich, 16)];
    let rungs = rungs.map(|r| (r.effects.join("+"), r)).into();
    let findings = vec![finding("plain", base - plain), finding("rich", base - rich)];
    let mut table = Table { rungs, findings };
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
