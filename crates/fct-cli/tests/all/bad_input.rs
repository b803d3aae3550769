//! What a user gets for a mistake: exit code 2, one message per fault with file and place, no panic,
//! nothing half-written; and the directories that fct must not touch.

use crate::common;

use common::{FIT, Tested, fct, folder, json, strip, synthetic};
use std::fs;
use std::path::Path;

/// Checks that a file is refused with exit code 2 and a message that holds all of `words`.
fn refused(folder: &Path, file: &str, words: &[&str]) -> Tested {
    for command in ["check", "identify"] {
        let (code, answer, stderr) = json(folder, &[command, file])?;
        assert_eq!(code, 2, "{command} {file}: {stderr}");
        assert!(answer["error"]["reason"].is_string() && !stderr.contains("panicked"), "{stderr}");
        for word in words {
            assert!(stderr.contains(word), "{command} {file}: `{word}` is not in\n{stderr}");
        }
        assert!(!folder.join("runs").exists(), "{command} {file} wrote something");
    }
    Ok(())
}

#[test]
fn numbers_that_cannot_be() -> Tested {
    let base = strip("");
    let cases = [
        ("thickness_mm = 0.8", "thickness_mm = 0.0", "thickness_mm"),
        ("cut_mm = 1.5", "cut_mm = 7.0", "cut_mm"),
        ("kappa = 0.22", "kappa = 0.5", "kappa"),
        ("mu_kPa = 6.0", "mu_kPa = nan", "mu_kPa"),
        ("k2 = 15.0", "k2 = inf", "k2"),
        ("gc_N_per_mm = 0.15", "areas = 0\ngc_N_per_mm = 0.15", "areas"),
        ("length_mm = 8.0", "length_mm = -8.0", "length_mm"),
    ];
    for (from, to, key) in cases {
        let folder = folder(&base.replace(from, to))?;
        refused(folder.path(), "strip.toml", &["strip.toml:", "error", key])?;
    }
    Ok(())
}

#[test]
fn all_faults_are_told_at_once_with_a_guess() -> Tested {
    let folder = folder(
        &strip("").replace("kappa = 0.22", "kapa = 0.22").replace("thickness_mm = 0.8", "thickness_mm = 0"),
    )?;
    refused(folder.path(), "strip.toml", &["did you mean `kappa`", "thickness_mm"])
}

#[test]
fn records_that_are_none() -> Tested {
    let records = [
        ("empty.csv", "", "empty"),
        ("header.csv", "time_s,displacement_mm,force_N\n", "header.csv"),
        (
            "back.csv",
            "time_s,displacement_mm,force_N\n0,0,0\n2,0.1,0.1\n1,0.2,0.2\n3,0.3,0.3\n",
            "back.csv:4",
        ),
        ("nan.csv", "time_s,displacement_mm,force_N\n0,0,0\n1,0.1,nan\n2,0.2,0.2\n3,0.3,0.3\n", "nan.csv:3"),
        ("word.csv", "time_s,displacement_mm,force_N\n0,0,0\n1,x,0.1\n2,0.2,0.2\n3,0.3,0.3\n", "word.csv:3"),
        ("few.csv", "time_s,displacement_mm,force_N\n0,0,0\n1,0.1,0.1\n2,0.2\n3,0.3,0.3\n", "few.csv:4"),
    ];
    let base = strip("");
    for (name, content, word) in records {
        let folder = folder(&with_data(&base, name))?;
        fs::write(folder.path().join(name), content)?;
        refused(folder.path(), "strip.toml", &[name, word])?;
    }
    Ok(())
}

/// The strip with a record in place of the first protocol.
fn with_data(base: &str, name: &str) -> String {
    base.replacen("protocol = [{ to_mm = 2.0, rate_mm_per_s = 0.05 }]", &format!("data = {name:?}"), 1)
}

#[test]
fn files_that_are_not_there_or_no_files() -> Tested {
    let folder = folder(&with_data(&strip(""), "nowhere.csv"))?;
    refused(folder.path(), "strip.toml", &["nowhere.csv"])?;
    refused(folder.path(), "missing.toml", &["missing.toml"])?;
    fs::create_dir(folder.path().join("a_folder"))?;
    refused(folder.path(), "a_folder", &["a_folder"])?;
    fs::write(folder.path().join("strip.toml"), with_data(&strip(""), "a_folder"))?;
    refused(folder.path(), "strip.toml", &["a_folder"])
}

#[test]
fn a_line_of_100_megabytes() -> Tested {
    let folder = folder(&with_data(&strip(""), "long.csv"))?;
    let mut content = b"time_s,displacement_mm,force_N\n".to_vec();
    content.resize(100_000_000, b'1');
    fs::write(folder.path().join("long.csv"), &content)?;
    fs::write(folder.path().join("long.toml"), &content)?;
    refused(folder.path(), "strip.toml", &["long.csv:2", "bytes"])?;
    refused(folder.path(), "long.toml", &["long.toml"])?;
    let out = fct(folder.path(), &["check", "strip.toml"])?;
    assert!(out.stderr.len() < 5000, "the line is not printed");
    Ok(())
}

#[test]
fn protocols_cannot_be_identified() -> Tested {
    let folder = folder(&strip(""))?;
    let (code, _, stderr) = json(folder.path(), &["identify", "strip.toml"])?;
    assert!(code == 2 && stderr.contains("record"), "{stderr}");
    assert!(!folder.path().join("runs/strip").exists());
    Ok(())
}

#[test]
fn an_effect_that_the_records_cannot_show() -> Tested {
    let monotone = strip("[solver]\nstep_mm = 0.5\n[output]\nnoise = 0.005\nfields = false\n")
        .replace("{ to_mm = 1.0, rate_mm_per_s = 0.05 }, ", "");
    let folder = folder(&monotone)?;
    let here = folder.path();
    assert!(fct(here, &["simulate", "strip.toml", "--quiet"])?.status.success());
    fs::write(
        here.join("fit.toml"),
        format!("{FIT}[effects.fatigue]\na = 0.1\n[effects.lag]\ntau_s = 0.1\n"),
    )?;
    for command in ["identify", "discover", "diagnose", "batch"] {
        let (code, _, stderr) = json(here, &[command, "fit.toml", "--out", "out"])?;
        assert_eq!(code, 2, "{command}: {stderr}");
        for part in ["fit.toml:13:10: error", "no unloading", "`fatigue`", "add a partial unloading"] {
            assert!(stderr.contains(part), "{command}: {part} is not in\n{stderr}");
        }
        assert!(stderr.contains("remark") && stderr.contains("no pause and one rate"), "{stderr}");
        assert!(!here.join("out/fit").exists() && !here.join("out/summary.json").exists());
    }
    // It can be simulated: nothing has to be told from anything there.
    let (code, ..) = json(here, &["check", "fit.toml"])?;
    assert_eq!(code, 0);
    Ok(())
}

#[test]
fn usage_is_checked() -> Tested {
    let folder = folder(&strip(""))?;
    for arguments in [&["frobnicate"][..], &["simulate"], &["simulate", "strip.toml", "--threads", "0"], &[]]
    {
        let out = fct(folder.path(), arguments)?;
        assert_eq!(out.status.code(), Some(2), "{arguments:?}");
        assert!(out.stdout.is_empty() && !out.stderr.is_empty());
    }
    assert!(fct(folder.path(), &["--help"])?.status.success());
    Ok(())
}

#[test]
fn what_is_not_ours_is_left_alone() -> Tested {
    let folder = folder(&strip("[solver]\nstep_mm = 1.0\n[output]\nfields = false\n"))?;
    let here = folder.path();
    let (code, _, stderr) = json(here, &["simulate", "strip.toml", "--out", "."])?;
    assert!(code == 2 && stderr.contains("no run directory"), "{stderr}");
    let (code, _, stderr) = json(here, &["simulate", "strip.toml", "--out", "strip.toml"])?;
    assert!(code == 2 && stderr.contains("file"), "{stderr}");
    let (code, _, stderr) = json(here, &["report", "."])?;
    assert!(code == 2 && stderr.contains("summary.json"), "{stderr}");
    let (code, _, stderr) = json(here, &["ladder", "nowhere"])?;
    assert!(code == 2 && stderr.contains("nowhere"), "{stderr}");
    assert_eq!(fs::read_dir(here)?.count(), 1, "nothing but strip.toml is there");
    Ok(())
}

#[test]
fn a_scaffold_is_made_once_and_is_valid() -> Tested {
    let folder = tempfile::tempdir()?;
    let here = folder.path();
    assert!(fct(here, &["new", "strip-1"])?.status.success());
    assert!(fct(here, &["check", "strip-1/strip-1.toml"])?.status.success());
    assert!(fct(here, &["check", "--quick", "strip-1/specimen.toml"])?.status.success());
    let again = fct(here, &["new", "strip-1"])?;
    assert!(again.status.code() == Some(2) && String::from_utf8(again.stderr)?.contains("exists"));
    for name in ["../out", "", "a/b"] {
        assert_eq!(fct(here, &["new", name])?.status.code(), Some(2), "{name}");
    }
    Ok(())
}

#[test]
fn what_check_prints_is_a_config_that_reads_back() -> Tested {
    let folder = synthetic()?;
    let out = fct(folder.path(), &["check", "fit.toml"])?;
    let text = String::from_utf8(out.stdout)?;
    assert!(text.contains("free parameters") && text.contains("max_iterations = 30"));
    fs::write(folder.path().join("again.toml"), &text)?;
    let (_, first, _) = json(folder.path(), &["check", "fit.toml"])?;
    let (code, second, stderr) = json(folder.path(), &["check", "again.toml"])?;
    assert_eq!(code, 0, "{stderr}");
    assert_eq!(first["resolved"], second["resolved"]);
    assert!(FIT.contains("fixed"));
    Ok(())
}

#[cfg(unix)]
#[test]
fn ctrl_c_leaves_a_valid_directory() -> Tested {
    use std::process::{Command, Stdio};
    let folder = synthetic()?;
    // A finer mesh, so that there is time to stop.
    let fine = FIT.replace("[8, 8, 1]", "[24, 24, 2]");
    fs::write(folder.path().join("fit.toml"), fine)?;
    let mut child = Command::new(env!("CARGO_BIN_EXE_fct"))
        .args(["identify", "fit.toml", "--json", "--out", "run"])
        .current_dir(folder.path())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()?;
    let state = folder.path().join(".run.part/state.json");
    while !state.exists() && child.try_wait()?.is_none() {
        std::thread::sleep(std::time::Duration::from_millis(20));
    }
    assert!(Command::new("kill").args(["-INT", &child.id().to_string()]).status()?.success());
    let out = child.wait_with_output()?;
    let answer: serde_json::Value = serde_json::from_slice(&out.stdout)?;
    assert_eq!(out.status.code(), Some(1), "{}", String::from_utf8_lossy(&out.stderr));
    assert_eq!(answer["complete"], false);
    let stored: serde_json::Value =
        serde_json::from_slice(&fs::read(folder.path().join("run/summary.json"))?)?;
    assert_eq!(stored["stopped_because"], "stopped by the user");
    assert!(stored["parameters"].as_object().is_some_and(|p| !p.is_empty()));
    assert!(folder.path().join("run/state.json").is_file() && !state.exists());
    Ok(())
}
