//! Runs that are killed or stopped at any moment: what stands in a run directory is whole, files of the user stay, and
//! `--resume` goes on and ends as if nothing had happened. `FCT_KILLS` and `FCT_SIGNALS` set how often, per command
//! (`just kills`).
#![cfg(unix)]

use crate::common;

use common::{Tested, json, synthetic, timeless};
use serde_json::Value;
use std::fs;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

fn ends(variable: &str, otherwise: u32) -> u32 {
    std::env::var(variable).ok().and_then(|n| n.parse().ok()).unwrap_or(otherwise)
}

/// Shares of a run's time at which it is killed: spread evenly, beyond its end too (golden-ratio sequence).
fn moments(n: u32) -> impl Iterator<Item = f64> {
    (1..=n).map(|i| 1.05 * (f64::from(i) * 0.618_033_988_749_895).fract())
}

/// The commands that are killed: identify, discover, batch, each into `run`.
const COMMANDS: [&[&str]; 3] = [
    &["identify", "fit.toml", "--out", "run", "--threads", "1"],
    &["discover", "fit.toml", "--out", "run", "--threads", "1"],
    &["batch", "fit.toml", "fit.toml", "--out", "run", "--threads", "1"],
];

/// What ends a run before its time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum End {
    Kill,
    Int,
    Term,
    Hup,
}

impl End {
    fn flag(self) -> &'static str {
        match self {
            Self::Kill => "-KILL",
            Self::Int => "-INT",
            Self::Term => "-TERM",
            Self::Hup => "-HUP",
        }
    }
}

/// Starts the command.
fn started(folder: &Path, arguments: &[&str]) -> std::io::Result<Child> {
    Command::new(env!("CARGO_BIN_EXE_fct"))
        .args(arguments)
        .arg("--json")
        .current_dir(folder)
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
}

/// Ends the command after a time; whether it was still running.
fn ended(
    folder: &Path,
    arguments: &[&str],
    after: Duration,
    how: End,
) -> Result<bool, Box<dyn std::error::Error>> {
    let mut child = started(folder, &[arguments, &["--quiet"]].concat())?;
    std::thread::sleep(after);
    let running = child.try_wait()?.is_none();
    if running {
        Command::new("kill").args([how.flag(), &child.id().to_string()]).status()?;
    }
    let out = child.wait_with_output()?;
    let stderr = String::from_utf8_lossy(&out.stderr);
    assert!(!stderr.contains("panicked") && !stderr.contains("fault of fct"), "{stderr}");
    if how != End::Kill {
        // Stopped (1), finished before the signal came (0), or before it could be listened to (none: the system's own end).
        assert!(matches!(out.status.code(), Some(0 | 1) | None), "{how:?}: {:?} {stderr}", out.status);
    }
    Ok(running)
}

/// Every run directory below `run` that is there is whole: its JSON reads, and a report can be made of it. How many.
fn readable(folder: &Path) -> Result<usize, Box<dyn std::error::Error>> {
    let mut count = 0;
    let run = folder.join("run");
    let below = fs::read_dir(&run).into_iter().flatten().filter_map(|e| e.ok().map(|e| e.path()));
    for place in below.chain([run.clone()]).filter(|p| p.join("run.toml").is_file()) {
        let hidden = place.file_name().is_some_and(|n| n.to_string_lossy().starts_with('.'));
        if hidden {
            continue;
        }
        // The report first: a reader finishes what a kill cut off while it was put in place.
        let (code, _, stderr) = json(folder, &["report", &place.to_string_lossy()])?;
        assert_eq!(code, 0, "{stderr}");
        let summary: Value = serde_json::from_slice(&fs::read(place.join("summary.json"))?)?;
        assert_eq!(summary["schema"], 1, "{}", place.display());
        count += 1;
    }
    Ok(count)
}

/// Files of the user in the place of the run.
const THEIRS: [&str; 3] = ["run/notes.txt", "run/curves/raw_day1.csv", "run/figures/photo.png"];

/// A copy of the finished run, with files of the user in it.
fn with_earlier_run(folder: &Path, reference: &Path) -> Tested {
    let copied = Command::new("cp").arg("-r").arg(reference.join("run")).arg(folder).status()?;
    assert!(copied.success());
    for file in THEIRS {
        fs::create_dir_all(folder.join(file).parent().ok_or("folder")?)?;
        fs::write(folder.join(file), file)?;
    }
    Ok(())
}

/// CPU time of all child processes that have ended, in ticks of the system's clock; nothing where that is not told.
fn cpu() -> f64 {
    let stat = fs::read_to_string("/proc/self/stat").unwrap_or_default();
    let after = stat.rsplit(')').next().unwrap_or_default();
    // User and system time of children are the 16th and 17th field, the 14th and 15th after the name.
    after.split_whitespace().skip(13).take(2).filter_map(|t| t.parse::<f64>().ok()).sum()
}

fn hidden_entries(folder: &Path) -> Vec<String> {
    let names = fs::read_dir(folder).into_iter().flatten().flatten();
    names.map(|e| e.file_name().to_string_lossy().into_owned()).filter(|n| n.starts_with('.')).collect()
}

/// Ends one command at many moments in one way, and takes it up each time.
fn taken_up(arguments: &[&str], times: u32, how: &[End]) -> Tested {
    let reference = synthetic()?;
    let (begun, before) = (Instant::now(), cpu());
    let (code, whole, stderr) = json(reference.path(), arguments)?;
    let (took, cost) = (begun.elapsed(), cpu() - before);
    assert_eq!(code, 0, "{arguments:?}: {stderr}");
    let whole = timeless(whole);
    let (mut caught, whole_runs) = (0, readable(reference.path())?);
    let (mut done, mut saved) = (0.0, 0.0);
    assert!(whole_runs > 0);
    for (k, share) in moments(times).enumerate() {
        let folder = synthetic()?;
        // Every second time there is an earlier run in the place: that, or the new one, stays whole.
        let earlier = k % 2 == 1;
        if earlier {
            with_earlier_run(folder.path(), reference.path())?;
        }
        let how = how[(k / 2) % how.len()];
        let before = cpu();
        let running = ended(folder.path(), arguments, took.mul_f64(share), how)?;
        let spent = cpu() - before;
        let found = readable(folder.path())?;
        assert!(
            !earlier || found == whole_runs,
            "{how:?} at {share:.3}: {found} of {whole_runs} runs are left"
        );
        let before = cpu();
        let (code, again, stderr) = json(folder.path(), &[arguments, &["--resume"]].concat())?;
        let again_cost = cpu() - before;
        assert_eq!(code, 0, "{arguments:?} {how:?} at {share:.3}: {stderr}");
        assert_eq!(timeless(again), whole, "{arguments:?} {how:?} at {share:.3}");
        if running && !earlier {
            done += spent;
            saved += (cost - again_cost).max(0.0);
        }
        caught += u32::from(running);
        if earlier {
            for file in THEIRS {
                assert_eq!(fs::read_to_string(folder.path().join(file))?, file, "{how:?} at {share:.3}");
            }
        }
        let left = hidden_entries(folder.path());
        assert!(left.is_empty(), "left behind: {left:?}");
    }
    println!(
        "{}: ended {caught} of {times} times while it ran ({how:?}); of the CPU time spent before, {:.0} % was not spent again",
        arguments[0],
        100.0 * saved / f64::max(done, 1e-9)
    );
    assert!(caught > 0, "{arguments:?}: never caught");
    Ok(())
}

#[test]
fn killed_runs_leave_nothing_broken_and_go_on_to_the_same_bits() -> Tested {
    COMMANDS.iter().try_for_each(|arguments| taken_up(arguments, ends("FCT_KILLS", 2), &[End::Kill]))
}

#[test]
fn stopped_runs_leave_a_valid_directory_and_go_on_to_the_same_bits() -> Tested {
    // All commands hear of a signal by the same way; `just kills` ends each by each.
    let commands = if std::env::var_os("FCT_SIGNALS").is_some() { &COMMANDS[..] } else { &COMMANDS[..1] };
    commands.iter().try_for_each(|arguments| {
        taken_up(arguments, ends("FCT_SIGNALS", 3), &[End::Int, End::Term, End::Hup])
    })
}

#[test]
fn two_runs_on_one_directory() -> Tested {
    let folder = synthetic()?;
    let here = folder.path();
    fs::write(here.join("fit.toml"), common::FIT.replace("[8, 8, 1]", "[24, 24, 2]"))?;
    let mut first = started(here, &["identify", "fit.toml", "--out", "run", "--quiet"])?;
    while !here.join(".run.part").exists() && first.try_wait()?.is_none() {
        std::thread::sleep(Duration::from_millis(5));
    }
    let (code, _, stderr) = json(here, &["identify", "fit.toml", "--out", "run"])?;
    let alone = first.try_wait()?.is_none();
    first.kill()?;
    first.wait()?;
    assert!(alone, "the first run was to be still there");
    assert!(code == 2 && stderr.contains("another") && stderr.contains("run"), "{code}: {stderr}");
    Ok(())
}

#[test]
fn a_directory_that_vanishes_under_a_run() -> Tested {
    let folder = synthetic()?;
    let here = folder.path();
    fs::write(here.join("fit.toml"), common::FIT.replace("[8, 8, 1]", "[16, 16, 1]"))?;
    let child = started(here, &["identify", "fit.toml", "--out", "runs/deep/run"])?;
    while !here.join("runs/deep/.run.part/state.json").exists() {
        std::thread::sleep(Duration::from_millis(5));
    }
    fs::remove_dir_all(here.join("runs/deep"))?;
    let out = child.wait_with_output()?;
    let stderr = String::from_utf8_lossy(&out.stderr);
    // It is made again with all that belongs there: everything but the search's state is written at the end.
    assert_eq!(out.status.code(), Some(0), "{stderr}");
    let place = here.join("runs/deep/run");
    let stored: Value = serde_json::from_slice(&fs::read(place.join("summary.json"))?)?;
    let answer: Value = serde_json::from_slice(&out.stdout)?;
    assert_eq!(timeless(stored)["parameters"], timeless(answer)["parameters"]);
    for file in ["run.toml", "history.csv", "jacobian.csv", "report.html", "curves/tearing.csv"] {
        assert!(place.join(file).is_file(), "{file}");
    }
    Ok(())
}

/// A disk that takes no more, as far as one can have it without a disk of one's own: files may grow to a few kB only.
#[test]
fn a_full_disk_and_a_place_that_cannot_be_written() -> Tested {
    let folder = synthetic()?;
    let here = folder.path();
    let fct = env!("CARGO_BIN_EXE_fct");
    let script = format!("trap '' XFSZ; ulimit -f 8; exec '{fct}' identify fit.toml --out run --json");
    let out = Command::new("sh").args(["-c", &script]).current_dir(here).output()?;
    let stderr = String::from_utf8_lossy(&out.stderr);
    // What was computed is not lost: it is printed.
    let answer: Value = serde_json::from_slice(&out.stdout)?;
    assert_eq!(out.status.code(), Some(1), "{stderr}");
    assert!(answer["parameters"].is_array() && stderr.contains("could not be stored"), "{stderr}");
    assert!(!here.join("run").exists() && !here.join(".run.part").exists(), "nothing half-written stays");
    let (code, answer, stderr) = json(here, &["identify", "fit.toml", "--out", "/proc/fct-run"])?;
    assert!(code != 0 && !stderr.contains("panicked"), "{stderr}");
    assert!(answer["error"]["reason"].as_str().is_some_and(|r| r.contains("/proc")), "{answer}");
    Ok(())
}
