//! A base model that is bent by what it lacks: the toughness of one half of the tear path runs away.

use crate::common;

use common::{Tested, fct, json};
use std::fs;
use std::path::Path;

/// Adds a drift of the load cell (N/s) to a record; lines of text stay.
fn drifted(file: &Path, rate: f64) -> Tested {
    let text = fs::read_to_string(file)?;
    let mut out = String::new();
    for line in text.lines() {
        let cells: Vec<&str> = line.split(',').collect();
        let number = |k: usize| cells.get(k).and_then(|c| c.trim().parse::<f64>().ok());
        match (number(0), number(2)) {
            (Some(time), Some(force)) => {
                out += &format!("{},{},{}\n", cells[0], cells[1], force + rate * time);
            }
            _ => out += &format!("{line}\n"),
        }
    }
    fs::write(file, out)?;
    Ok(())
}

/// Fitted from the base's optimum a model with the drift ends in a corner, and other effects are named beside it. Fitted from
/// the record it explains all; and every rung, computed once more at its values, misses the records by what its row says.
#[test]
#[ignore = "slow: run by `just slow`"]
fn what_bends_the_base_is_named_alone() -> Tested {
    let folder = tempfile::tempdir()?;
    let made = fct(folder.path(), &["new", "strip"])?;
    assert!(made.status.success(), "{}", String::from_utf8_lossy(&made.stderr));
    let here = folder.path().join("strip");
    for record in ["uniaxial.csv", "tearing.csv"] {
        drifted(&here.join(record), 2e-4)?;
    }
    let (code, answer, said) = json(&here, &["discover", "strip.toml", "--quiet", "--out", "run"])?;
    assert_eq!(code, 0, "{said}");
    assert_eq!(answer["found"], serde_json::json!(["drift"]), "{}", answer["words"]);
    assert_eq!(answer["verdict"], "explained");
    let rows = answer["ladder"].as_array().ok_or("a ladder")?;
    assert_eq!(rows.len(), 2);
    for (k, row) in rows.iter().enumerate() {
        let again = fs::read_to_string(here.join(format!("run/rungs/{k}/summary.json")))?;
        let again: serde_json::Value = serde_json::from_str(&again)?;
        let of = |v: &serde_json::Value| v["reduced_chi2_total"].as_f64().ok_or("a number");
        let (table, page) = (of(row)?, of(&again)?);
        assert!((table - page).abs() < 0.01 * table, "rung {k}: {table} in the table, {page} on its page");
    }
    Ok(())
}
