//! Probabilities as bars.

use super::SOON;
use crate::bench::Bench;
use crate::common::{self, Tested};
use crate::driver::{self, Page};
use serde_json::{Value, json};
use std::error::Error;

/// Probabilities of a search, look-alikes, "nothing" and "something else" are bars where a diagnosis has them.
#[test]
#[ignore = "needs Chromium; `just browser`"]
fn probabilities_are_bars() -> Tested {
    let chromium = driver::found().ok_or("no chromium on the path and no $CHROMIUM")?;
    let made = common::synthetic()?;
    let bench = Bench::open(made.path(), &["fit.toml"])?;
    let mut page = Page::open(&chromium)?;
    page.looks(1280, "light")?;
    page.go(&bench.url)?;
    page.until("document.querySelector('#name').innerText === 'strip'", SOON)?;
    let row = |effect: &str, fall: f64, alike: &[&str]| json!({ "effect": effect, "expected_fall": fall, "significant": fall > 0.5, "look_alikes": alike, "sentence": "s." });
    let screen = json!([
        row("drift", 0.9, &["lag"]),
        row("lag", 0.8, &["drift"]),
        row("compliance", 0.1, &[]),
        row("slack", 0.0, &[])
    ]);
    let posterior = json!({ "effects": { "compliance": 0.93, "lag": 0.03, "drift": 0.02 }, "nothing": 0.01, "something_else": 0.04,
        "sets": [{ "effects": ["compliance"], "probability": 0.93 }],
        "sensitivity": { "amplitude_half": { "effects": { "compliance": 0.6 } }, "rest_x2": { "effects": { "compliance": 0.92 } } } });
    let shown = |page: &mut Page, diagnosis: Value| -> Result<Value, Box<dyn Error>> {
        page.ask_later(&format!(
            "(async () => {{ const missing = await import('/assets/missing.js'), state = await (await fetch('/api/state')).json();
               missing.set({{ ...state, diagnosis: {diagnosis} }});
               return [...document.querySelectorAll('#effects li:not(.group)')].map(l => [l.querySelector('b').textContent, l.querySelector('.muted').textContent,
                 l.querySelector('.share span').style.width, l.closest('.group') !== null]); }})()"
        ))
    };
    let bars = shown(&mut page, json!({ "screen": screen, "words": [], "posterior": posterior }))?;
    let names: Vec<&str> = bars.as_array().into_iter().flatten().filter_map(|b| b[0].as_str()).collect();
    assert_eq!(names, ["compliance", "lag", "drift", "nothing is missing", "something else"]);
    assert_eq!(bars[0], json!(["compliance", "probability 93 %", "93%", false]));
    assert_eq!(
        (&bars[1][3], &bars[2][3], &bars[4][1]),
        (&json!(true), &json!(true), &json!("probability 4 %"))
    );
    assert!(page.text("#words")?.contains("half the usual amplitudes: compliance 60 %"));
    page.picture("workbench-probabilities", true)?;
    // Without probabilities the screen's expectation is what there is.
    let bars = shown(&mut page, json!({ "screen": screen, "words": [] }))?;
    assert_eq!(bars[0], json!(["drift", "90 % of χ²", "90%", true]));
    assert_eq!(bars.as_array().map(Vec::len), Some(4), "{bars}");
    assert_eq!(page.faults(), Vec::<String>::new());
    Ok(())
}
