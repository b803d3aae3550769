//! The workbench in a real browser: `just browser`. Ignored where nobody asks, for it needs Chromium.

mod elsewhere;
mod fitted;
mod looks;
mod missing;
mod probabilities;

use crate::bench::Bench;
use crate::common::{self, Tested};
use crate::driver::{self, Page};
use serde_json::json;
use std::error::Error;
use std::fs;
use std::path::Path;
use std::time::Duration;

pub const SOON: Duration = Duration::from_secs(30);

/// A strip between clamps that give way: what the page is to find.
const COMPLIANT: &str = "[solver]\nstep_mm = 0.05\n[output]\nnoise = 0.003\nseed = 3\nfields = false\n[effects.compliance]\nc_mm_per_N = 1.5\n";

/// A record of `fct simulate` as a testing machine's program writes it, without dimensions.
pub fn raw(record: &Path) -> Result<String, Box<dyn Error>> {
    let text = fs::read_to_string(record)?;
    let rows = text.lines().filter(|l| l.starts_with(|c: char| c.is_ascii_digit()));
    Ok(rows.fold("Time,Extension,Load\n(s),(mm),(N)\n".to_owned(), |all, row| {
        let three: Vec<&str> = row.split(',').take(3).collect();
        all + &three.join(",") + "\n"
    }))
}

/// Drops a file on the page, as a hand does.
pub fn drop_file(page: &mut Page, name: &str, content: &str) -> Tested {
    let (name, content) = (json!(name), json!(content));
    page.ask(&format!(
        "(() => {{ const d = new DataTransfer(); d.items.add(new File([{content}], {name}));
           document.querySelector('#drop').dispatchEvent(new DragEvent('drop', {{ dataTransfer: d, bubbles: true, cancelable: true }})); }})()"
    ))?;
    page.until(&format!("document.querySelector('#import').innerText.includes({name})"), SOON)
}

/// Writes into a field, as a keyboard does.
pub fn fill(page: &mut Page, selector: &str, text: &str) -> Tested {
    page.ask(&format!(
        "(() => {{ const e = document.querySelector({selector:?}); e.focus(); e.select(); }})()"
    ))?;
    page.call("Input.insertText", json!({ "text": text })).map(|_| ())
}

/// Presses something with the keyboard alone: the tabulator until it has the focus, then a key.
fn by_keyboard(page: &mut Page, selector: &str, key: (&str, u32)) -> Tested {
    let all =
        page.ask("document.querySelectorAll('button, input, select, a[href], summary, [tabindex]').length")?;
    for _ in 0..all.as_u64().unwrap_or(0) + 2 {
        if page.ask(&format!("document.activeElement.matches({selector:?})"))? == true {
            return page.press(key.0, key.1, 0);
        }
        page.press("Tab", 9, 0)?;
    }
    Err(format!("the tabulator does not come to {selector}").into())
}

const ENTER: (&str, u32) = ("Enter", 13);

pub const IDLE: &str =
    "document.querySelector('#busy').hidden && !document.body.classList.contains('working')";

/// The misfit that the present step of the staircase shows, N.
pub fn misfit(page: &mut Page) -> Result<f64, Box<dyn Error>> {
    let rms = page.ask("Number(document.querySelector('[aria-current=step]').dataset.rms)")?;
    Ok(rms.as_f64().ok_or("no misfit on the staircase")?)
}

pub fn present(page: &mut Page, title: &str, patience: Duration) -> Tested {
    let there =
        format!("document.querySelector('[aria-current=step] b')?.textContent === {title:?} && {IDLE}");
    page.until(&there, patience)
}

#[test]
#[ignore = "needs Chromium; `just browser`"]
fn the_error_falls_in_the_hands() -> Tested {
    let chromium = driver::found().ok_or("no chromium on the path and no $CHROMIUM")?;
    let made = common::folder(&common::strip(COMPLIANT))?;
    let out = common::fct(made.path(), &["simulate", "strip.toml", "--quiet"])?;
    assert!(out.status.success(), "{}", String::from_utf8_lossy(&out.stderr));
    let folder = tempfile::tempdir()?;
    let bench = Bench::open(folder.path(), &[])?;
    let mut page = Page::open(&chromium)?;
    page.looks(1280, "light")?;
    let first = page.go(&bench.url)?;
    // A second on a machine that has nothing else to do: `just workbench-figures`.
    assert!(first < 10_000.0, "loaded after {first} ms");
    assert_eq!(page.ask("location.search")?, "", "the token stays in no address");
    assert_eq!(page.ask("document.cookie")?, "", "no script sees the token");
    page.picture("workbench-empty", false)?;
    page.film(15)?;
    specimen(&mut page, made.path())?;
    fitted::fits(&mut page)?;
    missing::adds(&mut page)?;
    elsewhere::again(&mut page, folder.path())?;
    elsewhere::windows(&mut page, &chromium, &bench)?;
    looks::strip(&mut page)?;
    looks::looks(&mut page)?;
    assert_eq!(page.faults(), Vec::<String>::new());
    let elsewhere: Vec<String> =
        page.outside().into_iter().filter(|u| !u.starts_with("http://127.0.0.1:")).collect();
    assert_eq!(elsewhere, Vec::<String>::new());
    Ok(())
}

/// Raw files, the question of the importer, dimensions, a mesh.
fn specimen(page: &mut Page, made: &Path) -> Tested {
    // A column without a unit is asked for beside the file.
    let unclear = raw(&made.join("runs/strip/uniaxial.csv"))?.replace("(N)", "()");
    drop_file(page, "uniaxial.csv", &unclear)?;
    page.until("document.querySelector('#questions button')", SOON)?;
    page.picture("workbench-question", true)?;
    page.film(15)?;
    page.click("#questions button")?;
    page.until("document.querySelector('#geometry')", SOON)?;
    drop_file(page, "tearing.csv", &raw(&made.join("runs/strip/tearing.csv"))?)?;
    page.until("document.querySelectorAll('.understood').length === 2", SOON)?;
    for (side, mm) in [("length", "8"), ("width", "6"), ("thickness", "0.8"), ("cut", "1.5")] {
        fill(page, &format!("#g-{side}"), mm)?;
    }
    fill(page, "#g-name", "strip A & B")?;
    let drawn = page.ask("document.querySelector('.strip').getAttribute('aria-label')")?;
    assert!(drawn.as_str().is_some_and(|d| d.contains("width 6 mm") && d.contains("cut 1.5 mm")), "{drawn}");
    page.picture("workbench-geometry", true)?;
    page.film(20)?;
    page.click("#geometry button[type=submit]")?;
    page.until("document.querySelector('#name').innerText === 'strip A & B'", SOON)?;
    page.until("document.querySelectorAll('#charts figure').length === 2", SOON)?;
    page.ask("document.querySelector('#mesh').open = true")?;
    for (field, n) in [("#d0", "8"), ("#d1", "8"), ("#d2", "1"), ("#areas", "1")] {
        fill(page, field, n)?;
    }
    page.click("#model button")?;
    present(page, "Model", SOON)
}
