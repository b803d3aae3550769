//! Studies from outside: workers that are killed, shares, wrong rows, the page.
#![cfg(unix)]

use crate::common;

use common::{FIT, Tested, fct, json, strip, timeless};
use serde_json::Value;
use std::error::Error;
use std::fs;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};
use tempfile::TempDir;

/// An intact strip of few elements: a fit of it takes a moment.
const INTACT: &str = r#"[geometry]
length_mm = 8.0
width_mm = WIDTH
thickness_mm = 0.8
[[tests]]
kind = "uniaxial"
ends = "sliding"
protocol = [{ to_mm = 1.5, rate_mm_per_s = 0.05 }]
[mesh]
divisions = [1, 2, 1]
[bulk]
mu_kPa = 6.0
k1_kPa = 700.0
k2 = 15.0
gamma_deg = 42.0
kappa = 0.22
[solver]
step_mm = 0.05
[output]
noise = 0.005
fields = false
"#;

const MODEL: &str = r#"[mesh]
divisions = [1, 2, 1]
[bulk]
mu_kPa = { start = 6.0, fixed = true }
k1_kPa = 500.0
k2 = 12.0
gamma_deg = { start = 42.0, fixed = true }
kappa = { start = 0.22, fixed = true }
"#;

/// Synthetic intact strips s1, s2, …, a model, and a study of them with so many repeats.
fn study(specimens: usize, repeats: usize) -> Result<TempDir, Box<dyn Error>> {
    let folder = tempfile::tempdir()?;
    let here = folder.path();
    let mut table = String::from("file,group,donor,exclude\n");
    for k in 1..=specimens {
        let text = INTACT.replace("WIDTH", &format!("{}.0", 4 + k));
        fs::write(here.join(format!("s{k}.toml")), format!("name = \"s{k}\"\n{text}seed = {k}\n"))?;
        let out = fct(here, &["simulate", &format!("s{k}.toml"), "--quiet"])?;
        assert!(out.status.success(), "{}", String::from_utf8_lossy(&out.stderr));
        table.push_str(&format!(
            "runs/s{k}/specimen.toml,{},d{k},\n",
            if k % 2 == 0 { "even" } else { "odd" }
        ));
    }
    fs::write(here.join("table.csv"), table)?;
    fs::write(here.join("model.toml"), MODEL)?;
    let text = format!(
        "name = \"strips\"\ntable = \"table.csv\"\n[[models]]\nname = \"base\"\nconfig = \"model.toml\"\n[repeats]\nbootstrap = {repeats}\nseed = 5\n"
    );
    fs::write(here.join("study.toml"), text)?;
    Ok(folder)
}

fn answer(here: &Path, arguments: &[&str], code: i32) -> Result<Value, Box<dyn Error>> {
    let (ended, answer, stderr) = json(here, arguments)?;
    assert_eq!(ended, code, "{arguments:?}: {stderr}");
    Ok(answer)
}

/// Every result by its key, without times.
fn results(study: &Path) -> Result<Vec<(String, Value)>, Box<dyn Error>> {
    let mut out = Vec::new();
    for entry in fs::read_dir(study.join("results"))? {
        let path = entry?.path();
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        // What a worker that was killed had begun to write is no result.
        if name.starts_with('.') {
            continue;
        }
        out.push((name, timeless(serde_json::from_slice(&fs::read(path)?)?)));
    }
    out.sort_by(|a, b| a.0.cmp(&b.0));
    Ok(out)
}

fn worker(here: &Path, shard: &str) -> std::io::Result<Child> {
    Command::new(env!("CARGO_BIN_EXE_fct"))
        .args(["campaign", "run", "study.toml", "--quiet", "--threads", "1", "--shard", shard])
        .current_dir(here)
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
}

#[test]
fn workers_that_are_killed_lose_nothing_and_do_nothing_twice() -> Tested {
    let folder = study(2, 6)?;
    let here = folder.path();
    let alone = here.join("alone");
    fs::create_dir(&alone)?;
    // Serially, in a folder of its own.
    let text = fs::read_to_string(here.join("study.toml"))?;
    fs::write(here.join("serial.toml"), format!("folder = \"alone\"\n{text}"))?;
    answer(here, &["campaign", "run", "serial.toml", "--threads", "1"], 0)?;
    // Several at once, killed as soon as something is done.
    answer(here, &["campaign", "plan", "study.toml"], 0)?;
    let place = here.join("study-study");
    let mut told = Vec::new();
    for round in 1..=2 {
        let mut workers = [worker(here, "1/1")?, worker(here, "1/1")?];
        let done = || fs::read_dir(place.join("results")).map_or(0, Iterator::count);
        let begun = Instant::now();
        while done() < 2 * round && begun.elapsed() < Duration::from_secs(60) {
            std::thread::sleep(Duration::from_millis(5));
            let now = answer(here, &["campaign", "status", "study.toml"], 0)?;
            let sum: u64 = ["done", "failed", "running", "waiting", "set_aside"]
                .iter()
                .filter_map(|k| now[k].as_u64())
                .sum();
            assert_eq!(sum, 14, "{now}");
            told.push(now["done"].as_u64().ok_or("done")?);
        }
        for worker in &mut workers {
            worker.kill()?;
            worker.wait()?;
        }
    }
    assert!(told.is_sorted(), "what is done stays done: {told:?}");
    let before = results(&place)?;
    let stamp = |name: &str| fs::metadata(place.join("results").join(name)).and_then(|m| m.modified());
    let stamps: Vec<_> = before.iter().map(|r| stamp(&r.0)).collect::<Result<_, _>>()?;
    let end = answer(here, &["campaign", "run", "study.toml", "--workers", "2", "--threads", "1"], 0)?;
    let claims = || fs::read_dir(place.join("claims")).into_iter().flatten().flatten().map(|e| e.file_name());
    let ended = (&end["status"]["done"], &end["status"]["failed"]);
    assert_eq!(ended, (&14.into(), &0.into()), "{end}, {:?}", claims().collect::<Vec<_>>());
    for (result, stamp_before) in before.iter().zip(stamps) {
        assert_eq!(stamp(&result.0)?, stamp_before, "done twice");
    }
    assert_eq!(results(&place)?, results(&alone)?, "the same bits as serially");
    assert!(claims().all(|name| name.as_encoded_bytes()[0] == b'.'), "claims stay behind");
    let again = answer(here, &["campaign", "run", "study.toml"], 0)?;
    assert_eq!((&again["ran"]["done"], &again["ran"]["before"]), (&0.into(), &14.into()));
    Ok(())
}

#[test]
fn shares_make_the_whole_and_what_took_three_workers_is_set_aside() -> Tested {
    let folder = study(3, 1)?;
    let here = folder.path();
    let plan = answer(here, &["campaign", "plan", "study.toml"], 0)?;
    let tasks = plan["plan"]["tasks"].as_array().ok_or("tasks")?;
    assert_eq!(tasks.len(), 6);
    // Three processes that are no more had the last specimen's fit.
    let key = tasks[4]["key"].as_str().ok_or("key")?;
    let claims = here.join("study-study/claims");
    fs::create_dir_all(&claims)?;
    for attempt in 1..=3 {
        let path = claims.join(format!("{key}.{attempt}"));
        fs::write(&path, r#"{"place":"elsewhere","pid":1,"began":"7"}"#)?;
        let long_ago = std::time::SystemTime::now() - Duration::from_secs(3600);
        fs::File::options().write(true).open(&path)?.set_modified(long_ago)?;
    }
    for (shard, done) in [("1/2", 2), ("2/2", 2)] {
        let code = i32::from(shard == "1/2");
        let end = answer(here, &["campaign", "run", "study.toml", "--shard", shard, "--threads", "1"], code)?;
        assert_eq!(end["ran"]["done"], done, "{shard}: {}", end["ran"]);
    }
    let now = answer(here, &["campaign", "status", "study-study"], 0)?;
    assert_eq!((&now["done"], &now["set_aside"], &now["waiting"]), (&4.into(), &1.into(), &1.into()));
    assert_eq!((&now["look_at"][0]["row"], &now["look_at"][0]["state"]), (&3.into(), &"set_aside".into()));
    let end = answer(here, &["campaign", "run", "study.toml", "--retry", "--threads", "1"], 0)?;
    assert_eq!(end["status"]["done"], 6);
    for bad in ["0/2", "3/2", "2", "a/b", "1/0"] {
        let (code, _, stderr) = bad_usage(here, bad)?;
        assert!(code == 2 && stderr.contains("shard"), "{bad}: {stderr}");
    }
    Ok(())
}

fn bad_usage(here: &Path, shard: &str) -> Result<(i32, String, String), Box<dyn Error>> {
    let out = fct(here, &["campaign", "run", "study.toml", "--shard", shard])?;
    let text = |b: &[u8]| String::from_utf8_lossy(b).into_owned();
    Ok((out.status.code().unwrap_or(-1), text(&out.stdout), text(&out.stderr)))
}

#[test]
fn a_wrong_row_is_named_and_the_rest_runs() -> Tested {
    let folder = study(1, 0)?;
    let here = folder.path();
    let good = "runs/s1/specimen.toml";
    fs::write(here.join("broken.toml"), "[geometry]\nlength_mm = \"long\"\n")?;
    let table =
        format!("file,group\nnowhere.toml,a\n{good},a\nbroken.toml,b\n{good},b\n{good},a,too many\n,b\n");
    fs::write(here.join("table.csv"), table)?;
    let end = answer(here, &["campaign", "run", "study.toml", "--threads", "1"], 1)?;
    assert_eq!(end["status"]["done"], 1);
    let wrong = end["status"]["wrong_rows"].as_array().ok_or("wrong rows")?;
    let said: Vec<(u64, &str)> =
        wrong.iter().filter_map(|w| Some((w["row"].as_u64()?, w["reason"].as_str()?))).collect();
    let expected =
        [(1, "nowhere.toml"), (3, "broken.toml:2"), (4, "row 2"), (5, "table.csv:6"), (6, "`file` is empty")];
    assert_eq!(said.len(), expected.len(), "{said:#?}");
    for ((row, reason), (number, part)) in said.iter().zip(expected) {
        assert!(*row == number && reason.contains(part), "row {row}: {reason}");
    }
    // What is wrong with the study itself stops it, with file, line and key.
    for (text, part) in [
        ("tabel = \"table.csv\"\n", "did you mean `table`?"),
        ("table = \"gone.csv\"\n", "gone.csv"),
        ("table = \"table.csv\"\n[repeats]\nbootstrap = -1\n", "study.toml:3:13"),
        ("table = \"table.csv\"\n[[models]]\ntask = \"guess\"\n", "unknown task `guess`"),
        ("specimens = []\n", "empty"),
        ("table = 3\n", "`table` expects a text"),
        ("= 3\n", "not valid TOML"),
    ] {
        fs::write(here.join("study.toml"), text)?;
        let (code, _, stderr) = json(here, &["campaign", "plan", "study.toml"])?;
        assert!(code == 2 && stderr.contains(part), "{text}: {code} {stderr}");
    }
    Ok(())
}

#[test]
fn a_specimen_that_changed_is_planned_again_and_the_others_stay() -> Tested {
    let folder = study(2, 0)?;
    let here = folder.path();
    answer(here, &["campaign", "run", "study.toml", "--threads", "1"], 0)?;
    let file = here.join("runs/s2/specimen.toml");
    // A comment changes nothing.
    fs::write(&file, format!("# seen\n{}", fs::read_to_string(&file)?))?;
    answer(here, &["campaign", "plan", "study.toml"], 0)?;
    assert_eq!(answer(here, &["campaign", "status", "study.toml"], 0)?["done"], 2);
    fs::write(&file, fs::read_to_string(&file)?.replace("thickness_mm = 0.8", "thickness_mm = 0.7"))?;
    fs::remove_dir_all(here.join("study-study/results"))?;
    let end = answer(here, &["campaign", "run", "study.toml", "--threads", "1"], 1)?;
    assert!(end["ran"]["changed"][0].as_str().is_some_and(|w| w.contains("plan it again")), "{}", end["ran"]);
    answer(here, &["campaign", "plan", "study.toml"], 0)?;
    assert_eq!(answer(here, &["campaign", "run", "study.toml", "--threads", "1"], 0)?["status"]["done"], 2);
    Ok(())
}

#[test]
fn the_page_pools_what_is_explained_and_says_what_is_not() -> Tested {
    let folder = tempfile::tempdir()?;
    let here = folder.path();
    let mut rows = String::new();
    for (k, (gc, more)) in
        [(0.15, ""), (0.17, ""), (0.15, "[effects.drift]\nc_N_per_s = 1.5e-4\n")].iter().enumerate()
    {
        let end =
            format!("{more}[solver]\nstep_mm = 0.2\n[output]\nnoise = 0.005\nseed = {k}\nfields = false\n");
        let text = strip(&end).replace("gc_N_per_mm = 0.15", &format!("gc_N_per_mm = {gc}"));
        fs::write(here.join("t.toml"), text.replace("\"strip\"", &format!("\"t{k}\"")))?;
        assert!(fct(here, &["simulate", "t.toml", "--quiet"])?.status.success());
        rows.push_str(&format!("[[specimens]]\nfile = \"runs/t{k}/specimen.toml\"\ngroup = \"g\"\n"));
    }
    rows.push_str("[[specimens]]\nfile = \"nowhere.toml\"\n");
    fs::write(here.join("fit.toml"), FIT.replace("specimen = \"runs/strip/specimen.toml\"\n", ""))?;
    fs::write(here.join("torn.toml"), format!("{rows}[[models]]\nname = \"base\"\nconfig = \"fit.toml\"\n"))?;
    answer(here, &["campaign", "run", "torn.toml", "--threads", "1"], 1)?;
    let said = answer(here, &["campaign", "report", "torn.toml"], 0)?;
    let gc = said["models"][0]["groups"].as_array().ok_or("groups")?;
    let gc = gc.iter().find(|g| g["quantity"]["path"] == "gc" && g["group"] == "g").ok_or("no Gc")?;
    assert_eq!(gc["pooled"]["specimens"], 2, "the drifting one is not averaged in silence");
    let mean = gc["pooled"]["mean"].as_f64().ok_or("mean")?;
    assert!((mean / 0.16 - 1.0).abs() < 0.05, "{mean}");
    assert!(gc["with_unexplained"].is_number());
    let page = fs::read_to_string(here.join("torn-study/study.html"))?;
    for part in
        ["not explained by its model", "nowhere.toml", "synthetic records", "random-effects", "image/svg"]
    {
        assert!(page.contains(part), "the page lacks {part}");
    }
    let table = fs::read_to_string(here.join("torn-study/specimens.csv"))?;
    assert_eq!(table.lines().filter(|l| l.contains(",gc,")).count(), 3, "{table}");
    assert!(said["methods"].as_str().is_some_and(|m| m.contains("Leng") && m.contains("3 specimens")));
    Ok(())
}

#[test]
fn the_slurm_script_is_one_that_bash_reads() -> Tested {
    let folder = study(1, 0)?;
    let here = folder.path();
    let out = fct(here, &["campaign", "slurm", "study.toml", "--array", "7"])?;
    let script = String::from_utf8(out.stdout)?;
    assert!(script.starts_with("#!/bin/bash\n#SBATCH") && script.contains("--array=1-7"), "{script}");
    fs::write(here.join("job.sh"), script)?;
    assert!(Command::new("bash").args(["-n", "job.sh"]).current_dir(here).status()?.success());
    // As Slurm would call its first member.
    let done =
        Command::new("bash").arg("job.sh").env("SLURM_ARRAY_TASK_ID", "1").current_dir(here).output()?;
    assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
    assert_eq!(answer(here, &["campaign", "status", "study.toml"], 0)?["done"], 1);
    Ok(())
}
