//! The page of a search: the answer on the first screen, the ladder's numbers.

use super::{first_screen, number, summary};
use crate::common::{BOOK, Tested, blocks, fct};
use crate::driver::{self, Page};
use std::fs;
use std::path::Path;

#[test]
#[ignore = "needs Chromium; `just browser`"]
fn a_search_answers_on_its_first_screen() -> Tested {
    let chromium = driver::found().ok_or("no chromium on the path and no $CHROMIUM")?;
    let folder = tempfile::tempdir()?;
    let here = folder.path();
    // The specimen of the tutorial: it relaxes.
    for (head, lines) in blocks(&fs::read_to_string(Path::new(BOOK).join("tutorial.md"))?) {
        if let Some(file) = head.strip_prefix("toml ") {
            fs::write(here.join(file), lines.join("\n"))?;
        }
    }
    for arguments in [
        &["simulate", "secret.toml", "--out", "measured"][..],
        &["discover", "strip.toml", "--out", "search"],
    ] {
        let out = fct(here, &[arguments, &["--quiet"]].concat())?;
        assert!(out.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&out.stderr));
    }
    let file = here.join("search/report.html");
    assert!(fs::metadata(&file)?.len() < 3_000_000);
    let mut page = Page::open(&chromium)?;
    for (width, scheme) in [(390, "dark"), (1280, "dark"), (1280, "light")] {
        page.load(&file, width, scheme)?;
        page.picture(&format!("search-{width}-{scheme}"), true)?;
    }
    first_screen(&mut page)?;
    let answers = page.text("#answers")?;
    for word in
        ["Yes, with viscoelastic", "unload 1", "Missing: viscoelastic", "viscoelastic.g =", "fct identify"]
    {
        assert!(answers.contains(word), "{word} in\n{answers}");
    }
    // The ladder's numbers are those of the search; its rungs switch the curves.
    let answer = summary(&here.join("search"))?;
    for fitted_model in 0..2 {
        page.click(&format!("[data-rung='{fitted_model}']"))?;
        let rms = answer["ladder"][fitted_model]["rms_N"].as_f64().ok_or("rms")?;
        let text = page.text(&format!("[data-rung='{fitted_model}']"))?;
        let shown = text.lines().find_map(|l| l.strip_suffix(" N")?.parse::<f64>().ok());
        assert!(shown.is_some_and(|s| (s - rms).abs() < 6e-3 * rms), "{text}: {rms}");
        page.hover("#curves figure[data-name='uniaxial'] .u-over", [0.8, 0.3])?;
        let told = page.text("#curves figure[data-name='uniaxial'] .readout")?;
        let index =
            page.ask("document.querySelector(\"#curves figure[data-name='uniaxial']\").dataset.index")?;
        let index: usize = index.as_str().ok_or("no point under the mouse")?.parse()?;
        let curve =
            fs::read_to_string(here.join(format!("search/rungs/{fitted_model}/curves/uniaxial.csv")))?;
        let row = curve.lines().nth(index + 1).ok_or("row")?;
        let model: f64 = row.split(',').nth(3).ok_or("model")?.parse()?;
        let shown = number(&told, "model").ok_or_else(|| told.clone())?;
        assert!((shown - model).abs() <= 1e-3 * model.abs() + 1e-6, "rung {fitted_model}: {told}, {model}");
    }
    assert_eq!(page.faults(), Vec::<String>::new());
    assert_eq!(page.outside(), Vec::<String>::new());
    Ok(())
}
