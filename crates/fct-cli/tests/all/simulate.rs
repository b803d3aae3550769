//! `fct simulate` from outside: the contract's fields, jumps, synthetic records, the run directory.

use crate::common;

use common::{Tested, fct, folder, json, strip, timeless};
use std::fs;

#[test]
fn answers_stand_at_every_step_and_turn() -> Tested {
    let folder = folder(&strip("[solver]\nstep_mm = 0.3\n"))?;
    let (code, answer, _) = json(folder.path(), &["simulate", "strip.toml"])?;
    assert_eq!((code, &answer["schema"]), (0, &1.into()));
    let tearing = &answer["tests"]["tearing"];
    let u: Vec<f64> = serde_json::from_value(tearing["displacement_mm"].clone())?;
    let has = |x: f64| u.iter().any(|v| (v - x).abs() < 1e-12);
    // Multiples of the step within each leg, counted from its start, and the turning points.
    assert!(
        u[0] == 0.0
            && has(0.3)
            && has(1.8)
            && has(2.0)
            && has(1.7)
            && has(1.0)
            && has(1.3)
            && has(4.9)
            && has(5.0)
    );
    for key in ["time_s", "force_N"] {
        assert_eq!(tearing[key].as_array().map(Vec::len), Some(u.len()));
    }
    assert!(tearing["jumps"].is_array() && tearing["energy"]["external_work_Nmm"].is_f64());
    assert!(tearing["energy"]["closure"].as_f64().is_some_and(|c| c < 0.02), "{}", tearing["energy"]);
    let solver = &answer["solver"];
    assert!(solver["steps"].is_u64() && solver["iterations"].is_u64() && solver["seconds"].is_f64());
    Ok(())
}

#[test]
fn the_run_directory_is_whole_and_reruns() -> Tested {
    let folder = folder(&strip("[solver]\nstep_mm = 0.5\n[output]\nfields = 3\n"))?;
    let (_, first, _) = json(folder.path(), &["simulate", "strip.toml", "--threads", "1"])?;
    let run = folder.path().join("runs/strip");
    for file in [
        "run.toml",
        "summary.json",
        "curves/tearing.csv",
        "fields/tearing.pvd",
        "fields/tearing-3.vtu",
        "fields/tearing-path-3.vtu",
        "figures/uniaxial.svg",
        "report.html",
    ] {
        assert!(run.join(file).is_file(), "{file}");
    }
    let hidden =
        fs::read_dir(folder.path().join("runs"))?.flatten().filter(|e| e.file_name() != "strip").count();
    assert_eq!(hidden, 0, "nothing half-written is left");
    // The resolved input reproduces the run, also with another number of threads.
    let (_, again, _) =
        json(folder.path(), &["simulate", "runs/strip/run.toml", "--out", "again", "--threads", "2"])?;
    assert_eq!(timeless(first.clone()), timeless(again));
    // A finished run gives its answer again, seconds and all.
    let (_, resumed, _) = json(folder.path(), &["simulate", "strip.toml", "--resume"])?;
    assert_eq!(first, resumed);
    Ok(())
}

#[test]
fn a_tear_that_jumps_says_so_and_the_path_goes_through() -> Tested {
    let sharp = strip("[solver]\nstep_mm = 0.2\n[output]\nfields = false\n")
        .replace("length_mm = 8.0", "length_mm = 12.0")
        .replace("sigma_c_MPa = 0.08", "sigma_c_MPa = 0.25")
        .replace(
            "{ to_mm = 2.0, rate_mm_per_s = 0.05 }, { to_mm = 1.0, rate_mm_per_s = 0.05 }, { to_mm = 5.0",
            "{ to_mm = 6.0",
        );
    let folder = folder(&sharp)?;
    let (code, answer, _) = json(folder.path(), &["simulate", "strip.toml"])?;
    let jump = &answer["tests"]["tearing"]["jumps"][0];
    assert_eq!(code, 0);
    for key in ["displacement_mm", "time_s", "force_before_N", "force_after_N", "released_Nmm"] {
        assert!(jump[key].is_f64(), "{key} in {jump}");
    }
    assert!(jump["force_before_N"].as_f64() > jump["force_after_N"].as_f64());
    let path = sharp.replace("step_mm = 0.2", "step_mm = 0.2\ncontrol = \"path\"");
    fs::write(folder.path().join("path.toml"), path)?;
    let (code, answer, stderr) = json(folder.path(), &["simulate", "path.toml"])?;
    assert_eq!(code, 0, "{stderr}");
    let u: Vec<f64> = serde_json::from_value(answer["tests"]["tearing"]["displacement_mm"].clone())?;
    assert!(u.windows(2).any(|w| w[1] < w[0]), "the displacement falls in the snap-back");
    assert!(u.last().is_some_and(|u| (u - 6.0).abs() < 1e-9));
    Ok(())
}

#[test]
fn a_run_that_cannot_go_on_keeps_what_it_has() -> Tested {
    // Nothing can be pushed through itself.
    let folder = folder(
        &strip("").replace("to_mm = 2.0, rate_mm_per_s = 0.05 }]", "to_mm = -20.0, rate_mm_per_s = 0.05 }]"),
    )?;
    let (code, answer, stderr) = json(folder.path(), &["simulate", "strip.toml"])?;
    assert_eq!(code, 1, "{stderr}");
    let reason = answer["stopped_because"].as_str().unwrap_or_default();
    assert!(reason.contains("uniaxial") && stderr.contains(reason), "{reason}\n{stderr}");
    assert!(answer["tests"]["uniaxial"]["force_N"].as_array().is_some_and(|f| f.len() > 1));
    assert!(folder.path().join("runs/strip/summary.json").is_file());
    Ok(())
}

#[test]
fn people_get_a_table_within_100_columns() -> Tested {
    let folder = folder(&strip("[solver]\nstep_mm = 0.5\n[output]\nfields = false\n"))?;
    let out = fct(folder.path(), &["simulate", "strip.toml"])?;
    let text = String::from_utf8(out.stdout)?;
    assert!(text.contains("peak force") && !text.contains('\x1b'));
    assert!(text.lines().all(|l| l.chars().count() <= 100));
    let out = fct(folder.path(), &["simulate", "strip.toml", "--quiet"])?;
    assert!(out.stderr.is_empty());
    Ok(())
}

/// Meshes too coarse for the tear and steps too large are said to be; a fine mesh in small steps says nothing.
#[test]
fn coarse_meshes_and_large_steps_are_told() -> Tested {
    let remarks =
        |edit: &dyn Fn(String) -> String, step: f64| -> Result<Vec<String>, Box<dyn std::error::Error>> {
            let folder =
                folder(&edit(strip(&format!("[solver]\nstep_mm = {step}\n[output]\nfields = false\n"))))?;
            let (code, answer, stderr) = json(folder.path(), &["simulate", "strip.toml"])?;
            assert_eq!(code, 0, "{stderr}");
            Ok(serde_json::from_value(answer["remarks"].clone())?)
        };
    let fine = remarks(&|s| s.replace("[8, 8, 1]", "[24, 8, 1]"), 0.05)?;
    assert!(fine.is_empty(), "{fine:?}");
    // δc falls from 0.69 to 0.14 mm: the zone spans about one element.
    let brittle = |s: String| s.replace("gc_N_per_mm = 0.15", "gc_N_per_mm = 0.03");
    let coarse = remarks(&brittle, 0.05)?;
    assert!(
        coarse.iter().any(|r| r.contains("tearing: the mesh is too coarse") && r.contains("path_size_mm")),
        "{coarse:?}"
    );
    let large = remarks(&|s| s, 1.0)?;
    assert!(large.iter().any(|r| r.contains("steps are too large") && r.contains("step_mm")), "{large:?}");
    Ok(())
}
