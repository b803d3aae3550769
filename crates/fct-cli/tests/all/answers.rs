//! The loop from outside, one command after the other: `compare`, `diagnose`, `add`, `ladder`, `drop`, `discover` give
//! the answers that scripts rely on. The record hides a drifting zero of the load cell.

use crate::common;

use common::{FIT, Tested, fct, folder, json, strip};
use serde_json::Value;
use std::fs;
use std::path::Path;
use tempfile::TempDir;

const DRIFT: &str = "[effects.drift]\nc_N_per_s = 1.5e-4\n[solver]\nstep_mm = 0.2\n\
    [output]\nnoise = 0.005\nseed = 3\nfields = false\n";

/// A folder with a record of a strip on a drifting load cell, and a config that does not know of it.
fn drifting() -> Result<TempDir, Box<dyn std::error::Error>> {
    let folder = folder(&strip(DRIFT))?;
    answer(folder.path(), &["simulate", "strip.toml"])?;
    fs::write(folder.path().join("fit.toml"), FIT)?;
    Ok(folder)
}

/// The answer of a command that ends well.
fn answer(here: &Path, arguments: &[&str]) -> Result<Value, Box<dyn std::error::Error>> {
    let (code, answer, stderr) = json(here, arguments)?;
    assert_eq!(code, 0, "{arguments:?}: {stderr}");
    assert_eq!(answer["schema"], 1, "{arguments:?}");
    Ok(answer)
}

fn holds(value: &Value, keys: &[&str]) {
    for key in keys {
        assert!(value.get(key).is_some(), "`{key}` is not in {value}");
    }
}

/// What `diagnose` and `discover` both say.
fn holds_a_diagnosis(said: &Value, catalogue: usize) {
    holds(said, &["specimen", "screen", "found", "groups", "verdict", "where", "next_test", "seconds"]);
    let screen = said["screen"].as_array().map_or(&[][..], Vec::as_slice);
    assert_eq!(screen.len(), catalogue);
    for row in screen {
        holds(row, &["effect", "expected_fall", "p_value", "estimate", "visible", "look_alikes", "sentence"]);
        let share = row["expected_fall"].as_f64().unwrap_or(f64::NAN);
        assert!((0.0..=1.0).contains(&share), "{row}");
    }
    assert_eq!(screen[0]["effect"], "drift", "{}", screen[0]);
    holds(&said["where"][0], &["test", "segment", "share"]);
}

#[test]
fn the_loop_one_command_after_the_other() -> Tested {
    let folder = drifting()?;
    let here = folder.path();
    let base = answer(here, &["identify", "fit.toml", "--out", "base"])?;
    assert_eq!(base["explained"], false);

    let compared = answer(here, &["compare", "base"])?;
    assert_eq!(compared["tests"], base["tests"], "it is that run which is looked at");
    holds(&compared, &["where", "along_the_tear", "depends_on", "words", "explained"]);
    let share = |rows: &str| -> f64 {
        let of_tear = compared[rows].as_array().into_iter().flatten().filter(|r| r["test"] == "tearing");
        of_tear.filter_map(|r| r["share"].as_f64()).sum()
    };
    assert!((share("where") - share("along_the_tear")).abs() < 1e-9 && share("where") > 0.5);
    assert_eq!(compared["along_the_tear"][0]["to_mm"], 1.5, "the tear begins at the cut");

    let catalogue = answer(here, &["effects"])?["effects"].as_array().map_or(0, Vec::len);
    assert!(catalogue >= 25);
    let diagnosis = answer(here, &["diagnose", "base"])?;
    holds_a_diagnosis(&diagnosis, catalogue);
    assert!(here.join("base/diagnosis.json").is_file());

    answer(here, &["add", "drift", "base", "--out", "more.toml"])?;
    let more = answer(here, &["identify", "more.toml", "--out", "more"])?;
    assert_eq!((&more["explained"], &more["effects"]), (&true.into(), &serde_json::json!(["drift"])));
    // What was foretold came true.
    let fall =
        1.0 - more["reduced_chi2"].as_f64().ok_or("χ²")? / base["reduced_chi2"].as_f64().ok_or("χ²")?;
    let foretold = diagnosis["screen"][0]["expected_fall"].as_f64().ok_or("fall")?;
    assert!((foretold / fall - 1.0).abs() < 0.25, "foretold {foretold}, came {fall}");

    let ladder = answer(here, &["ladder", "base", "more"])?;
    assert_eq!(ladder["ladder"].as_array().map(Vec::len), Some(2));
    holds(&ladder["ladder"][1], &["effects", "parameters", "rms_N", "reduced_chi2", "held_out_rms_N", "bic"]);
    assert!(ladder["ladder"][1]["bic"].as_f64() < ladder["ladder"][0]["bic"].as_f64());

    answer(here, &["drop", "drift", "more.toml", "--out", "less.toml"])?;
    assert!(!fs::read_to_string(here.join("less.toml"))?.contains("drift"));
    // A screen that calls for nothing points to nothing.
    for verdict in ["ambiguous", "unexplained"] {
        rewritten(&here.join("base"), "diagnosis.json", |said| {
            said["verdict"] = verdict.into();
            said["found"] = Value::Array(vec![]);
            said["groups"] = Value::Array(vec![]);
        })?;
        assert!(fct(here, &["report", "base"])?.status.success());
        let page = fs::read_to_string(here.join("base/report.html"))?;
        assert!(!page.contains("points to <") && !page.contains("points to ."), "{verdict}");
    }
    Ok(())
}

#[test]
fn discover_names_what_is_hidden() -> Tested {
    let folder = drifting()?;
    let here = folder.path();
    fs::write(here.join("fit.toml"), FIT.replace("[interface]\n", "[interface]\nareas = 3\n"))?;
    let out = fct(here, &["discover", "fit.toml", "--out", "search", "--json"])?;
    let said = String::from_utf8(out.stderr)?;
    let look = said.lines().find(|l| l.contains("First look")).ok_or("no first look")?;
    assert!(look.contains("χ² takes away drift "), "{look}");
    let found: Value = serde_json::from_slice(&out.stdout)?;
    let catalogue = answer(here, &["effects"])?["effects"].as_array().map_or(0, Vec::len);
    holds_a_diagnosis(&found, catalogue);
    assert!(matches!(found["verdict"].as_str(), Some("explained" | "ambiguous")), "{}", found["verdict"]);
    let group = found["groups"][0].as_array().ok_or("groups")?;
    assert!(group.contains(&"drift".into()) && group.len() <= 3, "{group:?}");
    let fitted_models = found["ladder"].as_array().ok_or("ladder")?;
    assert!(
        fitted_models.len() >= 2 && fitted_models[1]["rms_N"].as_f64() < fitted_models[0]["rms_N"].as_f64()
    );
    // One strength would do as well as three, and is said to.
    let one = &found["one_strength"];
    assert!(one["as_good"].as_array().is_some_and(|a| a.contains(&serde_json::json!(["drift"]))), "{one}");
    let gc = &one["ladder"][0]["values"]["interface.area[1].gc"];
    assert!(gc.as_f64().is_some_and(|gc| (gc / 0.15 - 1.0).abs() < 0.1), "{gc}");
    let averaged = &found["averaged"]["path_means"]["sigma_c"];
    let [strength, low, high] =
        [&averaged["value"], &averaged["interval_95"][0], &averaged["interval_95"][1]]
            .map(|v| v.as_f64().unwrap_or(f64::NAN));
    assert!((strength / 0.08 - 1.0).abs() < 0.1 && low < 0.08 && 0.08 < high, "{}", found["averaged"]);
    // The same run, asked in words.
    let sentence = "Averaged over what may be missing, along the tear: strength σc 0.08";
    let again = fct(here, &["discover", "fit.toml", "--out", "search", "--resume"])?;
    let words = String::from_utf8(again.stdout)?;
    assert!(words.split_whitespace().collect::<Vec<_>>().join(" ").contains(sentence), "{words}");
    let out = fct(here, &["report", "search"])?;
    assert!(out.status.success());
    let page = fs::read_to_string(here.join("search/report.html"))?;
    assert!(page.contains("drift") && page.contains("Is the model good enough?"));
    assert!(page.contains(sentence) && !page.contains("This leaves out"));
    practice_on_the_page(here)?;
    undecided_on_the_page(here)
}

/// The same run as if the misfit with drift were many times noise and mesh's error: what the page says of it follows from how much is
/// left, and whether that is more than a complete model leaves.
fn practice_on_the_page(here: &Path) -> Tested {
    let said = |found: &str, something_else: f64| -> Result<String, Box<dyn std::error::Error>> {
        rewritten(&here.join("search"), "summary.json", |answer| {
            answer["verdict"] = found.into();
            answer["posterior"]["something_else"] = something_else.into();
            answer["ladder"][1]["reduced_chi2"] = 14.0.into();
        })?;
        let out = fct(here, &["report", "search"])?;
        assert!(out.status.success(), "{}", String::from_utf8_lossy(&out.stderr));
        Ok(fs::read_to_string(here.join("search/report.html"))?)
    };
    rewritten(&here.join("search/rungs/1"), "summary.json", |fitted| {
        fitted["explained"] = false.into();
        fitted["reduced_chi2"] = 14.0.into();
        fitted["rest"]["share_of_peak"] = 0.018.into();
    })?;
    let practice = said("explained", 0.1)?;
    assert!(practice.contains("1.8 % of the peak force, as in a complete model of such a test"));
    assert!(!practice.contains("what is left is noise") && !practice.contains("error of the mesh"));
    let more = said("unexplained", 0.1)?;
    assert!(more.contains("; more is left than a complete model leaves"));
    let other = said("unexplained", 0.9)?;
    assert!(other.contains(", and something that the catalogue does not hold"));
    Ok(())
}

/// The same run as if drift led without being probable enough to be named, and an end of a record had been left out: the page
/// says so, and names nothing.
fn undecided_on_the_page(here: &Path) -> Tested {
    rewritten(&here.join("search"), "summary.json", |answer| {
        answer["ladder"] = Value::Array(vec![answer["ladder"][0].clone()]);
        answer["verdict"] = "ambiguous".into();
        answer["found"] = Value::Array(vec![]);
        answer["groups"] = Value::Array(vec![]);
        answer["left_out"] = serde_json::json!([{
            "test": "tearing", "from_s": 70.0, "to_s": 80.0, "points": 3, "of": 90
        }]);
        answer["next_test"] = serde_json::json!({
            "proposal": "a hold of 300 s, and on", "separates": ["drift", "nothing"], "basis": "the effect's card"
        });
    })?;
    let out = fct(here, &["report", "search"])?;
    assert!(out.status.success(), "{}", String::from_utf8_lossy(&out.stderr));
    let page = fs::read_to_string(here.join("search/report.html"))?;
    for said in [
        "whether an effect is missing, they cannot tell",
        "These records cannot tell",
        "Neither that an effect is missing, nor that none is",
        "Separate drift from nothing",
        "This leaves out the last 3 of 90 points of tearing",
    ] {
        assert!(page.contains(said), "{said}");
    }
    Ok(())
}

/// Changes a file of a stored run, and the manifest with it.
fn rewritten(run: &Path, name: &str, change: impl FnOnce(&mut Value)) -> Tested {
    let (file, manifest) = (run.join(name), run.join("manifest.json"));
    let before = fs::read(&file)?;
    let mut value: Value = serde_json::from_slice(&before)?;
    change(&mut value);
    let after = serde_json::to_vec(&value)?;
    fs::write(&file, &after)?;
    let listed = fs::read_to_string(&manifest)?;
    let [old, new] = [before, after].map(|bytes| input::sha256(&bytes));
    assert!(listed.contains(&old));
    fs::write(&manifest, listed.replace(&old, &new))?;
    Ok(())
}
