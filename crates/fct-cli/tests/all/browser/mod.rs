//! The report in a real browser: `just browser`. Ignored where nobody asks, for it needs Chromium.

mod looks;
mod robust;
mod search;

use crate::common;
use crate::driver;

use common::{Tested, fct, synthetic};
use driver::Page;
use std::fs;
use std::path::Path;

/// A ladder of two rungs, as a user makes it.
fn ladder(here: &Path) -> Tested {
    for arguments in [
        &["identify", "fit.toml", "--out", "base"][..],
        &["add", "compliance", "base", "--out", "more.toml"],
        &["identify", "more.toml", "--out", "more"],
        &["diagnose", "base"],
        &["batch", "fit.toml", "fit.toml", "--out", "batch"],
    ] {
        let out = fct(here, &[arguments, &["--quiet"]].concat())?;
        assert!(out.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&out.stderr));
    }
    Ok(())
}

fn summary(run: &Path) -> Result<serde_json::Value, Box<dyn std::error::Error>> {
    Ok(serde_json::from_str(&fs::read_to_string(run.join("summary.json"))?)?)
}

/// The first number in a text, from `after` on.
fn number(text: &str, after: &str) -> Option<f64> {
    let rest = text.split_once(after)?.1.trim_start();
    rest.split_whitespace().next()?.trim_end_matches([',', ';']).parse().ok()
}

#[test]
#[ignore = "needs Chromium; `just browser`"]
fn a_report_is_clicked_and_read() -> Tested {
    let Some(chromium) = driver::found() else {
        return Err("no chromium on the path and no $CHROMIUM; on Debian: apt-get install chromium".into());
    };
    let folder = synthetic()?;
    let here = folder.path();
    ladder(here)?;
    let mut page = Page::open(&chromium)?;
    let file = here.join("more/report.html");
    assert!(fs::metadata(&file)?.len() < 3_000_000);
    for (width, scheme) in [(1280, "light"), (1280, "dark"), (390, "light"), (390, "dark")] {
        page.load(&file, width, scheme)?;
        page.picture(&format!("report-{width}-{scheme}"), true)?;
        let scroll = page.ask("document.documentElement.scrollWidth")?.as_u64();
        assert!(scroll.is_some_and(|w| w <= u64::from(width)), "{scroll:?} px wide at {width}");
    }
    page.load(&file, 1280, "light")?;
    first_screen(&mut page)?;
    fitted_models(&mut page, here)?;
    hovering(&mut page, here)?;
    moves(&mut page, here)?;
    // The page of the diagnosed run names effects; the batch page has its table.
    page.load(&here.join("base/report.html"), 1280, "light")?;
    let diagnosis: serde_json::Value =
        serde_json::from_str(&fs::read_to_string(here.join("base/diagnosis.json"))?)?;
    let first = diagnosis["screen"][0]["effect"].as_str().ok_or("a screen")?;
    assert!(page.text("#effects")?.contains(first), "{first}");
    page.load(&here.join("batch/batch.html"), 1280, "light")?;
    page.picture("batch", true)?;
    assert!(page.text("#table")?.contains("0.150"));
    assert_eq!(page.faults(), Vec::<String>::new());
    assert_eq!(page.outside(), Vec::<String>::new());
    Ok(())
}

/// One sentence, Gc and σc with intervals, the main curve, and the first questions stand above the fold; no label
/// of an axis is printed over another, and the misfit has ticks.
fn first_screen(page: &mut Page) -> Tested {
    let bottom = page.ask("document.querySelector('#first').getBoundingClientRect().bottom")?.as_f64();
    assert!(bottom.is_some_and(|b| b < 620.0), "the first screen ends at {bottom:?}");
    let top = page.ask("document.querySelector('#answers').getBoundingClientRect().top")?.as_f64();
    assert!(top.is_some_and(|t| t < 700.0), "the answers begin at {top:?}");
    let told = page.text("#first")?;
    for word in ["fracture energy Gc", "strength σc", "95 %", "N/mm", "The model"] {
        assert!(told.contains(word), "{word} in\n{told}");
    }
    assert!(page.ask("document.querySelectorAll('#first canvas').length")?.as_u64() == Some(1));
    Ok(())
}

/// Each rung shows its own numbers, those of its summary.json.
fn fitted_models(page: &mut Page, here: &Path) -> Tested {
    for (fitted_model, run, name) in [("0", "base", "base model"), ("1", "more", "compliance")] {
        page.click(&format!("[data-rung='{fitted_model}']"))?;
        assert_eq!(page.text("#curves h2 [data-shown]")?, name);
        let answer = summary(&here.join(run))?;
        let visible = page.text(&format!("#parameters [data-of='{fitted_model}'] table"))?;
        for p in answer["parameters"].as_array().ok_or("parameters")? {
            let path = p["path"].as_str().ok_or("path")?;
            let line = visible
                .lines()
                .find(|l| l.starts_with(path))
                .ok_or_else(|| format!("{path} in {visible}"))?;
            let shown = number(line, path).ok_or_else(|| format!("a number in {line}"))?;
            let factor = if path.starts_with("bulk.") && p["unit"] == "MPa" { 1e3 } else { 1.0 };
            let value = p["value"].as_f64().ok_or("value")? * factor;
            assert!((shown - value).abs() <= 6e-4 * value.abs(), "{path}: {shown} on the page, {value}");
        }
        let misfit = page.text(&format!("[data-rung='{fitted_model}']"))?;
        let rms = answer["rms_N"].as_f64().ok_or("rms")?;
        let shown = misfit.lines().find_map(|l| l.strip_suffix(" N")?.parse::<f64>().ok());
        assert!(shown.is_some_and(|s| (s - rms).abs() < 6e-3 * rms), "{misfit}: {rms}");
    }
    Ok(())
}

/// A slider without a server: the curve moves by the derivatives of `jacobian.csv`, the page says what that does to the misfit,
/// and its command computes the same exactly.
fn moves(page: &mut Page, here: &Path) -> Tested {
    page.click("[data-rung='1']")?;
    let slider = "#sliders [data-of='1'] input[data-path='bulk.k1']";
    page.picture("report-sliders", true)?;
    page.ask(&format!(
        "(() => {{ const s = document.querySelector({slider:?}); s.value = 520; s.dispatchEvent(new Event('input')); }})()"
    ))?;
    let table = fs::read_to_string(here.join("more/jacobian.csv"))?;
    let column =
        table.lines().next().and_then(|h| h.split(',').position(|c| c == "bulk.k1")).ok_or("bulk.k1")?;
    let moved = page.ask("[...movedBy()][0]")?;
    assert_eq!(moved[0], "bulk.k1");
    let by = moved[1].as_f64().ok_or("a change")?;
    assert!(by > 0.0);
    let drawn = page.ask("linearForce('tearing')")?;
    let rows = table.lines().filter(|l| l.starts_with("tearing,"));
    for (row, drawn) in rows.zip(drawn.as_array().ok_or("a curve")?) {
        let cells: Vec<&str> = row.split(',').collect();
        let right = cells[2].parse::<f64>()? + by * cells[column].parse::<f64>()?;
        let drawn = drawn.as_f64().ok_or("a force")?;
        assert!((drawn - right).abs() < 1e-4 * right.abs() + 1e-6, "{drawn} {right}");
    }
    page.picture("report-moved", false)?;
    let told = page.text("#moved")?;
    let about =
        told.split("tearing: ").nth(1).and_then(|t| number(t, "about")).ok_or_else(|| told.clone())?;
    let line = page.text("#moved-command")?;
    let line = line.lines().next().ok_or("a command")?.replace(" --out moved.toml", "");
    let mut words: Vec<&str> = line.split_whitespace().skip(1).collect();
    words.extend(["--out", "moved.toml"]);
    for arguments in [&words[..], &["identify", "moved.toml", "--at-start", "--out", "moved"]] {
        let out = fct(here, &[arguments, &["--quiet"]].concat())?;
        assert!(out.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&out.stderr));
    }
    let exact = summary(&here.join("moved"))?["tests"]["tearing"]["rms_N"].as_f64().ok_or("a misfit")?;
    println!("tearing: misfit about {about:.3e} N by the slider, {exact:.3e} N exactly");
    assert!((about - exact).abs() < 0.1 * exact, "{about} {exact}");
    page.click("#back")?;
    assert_eq!(page.text("#moved")?, "");
    assert!(page.ask("linearForce('tearing')")?.is_null());
    Ok(())
}

/// What stands under the mouse is what the curve's file says.
fn hovering(page: &mut Page, here: &Path) -> Tested {
    let chart = "#curves figure[data-name='tearing']";
    for (axis, at) in [("u", [0.4, 0.4]), ("t", [0.6, 0.5]), ("front", [0.5, 0.5])] {
        page.click(&format!("[data-axis='{axis}']"))?;
        page.hover(&format!("{chart} .u-over"), at)?;
        let told = page.text(&format!("{chart} .readout"))?;
        let index = page.ask(&format!("document.querySelector(\"{chart}\").dataset.index"))?;
        let index: usize = index.as_str().ok_or("no point under the mouse")?.parse()?;
        let curve = fs::read_to_string(here.join("more/curves/tearing.csv"))?;
        let row = curve.lines().nth(index + 1).ok_or("row")?;
        let row: Vec<&str> = row.split(',').collect();
        for (word, column) in [("record", 2), ("model", 3), ("misfit", 4)] {
            let value: f64 = row[column].parse()?;
            let shown = number(&told, word).ok_or_else(|| told.clone())?;
            assert!((shown - value).abs() <= 2e-3 * value.abs() + 2e-6, "{told}: {word} {value}");
        }
        assert!(told.ends_with(row[5]), "{told}: {}", row[5]);
    }
    Ok(())
}
