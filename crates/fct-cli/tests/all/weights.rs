//! Stretches of a record that count less, or not at all.

use crate::common::{self, Tested};
use serde_json::Value;
use std::fs;
use std::path::Path;

/// Values of the parameters by path.
fn value(answer: &Value, path: &str) -> Option<f64> {
    answer["parameters"].as_array()?.iter().find(|p| p["path"] == path)?["value"].as_f64()
}

/// Adds a force that is no tissue's to the tearing record from 20 s to 30 s.
fn spoil(here: &Path) -> Tested {
    let file = here.join("runs/strip/tearing.csv");
    let text = fs::read_to_string(&file)?;
    let row = |line: &str| -> String {
        let mut cells: Vec<String> = line.split(',').map(str::to_owned).collect();
        let [time, force] = [0, 2].map(|k| cells.get(k).and_then(|c| c.parse::<f64>().ok()));
        if let (Some(20.0..=30.0), Some(force)) = (time, force) {
            cells[2] = format!("{}", force + 0.1);
        }
        cells.join(",") + "\n"
    };
    Ok(fs::write(file, text.lines().map(row).collect::<String>())?)
}

#[test]
fn what_is_left_out_does_not_move_the_fit_and_every_answer_says_so() -> Tested {
    let folder = common::synthetic()?;
    let here = folder.path();
    let (code, right, stderr) = common::json(here, &["identify", "fit.toml", "--out", "right"])?;
    assert_eq!(code, 0, "{stderr}");
    spoil(here)?;
    let (_, wrong, _) = common::json(here, &["identify", "fit.toml", "--out", "wrong"])?;
    let set = ["set", "fit.toml", "--weigh", "tearing,19.9,30.1,0", "--out", "out.toml"];
    assert_eq!(common::json(here, &set)?.0, 0);
    assert!(fs::read_to_string(here.join("out.toml"))?.contains("from_s = 19.9, to_s = 30.1, weight = 0.0"));
    let (_, out, _) = common::json(here, &["identify", "out.toml", "--out", "out"])?;
    let path = "interface.area[1].gc";
    let [right, wrong_gc, out_gc] = [&right, &wrong, &out].map(|a| value(a, path).unwrap_or(f64::NAN));
    println!("Gc {right:.4} N/mm, with a spoiled stretch {wrong_gc:.4}, that left out {out_gc:.4}");
    assert!(
        (out_gc / right - 1.0).abs() < 0.3 * (wrong_gc / right - 1.0).abs(),
        "{right} {wrong_gc} {out_gc}"
    );
    let points = |a: &Value| a["tests"]["tearing"]["points"].as_u64().unwrap_or(0);
    assert!(points(&out) < points(&wrong) && out["rms_N"].as_f64() < wrong["rms_N"].as_f64());
    let said = out["remarks"].to_string();
    assert!(said.contains("tearing: 19.9") && said.contains("left out of the fit"), "{said}");
    // The curve is whole; what was left out is a segment of its own.
    let curve = fs::read_to_string(here.join("out/curves/tearing.csv"))?;
    assert_eq!(
        curve.lines().count(),
        fs::read_to_string(here.join("wrong/curves/tearing.csv"))?.lines().count()
    );
    assert_eq!(curve.matches("left out").count() as u64, points(&wrong) - points(&out));
    let (_, diagnosed, _) = common::json(here, &["diagnose", "out"])?;
    assert!(diagnosed["words"].to_string().contains("left out of the fit"), "{}", diagnosed["words"]);
    // Back again: the same file as if nothing had been said of it.
    let set = ["set", "out.toml", "--unweigh", "tearing", "--out", "back.toml"];
    assert_eq!(common::json(here, &set)?.0, 0);
    assert!(!fs::read_to_string(here.join("back.toml"))?.contains("weights"));
    Ok(())
}

#[test]
fn a_weight_that_is_none_is_refused_where_it_stands() -> Tested {
    let folder = common::synthetic()?;
    let here = folder.path();
    let specimen = fs::read_to_string(here.join("runs/strip/specimen.toml"))?;
    for (weights, why) in [
        ("[{ from_s = 5.0, to_s = 2.0 }]", "`to_s` is 2"),
        ("[{ from_s = 0.0 }]", "to_s"),
        ("[{ from_s = 0.0, to_s = 1e6 }]", "expected at least 4"),
        ("[{ from_s = 0.0, to_s = 1.0, weight = -1.0 }]", "weight"),
        ("[{ from_s = 0.0, to_s = 1.0, until = 2.0 }]", "until"),
        ("3", "weights"),
    ] {
        let at = specimen.find("kind = ").ok_or("a test")?;
        let text = format!("{}weights = {weights}\n{}", &specimen[..at], &specimen[at..]);
        fs::write(here.join("runs/strip/bad.toml"), text)?;
        let (code, _, stderr) = common::json(here, &["check", "runs/strip/bad.toml", "--quick"])?;
        assert!(code == 2 && stderr.contains("bad.toml:") && stderr.contains(why), "{weights}: {stderr}");
    }
    for word in ["tearing", "tearing,1,2", "tearing,2,1,0", "tearing,0,1,-1", "none,0,1,0", "tearing,0,1,nan"]
    {
        let out = common::fct(here, &["set", "fit.toml", "--weigh", word, "--out", "x.toml"])?;
        let stderr = String::from_utf8_lossy(&out.stderr);
        assert!(
            out.status.code() == Some(2) && !stderr.is_empty() && !here.join("x.toml").exists(),
            "{word}: {stderr}"
        );
    }
    Ok(())
}
