//! A hundred odd command lines: each ends with 0, 1 or 2, says why, and never in a panic.
#![cfg(unix)]

use crate::common;
use crate::watched;

use common::{Tested, folder, strip};
use std::ffi::OsString;
use std::os::unix::ffi::OsStringExt;
use std::process::{Command, Stdio};
use watched::watched;

const COMMANDS: [&str; 17] = [
    "new",
    "check",
    "simulate",
    "identify",
    "compare",
    "diagnose",
    "add",
    "drop",
    "discover",
    "ladder",
    "batch",
    "effects",
    "report",
    "export",
    "completions",
    "man",
    "campaign",
];

fn lines() -> Vec<Vec<String>> {
    let split =
        |line: &str| line.split(' ').map(|w| if w == "''" { String::new() } else { w.to_owned() }).collect();
    let mut out: Vec<Vec<String>> = Vec::new();
    for command in COMMANDS {
        for rest in [
            "",
            " ''",
            " nowhere.toml",
            " .",
            " strip.toml strip.toml strip.toml",
            " --frobnicate",
            " -x strip.toml",
        ] {
            // `new` and `effects` alone, and `batch` of nothing but good files, are no oddities.
            if !(rest.is_empty() && command == "effects") {
                out.push(split(&format!("{command}{rest}")));
            }
        }
    }
    let odd = [
        "",
        "''",
        "frobnicate",
        "Check strip.toml",
        "check strip.toml --out",
        "check strip.toml --out ''",
        "simulate strip.toml --out ''",
        "simulate strip.toml --out strip.toml",
        "simulate strip.toml --out strip.toml/x",
        "simulate strip.toml --out /dev/null",
        "simulate strip.toml --out /proc/x",
        "simulate strip.toml --out .",
        "check strip.toml --threads",
        "check strip.toml --threads 0",
        "check strip.toml --threads -1",
        "check strip.toml --threads 1e3",
        "check strip.toml --threads 99999999999999999999",
        "check strip.toml --threads 1025",
        "check strip.toml --threads ''",
        "check strip.toml --json --json",
        "check strip.toml --quiet --quiet",
        "check strip.toml --threads 1 --threads 2",
        "check strip.toml --out a --out b",
        "check strip.toml --figures",
        "check strip.toml --figures ''",
        "check strip.toml --figures bmp",
        "check strip.toml --figures svg,svg,,",
        "check --",
        "check -- strip.toml --json",
        "check - strip.toml",
        "check -",
        "check --json",
        "--json",
        "--out",
        "--version extra",
        "--help extra",
        "help help help",
        "help frobnicate",
        "add",
        "add drift",
        "add '' strip.toml",
        "add drift ''",
        "add driftt strip.toml",
        "add drift strip.toml --out ''",
        "add drift strip.toml --out /",
        "add drift strip.toml --out nowhere/x.toml",
        "add drift /dev/zero",
        "drop drift strip.toml",
        "drop '' strip.toml",
        "drop drift /dev/zero",
        "effects ''",
        "effects drift lag",
        "effects nothing",
        "new ''",
        "new ..",
        "new a/b",
        "new strip.toml",
        "new name --out ''",
        "report strip.toml",
        "report ''",
        "ladder",
        "ladder . .",
        "compare .",
        "diagnose .",
        "check strip.toml --resume",
        "--json campaign",
        "campaign run strip.toml",
        "campaign run .",
        "campaign run strip.toml --shard 2/1",
        "campaign run strip.toml --workers 0",
        "--json campaign status .",
        "campaign plan ''",
        "campaign report nowhere.toml",
        "campaign slurm strip.toml --time ;",
        "export felupe .",
        "export felupe strip.toml",
        "export word strip.toml",
        "man frobnicate",
        "completions frobnicate",
        "schema extra",
        "simulate nowhere.toml --resume",
        "identify strip.toml --json --quiet",
    ];
    out.extend(odd.iter().map(|l| split(l)));
    out.push(vec!["check".into(), "x".repeat(100_000)]);
    out.push(vec!["new".into(), "x".repeat(5_000)]);
    out.push(vec!["check".into(), "strip\n.toml\u{1b}[2J".into()]);
    out.push(std::iter::once("batch".to_owned()).chain(vec!["nowhere.toml".to_owned(); 2000]).collect());
    out.push(std::iter::once("ladder".to_owned()).chain(vec![".".to_owned(); 2000]).collect());
    out
}

#[test]
fn odd_command_lines_end_in_a_message() -> Tested {
    let mut wrong = Vec::new();
    let lines = lines();
    assert!(lines.len() >= 100, "{} lines", lines.len());
    for line in &lines {
        // Some of them write: each has its own folder.
        let folder = folder(&strip("[solver]\nstep_mm = 1.0\n[output]\nfields = false\n"))?;
        let ended = watched(folder.path(), line)?;
        let shown: String = line.join(" ").chars().take(80).collect();
        wrong.extend(ended.fault().map(|why| format!("fct {shown}: {why}")));
        if ended.stderr.contains('\u{1b}') {
            wrong.push(format!("fct {shown}: an escape character reaches the terminal"));
        }
    }
    assert!(wrong.is_empty(), "{} of {} wrong:\n{}", wrong.len(), lines.len(), wrong.join("\n"));
    Ok(())
}

/// Names that are no UTF-8, as files may have.
#[test]
fn arguments_that_are_no_text() -> Tested {
    let (odd, word) = (odd_name, |w: &str| OsString::from(w));
    end_well(&[
        vec![odd()],
        vec![word("check"), odd()],
        vec![word("add"), word("drift"), odd()],
        vec![word("add"), odd(), word("strip.toml")],
        vec![word("new"), odd()],
        vec![word("effects"), odd()],
        vec![word("check"), word("strip.toml"), word("--threads"), odd()],
    ])
}

#[test]
fn arguments_that_are_no_text_in_a_run() -> Tested {
    let (odd, word) = (odd_name, |w: &str| OsString::from(w));
    end_well(&[
        vec![word("simulate"), odd()],
        vec![word("simulate"), word("strip.toml"), word("--out"), odd()],
    ])
}

fn odd_name() -> OsString {
    OsString::from_vec(b"str\xffip.toml".to_vec())
}

fn end_well(lines: &[Vec<OsString>]) -> Tested {
    let folder = folder(&strip("[solver]\nstep_mm = 1.0\n[output]\nfields = false\n"))?;
    std::fs::copy(folder.path().join("strip.toml"), folder.path().join(odd_name()))?;
    let mut wrong = Vec::new();
    for line in lines {
        wrong.extend(watched(folder.path(), line)?.fault().map(|why| format!("{line:?}: {why}")));
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    Ok(())
}

/// A reader that goes away (`fct … | head -1`) is no fault of anybody's.
#[test]
fn a_closed_pipe_is_no_panic() -> Tested {
    scripts_end_well(&[
        "FCT effects | true; exit ${PIPESTATUS[0]}",
        "FCT check strip.toml --json | true; exit ${PIPESTATUS[0]}",
        "FCT check strip.toml >&-; exit $?",
        "FCT --help | true; exit ${PIPESTATUS[0]}",
    ])
}

#[test]
fn a_closed_stderr_is_no_panic() -> Tested {
    scripts_end_well(&[
        "FCT check nowhere.toml 2> >(true); exit $?",
        "FCT simulate strip.toml 2> >(true); exit $?",
        "FCT check nowhere.toml 2>&-; exit $?",
        "FCT check nowhere.toml 2>/dev/full; exit $?",
    ])
}

fn scripts_end_well(scripts: &[&str]) -> Tested {
    let folder = folder(&strip("[solver]\nstep_mm = 1.0\n[output]\nfields = false\n"))?;
    for script in scripts {
        let script = script.replace("FCT", &format!("'{}'", env!("CARGO_BIN_EXE_fct")));
        let mut command = Command::new("bash");
        let command = command.args(["-c", &script]).current_dir(folder.path());
        let code = command.stdout(Stdio::null()).stderr(Stdio::null()).status()?.code();
        assert!(matches!(code, Some(0..=2)), "{script}: {code:?}");
    }
    Ok(())
}
