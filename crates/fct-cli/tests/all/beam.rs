//! A double cantilever beam whose file starts the search far off: three times too stiff, on a path so brittle that its
//! tear cannot be followed.

use crate::common;

use common::{Tested, fct, folder, json};
use std::fs;

/// A laminate beam, pulled open at its mouth; `tests` says what is done to it.
fn beam(tests: &str, k1: f64, gc: f64, sigma_c: f64, more: &str) -> String {
    format!(
        r#"name = "beam"
provenance = "synthetic"
[geometry]
length_mm = 5.4
width_mm = 60.0
thickness_mm = 25.0
cut_mm = 20.0
[[tests]]
kind = "tearing"
grips = "mouth"
{tests}
[mesh]
divisions = [60, 4, 1]
[bulk]
mu_MPa = 2288.0
k1_MPa = {k1}
k2 = 0.0
gamma_deg = 90.0
kappa = 0.0
bulk_modulus_MPa = 5900.0
fibre_invariants = "full"
tension_only = false
[interface]
gc_N_per_mm = {gc}
sigma_c_MPa = {sigma_c}
{more}"#
    )
}

/// The record of [`recorded`].
const RECORD: &str = "data = \"record/tearing.csv\"";

/// A folder with the record of a beam.
fn recorded() -> Result<tempfile::TempDir, Box<dyn std::error::Error>> {
    let protocol = "protocol = [{ to_mm = 4.0, rate_mm_per_s = 0.05 }]";
    let output = "[solver]\nstep_mm = 0.05\n[output]\nnoise = 0.01\nseed = 3\n";
    let folder = folder(&beam(protocol, 5000.0, 0.8, 1.0, output))?;
    let (code, _, stderr) = json(folder.path(), &["simulate", "strip.toml", "--out", "record"])?;
    assert_eq!(code, 0, "{stderr}");
    Ok(folder)
}

#[test]
#[ignore = "slow: run by `just slow`"]
fn a_start_from_which_the_record_cannot_be_followed_is_mended() -> Tested {
    let folder = recorded()?;
    fs::write(folder.path().join("far.toml"), beam(RECORD, 15_000.0, 0.03, 20.0, ""))?;

    // The start itself gives no answer, and what lies at a limit of the law stays there.
    let (code, _, _) = json(folder.path(), &["simulate", "far.toml", "--out", "start"])?;
    assert_eq!(code, 1, "the start is not as bad as this test needs it");
    let checked = fct(folder.path(), &["check", "far.toml"])?;
    let text = String::from_utf8(checked.stdout)?;
    assert!(text.contains("Held at the limit that the file gives: bulk.k2 = 0, bulk.gamma = 90"), "{text}");

    let (code, answer, stderr) = json(folder.path(), &["identify", "far.toml", "--out", "fit"])?;
    assert_eq!(code, 0, "{stderr}");
    holds_the_truth(&answer)?;
    let remarks = answer["remarks"].to_string();
    assert!(remarks.contains("bulk.kappa = 0"), "{remarks}");
    Ok(())
}

/// All start values ten times as large, and a tenth.
#[test]
#[ignore = "slow: run by `just slow`"]
fn a_start_ten_times_off_ends_at_the_truth() -> Tested {
    let folder = recorded()?;
    let mut ends = Vec::new();
    for (name, times) in [("more", 10.0), ("less", 0.1)] {
        let file = format!("{name}.toml");
        let far = beam(RECORD, times * 5000.0, times * 0.8, times * 1.0, "");
        fs::write(folder.path().join(&file), far)?;
        let (code, answer, stderr) = json(folder.path(), &["identify", &file, "--out", name])?;
        assert_eq!(code, 0, "{stderr}");
        holds_the_truth(&answer).map_err(|e| format!("{name}: {e}"))?;
        ends.push(answer["reduced_chi2_total"].as_f64().ok_or("reduced χ²")?);
    }
    assert!((ends[0] / ends[1] - 1.0).abs() < 0.01, "{ends:?}");
    Ok(())
}

/// Explained, with toughness and strength inside their intervals.
fn holds_the_truth(answer: &serde_json::Value) -> Tested {
    assert_eq!(answer["explained"], true, "{}", answer["reduced_chi2_total"]);
    for (path, truth) in [("interface.area[1].gc", 0.8), ("interface.area[1].sigma_c", 1.0)] {
        let all = answer["parameters"].as_array().ok_or("parameters")?;
        let p = all.iter().find(|p| p["path"] == path).ok_or(path)?;
        let ends: Vec<f64> =
            p["interval_95"].as_array().ok_or("interval")?.iter().filter_map(|v| v.as_f64()).collect();
        assert!(ends[0] <= truth && truth <= ends[1], "{path}: {ends:?}");
    }
    Ok(())
}
