//! Who shares a group with the effect that was named: fits and screens are written down here, so that each rule is
//! met by the numbers that it is about.
#![allow(missing_docs)]

use diagnose::*;
use std::collections::BTreeMap;

const POINTS: f64 = 720.0;

/// Fits as a table: effects joined by `+`, χ² and number of parameters.
struct Table {
    rungs: BTreeMap<String, Rung>,
    findings: Vec<Finding>,
}

fn rung(effects: &[&str], chi2: f64, parameters: usize) -> Rung {
    let freedom = POINTS - parameters as f64;
    Rung {
        effects: effects.iter().map(|e| (*e).to_owned()).collect(),
        parameters,
        points: POINTS as usize,
        rms: 0.01,
        reduced_chi2: chi2 / freedom,
        chi2_total: chi2,
        freedom,
        bic: chi2 + parameters as f64 * POINTS.ln(),
        aicc: chi2 + 2.0 * parameters as f64,
        held_out_chi2: None,
        held_out_points: 0,
        held_out_rms: None,
        structure_p: 1.0,
    }
}

fn finding(effect: &str, fall: f64) -> Finding {
    Finding {
        effect: effect.into(),
        amplitudes: vec![("amount".into(), 0.1)],
        std_errors: vec![0.01],
        shape: vec![],
        shape_index: 0,
        fall,
        expected_fall: fall / POINTS,
        p_value: 1e-9,
        p_bonferroni: 1e-9,
        q_value: 1e-8,
        visibility: 0.5,
        snr: 20.0,
        visible: true,
        significant: true,
        look_alikes: vec![],
        refit_only: false,
        set_aside: false,
    }
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
