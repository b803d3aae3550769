//! Experiments from a file to the ladder, and what is said of files that ask for what an experiment does not offer.

use crate::common::{Tested, fct, json};
use serde_json::Value;
use std::fs;
use std::path::Path;

/// A peel of soft tissue on a coarse mesh; `more` goes to the end of the file.
fn peel(test: &str, more: &str) -> String {
    format!(
        "name = \"peel\"\n[geometry]\nlength_mm = 14.0\nwidth_mm = 4.0\nthickness_mm = 2.0\ncut_mm = 4.0\n\
         [[tests]]\nkind = \"t_peel\"\n{test}\n[mesh]\ndivisions = [28, 4, 1]\n\
         [bulk]\nlaw = \"neo_hooke\"\nmu_kPa = {{ start = 30.0, fixed = true }}\nbulk_modulus_MPa = 5.0\n{more}"
    )
}

const PROTOCOL: &str = "protocol = [{ to_mm = 12.0, rate_mm_per_s = 0.1 }, { hold_s = 60.0 }, \
                        { to_mm = 6.0, rate_mm_per_s = 0.1 }, { to_mm = 17.0, rate_mm_per_s = 0.1 }]";

fn written(text: &str) -> Result<tempfile::TempDir, Box<dyn std::error::Error>> {
    let folder = tempfile::tempdir()?;
    fs::write(folder.path().join("peel.toml"), text)?;
    Ok(folder)
}

fn answer(here: &Path, arguments: &[&str]) -> Result<Value, Box<dyn std::error::Error>> {
    let (code, answer, stderr) = json(here, arguments)?;
    assert_eq!(code, 0, "{arguments:?}: {stderr}");
    Ok(answer)
}

#[test]
fn what_an_experiment_does_not_offer_is_refused_at_its_place() -> Tested {
    let refused = |text: &str, expected: &[&str]| -> Tested {
        let folder = written(text)?;
        let out = fct(folder.path(), &["check", "peel.toml"])?;
        let said = String::from_utf8_lossy(&out.stderr);
        assert_eq!(out.status.code(), Some(2), "{said}");
        for part in expected {
            assert!(said.contains(part), "`{part}` is not in\n{said}");
        }
        Ok(())
    };
    refused(
        &peel(&format!("{PROTOCOL}\nends = \"sliding\""), ""),
        &["peel.toml:10:8: error: `ends`", "t_peel"],
    )?;
    refused(&peel(&format!("{PROTOCOL}\ngrips = \"mouth\""), ""), &["peel.toml:10:9: error: `grips`"])?;
    let shaped = peel(PROTOCOL, "").replace("cut_mm", "outline = [[0, 0, 4], [14, 0, 4]]\ncut_mm");
    refused(&shaped, &["peel.toml:6:1: error: `outline`", "rectangle"])?;
    refused(
        &peel(PROTOCOL, "").replace("cut_mm = 4.0", "cut_mm = 14.0"),
        &["peel.toml:6:1", "the length is 14"],
    )?;
    let kind = peel(PROTOCOL, "").replace("t_peel", "t_peal");
    refused(&kind, &["peel.toml:8:8: error: `kind` is \"t_peal\"", "did you mean \"t_peel\"?"])
}

#[test]
fn an_effect_that_no_test_offers_is_named_with_its_place() -> Tested {
    let rows: String =
        (0..60).map(|i| format!("{i},{},{}\n", 0.2 * f64::from(i), 0.05 * f64::from(i.min(20)))).collect();
    let folder = written(&peel("data = \"peel.csv\"", "[effects.misalignment]\n"))?;
    fs::write(folder.path().join("peel.csv"), format!("time_s,displacement_mm,force_N\n{rows}"))?;
    let out = fct(folder.path(), &["identify", "peel.toml"])?;
    let said = String::from_utf8_lossy(&out.stderr);
    assert_eq!(out.status.code(), Some(2), "{said}");
    assert!(said.contains("peel.toml:16:10") && said.contains("no test between clamped ends"), "{said}");
    Ok(())
}

#[test]
fn a_card_says_in_which_experiments_its_effect_shows() -> Tested {
    let folder = tempfile::tempdir()?;
    let of = |effect: &str| -> Result<Value, Box<dyn std::error::Error>> {
        Ok(answer(folder.path(), &["effects", effect])?["effect"]["experiments"].clone())
    };
    assert_eq!(of("drift")?, serde_json::json!(["uniaxial", "tearing", "t_peel"]));
    assert_eq!(of("bridging")?, serde_json::json!(["tearing", "t_peel"]));
    assert_eq!(of("misalignment")?, serde_json::json!(["tearing"]));
    Ok(())
}

#[test]
#[ignore = "slow: run by `just slow`"]
fn the_loop_on_a_synthetic_peel_with_a_hidden_drift() -> Tested {
    let truth = "[interface]\ngc_N_per_mm = 0.04\nsigma_c_MPa = 0.03\n[effects.drift]\nc_mN_per_s = 0.1\n\
                 [solver]\nstep_mm = 0.25\n[output]\nnoise = 0.005\nseed = 5\nfields = false\n";
    let folder = written(&peel(PROTOCOL, truth))?;
    let here = folder.path();
    answer(here, &["simulate", "peel.toml", "--out", "made"])?;
    let model = peel("", "[interface]\ngc_N_per_mm = 0.03\nsigma_c_MPa = 0.05\n");
    let (_, model) = model.split_once("[mesh]").ok_or("a mesh")?;
    fs::write(here.join("fit.toml"), format!("specimen = \"made/specimen.toml\"\n[mesh]{model}"))?;

    let base = answer(here, &["identify", "fit.toml", "--out", "base"])?;
    assert_eq!(base["explained"], false);
    let balance = &base["tests"]["t_peel"]["gc_by_energy"];
    assert!(balance["gc_N_per_mm"].as_f64().is_some_and(|gc| gc > 0.02 && gc < 0.05), "{balance}");
    let diagnosis = answer(here, &["diagnose", "base"])?;
    assert_eq!(diagnosis["screen"][0]["effect"], "drift", "{}", diagnosis["screen"][0]);
    answer(here, &["add", "drift", "base", "--out", "more.toml"])?;
    let more = answer(here, &["identify", "more.toml", "--out", "more"])?;
    assert_eq!(more["explained"], true);
    let value = |path: &str| -> Option<f64> {
        let rows = more["parameters"].as_array()?;
        rows.iter().find(|p| p["path"] == path)?["value"].as_f64()
    };
    let gc = value("interface.area[1].gc").ok_or("gc")?;
    println!("Gc = {gc:.5} N/mm of 0.04, c = {:?} N/s of 1e-4", value("effects.drift.c"));
    assert!((gc / 0.04 - 1.0).abs() < 0.02, "{gc}");
    let ladder = answer(here, &["ladder", "base", "more"])?;
    assert!(ladder["ladder"][1]["bic"].as_f64() < ladder["ladder"][0]["bic"].as_f64());
    Ok(())
}
