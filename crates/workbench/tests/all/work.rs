//! What the page asks for becomes commands; the newest wins; what was done is found again.

use crate::running::{Idle, Running, Tested};
use std::fs;
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};
use workbench::{Bench, Opened};

const STRIP: &str = "name = \"made\"\n[geometry]\nlength_mm = 8.0\nwidth_mm = 6.0\nthickness_mm = 0.8\ncut_mm = 1.0\n[[tests]]\n\
    kind = \"tearing\"\nprotocol = [{ to_mm = 1.0, rate_mm_per_s = 0.1 }]\n[mesh]\ndivisions = [6, 4, 1]\n";

/// Waits until so many commands have been heard.
fn wait(commands: &Idle, n: usize) -> Vec<(Vec<String>, bool)> {
    let begun = Instant::now();
    loop {
        let heard = commands.heard.lock().map(|h| h.clone()).unwrap_or_default();
        if heard.len() >= n || begun.elapsed() > Duration::from_secs(20) {
            return heard;
        }
        std::thread::sleep(Duration::from_millis(5));
    }
}

#[test]
fn an_upload_and_an_import_are_commands_on_the_folder() -> Tested {
    let running = Running::new()?;
    let kept = running.own("POST /api/upload?name=Zug%201.csv", b"t,u,F\n")?;
    assert!(kept.body.contains("workbench/raw/Zug 1.csv"), "{}", kept.body);
    // The same again is the same file; another content is another file.
    assert_eq!(running.own("POST /api/upload?name=Zug%201.csv", b"t,u,F\n")?.body, kept.body);
    assert!(running.own("POST /api/upload?name=Zug%201.csv", b"other")?.body.contains("2-Zug 1.csv"));
    let asked = r#"{"do":"import","files":["workbench/raw/Zug 1.csv"],"kinds":["uniaxial"],"flags":{"force":"F"},
        "geometry":{"length":8,"width":6,"thickness":0.8},"name":"one"}"#;
    assert_eq!(running.own("POST /api/do", asked.as_bytes())?.status, 200);
    let heard = wait(&running.commands, 1);
    let words = "import ./workbench/raw/Zug 1.csv --kind=uniaxial --force=F --geometry=workbench/01-geometry.toml --out workbench/imported/01";
    assert_eq!(heard.first().map(|h| h.0.join(" ")).as_deref(), Some(words));
    let written = fs::read_to_string(running.path().join("workbench/01-geometry.toml"))?;
    assert!(written.contains("name = \"one\"") && written.contains("width_mm = 6.0"), "{written}");
    // What failed is shown beside the file, with its first lines.
    let begun = Instant::now();
    while running.state()?["import"].is_null() && begun.elapsed() < Duration::from_secs(5) {}
    let state = running.state()?;
    assert_eq!(state["import"]["failed"]["message"], "nothing is computed here");
    assert_eq!(state["import"]["heads"]["workbench/raw/Zug 1.csv"][0], "t,u,F");
    Ok(())
}

#[test]
fn a_newer_request_cancels_an_older_one_at_once() -> Tested {
    let folder = tempfile::tempdir()?;
    fs::write(folder.path().join("a.toml"), STRIP)?;
    let commands = Arc::new(Idle::default());
    let opened = Opened::of(&[folder.path().join("a.toml")])?;
    let running = Running::on(folder, opened, commands.clone())?;
    let state = running.state()?;
    assert_eq!(
        (state["specimen"]["name"].as_str(), state["steps"][0]["kind"].as_str()),
        (Some("made"), Some("open"))
    );
    assert!(state["parameters"].as_array().is_some_and(|p| p.iter().any(|p| p["path"] == "bulk.mu")));
    commands.waits.store(true, Ordering::SeqCst);
    running.own("POST /api/do", br#"{"do":"fit"}"#)?;
    assert_eq!(running.state()?["busy"], true);
    // What has not begun would be forgotten, not cancelled.
    let asked = Instant::now();
    while commands.begun.load(Ordering::SeqCst) == 0 && asked.elapsed() < Duration::from_secs(20) {}
    let begun = Instant::now();
    running.own("POST /api/do", br#"{"do":"add","effect":"viscoelastic"}"#)?;
    let heard = wait(&commands, 1);
    assert!(begun.elapsed() < Duration::from_millis(500), "{:?}", begun.elapsed());
    assert_eq!(
        heard[0],
        (vec!["identify".into(), "a.toml".into(), "--out".into(), "a-workbench/runs/01-fit".into()], true)
    );
    running.own("POST /api/do", br#"{"do":"stop"}"#)?;
    assert_eq!(wait(&commands, 2)[1].0[..3], ["add", "viscoelastic", "a.toml"]);
    // What is no effect is no command.
    running.own("POST /api/do", br#"{"do":"add","effect":"--out=/etc"}"#)?;
    std::thread::sleep(Duration::from_millis(200));
    assert_eq!(wait(&commands, 2).len(), 2);
    Ok(())
}

#[test]
fn a_folder_is_taken_up_where_it_was_left_and_only_once_at_a_time() -> Tested {
    let folder = tempfile::tempdir()?;
    fs::write(folder.path().join("a.toml"), STRIP)?;
    let open = || {
        let opened = Opened::of(&[folder.path().join("a.toml")])?;
        Bench::open(opened, Arc::new(Idle::default()), effects::catalogue())
    };
    let first = open()?;
    let written = fs::read_to_string(folder.path().join("a-workbench/steps.json"))?;
    assert!(open().is_err_and(|e| e.to_string().contains("another workbench")));
    drop(first);
    drop(open()?);
    assert_eq!(fs::read_to_string(folder.path().join("a-workbench/steps.json"))?, written);
    fs::write(folder.path().join("a-workbench/steps.json"), "{")?;
    assert!(open().is_err_and(|e| e.to_string().contains("steps.json")));
    Ok(())
}
