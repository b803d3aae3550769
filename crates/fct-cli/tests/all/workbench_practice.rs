//! The workbench's journey on a record of another program with a hidden effect: files of a testing machine dropped on an
//! empty page, the base model fitted, what is missing named and added, the error falling. Minutes: `just workbench-practice`.

use crate::bench::Bench;
use crate::common::Tested;
use crate::driver::{self, Page};
use crate::workbench_browser::{IDLE, SOON, drop_file, fill, misfit, present, raw};
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// A fit on the mesh that the file's dimensions ask for.
const FIT: Duration = Duration::from_secs(3000);

#[test]
#[ignore = "needs Chromium and $FCT_PRACTICE, and minutes; `just workbench-practice`"]
fn a_practice_record_is_explained_in_the_hands() -> Tested {
    let chromium = driver::found().ok_or("no chromium on the path and no $CHROMIUM")?;
    let practice = std::env::var_os("FCT_PRACTICE").ok_or("no $FCT_PRACTICE")?;
    let case = std::env::var("FCT_CASE").unwrap_or("practice-08-drift".into());
    let case = PathBuf::from(practice).join(case);
    let truth: Value = serde_json::from_str(&std::fs::read_to_string(case.join("truth.json"))?)?;
    let effect = truth["effects"][0].as_str().ok_or("an effect in truth.json")?;
    let folder = tempfile::tempdir()?;
    let bench = Bench::open(folder.path(), &[])?;
    let mut page = Page::open(&chromium)?;
    page.looks(1280, "light")?;
    page.go(&bench.url)?;
    specimen(&mut page, &case, &truth)?;
    page.click("#fit")?;
    present(&mut page, "Fit", FIT)?;
    page.picture("practice-fit", false)?;
    let before = misfit(&mut page)?;
    page.click("#diagnose")?;
    page.until(&format!("document.querySelector('#effects li') && {IDLE}"), FIT)?;
    page.picture("practice-missing", false)?;
    let named = page.ask("document.querySelector('#effects li b').textContent")?;
    assert_eq!(named, effect, "what leads is what is hidden");
    page.click(&format!("[data-add={effect}]"))?;
    present(&mut page, &format!("+ {effect}"), FIT)?;
    page.picture("practice-added", false)?;
    let (after, noise) = (misfit(&mut page)?, noise(&page.ask_later(STATE)?, &truth));
    println!("{}: misfit {before:.3e} N, with {effect} {after:.3e} N; noise {noise:.3e} N", case.display());
    assert!(after < 0.7 * before && after < 1.3 * noise, "{before} {after} {noise}");
    assert_eq!(page.faults(), Vec::<String>::new());
    Ok(())
}

const STATE: &str = "fetch('/api/state').then(r => r.json())";

/// Files as the machine wrote them, dimensions, areas along the tear.
fn specimen(page: &mut Page, case: &Path, truth: &Value) -> Tested {
    for (k, name) in ["uniaxial.csv", "tearing.csv"].into_iter().enumerate() {
        drop_file(page, name, &raw(&case.join(name))?)?;
        page.until(&format!("document.querySelectorAll('.understood').length === {}", k + 1), SOON)?;
    }
    for side in ["length", "width", "thickness", "cut"] {
        fill(page, &format!("#g-{side}"), &truth["geometry_file"][side].to_string())?;
    }
    fill(page, "#g-name", "practice")?;
    page.click("#geometry button[type=submit]")?;
    page.until("document.querySelectorAll('#charts figure').length === 2", SOON)?;
    let areas = truth["areas_Gc_N_per_mm_sigma_c_MPa"].as_array().map_or(1, Vec::len);
    page.ask("document.querySelector('#mesh').open = true")?;
    fill(page, "#areas", &areas.to_string())?;
    page.click("#model button")?;
    present(page, "Model", SOON)
}

/// Root mean square of the noise that was put on all points, N.
fn noise(state: &Value, truth: &Value) -> f64 {
    let (mut sum, mut n) = (0.0, 0.0);
    for curve in state["curves"].as_array().into_iter().flatten() {
        let points = curve["f"].as_array().map_or(0, Vec::len) as f64;
        let sd = truth["noise_sd_N"][curve["test"].as_str().unwrap_or_default()].as_f64().unwrap_or(f64::NAN);
        sum += points * sd * sd;
        n += points;
    }
    (sum / n).sqrt()
}
