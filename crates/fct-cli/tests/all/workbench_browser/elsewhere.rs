//! The same state after a reload, in another window, and in a shell.

use super::{SOON, misfit, present};
use crate::bench::Bench;
use crate::common::{self, Tested};
use crate::driver::Page;
use serde_json::{Value, json};
use std::error::Error;
use std::fs;
use std::path::Path;
use std::process::Command;

/// A reload, and a terminal, see the same; undo goes back.
pub(super) fn again(page: &mut Page, folder: &Path) -> Tested {
    let (after, steps) = (misfit(page)?, page.ask("document.querySelectorAll('[data-step]').length")?);
    page.call("Page.reload", json!({}))?;
    page.until("document.querySelector('[aria-current=step]')", SOON)?;
    present(page, "+ compliance", SOON)?;
    assert_eq!((misfit(page)?, page.ask("document.querySelectorAll('[data-step]').length")?), (after, steps));
    let commands = page.text("#commands")?;
    for word in [
        "cd '",
        "fct import",
        "--kind=uniaxial,tearing",
        "fct diagnose",
        "fct add compliance",
        "fct identify",
    ] {
        assert!(commands.contains(word), "{word} in\n{commands}");
    }
    in_a_shell(page, folder)?;
    // The run is an ordinary one, and its report can be saved.
    let run = page.ask("document.querySelectorAll('#links a')[1].getAttribute('href')")?;
    let run =
        run.as_str().and_then(|r| r.strip_prefix("/files/")?.strip_suffix("/report.html")).ok_or("a run")?;
    let (code, compared, _) = common::json(folder, &["compare", run])?;
    assert_eq!((code, compared["schema"].as_u64()), (0, Some(1)));
    let saved = page.ask_later("fetch(document.querySelectorAll('#links a')[1].href).then(r => r.text()).then(t => t.includes('name=\"generator\" content=\"fct\"'))")?;
    assert_eq!(saved, true);
    page.click("#undo")?;
    present(page, "Fit", SOON)?;
    assert!(misfit(page)? > after);
    page.click("#redo")?;
    present(page, "+ compliance", SOON)
}

/// Another window sees the same; what is done there is seen here.
pub(super) fn windows(page: &mut Page, chromium: &Path, bench: &Bench) -> Tested {
    let mut other = Page::open(chromium)?;
    other.go(&bench.url)?;
    present(&mut other, "+ compliance", SOON)?;
    assert_eq!(misfit(&mut other)?, misfit(page)?);
    other.press("z", 90, 2)?;
    present(page, "Fit", SOON)?;
    page.press("z", 90, 10)?;
    present(&mut other, "+ compliance", SOON)?;
    assert_eq!(other.faults(), Vec::<String>::new());
    present(page, "+ compliance", SOON)
}

/// The lines on the page, pasted into a shell in another folder that holds only the raw files, give the page's numbers to the bit.
fn in_a_shell(page: &mut Page, folder: &Path) -> Tested {
    let commands = page.text("#commands")?;
    let elsewhere = tempfile::tempdir()?;
    let raw = elsewhere.path().join("workbench/raw");
    fs::create_dir_all(&raw)?;
    for file in fs::read_dir(folder.join("workbench/raw"))? {
        let file = file?;
        fs::copy(file.path(), raw.join(file.file_name()))?;
    }
    let lines: Vec<&str> = commands.lines().skip(1).collect();
    let last = lines.iter().rev().find(|l| l.starts_with("fct identify")).ok_or("a fit")?;
    let run = last.rsplit(' ').next().ok_or("a run")?;
    let program = Path::new(env!("CARGO_BIN_EXE_fct"));
    let path = std::env::join_paths(
        std::iter::once(program.parent().ok_or("a folder")?.to_owned())
            .chain(std::env::split_paths(&std::env::var_os("PATH").unwrap_or_default())),
    )?;
    let out = Command::new("sh")
        .args(["-e", "-c", &lines.join("\n")])
        .current_dir(elsewhere.path())
        .env("PATH", path)
        .output()?;
    assert!(out.status.success(), "{}\n{}", lines.join("\n"), String::from_utf8_lossy(&out.stderr));
    let summary = |at: &Path| -> Result<Value, Box<dyn Error>> {
        Ok(common::timeless(serde_json::from_slice(&fs::read(at.join(run).join("summary.json"))?)?))
    };
    let (theirs, ours) = (summary(elsewhere.path())?, summary(folder)?);
    // `run` has the folder's path, and `--json`, which the page adds.
    for (key, value) in ours.as_object().ok_or("an answer")?.iter().filter(|(k, _)| *k != "run") {
        assert_eq!(&theirs[key], value, "{run}: {key}");
    }
    for file in ["jacobian.csv", "curves/uniaxial.csv", "curves/tearing.csv"] {
        let read = |at: &Path| fs::read(at.join(run).join(file));
        assert!(read(elsewhere.path())? == read(folder)?, "{run}/{file} is not the same");
    }
    Ok(())
}
