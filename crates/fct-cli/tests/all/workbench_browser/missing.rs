//! What is missing: named, shown on the misfit, added.

use super::{ENTER, IDLE, SOON, by_keyboard, misfit, present};
use crate::bench::PATIENCE;
use crate::common::Tested;
use crate::driver::Page;
use serde_json::Value;
use std::error::Error;

/// What leads is added, and the error falls to the noise.
pub(super) fn adds(page: &mut Page) -> Tested {
    let before = misfit(page)?;
    by_keyboard(page, "#diagnose", ENTER)?;
    page.until(&format!("document.querySelector('#effects li') && {IDLE}"), PATIENCE)?;
    let names = page.ask("[...document.querySelectorAll('#effects li b')].map(b => b.textContent)")?;
    let told = page.text("#effects li")?;
    assert!(told.contains("of χ²"), "{told}");
    assert_eq!(names[0], "compliance", "{names}");
    shows(page)?;
    by_keyboard(page, "[data-add=compliance]", ENTER)?;
    page.ask("scrollTo(0, 0)")?;
    present(page, "+ compliance", PATIENCE)?;
    page.ask("scrollTo(0, 0)")?;
    page.film(40)?;
    let after = misfit(page)?;
    println!("misfit {before:.3e} N, with compliance {after:.3e} N");
    assert!(after < 0.7 * before, "{before} {after}");
    page.until("document.querySelector('#effects .present b').textContent === 'compliance'", SOON)
}

/// What an effect would add is drawn onto the misfit while the pointer is there; its card has its picture.
fn shows(page: &mut Page) -> Tested {
    let drawn = "[...document.querySelectorAll('#charts figure')].map(f => f.dataset.hovered)";
    page.hover("[data-effect=compliance]", [0.05, 0.5])?;
    page.until(&format!("{drawn}.every(h => h === 'compliance')"), SOON)?;
    page.picture("workbench-hover", false)?;
    page.film(25)?;
    page.hover("#name", [0.5, 0.5])?;
    page.until(&format!("{drawn}.every(h => h === '')"), SOON)?;
    page.click("[data-card=compliance]")?;
    let card = page.text("#card")?;
    assert!(card.contains("law") && card.contains("told apart by"), "{card}");
    assert_eq!(page.ask("document.querySelectorAll('#card canvas').length")?, 2);
    // What the list beside it calls probable takes the misfit away where it is drawn.
    let (misfit, left, probable) = left_over(page, "compliance")?;
    let falls = 1.0 - (left / misfit).powi(2);
    assert!(falls > 0.5 && probable > 0.5, "{falls} {probable}");
    page.picture("workbench-card", true)?;
    page.click("#card button")
}

/// Root mean square misfit over all points, what would be left of it with what an effect would add, N; and how probable it is
/// that the effect acts.
fn left_over(page: &mut Page, effect: &str) -> Result<(f64, f64, f64), Box<dyn Error>> {
    let state = page.ask_later("fetch('/api/state').then(r => r.json())")?;
    let k = state["adds"]["paths"]
        .as_array()
        .and_then(|p| p.iter().position(|e| e == effect))
        .ok_or("no such effect")?;
    let (mut misfit, mut left, mut n) = (0.0, 0.0, 0.0);
    for curve in state["curves"].as_array().ok_or("curves")? {
        let adds = &state["adds"]["tests"][curve["test"].as_str().unwrap_or_default()][k];
        for i in 0..curve["f"].as_array().map_or(0, Vec::len) {
            let at = |v: &Value| v[i].as_f64().unwrap_or_default();
            let rest = at(&curve["f"]) - at(&curve["m"]);
            misfit += rest * rest;
            left += (rest - at(adds)).powi(2);
            n += 1.0;
        }
    }
    let probable = state["diagnosis"]["posterior"]["effects"][effect].as_f64().ok_or("a probability")?;
    Ok(((misfit / n).sqrt(), (left / n).sqrt(), probable))
}
