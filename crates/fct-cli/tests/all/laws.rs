//! Another law in place of the file's: asked for by name, and found by a search.

use crate::common::{self, Tested, fct, json};
use std::fs;

const TORN: &str = "[interface]\nlaw = \"bilinear\"\n";

#[test]
fn a_law_takes_the_place_of_the_files() -> Tested {
    let folder = common::folder(&common::strip(""))?;
    let here = folder.path();
    let out = fct(here, &["add", "bilinear", "strip.toml", "--out", "torn.toml"])?;
    assert!(out.status.success(), "{}", String::from_utf8_lossy(&out.stderr));
    let text = fs::read_to_string(here.join("torn.toml"))?;
    assert!(text.contains("law = \"bilinear\"") && text.contains("gc_N_per_mm = 0.15"), "{text}");
    let out = fct(here, &["add", "bilinear", "torn.toml"])?;
    let said = String::from_utf8_lossy(&out.stderr);
    assert_eq!(out.status.code(), Some(2), "{said}");
    assert!(said.contains("`bilinear` is the law in [interface] already"), "{said}");
    // Another tissue: its parameters are its own, what resists changes of volume stays.
    let bulk = text.replace("kappa = 0.22", "kappa = 0.22\nbulk_modulus_MPa = 30.0");
    fs::write(here.join("torn.toml"), bulk)?;
    let out = fct(here, &["add", "yeoh", "torn.toml", "--out", "yeoh.toml"])?;
    assert!(out.status.success(), "{}", String::from_utf8_lossy(&out.stderr));
    let text = fs::read_to_string(here.join("yeoh.toml"))?;
    assert!(!text.contains("k1_kPa") && !text.contains("kappa") && !text.contains("mu_kPa"), "{text}");
    assert!(text.contains("bulk_modulus_MPa = 30.0") && text.contains("law = \"yeoh\""), "{text}");
    Ok(())
}

#[test]
fn what_cannot_be_added_is_told_of_the_file_that_would_be_written() -> Tested {
    let folder = common::folder(&common::strip(""))?;
    let here = folder.path();
    let said = |arguments: &[&str]| -> Result<String, Box<dyn std::error::Error>> {
        let out = fct(here, arguments)?;
        assert_eq!(out.status.code(), Some(2));
        Ok(String::from_utf8_lossy(&out.stderr).into_owned())
    };
    let none = said(&["add", "bilinaer", "strip.toml"])?;
    assert!(none.contains("unknown effect or law `bilinaer`; did you mean `bilinear`?"), "{none}");
    let effect = said(&["add", "mulins", "strip.toml"])?;
    assert!(effect.contains("did you mean `mullins`?"), "{effect}");
    // A prior of what the new law does not have.
    fs::write(
        here.join("prior.toml"),
        common::strip("[identify.priors]\nbulk.k1_kPa = { mean = 500.0, relative_sd = 0.1 }\n"),
    )?;
    let fault = said(&["add", "yeoh", "prior.toml", "--out", "yeoh.toml"])?;
    assert!(fault.contains("yeoh.toml:") && !fault.contains(".check.toml"), "{fault}");
    assert!(!here.join("yeoh.toml").exists());
    // What is wrong before anything is added is told of the user's own file, at its own line.
    let broken = common::strip("").replace("[interface]\n", "[interface]\nareas = 0\n");
    fs::write(here.join("broken.toml"), &broken)?;
    let line = 1 + broken.lines().position(|l| l == "areas = 0").ok_or("a line")?;
    for (verb, name) in [("add", "mullins"), ("add", "yeoh")] {
        let fault = said(&[verb, name, "broken.toml"])?;
        assert!(fault.contains(&format!("broken.toml:{line}:")), "{fault}");
        assert!(!fault.contains(&format!("+{name}")) && !here.join(format!("broken+{name}.toml")).exists());
    }
    // No TOML: the line, from whatever cannot change it.
    fs::write(
        here.join("quoted.toml"),
        common::strip("").replace("[interface]\n", "[interface]\nareas = few\n"),
    )?;
    for (verb, name) in [("add", "mullins"), ("add", "yeoh"), ("drop", "mullins")] {
        let fault = said(&[verb, name, "quoted.toml"])?;
        assert!(fault.contains(&format!("quoted.toml:{line}:")), "{fault}");
    }
    Ok(())
}

/// Rungs that differ by a law alone are told apart: in the answer, in the terminal's table, on the page. Where every model
/// has the default laws, no table speaks of them.
#[test]
fn a_ladder_says_which_law_each_model_has() -> Tested {
    let folder = common::synthetic()?;
    let here = folder.path();
    let done = |arguments: &[&str]| -> Result<String, Box<dyn std::error::Error>> {
        let out = fct(here, arguments)?;
        assert!(out.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&out.stderr));
        Ok(String::from_utf8(out.stdout)?)
    };
    done(&["identify", "fit.toml", "--out", "base"])?;
    let plain = done(&["ladder", "base"])?;
    assert!(!plain.contains("law"), "{plain}");
    done(&["add", "bilinear", "base", "--out", "torn.toml"])?;
    let identified = json(here, &["identify", "torn.toml", "--out", "torn"])?.1;
    let (default, other) = (
        serde_json::json!({ "bulk": "hgo", "interface": "exponential" }),
        serde_json::json!({ "bulk": "hgo", "interface": "bilinear" }),
    );
    assert_eq!((&identified["laws"], &identified["effects"]), (&other, &serde_json::json!([])));

    let (code, ladder, said) = json(here, &["ladder", "torn", "base"])?;
    assert_eq!(code, 0, "{said}");
    for row in ladder["ladder"].as_array().ok_or("rungs")? {
        assert_eq!(row["laws"], if row["run"] == "torn" { other.clone() } else { default.clone() }, "{row}");
    }
    let table = done(&["ladder", "torn", "base"])?;
    // The words of a cell may stand below each other.
    assert!(table.contains("bilinear") && !table.contains("bulk"), "{table}");
    assert!(table.contains("Where no law is named: interface exponential."), "{table}");
    assert!(table.lines().all(|l| l.chars().count() <= 100), "{table}");

    done(&["report", "base", "torn", "--out", "ladder.html"])?;
    for page in [here.join("ladder.html"), here.join("torn/report.html")] {
        let page = fs::read_to_string(page)?;
        let (_, ladder) = page.split_once("id=\"ladder\"").ok_or("a ladder")?;
        let (ladder, _) = ladder.split_once("</section>").ok_or("its end")?;
        for part in ["interface law", "law bilinear", "exponential"] {
            assert!(ladder.contains(part), "{part} in\n{ladder}");
        }
    }
    Ok(())
}

/// A record made with a bilinear law, with another mesh and other steps than it is fitted with, is called that: no bridging,
/// no other effect in its place.
#[test]
#[ignore = "slow: run by `just slow`"]
fn a_record_of_another_law_is_called_that() -> Tested {
    let more = "[solver]\nstep_mm = 0.04\n[output]\nnoise = 0.003\nseed = 3\nfields = false\n";
    let strip = common::strip(more)
        .replace("divisions = [8, 8, 1]", "divisions = [12, 8, 1]")
        .replace("[interface]\n", TORN);
    let folder = common::folder(&strip)?;
    let here = folder.path();
    let made = fct(here, &["simulate", "strip.toml", "--quiet"])?;
    assert!(made.status.success(), "{}", String::from_utf8_lossy(&made.stderr));
    fs::write(here.join("fit.toml"), format!("{}[diagnose]\nlaws = true\n", common::FIT))?;
    let (code, answer, said) = json(here, &["discover", "fit.toml", "--quiet"])?;
    assert_eq!(code, 0, "{said}");
    println!("{} {}", answer["found"], answer["posterior"]["effects"]["bilinear"]);
    assert_eq!(answer["found"], serde_json::json!(["bilinear"]), "{}", answer["words"]);
    assert!(
        answer["words"][0].as_str().is_some_and(|w| w.contains("the law `bilinear`")),
        "{}",
        answer["words"]
    );
    let top = answer["ladder"].as_array().and_then(|l| l.last()).ok_or("a ladder")?;
    assert_eq!(top["laws"], serde_json::json!({ "bulk": "hgo", "interface": "bilinear" }));
    // Asked again, in words.
    let out = fct(here, &["discover", "fit.toml", "--quiet"])?;
    let table = String::from_utf8(out.stdout)?;
    assert!(table.contains("bilinear"), "{table}");
    assert!(table.contains("Laws of the base: interface exponential."), "{table}");
    Ok(())
}
