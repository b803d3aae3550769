//! What belongs to the user stays, and what is computed is not lost: directories, files, names, pipes.

use crate::common;

use common::{FIT, Tested, fct, folder, json, strip, synthetic, timeless};
use serde_json::Value;
use std::fs;
use std::path::Path;
use std::process::Command;

/// A strip that is simulated in no time.
fn quick() -> String {
    strip("[solver]\nstep_mm = 1.0\n[output]\nfields = false\n")
}

/// Every file below a folder with its content.
fn content(folder: &Path) -> std::io::Result<Vec<(String, Vec<u8>)>> {
    let mut out = Vec::new();
    for entry in fs::read_dir(folder)?.flatten() {
        let path = entry.path();
        if path.is_dir() {
            out.extend(content(&path)?);
        } else {
            out.push((path.display().to_string(), fs::read(&path)?));
        }
    }
    out.sort();
    Ok(out)
}

#[test]
fn a_folder_of_the_user_survives_every_command() -> Tested {
    let folder = folder(&quick())?;
    let here = folder.path();
    fs::rename(here.join("strip.toml"), here.join("run.toml"))?;
    for (file, text) in [
        ("curves/raw_day1.csv", "mine"),
        ("figures/photo.png", "mine"),
        ("report.html", "mine"),
        ("summary.json", "{}"),
    ] {
        fs::create_dir_all(here.join(file).parent().ok_or("folder")?)?;
        fs::write(here.join(file), text)?;
    }
    let before = content(here)?;
    for arguments in [
        &["simulate", "run.toml", "--out", "."][..],
        &["identify", "run.toml", "--out", "."],
        &["discover", "run.toml", "--out", "."],
        &["report", "."],
        &["diagnose", "."],
        &["compare", "."],
        &["ladder", "."],
        &["add", "drift", "run.toml", "--out", "curves/raw_day1.csv"],
        &["add", "drift", "."],
        &["report", ".", "--out", "figures/photo.png"],
        &["new", "curves"],
    ] {
        let out = fct(here, arguments)?;
        let stderr = String::from_utf8_lossy(&out.stderr);
        assert_eq!(out.status.code(), Some(2), "{arguments:?}: {stderr}");
        assert!(content(here)? == before, "{arguments:?} changed the folder");
    }
    Ok(())
}

#[test]
fn with_force_only_our_files_come_and_theirs_stay() -> Tested {
    let folder = folder(&quick())?;
    let here = folder.path();
    fs::create_dir(here.join("curves"))?;
    fs::write(here.join("curves/raw_day1.csv"), "mine")?;
    let strip = fs::read_to_string(here.join("strip.toml"))?;
    assert!(fct(here, &["simulate", "strip.toml", "--out", ".", "--force"])?.status.success());
    assert_eq!(fs::read_to_string(here.join("strip.toml"))?, strip);
    // A second run knows which files are its own.
    assert!(fct(here, &["simulate", "strip.toml", "--out", "."])?.status.success());
    assert_eq!(fs::read_to_string(here.join("curves/raw_day1.csv"))?, "mine");
    assert!(here.join("curves/tearing.csv").is_file() && here.join("manifest.json").is_file());
    Ok(())
}

#[test]
fn every_command_and_configuration_has_a_directory_of_its_own() -> Tested {
    let folder = folder(&quick())?;
    let here = folder.path();
    let place = |arguments: &[&str]| -> Result<String, Box<dyn std::error::Error>> {
        let out = fct(here, arguments)?;
        assert!(out.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&out.stderr));
        let text = String::from_utf8(out.stdout)?;
        let line = text.lines().find_map(|l| l.strip_prefix("Run directory: ")).ok_or("no directory told")?;
        Ok(Path::new(line).file_name().ok_or("name")?.to_string_lossy().into_owned())
    };
    assert_eq!(place(&["simulate", "strip.toml"])?, "strip");
    let first = fs::read(here.join("runs/strip/run.toml"))?;
    fs::write(
        here.join("other.toml"),
        format!("name = \"strip\"\n{}", quick().replace("0.08", "0.07").replace("name = \"strip\"\n", "")),
    )?;
    assert_eq!(place(&["simulate", "other.toml"])?, "strip-simulate");
    assert_eq!(place(&["simulate", "strip.toml"])?, "strip", "the same run takes its own place");
    assert_eq!(fs::read(here.join("runs/strip/run.toml"))?, first);
    Ok(())
}

#[test]
fn an_identification_is_not_replaced_by_a_simulation() -> Tested {
    let folder = synthetic()?;
    let here = folder.path();
    fs::remove_file(here.join("strip.toml"))?;
    fs::rename(here.join("runs/strip"), here.join("data"))?;
    fs::write(here.join("fit.toml"), FIT.replace("runs/strip", "data"))?;
    let (code, answer, stderr) = json(here, &["identify", "fit.toml"])?;
    assert_eq!(code, 0, "{stderr}");
    assert!(fct(here, &["simulate", "fit.toml"])?.status.success());
    let stored: Value = serde_json::from_slice(&fs::read(here.join("runs/strip/summary.json"))?)?;
    assert_eq!(timeless(stored)["parameters"], timeless(answer)["parameters"]);
    assert!(here.join("runs/strip-simulate/summary.json").is_file());
    Ok(())
}

#[test]
fn equal_names_in_a_batch_have_a_page_each() -> Tested {
    let folder = synthetic()?;
    let here = folder.path();
    for (k, start) in [0.12, 0.13, 0.14].iter().enumerate() {
        fs::write(here.join(format!("{k}.toml")), FIT.replace("0.12", &start.to_string()))?;
    }
    let (code, answer, stderr) = json(here, &["batch", "0.toml", "1.toml", "2.toml", "--out", "all"])?;
    assert_eq!(code, 0, "{stderr}");
    assert_eq!(answer["specimens"].as_array().map(Vec::len), Some(3));
    let page = fs::read_to_string(here.join("all/batch.html"))?;
    for place in ["strip", "strip-2", "strip-3"] {
        assert!(here.join("all").join(place).join("report.html").is_file(), "{place}");
        assert!(page.contains(&format!("{place}/report.html")), "{place}");
    }
    Ok(())
}

#[test]
fn raw_records_are_not_overwritten() -> Tested {
    let folder = synthetic()?;
    let here = folder.path();
    let (code, ..) = json(here, &["identify", "fit.toml", "--out", "run"])?;
    assert_eq!(code, 0);
    let record = here.join("runs/strip/tearing.csv");
    let before = fs::read(&record)?;
    for arguments in [
        &["add", "drift", "fit.toml", "--out", "runs/strip/tearing.csv"][..],
        &["report", "run", "--out", "runs/strip/tearing.csv"],
        &["drop", "drift", "with.toml", "--out", "runs/strip/tearing.csv"],
    ] {
        if arguments[0] == "drop" {
            assert!(fct(here, &["add", "drift", "fit.toml", "--out", "with.toml"])?.status.success());
        }
        let out = fct(here, arguments)?;
        let stderr = String::from_utf8_lossy(&out.stderr);
        assert!(out.status.code() == Some(2) && stderr.contains("--force"), "{arguments:?}: {stderr}");
        assert_eq!(fs::read(&record)?, before, "{arguments:?}");
    }
    // A page of ours is made anew where it stands.
    for _ in 0..2 {
        assert!(fct(here, &["report", "run", "--out", "page.html"])?.status.success());
    }
    Ok(())
}

#[test]
fn a_record_that_changes_after_it_was_read_is_found_out() -> Tested {
    let folder = synthetic()?;
    let here = folder.path();
    let (code, ..) = json(here, &["identify", "fit.toml", "--out", "run"])?;
    assert_eq!(code, 0);
    let record = here.join("runs/strip/tearing.csv");
    let text = fs::read_to_string(&record)?;
    fs::write(&record, text.replacen("\n", "\n# a remark\n", 1))?;
    let (code, _, stderr) = json(here, &["diagnose", "run"])?;
    assert!(code == 2 && stderr.contains("tearing.csv") && stderr.contains("changed"), "{stderr}");
    let (code, _, stderr) = json(here, &["compare", "run"])?;
    assert!(code == 0 && stderr.contains("tearing.csv") && stderr.contains("changed"), "{stderr}");
    // The answer of before is not that of the new record.
    let (code, answer, _) = json(here, &["identify", "fit.toml", "--out", "run", "--resume"])?;
    assert_eq!(code, 0);
    let stored: Value = serde_json::from_slice(&fs::read(here.join("run/summary.json"))?)?;
    let hash = |name: &str| {
        let inputs = stored["run"]["inputs"].as_array().cloned().unwrap_or_default();
        inputs.into_iter().find(|i| i["file"].as_str().is_some_and(|f| f.ends_with(name)))
    };
    let now = input::sha256(&fs::read(&record)?);
    assert_eq!(hash("tearing.csv").ok_or("tearing.csv")?["sha256"], now.as_str());
    assert!(answer["parameters"].is_array());
    Ok(())
}

#[test]
fn a_closed_pipe_is_no_fault_and_a_full_disk_is_one() -> Tested {
    let folder = folder(&quick())?;
    let fct = env!("CARGO_BIN_EXE_fct");
    let shell = |script: &str| Command::new("bash").args(["-c", script]).current_dir(folder.path()).output();
    for command in ["effects", "effects --json", "--help", "check strip.toml"] {
        let out = shell(&format!("'{fct}' {command} 2>&1 | head -1 >/dev/null; exit ${{PIPESTATUS[0]}}"))?;
        assert_eq!(out.status.code(), Some(0), "{command}: {}", String::from_utf8_lossy(&out.stderr));
    }
    let out = shell(&format!("'{fct}' identify nowhere.toml 2>&1 | head -0; exit ${{PIPESTATUS[0]}}"))?;
    assert_eq!(out.status.code(), Some(2), "an error that nobody reads is still one");
    if Path::new("/dev/full").exists() {
        let out = shell(&format!("'{fct}' check strip.toml --json >/dev/full"))?;
        let stderr = String::from_utf8_lossy(&out.stderr);
        assert!(out.status.code() == Some(1) && stderr.contains("cannot print"), "{stderr}");
    }
    Ok(())
}

#[cfg(unix)]
#[test]
fn names_that_no_file_could_hold_are_refused_before_anything_is_computed() -> Tested {
    use std::os::unix::ffi::OsStrExt;
    let folder = folder(&quick())?;
    let odd = std::ffi::OsStr::from_bytes(b"caf\xe9");
    let run = |arguments: &[&std::ffi::OsStr]| {
        Command::new(env!("CARGO_BIN_EXE_fct")).args(arguments).current_dir(folder.path()).output()
    };
    let out = run(&["simulate".as_ref(), "strip.toml".as_ref(), "--out".as_ref(), odd])?;
    let stderr = String::from_utf8_lossy(&out.stderr);
    assert!(out.status.code() == Some(2) && stderr.contains("UTF-8"), "{stderr}");
    fs::create_dir(folder.path().join(odd))?;
    fs::copy(folder.path().join("strip.toml"), folder.path().join(odd).join("strip.toml"))?;
    let file = Path::new(odd).join("strip.toml");
    let out = run(&["simulate".as_ref(), file.as_os_str()])?;
    let stderr = String::from_utf8_lossy(&out.stderr);
    assert!(out.status.code() == Some(2) && stderr.contains("UTF-8"), "{stderr}");
    assert!(!folder.path().join("runs").exists());
    Ok(())
}

#[test]
fn a_place_that_cannot_be_written_is_told_before_anything_is_computed() -> Tested {
    let folder = folder(&quick())?;
    for (place, named) in
        [("/proc/fct-run", "/proc/fct-run"), ("/dev/null/run", "/dev/null"), ("strip.toml/run", "strip.toml")]
    {
        let (code, _, stderr) = json(folder.path(), &["simulate", "strip.toml", "--out", place])?;
        assert!(code != 0 && stderr.contains(named) && !stderr.contains("fault of fct"), "{place}: {stderr}");
    }
    // No progress either: nothing was computed.
    let (_, _, stderr) = json(folder.path(), &["simulate", "strip.toml", "--out", "/proc/fct-run"])?;
    assert_eq!(stderr.lines().count(), 1, "{stderr}");
    Ok(())
}
