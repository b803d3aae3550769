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
    assert_eq!(of("drift")?, serde_json::json!(["uniaxial", "tearing", "t_peel", "peel_180", "pure_shear"]));
    assert_eq!(of("bridging")?, serde_json::json!(["tearing", "t_peel", "peel_180", "pure_shear"]));
    assert_eq!(of("misalignment")?, serde_json::json!(["tearing", "pure_shear"]));
    let all = ["uniaxial", "tearing", "t_peel", "peel_180", "biaxial", "pure_shear"];
    assert_eq!(of("viscoelastic")?, serde_json::json!(all));
    Ok(())
}

/// The mesh that a start is looked for on tears in jumps where the file's own does not; a path that holds needs fewer iterations there than
/// one that tears, and is no start.
#[test]
fn stiffness_and_tear_of_a_peel_are_found_from_a_file_ten_times_off() -> Tested {
    let path = |times: f64| {
        let (gc, sigma_c) = (0.04 * times, 0.03 * times);
        format!("[interface]\ngc_N_per_mm = {gc}\nsigma_c_MPa = {sigma_c}\n")
    };
    let truth = "[solver]\nstep_mm = 0.25\n[output]\nnoise = 0.005\nseed = 5\nfields = false\n";
    let folder = written(&peel(PROTOCOL, &(path(1.0) + truth)))?;
    let here = folder.path();
    answer(here, &["simulate", "peel.toml", "--out", "made"])?;
    let model = peel("", &path(10.0)).replace("{ start = 30.0, fixed = true }", "300.0");
    let (_, model) = model.split_once("[mesh]").ok_or("a mesh")?;
    let fit = format!("specimen = \"made/specimen.toml\"\n[mesh]{model}[output]\nfields = false\n");
    fs::write(here.join("fit.toml"), fit)?;
    let found = answer(here, &["identify", "fit.toml"])?;
    assert_eq!(found["explained"], true, "{}", found["reduced_chi2"]);
    let rows = found["parameters"].as_array().ok_or("parameters")?;
    for (path, truth) in
        [("bulk.mu", 0.03), ("interface.area[1].gc", 0.04), ("interface.area[1].sigma_c", 0.03)]
    {
        let row = rows.iter().find(|p| p["path"] == path).ok_or(path)?;
        let [lower, upper]: [f64; 2] = serde_json::from_value(row["interval_95"].clone())?;
        assert!(lower <= truth && truth <= upper, "{row}");
    }
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

/// A sheet of fibrous tissue; `tests` and `more` go into the file.
fn sheet(tests: &str, gamma: f64, mu: f64, more: &str) -> String {
    format!(
        "name = \"sheet\"\n[geometry]\nlength_mm = 10.0\nwidth_mm = 8.0\nthickness_mm = 1.0\n{tests}\
         [bulk]\nmu_kPa = {mu}\nk1_kPa = 40.0\nk2 = 8.0\ngamma_deg = {gamma}\nkappa = 0.15\n{more}"
    )
}

/// One biaxial test.
fn biaxial(name: &str, rest: &str) -> String {
    format!("[[tests]]\nname = \"{name}\"\nkind = \"biaxial\"\n{rest}\n")
}

const SHEET_LEGS: &str = "protocol = [{ to_mm = 1.2, rate_mm_per_s = 0.05 }, { hold_s = 60.0 }, \
                          { to_mm = 0.4, rate_mm_per_s = 0.05 }, { to_mm = 2.0, rate_mm_per_s = 0.05 }]";

#[test]
fn records_of_two_axes_are_checked_against_their_experiment() -> Tested {
    let rows = |x: &dyn Fn(f64) -> f64| -> String {
        let row = |i: i32| {
            let u = 0.05 * f64::from(i);
            format!("{i},{u},{},{},{}\n", 0.1 * u, x(u), 0.08 * u)
        };
        (0..30).map(row).collect()
    };
    let said = |record: String, kind: &str| -> Result<String, Box<dyn std::error::Error>> {
        let folder = tempfile::tempdir()?;
        let text = sheet(&biaxial("one", "data = \"one.csv\"").replace("biaxial", kind), 30.0, 5.0, "");
        fs::write(folder.path().join("sheet.toml"), text)?;
        fs::write(folder.path().join("one.csv"), record)?;
        let out = fct(folder.path(), &["check", "sheet.toml"])?;
        Ok(format!("{:?} {}", out.status.code(), String::from_utf8_lossy(&out.stderr)))
    };
    let header = "time_s,displacement_mm,force_N,displacement_x_mm,force_x_N\n";
    let good = format!("{header}{}", rows(&|u| 0.5 * u));
    let bent = format!("{header}{}", rows(&|u| if u < 1.0 { 0.5 * u } else { u - 0.5 }));
    assert!(said(good.clone(), "biaxial")?.starts_with("Some(0)"), "{}", said(good.clone(), "biaxial")?);
    let refused = said(good, "uniaxial")?;
    assert!(
        refused.starts_with("Some(2)") && refused.contains("`force_x_N` of a uniaxial test"),
        "{refused}"
    );
    let refused = said(bent, "biaxial")?;
    assert!(refused.contains("sheet.toml:9:8") && refused.contains("one ratio"), "{refused}");
    let alone: String = (0..30).map(|i| format!("{i},{},{}\n", 0.05 * f64::from(i), f64::from(i))).collect();
    let refused = said(format!("time_s,displacement_mm,force_N\n{alone}"), "biaxial")?;
    assert!(refused.contains("displacement_x_mm and force_x_N"), "{refused}");
    Ok(())
}

#[test]
fn an_effect_of_one_load_cell_is_none_of_a_test_with_two() -> Tested {
    let folder = tempfile::tempdir()?;
    let rows: String = (0..40)
        .map(|i| 0.05 * f64::from(i))
        .map(|u| format!("{},{u},{},{u},{}\n", 20.0 * u, 0.1 * u, 0.08 * u))
        .collect();
    let text = sheet(&biaxial("one", "data = \"one.csv\""), 30.0, 5.0, "[effects.drift]\n");
    fs::write(folder.path().join("sheet.toml"), text)?;
    fs::write(
        folder.path().join("one.csv"),
        format!("time_s,displacement_mm,force_N,displacement_x_mm,force_x_N\n{rows}"),
    )?;
    let out = fct(folder.path(), &["identify", "sheet.toml"])?;
    let said = String::from_utf8_lossy(&out.stderr);
    assert_eq!(out.status.code(), Some(2), "{said}");
    assert!(said.contains("sheet.toml:16:10") && said.contains("one load cell"), "{said}");
    Ok(())
}

#[test]
#[ignore = "slow: run by `just slow`"]
fn the_loop_on_a_synthetic_sheet_with_hidden_viscosity() -> Tested {
    let ratios = [("equal", 1.0), ("half", 0.5), ("broad", 1.5)];
    let made: String = ratios
        .iter()
        .map(|(n, r)| biaxial(n, &format!("{SHEET_LEGS}\nratio_x = {r}\nfresh_piece = true")).to_string())
        .collect();
    // The record is made on bricks and with steps that the fit does not use.
    let truth = "[mesh]\ndivisions = [3, 4, 2]\n[effects.viscoelastic]\ng = 0.2\ntau_s = 12.0\n\
                 [solver]\nstep_mm = 0.03\n[output]\nnoise = 0.005\nseed = 7\nfields = false\n";
    let folder = tempfile::tempdir()?;
    let here = folder.path();
    fs::write(here.join("sheet.toml"), sheet(&made, 32.0, 6.0, truth))?;
    answer(here, &["simulate", "sheet.toml", "--out", "made"])?;
    let model = sheet("", 40.0, 4.0, "");
    let (_, model) = model.split_once("[bulk]").ok_or("a bulk")?;
    fs::write(here.join("fit.toml"), format!("specimen = \"made/specimen.toml\"\n[bulk]{model}"))?;

    let base = answer(here, &["identify", "fit.toml", "--out", "base"])?;
    assert_eq!(base["explained"], false);
    assert!(
        base["channels"]["equal.force_x"]["points"].as_f64().is_some_and(|n| n > 50.0),
        "{}",
        base["channels"]
    );
    let curve = fs::read_to_string(here.join("base/curves/equal.csv"))?;
    assert!(
        curve.starts_with("time_s") && curve.contains("force_x_measured_N,force_x_model_N"),
        "{curve:.200}"
    );
    let compared = answer(here, &["compare", "base"])?;
    assert!(compared.to_string().contains("equal.force_x"), "{compared}");
    let diagnosis = answer(here, &["diagnose", "base"])?;
    println!("screen: {} first", diagnosis["screen"][0]["effect"]);
    assert_eq!(diagnosis["screen"][0]["effect"], "viscoelastic", "{}", diagnosis["screen"][0]);
    answer(here, &["add", "viscoelastic", "base", "--out", "more.toml"])?;
    let more = answer(here, &["identify", "more.toml", "--out", "more"])?;
    let value = |path: &str| -> Option<f64> {
        let rows = more["parameters"].as_array()?;
        rows.iter().find(|p| p["path"] == path)?["value"].as_f64()
    };
    let found = ["bulk.gamma", "bulk.kappa", "bulk.k2", "effects.viscoelastic.g", "effects.viscoelastic.tau"];
    println!("chi2 {} then {}", base["reduced_chi2"], more["reduced_chi2"]);
    println!("found {:?} of [0.5585, 0.15, 8, 0.2, 12]", found.map(value));
    assert_eq!(more["explained"], true);
    let near =
        |path: &str, truth: f64, share: f64| value(path).is_some_and(|v| (v / truth - 1.0).abs() < share);
    assert!(near("bulk.gamma", 32f64.to_radians(), 0.02) && near("effects.viscoelastic.g", 0.2, 0.05));
    let ladder = answer(here, &["ladder", "base", "more"])?;
    assert!(ladder["ladder"][1]["bic"].as_f64() < ladder["ladder"][0]["bic"].as_f64());
    Ok(())
}

#[test]
fn a_new_folder_of_each_experiment_is_read() -> Tested {
    let folder = tempfile::tempdir()?;
    let here = folder.path();
    for experiment in ["uniaxial", "tearing", "t_peel", "peel_180", "biaxial"] {
        let name = format!("my_{experiment}");
        answer(here, &["new", &name, "--experiment", experiment])?;
        let text = fs::read_to_string(here.join(&name).join("specimen.toml"))?;
        assert!(text.contains("synthetic") && text.contains(&format!("kind = \"{experiment}\"")), "{text}");
        answer(here, &["check", "--quick", &format!("{name}/{name}.toml")])?;
    }
    let out = fct(here, &["new", "x", "--experiment", "t_peal"])?;
    let said = String::from_utf8_lossy(&out.stderr);
    assert_eq!(out.status.code(), Some(2), "{said}");
    assert!(said.contains("t_peel, peel_180, biaxial") && !here.join("x").exists(), "{said}");
    Ok(())
}
