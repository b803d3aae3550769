//! The workbench in a real browser: `just browser`. Ignored where nobody asks, for it needs Chromium.

use crate::accessible;
use crate::bench::{Bench, PATIENCE};
use crate::common::{self, Tested};
use crate::driver::{self, Page};
use serde_json::{Value, json};
use std::error::Error;
use std::fs;
use std::path::Path;
use std::process::Command;
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
fn misfit(page: &mut Page) -> Result<f64, Box<dyn Error>> {
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
    fits(&mut page)?;
    adds(&mut page)?;
    again(&mut page, folder.path())?;
    windows(&mut page, &chromium, &bench)?;
    strip(&mut page)?;
    looks(&mut page)?;
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

/// A fit that moves while it runs; a slider whose curve follows at once, and the exact run on release.
fn fits(page: &mut Page) -> Tested {
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

/// What leads is added, and the error falls to the noise.
fn adds(page: &mut Page) -> Tested {
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

/// A reload, and a terminal, see the same; undo goes back.
fn again(page: &mut Page, folder: &Path) -> Tested {
    let (after, steps) = (misfit(page)?, page.ask("document.querySelectorAll('[data-step]').length")?);
    page.call("Page.reload", json!({}))?;
    page.until("document.querySelector('[aria-current=step]')", SOON)?;
    present(page, "+ compliance", SOON)?;
    assert_eq!((misfit(page)?, page.ask("document.querySelectorAll('[data-step]').length")?), (after, steps));
    let commands = page.text("#commands")?;
    for word in [
        "cd '",
        "fct import",
        "--kind=uniaxial,tearing",
        "fct diagnose",
        "fct add compliance",
        "fct identify",
    ] {
        assert!(commands.contains(word), "{word} in\n{commands}");
    }
    in_a_shell(page, folder)?;
    // The run is an ordinary one, and its report can be saved.
    let run = page.ask("document.querySelectorAll('#links a')[1].getAttribute('href')")?;
    let run =
        run.as_str().and_then(|r| r.strip_prefix("/files/")?.strip_suffix("/report.html")).ok_or("a run")?;
    let (code, compared, _) = common::json(folder, &["compare", run])?;
    assert_eq!((code, compared["schema"].as_u64()), (0, Some(1)));
    let saved = page.ask_later("fetch(document.querySelectorAll('#links a')[1].href).then(r => r.text()).then(t => t.includes('name=\"generator\" content=\"fct\"'))")?;
    assert_eq!(saved, true);
    page.click("#undo")?;
    present(page, "Fit", SOON)?;
    assert!(misfit(page)? > after);
    page.click("#redo")?;
    present(page, "+ compliance", SOON)
}

/// Another window sees the same; what is done there is seen here.
fn windows(page: &mut Page, chromium: &Path, bench: &Bench) -> Tested {
    let mut other = Page::open(chromium)?;
    other.go(&bench.url)?;
    present(&mut other, "+ compliance", SOON)?;
    assert_eq!(misfit(&mut other)?, misfit(page)?);
    other.press("z", 90, 2)?;
    present(page, "Fit", SOON)?;
    page.press("z", 90, 10)?;
    present(&mut other, "+ compliance", SOON)?;
    assert_eq!(other.faults(), Vec::<String>::new());
    present(page, "+ compliance", SOON)
}

/// Nothing is wider than its window; everything that is pressed has a name; labels of fields are theirs.
fn looks(page: &mut Page) -> Tested {
    page.ask("scrollTo(0, 0)")?;
    page.picture("workbench", false)?;
    for (width, scheme) in [(1280, "light"), (1280, "dark"), (390, "light"), (390, "dark")] {
        page.looks(width, scheme)?;
        page.settle()?;
        page.picture(&format!("workbench-{width}-{scheme}"), true)?;
        assert_eq!(accessible::faults(page)?, Vec::<String>::new(), "{width} {scheme}");
    }
    page.looks(1280, "light")?;
    assert_eq!(accessible::unreached(page)?, Vec::<String>::new());
    Ok(())
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

/// The deformed strip: its pictures are played, and another model's curves are laid over these.
fn strip(page: &mut Page) -> Tested {
    page.until("document.querySelector('#frame-told').textContent.includes('picture')", SOON)?;
    let coloured = "(() => { const c = document.querySelector('#mesh-canvas'), d = c.getContext('2d').getImageData(0, 0, c.width, c.height).data, s = new Set();
        for (let i = 0; i < d.length; i += 4) if (d[i + 3] === 255) s.add(d[i] * 65536 + d[i + 1] * 256 + d[i + 2]); return s.size; })()";
    assert!(page.ask(coloured)?.as_u64() > Some(20), "colours of stress");
    let before = page.text("#frame-told")?;
    // Asked again until it holds: pictures of the step that was gone to may still be on their way.
    page.until(
        &format!(
            "(() => {{ const f = document.querySelector('#frame'); f.value = 1; f.dispatchEvent(new Event('input'));
               return document.querySelector('#frame-told').textContent !== {before:?}; }})()"
        ),
        SOON,
    )?;
    page.picture("workbench-strip", true)?;
    page.click("[data-over='2']")?;
    page.until("document.querySelector('#overlays').textContent.includes('Fit')", SOON)?;
    page.click("[data-over='2']")
}

/// The lines on the page, pasted into a shell in another folder that holds only the raw files, give the page's numbers to the bit.
fn in_a_shell(page: &mut Page, folder: &Path) -> Tested {
    let commands = page.text("#commands")?;
    let elsewhere = tempfile::tempdir()?;
    let raw = elsewhere.path().join("workbench/raw");
    fs::create_dir_all(&raw)?;
    for file in fs::read_dir(folder.join("workbench/raw"))? {
        let file = file?;
        fs::copy(file.path(), raw.join(file.file_name()))?;
    }
    let lines: Vec<&str> = commands.lines().skip(1).collect();
    let last = lines.iter().rev().find(|l| l.starts_with("fct identify")).ok_or("a fit")?;
    let run = last.rsplit(' ').next().ok_or("a run")?;
    let program = Path::new(env!("CARGO_BIN_EXE_fct"));
    let path = std::env::join_paths(
        std::iter::once(program.parent().ok_or("a folder")?.to_owned())
            .chain(std::env::split_paths(&std::env::var_os("PATH").unwrap_or_default())),
    )?;
    let out = Command::new("sh")
        .args(["-e", "-c", &lines.join("\n")])
        .current_dir(elsewhere.path())
        .env("PATH", path)
        .output()?;
    assert!(out.status.success(), "{}\n{}", lines.join("\n"), String::from_utf8_lossy(&out.stderr));
    let summary = |at: &Path| -> Result<Value, Box<dyn Error>> {
        Ok(common::timeless(serde_json::from_slice(&fs::read(at.join(run).join("summary.json"))?)?))
    };
    let (theirs, ours) = (summary(elsewhere.path())?, summary(folder)?);
    // `run` has the folder's path, and `--json`, which the page adds.
    for (key, value) in ours.as_object().ok_or("an answer")?.iter().filter(|(k, _)| *k != "run") {
        assert_eq!(&theirs[key], value, "{run}: {key}");
    }
    for file in ["jacobian.csv", "curves/uniaxial.csv", "curves/tearing.csv"] {
        let read = |at: &Path| fs::read(at.join(run).join(file));
        assert!(read(elsewhere.path())? == read(folder)?, "{run}/{file} is not the same");
    }
    Ok(())
}
