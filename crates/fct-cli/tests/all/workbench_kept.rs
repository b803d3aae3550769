//! What was done on the page is not lost: with a killed server, on a full disk, by what cannot be computed.

use crate::bench::Bench;
use crate::common::{self, Tested};
use serde_json::Value;
use std::fs;
use std::path::Path;

/// Titles of the steps, and the misfit of the present one.
fn steps(state: &Value) -> (Vec<String>, Option<f64>) {
    let all = state["steps"].as_array().into_iter().flatten();
    let titles = all.filter_map(|s| Some(s["title"].as_str()?.to_owned())).collect();
    let cursor = state["cursor"].as_u64().unwrap_or(0) as usize;
    (titles, state["steps"][cursor]["fit"]["rms_N"].as_f64())
}

/// Files that only exist while something is being written.
fn half_written(folder: &Path) -> Vec<String> {
    let mut out = Vec::new();
    let mut open = vec![folder.to_owned()];
    while let Some(at) = open.pop() {
        for entry in fs::read_dir(at).into_iter().flatten().flatten() {
            let name = entry.file_name().to_string_lossy().into_owned();
            if name.ends_with(".part") || name.contains(".tmp") {
                out.push(name);
            } else if entry.path().is_dir() {
                open.push(entry.path());
            }
        }
    }
    out
}

#[test]
fn a_killed_workbench_goes_on_where_it_was() -> Tested {
    let folder = common::synthetic()?;
    let here = folder.path();
    let bench = Bench::open(here, &["fit.toml"])?;
    bench.begin(r#"{"do":"fit"}"#)?;
    bench.kill()?;
    // Nothing was found yet: the last good state is what was opened.
    let bench = Bench::open(here, &["fit.toml"])?;
    let state = bench.state()?;
    assert_eq!(steps(&state), (vec!["Opened".to_owned()], None));
    assert!(state["busy"] == false && state["faults"] == serde_json::json!([]), "{}", state["faults"]);
    bench.perform(r#"{"do":"fit"}"#)?;
    let (titles, rms) = steps(&bench.state()?);
    assert_eq!(titles, ["Opened", "Fit"]);
    // In the middle of the next one the found one stays.
    bench.begin(r#"{"do":"add","effect":"compliance"}"#)?;
    bench.kill()?;
    let bench = Bench::open(here, &["fit.toml"])?;
    let state = bench.state()?;
    assert_eq!(steps(&state), (titles, rms));
    assert!(state["curves"].as_array().is_some_and(|c| c.len() == 2) && state["jacobian"].is_object());
    Ok(())
}

#[test]
fn a_full_disk_and_what_cannot_be_computed_leave_the_last_good_state_and_say_why() -> Tested {
    let folder = common::synthetic()?;
    let here = folder.path();
    let bench = Bench::open(here, &["fit.toml"])?;
    bench.perform(r#"{"do":"fit"}"#)?;
    let good = steps(&bench.state()?);
    // No such parameter, a value out of its bounds, no such test, no such effect.
    for (asked, why) in [
        (r#"{"do":"set","values":{"bulk.none":1.0}}"#, "no parameter of this model"),
        (r#"{"do":"set","values":{"bulk.k1":-1.0}}"#, "k1"),
        (r#"{"do":"set","weigh":[{"test":"none","from":0,"to":1,"weight":0}]}"#, "no test of this specimen"),
        (r#"{"do":"add","effect":"--out=x"}"#, "no effect of the catalogue"),
    ] {
        let told = bench.perform(asked)?;
        assert!(told.contains("event: failed") && told.contains(why), "{told}");
        assert_eq!(steps(&bench.state()?), good, "{asked}");
    }
    drop(bench);
    let bench = Bench::on_a_full_disk(here, &["fit.toml"], 16)?;
    let told = bench.perform(r#"{"do":"add","effect":"compliance"}"#)?;
    assert!(told.contains("event: failed"), "{told}");
    let large = vec![b'1'; 100_000];
    let (status, answer) = bench.ask("POST /api/upload?name=large.csv", &large)?;
    assert!(status >= 400 && answer["error"].is_string(), "{status} {answer}");
    assert!(!here.join("fit-workbench/raw/large.csv").exists());
    drop(bench);
    // With room again everything is as it was.
    let bench = Bench::open(here, &["fit.toml"])?;
    assert_eq!(steps(&bench.state()?), good);
    assert_eq!(half_written(&here.join("fit-workbench")), Vec::<String>::new());
    let told = bench.perform(r#"{"do":"add","effect":"compliance"}"#)?;
    assert!(!told.contains("event: failed"), "{told}");
    Ok(())
}

/// A search that is stopped keeps its best, as a step of its own with the lines for a shell.
#[test]
fn a_stopped_fit_keeps_its_best() -> Tested {
    let folder = common::synthetic()?;
    let bench = Bench::open(folder.path(), &["fit.toml"])?;
    bench.begin(r#"{"do":"fit"}"#)?;
    assert_eq!(bench.ask("POST /api/do", br#"{"do":"stop"}"#)?.0, 200);
    let begun = std::time::Instant::now();
    while bench.state()?["busy"] == true && begun.elapsed() < crate::bench::PATIENCE {
        std::thread::sleep(std::time::Duration::from_millis(50));
    }
    let state = bench.state()?;
    let (titles, rms) = steps(&state);
    assert_eq!(titles, ["Opened", "Stopped: the best so far"]);
    assert!(rms.is_some_and(f64::is_finite));
    let commands = state["commands"].as_array().cloned().unwrap_or_default();
    assert!(commands[0].as_str().is_some_and(|c| c.starts_with("fct set ")), "{commands:?}");
    Ok(())
}
