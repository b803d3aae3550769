//! What the workbench takes, measured: `just workbench-figures`. Prints the rows of docs/performance.md; judges nothing but
//! that there is a figure, for what else runs on the machine is not the page's fault.

use crate::bench::{Bench, PATIENCE};
use crate::common::{self, Tested};
use crate::driver::{self, Page};
use crate::workbench_browser::{IDLE, SOON, drop_file, fill, present, raw};
use serde_json::{Value, json};
use std::error::Error;
use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::{Instant, SystemTime, UNIX_EPOCH};

type Figures = Result<(), Box<dyn Error>>;

fn row(what: &str, target: &str, measured: &str) {
    println!("| {what} | {target} | {measured} |");
}

/// Middle and worst of a list of numbers.
fn middle_and_worst(numbers: &Value) -> Result<[f64; 2], Box<dyn Error>> {
    let mut all: Vec<f64> = numbers.as_array().into_iter().flatten().filter_map(Value::as_f64).collect();
    all.sort_by(f64::total_cmp);
    let worst = *all.last().ok_or("no number")?;
    Ok([all[all.len() / 2], worst])
}

#[test]
#[ignore = "needs Chromium; `just workbench-figures`"]
fn the_figures_of_the_page() -> Tested {
    let chromium = driver::found().ok_or("no chromium on the path and no $CHROMIUM")?;
    let made = common::synthetic()?;
    let here = made.path();
    let mut page = Page::open(&chromium)?;
    page.looks(1280, "light")?;
    println!("| what | target | measured |\n|---|---|---|");
    first_paint(&mut page)?;
    let bench = Bench::open(here, &["fit.toml"])?;
    page.go(&bench.url)?;
    frames_while_fitting(&mut page)?;
    drop(bench);
    wide(here)?;
    let bench = Bench::open(here, &["wide"])?;
    page.go(&bench.url)?;
    sliders(&mut page)?;
    drop(bench);
    long_records(&mut page, here)?;
    let bench = Bench::open(here, &["wide"])?;
    page.go(&bench.url)?;
    an_hour(&mut page)?;
    drop(bench);
    exact(&mut page)
}

/// From the command to the first paint, the browser being open already; the best of three.
fn first_paint(page: &mut Page) -> Figures {
    let mut best = f64::MAX;
    for _ in 0..3 {
        let folder = tempfile::tempdir()?;
        let begun = SystemTime::now().duration_since(UNIX_EPOCH)?.as_secs_f64() * 1e3;
        let bench = Bench::open(folder.path(), &[])?;
        page.go(&bench.url)?;
        page.until("performance.getEntriesByName('first-contentful-paint').length", SOON)?;
        let painted = page.ask(
            "performance.timeOrigin + performance.getEntriesByName('first-contentful-paint')[0].startTime",
        )?;
        best = best.min(painted.as_f64().ok_or("a time")? - begun);
    }
    row("first paint after the command", "≤ 1 s", &format!("{best:.0} ms"));
    Ok(())
}

/// Times between frames while a fit runs and its curves move.
fn frames_while_fitting(page: &mut Page) -> Figures {
    page.until(IDLE, SOON)?;
    page.click("#fit")?;
    page.until("document.querySelector('#doing').textContent.includes('objective')", PATIENCE)?;
    let times = page.ask_later(
        "new Promise(done => { const all = []; let last = performance.now(); const step = now => { all.push(now - last); last = now;
           if (document.querySelector('#busy').hidden || all.length > 600) done(all.slice(1)); else requestAnimationFrame(step); }; requestAnimationFrame(step); })",
    )?;
    let [middle, worst] = middle_and_worst(&times)?;
    let all = times.as_array().map_or(0, Vec::len);
    let late = times.as_array().into_iter().flatten().filter(|t| t.as_f64() > Some(25.0)).count();
    let told = format!(
        "{:.0} per second (middle of {all} frames {middle:.1} ms), {late} of them later than 25 ms, the worst {worst:.0} ms",
        1e3 / middle
    );
    row("frames while a fit runs", "60 per second", &told);
    present(page, "Fit", PATIENCE)
}

/// A run of 2000 points: the small one with its tables made longer, as a page takes them.
fn wide(here: &Path) -> Figures {
    let out = common::fct(here, &["identify", "fit.toml", "--out", "wide", "--quiet"])?;
    assert!(out.status.success(), "{}", String::from_utf8_lossy(&out.stderr));
    let run = here.join("wide");
    let mut curve =
        String::from("time_s,displacement_mm,force_measured_N,force_model_N,residual_N,segment\n");
    let jacobian = fs::read_to_string(run.join("jacobian.csv"))?;
    let header = jacobian.lines().next().ok_or("a header")?.to_owned();
    let columns = header.split(',').count() - 3;
    let mut table = header + "\n";
    let others = jacobian.lines().skip(1).filter(|l| !l.starts_with("tearing,"));
    table.extend(others.flat_map(|l| [l, "\n"]));
    for i in 0..2000 {
        let t = f64::from(i) * 0.05;
        let (u, m) = (t * 0.05, (t * 0.06).sin().abs() * 0.2);
        let f = m + 0.001 * (t * 50.0).sin();
        writeln!(curve, "{t},{u},{f},{m},{},load 1", f - m)?;
        writeln!(table, "tearing,{i},{m}{}", format!(",{}", m / 500.0).repeat(columns))?;
    }
    let manifest = run.join("manifest.json");
    let mut files: Value = serde_json::from_slice(&fs::read(&manifest)?)?;
    for (name, text) in [("curves/tearing.csv", &curve), ("jacobian.csv", &table)] {
        files["files"][name] = input::sha256(text.as_bytes()).into();
        fs::write(run.join(name), text)?;
    }
    Ok(fs::write(manifest, files.to_string())?)
}

/// From a slider's event to curves drawn by the derivatives, all charts together, the page's own work in full.
fn sliders(page: &mut Page) -> Figures {
    page.until("document.querySelectorAll('#charts figure').length === 2", SOON)?;
    page.until("document.querySelector('[data-path=\"bulk.k1\"] input[type=range]')", SOON)?;
    let times = page.ask_later(
        "(async () => { const s = document.querySelector('[data-path=\"bulk.k1\"] input[type=range]'), all = [];
           for (let k = 0; k < 120; k++) { s.value = 400 + k; const begun = performance.now(); s.dispatchEvent(new Event('input')); all.push(performance.now() - begun);
             await new Promise(requestAnimationFrame); }
           return all; })()",
    )?;
    let [middle, worst] = middle_and_worst(&times)?;
    row(
        "slider's linear curve, 2000 points",
        "≤ 16 ms",
        &format!("{middle:.1} ms, the worst of 120 {worst:.1} ms"),
    );
    Ok(())
}

/// Two records of 20,000 rows each: from the drop to what was understood, and from the dimensions to the curves.
fn long_records(page: &mut Page, here: &Path) -> Figures {
    let folder = tempfile::tempdir()?;
    let bench = Bench::open(folder.path(), &[])?;
    page.go(&bench.url)?;
    let begun = Instant::now();
    for (n, name) in ["uniaxial", "tearing"].into_iter().enumerate() {
        let short = raw(&here.join(format!("runs/strip/{name}.csv")))?;
        drop_file(page, &format!("{name}.csv"), &refined(&short, 20_000))?;
        page.until(&format!("document.querySelectorAll('.understood').length === {}", n + 1), PATIENCE)?;
    }
    let read = begun.elapsed();
    for (side, mm) in [("length", "8"), ("width", "6"), ("thickness", "0.8"), ("cut", "1.5")] {
        fill(page, &format!("#g-{side}"), mm)?;
    }
    let begun = Instant::now();
    page.click("#geometry button[type=submit]")?;
    page.until("document.querySelectorAll('#charts figure').length === 2", PATIENCE)?;
    let told = format!(
        "two of them read {:.1} s after the drop, drawn {:.1} s after the dimensions",
        read.as_secs_f64(),
        begun.elapsed().as_secs_f64()
    );
    row("records of 20,000 rows", "work", &told);
    Ok(())
}

/// The record with rows between its rows, and a little noise of their own.
fn refined(text: &str, rows: usize) -> String {
    let mut lines = text.lines();
    let mut out: String = lines.by_ref().take(2).flat_map(|l| [l, "\n"]).collect();
    let numbers: Vec<[f64; 3]> = lines
        .filter_map(|l| {
            let three: Vec<f64> = l.split(',').filter_map(|x| x.parse().ok()).collect();
            three.try_into().ok()
        })
        .collect();
    let last = numbers.len() - 1;
    for k in 0..rows {
        let at = k as f64 * last as f64 / (rows - 1) as f64;
        let (i, share) = ((at as usize).min(last - 1), at - (at as usize).min(last - 1) as f64);
        let between = |c: usize| numbers[i][c] + share * (numbers[i + 1][c] - numbers[i][c]);
        let noise = 0.002 * ((k * 7919 % 1000) as f64 / 1000.0 - 0.5);
        // Writing to a String cannot fail.
        let _ = writeln!(out, "{},{},{}", between(0), between(1), between(2) + noise);
    }
    out
}

/// The exact run of a practice case, from the request to the curves.
fn exact(page: &mut Page) -> Figures {
    const WHAT: &str = "exact run of practice-05-compliance after a slider";
    const TARGET: &str = "≤ 0.5 s";
    let practice = std::env::var_os("FCT_PRACTICE").map(PathBuf::from);
    let Some(from) = practice.map(|p| p.join("practice-05-compliance")).filter(|p| p.is_dir()) else {
        row(WHAT, TARGET, "not measured: no $FCT_PRACTICE");
        return Ok(());
    };
    let folder = tempfile::tempdir()?;
    for file in fs::read_dir(from)? {
        let file = file?;
        fs::copy(file.path(), folder.path().join(file.file_name()))?;
    }
    let bench = Bench::open(folder.path(), &["config.toml"])?;
    page.go(&bench.url)?;
    page.until("document.querySelectorAll('#charts figure').length", PATIENCE)?;
    let values = json!({ "bulk.mu": 0.006, "bulk.k1": 0.7, "bulk.k2": 15.0, "bulk.gamma": 0.73, "bulk.kappa": 0.22,
        "interface.area[1].gc": 0.15, "interface.area[1].sigma_c": 0.08 });
    let action = json!({ "do": "set", "values": values }).to_string();
    let begun = Instant::now();
    let Ok(told) = bench.perform(&action) else {
        row(WHAT, TARGET, &format!("more than {} s", PATIENCE.as_secs()));
        return Ok(());
    };
    assert!(!told.contains("event: failed"), "{told}");
    let took = begun.elapsed().as_secs_f64();
    present(page, "Values set", SOON)?;
    let mesh = bench.state()?["specimen"]["mesh"].clone();
    row(WHAT, TARGET, &format!("{took:.1} s (mesh {mesh})"));
    Ok(())
}

/// An hour's work in short: 2000 moves of a slider, 200 states taken anew, models laid over; then what the page holds.
fn an_hour(page: &mut Page) -> Figures {
    page.until("document.querySelector('[data-path=\"bulk.k1\"] input[type=range]')", SOON)?;
    for _ in 0..20 {
        page.ask_later(
            "(async () => { const curves = await import('/assets/curves.js');
               for (let k = 0; k < 1000; k += 10) {
                 const s = document.querySelector('[data-path=\"bulk.k1\"] input[type=range]');
                 s.value = k; s.dispatchEvent(new Event('input'));
                 if (k % 100 === 0) { const state = await (await fetch('/api/state')).json(); curves.set(state); await new Promise(requestAnimationFrame); }
               } return 1; })()",
        )?;
    }
    page.call("HeapProfiler.enable", json!({}))?;
    page.call("HeapProfiler.collectGarbage", json!({}))?;
    page.call("Performance.enable", json!({}))?;
    let metrics = page.call("Performance.getMetrics", json!({}))?;
    let of = |name: &str| {
        let all = metrics["metrics"].as_array().into_iter().flatten();
        all.filter(|m| m["name"] == name).find_map(|m| m["value"].as_f64()).unwrap_or(f64::NAN)
    };
    let private = renderer_memory(page)?;
    let told = format!(
        "heap {:.1} MB, {:.0} DOM nodes; private memory of the browser's process for the page {private:.0} MB",
        of("JSHeapUsedSize") / 1e6,
        of("Nodes")
    );
    row("memory after an hour's work (2000 slider moves, 200 states)", "≤ 200 MB", &told);
    Ok(())
}

/// Private memory of the largest renderer process of our browser, MB; not a number where the system does not say.
fn renderer_memory(page: &mut Page) -> Result<f64, Box<dyn Error>> {
    let mut largest = f64::NAN;
    for id in page.renderers() {
        let text = fs::read_to_string(format!("/proc/{id}/smaps_rollup")).unwrap_or_default();
        let kb: f64 = text
            .lines()
            .filter(|l| l.starts_with("Private_"))
            .filter_map(|l| l.split_whitespace().nth(1)?.parse::<f64>().ok())
            .sum();
        largest = largest.max(kb / 1e3);
    }
    Ok(largest)
}
