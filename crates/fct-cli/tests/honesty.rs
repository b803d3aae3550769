//! What is not certain is said: bounds, searches that did not settle, starts that agree or not, numbers that are none.

mod common;

use common::{FIT, Tested, json, synthetic};
use serde_json::Value;
use std::fs;

/// The answer of an identification of the synthetic strip with an edited config.
fn identified(
    edit: &dyn Fn(&str) -> String,
) -> Result<(tempfile::TempDir, Value), Box<dyn std::error::Error>> {
    let folder = synthetic()?;
    fs::write(folder.path().join("fit.toml"), edit(FIT))?;
    let (code, answer, stderr) = json(folder.path(), &["identify", "fit.toml", "--out", "run"])?;
    assert_eq!(code, 0, "{stderr}");
    Ok((folder, answer))
}

#[test]
fn a_parameter_at_its_bound_is_flagged_and_nothing_is_explained_by_it() -> Tested {
    // The strength behind the record is 0.08 MPa.
    let (_, answer) =
        identified(&|f| f.replace("sigma_c_MPa = 0.06", "sigma_c_MPa = { start = 0.06, max = 0.065 }"))?;
    let parameters = answer["parameters"].as_array().ok_or("parameters")?;
    let held: Vec<&str> =
        parameters.iter().filter(|p| p["at_bound"] == true).filter_map(|p| p["path"].as_str()).collect();
    assert_eq!(held, ["interface.area[1].sigma_c"]);
    assert_eq!(answer["explained"], false);
    Ok(())
}

#[test]
fn a_search_that_did_not_settle_is_not_called_converged() -> Tested {
    let (_, answer) = identified(&|f| {
        format!("{f}[identify]\nmode = \"joint\"\nmax_iterations = 1\ncoarse_first = false\n")
    })?;
    let stages = answer["stages"].as_array().ok_or("stages")?;
    assert!(stages.iter().any(|s| s["converged"] == false), "{stages:?}");
    let why = answer["stopped_because"].as_str().ok_or("reason")?;
    assert!(why.to_lowercase().contains("iterations"), "{why}");
    Ok(())
}

#[test]
fn several_starts_say_how_they_agree() -> Tested {
    let (_, answer) = identified(&|f| format!("{f}[identify]\nmulti_start = 3\n"))?;
    let told = answer["starts"].as_str().ok_or("starts")?;
    assert!(told.contains('3'), "{told}");
    Ok(())
}

/// Every number that is written is one.
#[test]
fn no_file_holds_a_number_that_is_none() -> Tested {
    let (folder, _) = identified(&str::to_owned)?;
    let run = folder.path().join("run");
    for file in ["summary.json", "curves/tearing.csv", "curves/uniaxial.csv", "jacobian.csv", "history.csv"] {
        let text = fs::read_to_string(run.join(file))?.to_lowercase();
        let words = text.split(|c: char| !c.is_ascii_alphanumeric());
        assert!(words.into_iter().all(|w| w != "nan" && w != "inf"), "{file}");
    }
    Ok(())
}
