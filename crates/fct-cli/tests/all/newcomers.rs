//! What somebody meets who sees fct for the first time, or who does not mean well: text of files on terminals and
//! pages, commands to paste, folders that move, published values, means that say what is not in them.

use crate::common;

use common::{FIT, Tested, fct, json, synthetic};
use serde_json::Value;
use std::fs;
use std::path::Path;
use std::process::Command;

/// A segment's name that would run on a page, end a script, drive a terminal and turn a line around.
const EVIL: &str = "<img src=x onerror=alert(1)></script>\u{1b}[31m\u{202e}";

/// Puts the name on the second half of the tear's record.
fn poison(folder: &Path) -> Tested {
    let file = folder.join("runs/strip/tearing.csv");
    let text = fs::read_to_string(&file)?;
    let rows: Vec<&str> = text.lines().filter(|l| !l.starts_with('#')).collect();
    let half = rows.len() / 2;
    let named = rows.iter().enumerate().map(|(i, row)| {
        let columns: Vec<&str> = row.split(',').take(3).collect();
        let name = if i == 0 {
            "segment"
        } else if i < half {
            "first"
        } else {
            EVIL
        };
        format!("{},{name}\n", columns.join(","))
    });
    fs::write(&file, named.collect::<String>())?;
    Ok(())
}

fn stdout_of(here: &Path, arguments: &[&str]) -> Result<String, Box<dyn std::error::Error>> {
    let out = fct(here, arguments)?;
    let stderr = String::from_utf8(out.stderr)?;
    assert!(out.status.success(), "{arguments:?}: {stderr}");
    for text in [&stderr, &String::from_utf8(out.stdout.clone())?] {
        assert!(!text.contains(['\u{1b}', '\u{202e}']), "{arguments:?}: {text:?}");
    }
    Ok(String::from_utf8(out.stdout)?)
}

#[test]
fn text_of_a_record_runs_nowhere_and_published_values_have_a_place() -> Tested {
    let folder = synthetic()?;
    let here = folder.path();
    poison(here)?;
    // Others divided the path in two.
    let published =
        "source = \"a paper\"\n[strip.interface]\ngc_N_per_mm = [0.10, 0.30]\nsigma_c_MPa = [0.08]\n";
    fs::write(here.join("runs/published.toml"), published)?;
    stdout_of(here, &["identify", "fit.toml", "--out", "runs/base"])?;
    let compared = stdout_of(here, &["compare", "runs/base"])?;
    assert!(compared.contains("<img src=x"), "the name is shown as it is: {compared}");
    stdout_of(here, &["compare", "runs/base", "--json"])?;
    let page = fs::read_to_string(here.join("runs/base/report.html"))?;
    assert!(page.contains("&lt;img src=x onerror") && page.contains("default-src 'none'"));
    assert!(!page.contains("<img src=x") && !page.contains("innerHTML") && !page.contains('\u{202e}'));
    // The data, the charts, and the end of neither in a name.
    assert_eq!(page.matches("</script>").count(), 2);

    let answer: Value = serde_json::from_str(&fs::read_to_string(here.join("runs/base/summary.json"))?)?;
    let of = |path: &str| {
        answer["parameters"].as_array().into_iter().flatten().find(|p| p["path"] == path).cloned()
    };
    let gc = of("interface.area[1].gc").ok_or("Gc")?;
    assert!(
        gc["published"].as_f64().is_some_and(|v| (v - 0.2).abs() < 1e-12),
        "the mean along the path: {gc}"
    );
    assert!(gc["published_averaged"] == true && gc.get("published_in_interval").is_none(), "{gc}");
    let sigma = of("interface.area[1].sigma_c").ok_or("σc")?;
    assert!(sigma["published"] == 0.08 && sigma["published_in_interval"].is_boolean(), "{sigma}");
    assert_eq!((&answer["published"]["compared"], &answer["published"]["averaged"]), (&1.into(), &1.into()));
    Ok(())
}

/// What `add` prints is what a shell runs, and what it writes moves with its folder.
#[test]
fn a_printed_command_works_and_the_folder_can_move() -> Tested {
    let folder = synthetic()?;
    let (old, new) = (folder.path().join("it's a study"), folder.path().join("moved"));
    fs::create_dir(&old)?;
    for name in ["runs", "fit.toml"] {
        fs::rename(folder.path().join(name), old.join(name))?;
    }
    stdout_of(&old, &["identify", "fit.toml", "--out", "runs/the base"])?;
    let told = stdout_of(&old, &["add", "compliance", "runs/the base"])?;
    let next = told.lines().find_map(|l| l.strip_prefix("next: fct ")).ok_or("next")?.to_owned();
    assert!(next.contains(" --out "), "{next}");
    let written = fs::read_to_string(old.join("runs/the base+compliance.toml"))?;
    let lines: Vec<&str> =
        written.lines().filter(|l| l.starts_with("data =") || l.starts_with("parent =")).collect();
    assert!(
        lines.len() == 3 && lines.iter().all(|l| !l.contains("study") && !l.contains("\"/")),
        "{lines:?}"
    );
    fs::rename(&old, &new)?;
    let line = format!("{} {next}", env!("CARGO_BIN_EXE_fct"));
    let out = Command::new("sh").arg("-c").arg(&line).current_dir(&new).output()?;
    assert!(out.status.success(), "{line}: {}", String::from_utf8_lossy(&out.stderr));
    assert!(
        new.join("runs/the base+compliance/summary.json").is_file() && new.join("runs/the base").is_dir()
    );
    // Its page still knows what it was made from.
    let page = fs::read_to_string(new.join("runs/the base+compliance/report.html"))?;
    assert!(page.contains("data-rung=\"1\""), "a ladder of two");
    Ok(())
}

#[test]
fn a_batch_averages_what_is_known_and_explained() -> Tested {
    let folder = synthetic()?;
    let here = folder.path();
    // A strength that cannot reach the truth explains nothing.
    let held = FIT.replace("sigma_c_MPa = 0.06", "sigma_c_MPa = { start = 0.06, max = 0.065 }");
    fs::write(here.join("held.toml"), format!("name = \"held\"\n{held}"))?;
    let (code, answer, stderr) = json(here, &["batch", "fit.toml", "held.toml", "--out", "all"])?;
    assert_eq!(code, 0, "{stderr}");
    let all = &answer["over_all"];
    assert_eq!((&all["specimens"], &all["left_out"][0]["what"]), (&1.into(), &"held".into()), "{all}");
    assert!(all["left_out"][0]["why"].as_str().is_some_and(|w| w.starts_with("not explained")), "{all}");
    assert_eq!(all["sigma_c_MPa"][0], answer["table"][0]["sigma_c_MPa"][0]);
    let row = &answer["table"][1];
    assert!(row["sigma_c_MPa"].is_null() && row["at_bound"] == 1, "{row}");
    assert_eq!(row["left_out"][0]["why"], "at a bound");
    let page = fs::read_to_string(here.join("all/batch.html"))?;
    assert!(page.contains("Left out of it: held, not explained"));
    assert!(!page.contains("data-chart=\"batch\""), "a chart of one area each");
    Ok(())
}

#[test]
fn flags_that_do_nothing_are_refused_and_help_shows_how() -> Tested {
    let folder = tempfile::tempdir()?;
    for line in ["effects --figures pdf", "effects --out x", "effects --force", "check x.toml --figures pdf"]
    {
        let out = fct(folder.path(), &line.split(' ').collect::<Vec<_>>())?;
        assert_eq!(out.status.code(), Some(2), "{line}");
    }
    let help = stdout_of(folder.path(), &["effects", "--help"])?;
    assert!(help.trim_end().ends_with("fct effects viscoelastic") && !help.contains("--threads"), "{help}");
    Ok(())
}

/// Each line of the catalogue is filled before it is broken.
#[test]
fn the_catalogue_is_wrapped_once() -> Tested {
    let folder = tempfile::tempdir()?;
    for arguments in [&["effects"][..], &["effects", "drift"]] {
        let text = stdout_of(folder.path(), arguments)?;
        let lines: Vec<&str> = text.lines().collect();
        assert!(lines.iter().all(|l| l.chars().count() <= 100), "{text}");
        for pair in lines.windows(2) {
            let indent = |l: &str| l.chars().take_while(|c| *c == ' ').count();
            // A line that goes on an earlier one: its first word had no room there.
            let goes_on =
                indent(pair[1]) > indent(pair[0]) && !pair[0].trim().is_empty() && pair[0].contains("  ");
            let word = pair[1].split_whitespace().next().unwrap_or_default();
            let room = pair[0].chars().count() + 1 + word.chars().count();
            assert!(!goes_on || room > 100, "{pair:?}");
        }
    }
    Ok(())
}

#[test]
fn the_program_names_itself_once() -> Tested {
    let folder = synthetic()?;
    let here = folder.path();
    let (code, answer, _) = json(here, &["compare", "nowhere"])?;
    assert!(
        code == 2 && answer["error"]["reason"].as_str().is_some_and(|r| !r.starts_with("fct:")),
        "{answer}"
    );
    let (_, answer, stderr) = json(here, &["batch", "fit.toml", "fit.toml/x", "--out", "fit.toml"])?;
    assert!(!stderr.contains("fct: fct:") && !answer.to_string().contains("fct: "), "{stderr}\n{answer}");
    Ok(())
}
