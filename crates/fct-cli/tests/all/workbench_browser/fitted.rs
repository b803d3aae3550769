//! A fit in the hands: it moves while it runs, sliders, undo, stretches that are left out.

use super::{ENTER, IDLE, SOON, by_keyboard, misfit, present};
use crate::bench::PATIENCE;
use crate::common::Tested;
use crate::driver::Page;
use serde_json::Value;

/// A fit that moves while it runs; a slider whose curve follows at once, and the exact run on release.
pub(super) fn fits(page: &mut Page) -> Tested {
    by_keyboard(page, "#fit", ENTER)?;
    page.until("document.querySelector('#doing').textContent.includes('objective')", PATIENCE)?;
    page.picture("workbench-fitting", false)?;
    present(page, "Fit", PATIENCE)?;
    page.ask("scrollTo(0, 0)")?;
    page.film(20)?;
    assert!(page.text("#key")?.contains("N/mm"), "Gc with its unit");
    let before = misfit(page)?;
    let slider = "[data-path='bulk.k1'] input[type=range]";
    let moved = page.ask(&format!(
        "(() => {{ const s = document.querySelector({slider:?}), f = document.querySelector('#charts figure');
           const was = Number(f.dataset.rms); s.value = Number(s.value) + 60; s.dispatchEvent(new Event('input'));
           return [was, Number(f.dataset.rms), Number(f.dataset.ms)]; }})()"
    ))?;
    assert!(moved[1].as_f64() > moved[0].as_f64(), "the linear curve follows: {moved}");
    assert!(moved[2].as_f64().is_some_and(|ms| ms < 16.0), "within a frame: {moved}");
    page.picture("workbench-slider", false)?;
    page.ask(&format!("document.querySelector({slider:?}).dispatchEvent(new Event('change'))"))?;
    present(page, "Values set", PATIENCE)?;
    assert!(misfit(page)? > before, "{before}");
    assert!(page.text("#linear")?.contains("differs from the linear curve by up to"));
    // Undo by the keyboard.
    page.press("z", 90, 2)?;
    present(page, "Fit", SOON)?;
    by_keyboard(page, slider, ("ArrowRight", 39))?;
    present(page, "Values set", PATIENCE)?;
    page.press("z", 90, 2)?;
    present(page, "Fit", SOON)?;
    leaves_out(page)?;
    page.click("#check")?;
    page.until(
        &format!("document.querySelector('#doctor').innerText.includes('parameters they fix') && {IDLE}"),
        PATIENCE,
    )
}

/// A stretch dragged over in a chart is left out: the page and every later answer say so, and it counts again.
fn leaves_out(page: &mut Page) -> Tested {
    let before = misfit(page)?;
    page.drag("[data-test=tearing] canvas.force", [0.7, 0.5], [0.8, 0.5])?;
    let told = page.text("#w-told")?;
    assert!(told.starts_with("tearing, ") && told.contains("points"), "{told}");
    page.picture("workbench-stretch", false)?;
    page.click("#w-out")?;
    present(page, "Records weighed", PATIENCE)?;
    let state = page.ask_later("fetch('/api/state').then(r => r.json())")?;
    let remarks = state["answer"]["remarks"].to_string();
    assert!(remarks.contains("left out of the fit"), "{remarks}");
    let points = |state: &Value| state["answer"]["tests"]["tearing"]["points"].as_u64();
    let row = state["curves"][1]["t"].as_array().map_or(0, Vec::len) as u64;
    assert!(points(&state) < Some(row), "{:?} of {row}", points(&state));
    page.click("[data-unweigh=tearing]")?;
    page.until(&format!("!document.querySelector('[data-unweigh]') && {IDLE}"), PATIENCE)?;
    assert_eq!(misfit(page)?, before);
    let commands = page.text("#commands")?;
    assert!(commands.contains("--weigh=tearing,") && commands.contains("--unweigh=tearing"), "{commands}");
    // Twice in a row, without waiting.
    page.press("z", 90, 2)?;
    page.press("z", 90, 2)?;
    present(page, "Fit", SOON)
}
