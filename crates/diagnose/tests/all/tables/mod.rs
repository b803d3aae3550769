//! Rungs and findings as numbers: what the tests that write fits and screens down share.
#![allow(dead_code)]

use diagnose::*;

/// Points of the record.
pub const POINTS: f64 = 720.0;

/// A fitted rung of this χ², nothing held out and no structure left.
pub fn fitted_model(effects: &[&str], chi2: f64, parameters: usize) -> FittedModel {
    let freedom = POINTS - parameters as f64;
    FittedModel {
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

/// A significant finding that promises this fall.
pub fn finding(effect: &str, fall: f64) -> Finding {
    Finding {
        effect: effect.into(),
        amplitudes: vec![("amount".into(), 0.1)],
        std_errors: vec![0.01],
        shape: vec![],
        shape_index: 0,
        fall,
        expected_fall: fall / POINTS,
        p_value: 1e-9,
        p_estimated: None,
        p_bonferroni: 1e-9,
        q_value: 1e-8,
        visibility: 0.5,
        snr: 20.0,
        visible: true,
        significant: true,
        look_alikes: vec![],
        refit_only: false,
    }
}
