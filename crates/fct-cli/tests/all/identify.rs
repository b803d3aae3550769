//! `fct identify`, `batch`, `ladder`, `report` from outside, on a synthetic specimen.

use crate::common;

use common::{Tested, fct, json, synthetic, timeless};
use std::fs;

#[test]
fn values_are_found_again_whatever_the_threads() -> Tested {
    let folder = synthetic()?;
    let here = folder.path();
    let (code, answer, _) = json(here, &["identify", "fit.toml", "--out", "one", "--threads", "1"])?;
    assert_eq!(code, 0);
    for key in [
        "schema",
        "specimen",
        "effects",
        "parameters",
        "tests",
        "reduced_chi2",
        "reduced_chi2_total",
        "explained",
        "iterations",
        "forward_runs",
        "seconds",
        "stopped_because",
    ] {
        assert!(!answer[key].is_null(), "{key}");
    }
    let tear = &answer["tests"]["tearing"];
    for key in ["rms_N", "noise_N", "reduced_chi2", "objective", "points"] {
        assert!(tear[key].is_number(), "{key}");
    }
    let parameters = answer["parameters"].as_array().ok_or("parameters")?;
    let find = |path: &str| parameters.iter().find(|p| p["path"] == path).cloned().unwrap_or_default();
    for (path, truth, unit) in [
        ("bulk.k1", 0.7, "MPa"),
        ("interface.area[1].gc", 0.15, "N/mm"),
        ("interface.area[1].sigma_c", 0.08, "MPa"),
    ] {
        let p = find(path);
        let interval: [f64; 2] = serde_json::from_value(p["interval_95"].clone())?;
        let slack = 0.5 * (interval[1] - interval[0]);
        assert!(interval[0] - slack <= truth && truth <= interval[1] + slack, "{p}");
        assert!(
            p["unit"] == unit
                && p["std_error"].is_f64()
                && p["at_bound"] == false
                && p["identifiable"] == true,
            "{p}"
        );
    }
    assert_eq!(parameters.len(), 4);
    let (_, two, _) = json(here, &["identify", "fit.toml", "--out", "two", "--threads", "2"])?;
    assert_eq!(timeless(answer.clone()), timeless(two));
    for file in [
        "run.toml",
        "summary.json",
        "curves/tearing.csv",
        "jacobian.csv",
        "history.csv",
        "report.html",
        "figures/convergence.svg",
        "fields/tearing.pvd",
    ] {
        assert!(here.join("one").join(file).is_file(), "{file}");
    }
    let curve = fs::read_to_string(here.join("one/curves/tearing.csv"))?;
    assert!(curve.starts_with("time_s,displacement_mm,force_measured_N,force_model_N,residual_N,segment"));
    let page = fs::read_to_string(here.join("one/report.html"))?;
    assert!(page.contains("synthetic") && !page.contains("http://") || page.contains("http://www.w3.org"));
    assert!(!page.contains("<script src") && !page.contains("<link"));
    // What stands beside the values is a fact, no warning.
    assert!(page.contains("<li>tearing: energy balance of the record"), "{}", answer["remarks"]);
    Ok(())
}

#[test]
fn batch_and_ladder_go_over_runs() -> Tested {
    let folder = synthetic()?;
    let here = folder.path();
    let (code, answer, _) = json(here, &["batch", "fit.toml", "fit.toml", "missing.toml"])?;
    assert_eq!(code, 1, "one of three failed");
    assert_eq!(answer["specimens"].as_array().map(Vec::len), Some(2));
    assert_eq!(answer["failed"][0]["file"], "missing.toml");
    assert_eq!(timeless(answer["specimens"][0].clone()), timeless(answer["specimens"][1].clone()));
    // The synthetic specimen lives in runs/strip: identifications of that name go elsewhere, each to a place of its own.
    assert!(
        here.join("runs/strip/specimen.toml").is_file() && here.join("runs/strip-3/summary.json").is_file()
    );
    let (code, answer, _) = json(here, &["ladder", "runs/strip-2", "runs/strip-3"])?;
    assert_eq!((code, answer["ladder"].as_array().map(Vec::len)), (0, Some(2)));
    assert!(answer["ladder"][0]["rms_N"].is_f64());
    let (code, ..) = json(here, &["report", "runs/strip", "runs/strip-2", "runs/strip-3"])?;
    assert_eq!(code, 0);
    let table = fct(here, &["ladder", "runs/strip-2", "runs/strip-3"])?;
    assert!(String::from_utf8(table.stdout)?.lines().all(|l| l.chars().count() <= 100));
    Ok(())
}

#[test]
fn effects_are_added_and_dropped_with_comments_kept() -> Tested {
    let folder = synthetic()?;
    let here = folder.path();
    fs::write(here.join("fit.toml"), format!("# my remark\n{}", common::FIT))?;
    let out = fct(here, &["add", "compliance", "fit.toml", "--out", "sub.toml"])?;
    assert!(out.status.success(), "{}", String::from_utf8_lossy(&out.stderr));
    let text = fs::read_to_string(here.join("sub.toml"))?;
    assert!(text.starts_with("# my remark\n") && text.contains("[effects.compliance]"), "{text}");
    let (code, answer, _) = json(here, &["check", "sub.toml"])?;
    assert_eq!((code, &answer["effects"][0]), (0, &"compliance".into()));
    assert!(fct(here, &["drop", "compliance", "sub.toml", "--out", "back.toml"])?.status.success());
    assert!(!fs::read_to_string(here.join("back.toml"))?.contains("compliance]"));
    let out = fct(here, &["add", "complience", "fit.toml"])?;
    assert_eq!(out.status.code(), Some(2));
    assert!(String::from_utf8(out.stderr)?.contains("did you mean `compliance`"));
    assert_eq!(fct(here, &["add", "compliance", "sub.toml"])?.status.code(), Some(2));
    let (code, list, _) = json(here, &["effects"])?;
    assert!(code == 0 && list["effects"].as_array().is_some_and(|e| e.len() >= 22));
    Ok(())
}

/// Without a screen an effect begins as large as is ordinary on the records: a zero that drifts by three hundredths of the largest force
/// over the longest test. Where nothing was recorded, as its card has it.
#[test]
fn an_effect_is_added_as_large_as_the_records_have_it() -> Tested {
    let folder = synthetic()?;
    let here = folder.path();
    let (mut peak, mut duration) = (0.0f64, 0.0f64);
    for test in ["uniaxial", "tearing"] {
        let text = fs::read_to_string(here.join(format!("runs/strip/{test}.csv")))?;
        let mut lines = text.lines().filter(|l| !l.starts_with('#'));
        let head: Vec<&str> = lines.next().ok_or("a header")?.split(',').collect();
        let rows: Vec<Vec<f64>> =
            lines.map(|l| l.split(',').map(str::parse).collect()).collect::<Result<_, _>>()?;
        let column = |name: &str| {
            let at = head.iter().position(|h| *h == name);
            rows.iter().filter_map(|r| Some(*r.get(at?)?)).collect::<Vec<f64>>()
        };
        let (time, force) = (column("time_s"), column("force_N"));
        peak = force.iter().fold(peak, |m, f| m.max(f.abs()));
        duration = duration.max(time[time.len() - 1] - time[0]);
    }
    let drift = |file: &str| -> Result<f64, Box<dyn std::error::Error>> {
        let (code, ..) = json(here, &["add", "drift", file, "--out", "more.toml", "--force"])?;
        assert_eq!(code, 0);
        let more = fs::read_to_string(here.join("more.toml"))?;
        let value = more.lines().find_map(|l| l.strip_prefix("c_N_per_s = ")?.split_whitespace().next());
        Ok(value.ok_or("a value")?.parse()?)
    };
    let ordinary = 0.03 * peak / duration;
    let (added, bare) = (drift("fit.toml")?, drift("strip.toml")?);
    assert!((added / ordinary - 1.0).abs() < 5e-3, "{added} {ordinary}");
    assert!((bare / ordinary - 1.0).abs() > 0.1, "{bare} {ordinary}");
    Ok(())
}
