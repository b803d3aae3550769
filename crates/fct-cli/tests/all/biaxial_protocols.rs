//! What the five biaxial protocols of the sample fix, and one uniaxial curve of as many numbers does not.

use crate::common::{Tested, json};
use serde_json::Value;
use std::error::Error;
use std::fs;
use std::path::Path;

/// The tissue that the sample's records were made of, by path; MPa and rad.
const TRUTH: [(&str, f64); 5] = [
    ("bulk.mu", 5.1e-3),
    ("bulk.k1", 0.0388),
    ("bulk.k2", 8.0),
    ("bulk.gamma", 35.0 * std::f64::consts::PI / 180.0),
    ("bulk.kappa", 0.15),
];

fn answer(here: &Path, arguments: &[&str]) -> Result<Value, Box<dyn Error>> {
    let (code, answer, stderr) = json(here, arguments)?;
    assert_eq!(code, 0, "{arguments:?}: {stderr}");
    Ok(answer)
}

/// Value, and half the width of the 95 % interval as a share of the truth; infinite where the record does not fix it.
fn found(answer: &Value, (path, truth): (&str, f64)) -> Result<(f64, f64), Box<dyn Error>> {
    let all = answer["parameters"].as_array().ok_or("parameters")?;
    let p = all.iter().find(|p| p["path"] == path).ok_or(path)?;
    let fixed = p["identifiable"] == true && p["at_bound"] == false;
    let half = match (p["interval_95"][0].as_f64(), p["interval_95"][1].as_f64()) {
        (Some(low), Some(high)) if fixed => 0.5 * (high - low) / truth,
        _ => f64::INFINITY,
    };
    Ok((p["value"].as_f64().ok_or("a value")?, half))
}

#[test]
fn five_protocols_fix_what_one_uniaxial_curve_does_not() -> Tested {
    let folder = tempfile::tempdir()?;
    let here = folder.path();
    answer(here, &["new", "sheet", "--experiment", "biaxial"])?;
    let biaxial = answer(here, &["identify", "sheet/sheet.toml", "--out", "biaxial"])?;
    let numbers: u64 = ["tests", "channels"]
        .iter()
        .flat_map(|kind| biaxial[kind].as_object().into_iter().flatten())
        .filter_map(|(_, fit)| fit["points"].as_u64())
        .sum();

    // A strip of that tissue on free ends, stretched as far as strips usually are, with the same noise and as many rows.
    let rows = numbers - 1;
    let strip = format!(
        "name = \"strip\"\n[geometry]\nlength_mm = 10.0\nwidth_mm = 10.0\nthickness_mm = 1.0\n\
         [[tests]]\nkind = \"uniaxial\"\nends = \"sliding\"\nprotocol = [{{ to_mm = 3.5, rate_mm_per_s = 0.05 }}]\n\
         [bulk]\nmu_kPa = 5.1\nk1_kPa = 38.8\nk2 = 8.0\ngamma_deg = 35.0\nkappa = 0.15\n\
         [solver]\nstep_mm = {}\n[output]\nnoise = 0.005\nseed = 3\nfields = false\n",
        3.5 / rows as f64
    );
    fs::write(here.join("strip.toml"), strip)?;
    answer(here, &["simulate", "strip.toml", "--out", "made"])?;
    let config = fs::read_to_string(here.join("sheet/sheet.toml"))?;
    fs::write(here.join("fit.toml"), config.replace("\"specimen.toml\"", "\"made/specimen.toml\""))?;
    let uniaxial = answer(here, &["identify", "fit.toml", "--out", "uniaxial"])?;

    assert_eq!((&biaxial["explained"], &uniaxial["explained"]), (&true.into(), &true.into()));
    println!("{numbers} forces each");
    for truth in TRUTH {
        let ((b, sharp), (u, blunt)) = (found(&biaxial, truth)?, found(&uniaxial, truth)?);
        println!(
            "{} = {:.4}: biaxial {b:.4} ± {:.1} %, uniaxial {u:.4} ± {:.0} %",
            truth.0,
            truth.1,
            100.0 * sharp,
            100.0 * blunt
        );
        // 1.5 times the half-width are three standard deviations.
        assert!((b - truth.1).abs() < 1.5 * sharp * truth.1, "{}: {b}", truth.0);
        assert!(sharp < 0.1, "{}: {sharp}", truth.0);
        assert!(blunt > 10.0 * sharp, "{}: {blunt} and {sharp}", truth.0);
    }
    Ok(())
}
