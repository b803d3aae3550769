//! Files that nobody writes on purpose, and some that somebody does: more than 400, the same every time, through
//! `fct check`, and a sample of what is accepted through `fct identify`. Whatever stands in them, the command ends with
//! 0, 1 or 2, within a minute, in 2 GB of address space. In the normal run every seventh; all with `FCT_HOSTILE=all`
//! (`just hostile`).
#![cfg(unix)]

use crate::hostile_files;
use crate::watched;

use hostile_files::{CONFIG, Case, cases, record};
use std::error::Error;
use std::fs;
use std::path::Path;
use watched::watched;

fn write(folder: &Path, case: &Case) -> std::io::Result<()> {
    fs::write(folder.join("strip.toml"), &case.config)?;
    fs::write(folder.join("record.csv"), &case.record)
}

#[test]
fn hostile_files_end_in_a_message_or_an_answer() -> Result<(), Box<dyn Error>> {
    let all = std::env::var("FCT_HOSTILE").is_ok_and(|v| v == "all");
    let (every, identified) = if all { (1, 8) } else { (7, 20) };
    let folder = tempfile::tempdir()?;
    let cases = cases();
    assert!(cases.len() >= 400, "{} cases", cases.len());
    let (mut wrong, mut accepted, mut slowest) = (Vec::new(), 0, (0.0, ""));
    for case in cases.iter().step_by(every) {
        write(folder.path(), case)?;
        let ended = watched(folder.path(), &["check", "strip.toml", "--quick"])?;
        wrong.extend(ended.fault().map(|why| format!("check, {}: {why}", case.what)));
        if ended.took.as_secs_f64() > slowest.0 {
            slowest = (ended.took.as_secs_f64(), &case.what);
        }
        accepted += usize::from(ended.code == Some(0));
        // A fit to a record of very many rows is slow, which is no fault of the record.
        if ended.code == Some(0) && accepted % identified == 1 && case.record.len() < 1_000_000 {
            for arguments in
                [&["check", "strip.toml"][..], &["identify", "strip.toml", "--quiet", "--out", "out"]]
            {
                let ended = watched(folder.path(), arguments)?;
                wrong.extend(ended.fault().map(|why| format!("{}, {}: {why}", arguments[0], case.what)));
            }
            let _ = fs::remove_dir_all(folder.path().join("out"));
        }
    }
    println!("{} cases, {accepted} accepted by check, slowest {slowest:?}", cases.len().div_ceil(every));
    assert!(wrong.is_empty(), "{} wrong:\n{}", wrong.len(), wrong.join("\n"));
    Ok(())
}

/// What is no regular file, or one too large, wherever a file may be named: refused at once.
#[test]
fn what_is_no_file_or_has_no_end_is_refused_at_once() -> Result<(), Box<dyn Error>> {
    let folder = tempfile::tempdir()?;
    let here = folder.path();
    assert!(std::process::Command::new("mkfifo").arg(here.join("pipe")).status()?.success());
    let _socket = std::os::unix::net::UnixListener::bind(here.join("socket"))?;
    fs::create_dir(here.join("folder"))?;
    std::os::unix::fs::symlink("loop", here.join("loop"))?;
    fs::File::create(here.join("large"))?.set_len(10_000_000_000)?;
    fs::write(here.join("record.csv"), record(60))?;
    let sources = ["/dev/zero", "/dev/random", "pipe", "socket", "folder", "loop", "large", "missing"];
    let places = [
        ("the specimen of a config", "specimen = \"FILE\"\n".to_owned()),
        ("a record", CONFIG.replace("record.csv", "FILE")),
        ("an outline", CONFIG.replace("cut_mm = 1.5", "cut_mm = 1.5\noutline = \"FILE\"")),
        ("a profile", CONFIG.replace("cut_mm = 1.5", "cut_mm = 1.5\nthickness_profile = \"FILE\"")),
    ];
    let mut wrong = Vec::new();
    let mut refused = |what: String, arguments: &[&str]| -> Result<(), Box<dyn Error>> {
        let ended = watched(here, arguments)?;
        if ended.code != Some(2) || ended.took.as_secs_f64() > 10.0 || ended.fault().is_some() {
            wrong.push(format!("{what}: {ended:?}"));
        }
        Ok(())
    };
    for source in sources {
        for (what, text) in &places {
            fs::write(here.join("strip.toml"), text.replace("FILE", source))?;
            refused(format!("{source} as {what}"), &["check", "strip.toml"])?;
        }
        for command in ["check", "simulate", "identify", "discover", "batch"] {
            refused(format!("{command} {source}"), &[command, source])?;
        }
        refused(format!("add {source}"), &["add", "drift", source])?;
        refused(format!("drop {source}"), &["drop", "drift", source])?;
    }
    fs::write(here.join("strip.toml"), CONFIG)?;
    fs::rename(here.join("large"), here.join("published.toml"))?;
    refused("published.toml of 10 GB".to_owned(), &["identify", "strip.toml"])?;
    assert!(wrong.is_empty(), "{} wrong:\n{}", wrong.len(), wrong.join("\n"));
    Ok(())
}
