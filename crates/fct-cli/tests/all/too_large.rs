//! What a case costs is said before anything is meshed, and what fits into no memory is refused by the key that makes it so.
#![cfg(unix)]

use crate::common;
use crate::watched;

use common::{Tested, fct, folder, json, strip};
use watched::watched;

#[test]
fn check_says_memory_and_time_in_words_and_as_data() -> Tested {
    let folder = folder(&strip(""))?;
    let (code, answer, _) = json(folder.path(), &["check", "strip.toml"])?;
    assert_eq!(code, 0);
    let run = &answer["needs"]["run"];
    let bytes = run["memory_bytes"].as_f64().ok_or("no bytes")?;
    assert!((1e6..2e8).contains(&bytes) && run["seconds_per_run"].as_f64().is_some_and(|s| s > 0.0), "{run}");
    assert!(answer["needs"]["available_bytes"].as_f64().is_some_and(|b| b > bytes));
    let text = String::from_utf8(fct(folder.path(), &["check", "strip.toml"])?.stdout)?;
    assert!(
        text.contains("# needs about ") && text.contains(" MB and ") && text.contains("per run of the model")
    );
    // More elements, more of both.
    let fine = common::folder(&strip("").replace("[8, 8, 1]", "[40, 40, 4]"))?;
    let (_, more, _) = json(fine.path(), &["check", "strip.toml"])?;
    assert!(more["needs"]["run"]["memory_bytes"].as_f64() > Some(3.0 * bytes));
    assert!(more["needs"]["run"]["seconds_per_run"].as_f64() > run["seconds_per_run"].as_f64());
    Ok(())
}

/// In 2 GB of address space.
#[test]
fn what_does_not_fit_is_refused_by_every_command_with_what_would() -> Tested {
    let cases = [
        ("[8, 8, 1]", "[200, 200, 20]", "strip.toml:14", "`divisions = ["),
        ("divisions = [8, 8, 1]", "path_size_mm = 0.002", "strip.toml:14", "`path_size_mm = "),
    ];
    for (from, to, place, would) in cases {
        let folder = folder(&strip("").replace(from, to))?;
        for command in ["check", "simulate"] {
            let ended = watched(folder.path(), &[command, "strip.toml"])?;
            assert!(ended.code == Some(2) && ended.took.as_secs() < 30, "{command} {to}: {ended:?}");
            for word in [place, "error", would, "would fit", "this machine has"] {
                assert!(ended.stderr.contains(word), "{command} {to}: `{word}` is not in\n{}", ended.stderr);
            }
        }
        assert!(!folder.path().join("runs/strip/run.toml").exists());
    }
    Ok(())
}

#[test]
fn more_areas_than_elements_are_refused_by_both_names() -> Tested {
    let folder = folder(&strip("").replace("[interface]\n", "[interface]\nareas = 1000\n"))?;
    for command in ["check", "simulate"] {
        let (code, _, stderr) = json(folder.path(), &[command, "strip.toml"])?;
        assert_eq!(code, 2, "{stderr}");
        for word in ["strip.toml:22:1", "`areas` = 1000", "6 elements along the tear path", "`divisions`"] {
            assert!(stderr.contains(word), "`{word}` is not in\n{stderr}");
        }
    }
    Ok(())
}

/// Faults that only the mesh shows stand in a file all the same.
#[test]
fn a_fault_of_the_mesh_has_its_place() -> Tested {
    let cases = [
        ("[8, 8, 1]", "[1, 8, 1]", "strip.toml:14:1: error"),
        (
            "cut_mm = 1.5",
            "cut_mm = 1.5\noutline_mm = [[0, 0, 6], [4, 5.9, 6], [8, 0, 6]]",
            "strip.toml:6:1: error",
        ),
        ("cut_mm = 1.5", "cut_mm = 5.9999999", "strip.toml:14:1: error"),
    ];
    for (from, to, place) in cases {
        let folder = folder(&strip("").replacen(from, to, 1))?;
        let (code, _, stderr) = json(folder.path(), &["check", "strip.toml"])?;
        assert!(code == 2 && stderr.contains(place), "{to}: {stderr}");
    }
    Ok(())
}
