//! Long records, and records of markup.

use crate::common::{Tested, fct, synthetic};
use crate::driver::{self, Page};
use std::fmt::Write;
use std::fs;

/// A segment's name that would run if it were markup.
const EVIL: &str = "<img src=x onerror=window.ran=1></script><script>window.ran=2</script>";

#[test]
#[ignore = "needs Chromium; `just browser`"]
fn ten_thousand_points_open_within_a_second() -> Tested {
    let chromium = driver::found().ok_or("no chromium on the path and no $CHROMIUM")?;
    let folder = synthetic()?;
    let here = folder.path();
    let out = fct(here, &["identify", "fit.toml", "--out", "big", "--quiet"])?;
    assert!(out.status.success(), "{}", String::from_utf8_lossy(&out.stderr));
    let mut curve =
        String::from("time_s,displacement_mm,force_measured_N,force_model_N,residual_N,segment\n");
    for i in 0..10_000 {
        let t = f64::from(i) * 0.01;
        let (u, m) = ((t * 0.3).sin().abs() * 3.0, (t * 0.3).sin().abs() * 0.2);
        let f = m + 0.001 * (t * 50.0).sin();
        writeln!(curve, "{t},{u},{f},{m},{},load {}", f - m, 1 + i / 1000)?;
    }
    // A run whose files are not as they were written would be refused.
    let manifest = here.join("big/manifest.json");
    let mut files: serde_json::Value = serde_json::from_slice(&fs::read(&manifest)?)?;
    files["files"]["curves/tearing.csv"] = input::sha256(curve.as_bytes()).into();
    fs::write(&manifest, files.to_string())?;
    fs::write(here.join("big/curves/tearing.csv"), curve)?;
    let out = fct(here, &["report", "big"])?;
    assert!(out.status.success(), "{}", String::from_utf8_lossy(&out.stderr));
    let file = here.join("big/report.html");
    assert!(fs::metadata(&file)?.len() < 3_000_000);
    let mut page = Page::open(&chromium)?;
    // The best of three: what else runs on the machine is not the page's fault.
    let mut best = f64::MAX;
    for _ in 0..3 {
        best = best.min(page.load(&file, 1280, "light")?);
    }
    println!("10,000 points: loaded in {best:.0} ms");
    assert!(best < 1000.0, "{best} ms");
    assert_eq!(page.faults(), Vec::<String>::new());
    Ok(())
}

/// A record whose segments are markup: it is read as text, nothing of it runs, and the policy has nothing to stop.
#[test]
#[ignore = "needs Chromium; `just browser`"]
fn a_record_of_markup_is_text() -> Tested {
    let chromium = driver::found().ok_or("no chromium on the path and no $CHROMIUM")?;
    let folder = synthetic()?;
    let here = folder.path();
    let record = here.join("runs/strip/tearing.csv");
    let text = fs::read_to_string(&record)?;
    let rows = text.lines().filter(|l| !l.starts_with('#')).enumerate().map(|(i, row)| {
        let columns: Vec<&str> = row.split(',').take(3).collect();
        format!("{},{}\n", columns.join(","), if i == 0 { "segment" } else { EVIL })
    });
    fs::write(&record, rows.collect::<String>())?;
    let out = fct(here, &["identify", "fit.toml", "--out", "evil", "--quiet"])?;
    assert!(out.status.success(), "{}", String::from_utf8_lossy(&out.stderr));
    let mut page = Page::open(&chromium)?;
    page.load(&here.join("evil/report.html"), 1280, "light")?;
    page.click("[data-axis='t']")?;
    assert!(page.text("#curves .legend")?.contains("record"));
    let legends =
        page.ask("[...document.querySelectorAll('#curves .legend')].map(l => l.textContent).join()")?;
    assert!(legends.as_str().is_some_and(|l| l.contains("<img src=x")), "{legends}");
    assert!(
        page.ask("window.ran === undefined && !document.querySelector('img[src=x]')")?.as_bool()
            == Some(true)
    );
    assert_eq!(page.faults(), Vec::<String>::new());
    // Should something be forgotten, the policy stands: what a page did not bring does not run.
    page.ask("(() => { const s = document.createElement('script'); s.textContent = 'window.ran = 3'; document.body.append(s); \
              const d = document.createElement('div'); d.setAttribute('onclick', 'window.ran = 4'); document.body.append(d); d.click(); })()")?;
    assert!(page.ask("window.ran === undefined")?.as_bool() == Some(true), "the policy let a script run");
    Ok(())
}
