//! The tutorial of the book, word by word: its files are written, its commands run, its claims checked.

use crate::common;

use common::{BOOK, Tested, blocks, fct};
use serde_json::Value;
use std::fs;
use std::path::Path;

/// Writes the files and runs the commands of a page, in its order; gives the number of commands.
fn follow(page: &str, here: &Path) -> Result<usize, Box<dyn std::error::Error>> {
    let mut commands = 0;
    for (head, lines) in blocks(&fs::read_to_string(Path::new(BOOK).join(page))?) {
        if let Some(file) = head.strip_prefix("toml ") {
            fs::write(here.join(file), lines.join("\n"))?;
        }
        for line in lines.iter().filter(|_| head == "console").filter_map(|l| l.strip_prefix("$ fct ")) {
            let out = fct(here, &line.split_whitespace().collect::<Vec<_>>())?;
            let stderr = String::from_utf8_lossy(&out.stderr);
            assert!(out.status.success(), "fct {line}: {stderr}");
            let text = String::from_utf8(out.stdout)?;
            // `check` prints a file, with the user's own paths in it; all else is made for a terminal.
            let printed = line.starts_with("check ");
            assert!(
                printed || text.lines().all(|l| l.chars().count() <= 100),
                "fct {line}: wider than 100 columns\n{text}"
            );
            assert!(!text.contains('\x1b'), "fct {line}: colours in a pipe");
            commands += 1;
        }
    }
    Ok(commands)
}

fn read(file: &Path) -> Result<Value, Box<dyn std::error::Error>> {
    Ok(serde_json::from_str(&fs::read_to_string(file)?)?)
}

#[test]
fn the_tutorial_works_as_written() -> Tested {
    let folder = tempfile::tempdir()?;
    let here = folder.path();
    assert_eq!(follow("tutorial.md", here)?, 11);
    let base = read(&here.join("runs/base/summary.json"))?;
    assert_eq!(base["explained"], false);
    let diagnosis = read(&here.join("runs/base/diagnosis.json"))?;
    assert_eq!(diagnosis["screen"][0]["effect"], "viscoelastic");
    // `add` begins where that screen says, and quotes it.
    let added = fs::read_to_string(here.join("runs/more.toml"))?;
    for key in ["g", "tau_s"] {
        let estimate = diagnosis["screen"][0]["estimate"][key].as_f64().ok_or("estimate")?;
        assert!(added.contains(&format!("{key} = {estimate}")), "{key} = {estimate} in\n{added}");
    }
    let sentence = diagnosis["screen"][0]["sentence"].as_str().ok_or("sentence")?;
    let opening: Vec<&str> = sentence.split_whitespace().take(4).collect();
    assert!(added.contains(&opening.join(" ")), "{sentence} in\n{added}");
    let worst = diagnosis["where"][0]["segment"].as_str().ok_or("segment")?;
    assert!(worst.starts_with("unload"), "{}", diagnosis["where"]);
    assert!(
        diagnosis["posterior"]["effects"]["viscoelastic"].as_f64() > Some(0.95),
        "{}",
        diagnosis["posterior"]
    );
    let search = read(&here.join("runs/search/summary.json"))?;
    assert_eq!((&search["verdict"], &search["found"][0]), (&"explained".into(), &"viscoelastic".into()));
    // Where noise alone is left, a cause that looks the same keeps some 7 %.
    let acts = search["posterior"]["effects"]["viscoelastic"].as_f64();
    assert!(acts > Some(0.92) && acts < Some(0.95), "{}", search["posterior"]);
    // The first rung is what `identify` found.
    let ladder = &search["ladder"][0]["values"];
    for p in base["parameters"].as_array().ok_or("parameters")? {
        let (path, value) = (p["path"].as_str().ok_or("path")?, p["value"].as_f64().ok_or("value")?);
        let shown = ladder[path].as_f64().ok_or(path)?;
        assert!((shown / value - 1.0).abs() < 1e-9, "{path}: {shown} and {value}");
    }
    let more = read(&here.join("runs/more/summary.json"))?;
    assert_eq!(more["explained"], true);
    // What the last paragraph says about the secret.
    for (path, truth) in [
        ("interface.area[1].gc", 0.15),
        ("interface.area[1].sigma_c", 0.08),
        ("effects.viscoelastic.g", 0.25),
    ] {
        let all = more["parameters"].as_array().ok_or("parameters")?;
        let found = all.iter().find(|p| p["path"] == path).ok_or(path)?["value"].as_f64().ok_or(path)?;
        assert!((found / truth - 1.0).abs() < 0.05, "{path}: {found}, truth {truth}");
    }
    for file in [
        "ladder.html",
        "runs/search/report.html",
        "runs/search/rungs/1/curves/tearing.csv",
        "runs/search/figures/ladder.svg",
        "runs/more/figures/tearing.svg",
        "runs/more/figures/tearing-S22.svg",
    ] {
        assert!(here.join(file).is_file(), "{file}");
    }
    Ok(())
}

/// Every page that the table of contents names is there, and every page there is named.
#[test]
fn the_book_is_whole() -> Tested {
    let summary = fs::read_to_string(Path::new(BOOK).join("SUMMARY.md"))?;
    let named: Vec<&str> = summary.split("](").skip(1).filter_map(|r| r.split(')').next()).collect();
    for page in &named {
        let file = Path::new(BOOK).join(page);
        let text = fs::read_to_string(&file).map_err(|e| format!("{page}: {e}"))?;
        for link in text.split("](").skip(1).filter_map(|r| r.split([')', '#']).next()) {
            if link.is_empty() || link.contains("://") {
                continue;
            }
            let target = file.parent().ok_or("folder")?.join(link);
            assert!(target.exists(), "{page}: link to {link}");
        }
    }
    for folder in ["", "how-to", "reference", "explanation"] {
        for entry in fs::read_dir(Path::new(BOOK).join(folder))?.flatten() {
            let name = entry.file_name().to_string_lossy().into_owned();
            let page = if folder.is_empty() { name.clone() } else { format!("{folder}/{name}") };
            let known = !page.ends_with(".md") || page == "SUMMARY.md" || named.contains(&page.as_str());
            assert!(known, "{page} is not in SUMMARY.md");
        }
    }
    Ok(())
}
