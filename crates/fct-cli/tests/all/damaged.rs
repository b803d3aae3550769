//! Run directories that something happened to: every command that reads one gives an error with the file's name, or does
//! without that file; never a panic, a hang, or an answer made of what is left.

use crate::common;

use common::{Tested, json, synthetic};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

/// What may happen to a file.
const DAMAGES: [&str; 9] =
    ["missing", "empty", "half", "byte", "binary", "directory", "pipe", "nested", "other"];

fn damage(file: &Path, how: &str) -> Tested {
    let bytes = fs::read(file)?;
    fs::remove_file(file)?;
    match how {
        "missing" => {}
        "empty" => fs::write(file, "")?,
        "half" => fs::write(file, &bytes[..bytes.len() / 2])?,
        "byte" => {
            let mut changed = bytes.clone();
            let at = changed.len() / 3;
            if let Some(b) = changed.get_mut(at) {
                *b ^= 1;
            }
            fs::write(file, changed)?;
        }
        "binary" => fs::write(file, [0xFF, 0x00, 0x9F].repeat(1000))?,
        "directory" => fs::create_dir(file)?,
        "pipe" => assert!(Command::new("mkfifo").arg(file).status()?.success()),
        "nested" => fs::write(file, "[".repeat(100_000))?,
        _ => fs::write(file, "{\"schema\":1,\"run\":{},\"tests\":{\"tearing\":{}}}")?,
    }
    Ok(())
}

fn files(folder: &Path) -> Vec<PathBuf> {
    let mut out = Vec::new();
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        if entry.path().is_dir() { out.extend(files(&entry.path())) } else { out.push(entry.path()) }
    }
    out.sort();
    out
}

/// Runs a command with a time limit: exit code and what it said.
fn limited(folder: &Path, arguments: &[&str]) -> Result<(i32, String), Box<dyn std::error::Error>> {
    let mut child = Command::new(env!("CARGO_BIN_EXE_fct"))
        .args(arguments)
        .current_dir(folder)
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()?;
    let begun = Instant::now();
    while child.try_wait()?.is_none() {
        if begun.elapsed() > Duration::from_secs(60) {
            child.kill()?;
            return Err(format!("{arguments:?} hangs").into());
        }
        std::thread::sleep(Duration::from_millis(5));
    }
    let out = child.wait_with_output()?;
    Ok((out.status.code().unwrap_or(-1), String::from_utf8_lossy(&out.stderr).into_owned()))
}

/// Files without which a command cannot answer.
fn needed(command: &str, file: &str, how: &str) -> bool {
    // One byte of a manifest may be that of a file which the command does not read.
    let manifest = file == "manifest.json" && how != "byte";
    let answer = manifest || ["summary.json", "run.toml"].contains(&file);
    answer
        || match command {
            "compare" => file.starts_with("curves/"),
            "report" => {
                file.starts_with("curves/")
                    || file.starts_with("figures/") && file.contains("S22")
                    || file == "diagnosis.json"
                    // The sliders' derivatives; a run may have none.
                    || file == "jacobian.csv" && how != "missing"
            }
            "add" => file == "diagnosis.json",
            _ => false,
        }
}

#[test]
fn damaged_run_directories_are_errors() -> Tested {
    let folder = synthetic()?;
    let here = folder.path();
    let (code, ..) = json(here, &["identify", "fit.toml", "--out", "whole"])?;
    assert_eq!(code, 0);
    let (code, _, stderr) = json(here, &["diagnose", "whole"])?;
    assert_eq!(code, 0, "{stderr}");
    let names: Vec<String> = files(&here.join("whole"))
        .iter()
        .filter_map(|f| Some(f.strip_prefix(here.join("whole")).ok()?.to_string_lossy().into_owned()))
        .collect();
    // In the usual test run every seventh of them; `just damaged` tries all.
    let every: usize = std::env::var("FCT_EVERY").ok().and_then(|n| n.parse().ok()).unwrap_or(7);
    let cases: Vec<(&String, &str)> = names.iter().flat_map(|n| DAMAGES.map(|d| (n, d))).collect();
    let (mut tried, mut refused) = (0, 0);
    for (name, how) in cases.into_iter().step_by(every) {
        tried += 1;
        let run = here.join("run");
        let _ = fs::remove_dir_all(&run);
        assert!(Command::new("cp").arg("-r").arg(here.join("whole")).arg(&run).status()?.success());
        damage(&run.join(name), how)?;
        let commands = [
            &["compare", "run"][..],
            &["report", "run", "--out", "page.html"],
            &["ladder", "run"],
            &["add", "drift", "run", "--out", "added.toml"],
            &["diagnose", "run"],
        ];
        // A diagnosis that nothing prevents takes its time.
        for arguments in commands.into_iter().filter(|a| a[0] != "diagnose" || needed(a[0], name, how)) {
            let (code, stderr) = limited(here, arguments)?;
            let told = format!("{name} {how}, {arguments:?}: {code} {stderr}");
            assert!(!stderr.contains("panicked") && !stderr.contains("fault of fct"), "{told}");
            if needed(arguments[0], name, how) {
                assert!(code == 2 && stderr.contains(name.rsplit('/').next().unwrap_or(name)), "{told}");
                refused += 1;
            } else {
                assert!(code == 0 || name == "manifest.json" && code == 2, "{told}");
            }
            let _ = fs::remove_file(here.join("page.html"));
            let _ = fs::remove_file(here.join("added.toml"));
        }
    }
    println!("{tried} damaged run directories, {refused} answers refused, the others not concerned");
    assert!(refused > 0);
    Ok(())
}
