//! `fct import` from the outside: what it writes can be used, nothing of the user's is touched, refusals are quick.

use crate::common;

use common::{BOOK, Tested, blocks, fct, json};
use serde_json::Value;
use std::fs;
use std::path::Path;
use std::time::{Duration, Instant};

fn message(folder: &Path, arguments: &[&str]) -> Result<(Option<i32>, String), Box<dyn std::error::Error>> {
    let out = fct(folder, arguments)?;
    Ok((out.status.code(), String::from_utf8_lossy(&out.stderr).into_owned()))
}

/// A biaxial test from a machine's file to a specimen that `check` takes; a test of two forces is not thinned out.
#[test]
fn a_biaxial_file_becomes_a_biaxial_record() -> Tested {
    let there = tempfile::tempdir()?;
    let here = there.path();
    let row = |k: u32| {
        let (t, u) = (f64::from(k), 0.02 * f64::from(k));
        format!("{t},{},{},{u},{u}\n", 40.0 * u * u, 30.0 * u * u)
    };
    let rows: String = (0..60).map(row).collect();
    fs::write(
        here.join("biaxial-1.csv"),
        format!("Time (s),X Force (N),Y Force (N),X Position (mm),Y Position (mm)\n{rows}"),
    )?;
    fs::write(here.join("sheet.toml"), "[geometry]\nlength_mm = 10\nwidth_mm = 10\nthickness_mm = 1\n")?;
    let (code, answer, stderr) =
        json(here, &["import", "biaxial-1.csv", "--geometry", "sheet.toml", "--out", "sheet"])?;
    assert_eq!(code, 0, "{stderr}");
    assert_eq!(answer["tests"][0]["kind"], "biaxial", "{answer}");
    let text = fs::read_to_string(here.join("sheet/biaxial.csv"))?;
    assert!(text.contains("time_s,displacement_mm,force_N,displacement_x_mm,force_x_N\n"), "{text}");
    let (code, _, stderr) = json(here, &["check", "sheet/specimen.toml"])?;
    assert_eq!(code, 0, "{stderr}");
    let (code, answer, _) =
        json(here, &["import", "biaxial-1.csv", "--kind", "biaxial", "--points", "30", "--out", "b"])?;
    assert!(
        code == 2 && answer["error"]["reason"].as_str().is_some_and(|r| r.contains("--points")),
        "{answer}"
    );
    let (code, answer, _) = json(here, &["import", "biaxial-1.csv", "--kind", "biaxail", "--out", "b"])?;
    assert!(
        code == 2 && answer["error"]["reason"].as_str().is_some_and(|r| r.contains("t_peel")),
        "{answer}"
    );
    Ok(())
}

#[test]
fn the_scaffolds_raw_files_become_a_specimen_that_checks() -> Tested {
    let folder = tempfile::tempdir()?;
    let here = folder.path();
    assert!(fct(here, &["new", "strip"])?.status.success());
    let (code, answer, stderr) = json(
        here,
        &[
            "import",
            "strip/raw/uniaxial_RawData_1.csv",
            "strip/raw/tearing_RawData_1.csv",
            "--out",
            "strip/imported",
        ],
    )?;
    assert_eq!(code, 0, "{stderr}");
    assert_eq!((&answer["schema"], &answer["specimen"]), (&1.into(), &"strip".into()));
    let kinds: Vec<&Value> = answer["tests"].as_array().ok_or("tests")?.iter().map(|t| &t["kind"]).collect();
    assert_eq!(kinds, ["uniaxial", "tearing"]);
    assert_eq!(answer["geometry"]["cut"], 1.5);
    assert_eq!(answer["files"][0]["reading"]["dialect"], "Bluehill");
    // The same rows as in the sample records.
    for name in ["uniaxial.csv", "tearing.csv"] {
        let rows = |text: String| {
            text.lines().filter(|l| !l.starts_with('#')).map(str::to_owned).collect::<Vec<_>>()
        };
        let imported = rows(fs::read_to_string(here.join("strip/imported").join(name))?);
        assert_eq!(imported, rows(fs::read_to_string(here.join("strip").join(name))?));
    }
    let log: Value = serde_json::from_str(&fs::read_to_string(here.join("strip/imported/import.json"))?)?;
    assert_eq!(log, answer);
    let svg = fs::read_to_string(here.join("strip/imported/tearing.svg"))?;
    assert!(svg.contains("force (N)") && svg.contains("time (s)"));
    let (code, checked, stderr) = json(here, &["check", "--quick", "strip/imported/specimen.toml"])?;
    assert_eq!(code, 0, "{stderr}");
    assert!(
        checked["provenance"]
            .as_str()
            .is_some_and(|p| p.contains("uniaxial_RawData_1.csv (Bluehill, which says: synthetic sample"))
    );
    // Once more: nothing is written over.
    let before = fs::read(here.join("strip/imported/specimen.toml"))?;
    let again = message(here, &["import", "strip/raw/uniaxial_RawData_1.csv", "--out", "strip/imported"])?;
    assert!(again.0 == Some(2) && again.1.contains("this exists already; nothing was written"), "{again:?}");
    assert_eq!(fs::read(here.join("strip/imported/specimen.toml"))?, before);
    Ok(())
}

#[test]
fn what_is_open_names_its_flag_and_the_flag_settles_it() -> Tested {
    let folder = tempfile::tempdir()?;
    let here = folder.path();
    fs::write(
        here.join("a.csv"),
        "Time;Weg [mm];Kraft [N];Kraft 2 [N]\n0;0,5;0,1;1\n1;0,6;0,2;3\n2;0,7;0,4;2\n",
    )?;
    fs::write(here.join("g.toml"), "[geometry]\nlength_mm = 8\nwidth_mm = 6.0\nthickness_um = 800\n")?;
    let (code, stderr) = message(here, &["import", "a.csv"])?;
    assert_eq!(code, Some(2));
    assert!(stderr.contains("--units time=s") && !here.join("a").exists(), "{stderr}");
    let (code, answer, _) = json(here, &["import", "a.csv"])?;
    assert_eq!(code, 2);
    assert_eq!(answer["error"]["files"][0]["questions"][0]["flag"], "units");
    let flags = ["import", "a.csv", "--units", "time=s", "--force", "3", "--zero", "--geometry", "g.toml"];
    let out = fct(here, &flags)?;
    assert!(out.status.success(), "{}", String::from_utf8_lossy(&out.stderr));
    let text = String::from_utf8(out.stdout)?;
    assert!(text.lines().all(|l| l.chars().count() <= 100), "{text}");
    assert!(text.contains("0.5 mm taken off the displacement (--zero)"), "{text}");
    let record = fs::read_to_string(here.join("a/uniaxial.csv"))?;
    assert!(record.contains("\n1,0.09999999999999998,0.2\n"), "{record}");
    assert!(fct(here, &["check", "a/specimen.toml"])?.status.success());
    Ok(())
}

#[test]
fn a_specimen_is_written_with_a_name_that_it_can_have() -> Tested {
    let folder = tempfile::tempdir()?;
    let here = folder.path();
    let sides = "[geometry]\nlength_mm = 8\nwidth_mm = 6\nthickness_mm = 1\n";
    fs::write(here.join("g.toml"), sides)?;
    fs::write(
        here.join("a.csv"),
        "Specimen: P7/23 <left>\nTime [s],Extension [mm],Load [N]\n0,0,0\n1,0.1,0.2\n2,0.2,0.4\n",
    )?;
    let (code, answer, stderr) = json(here, &["import", "a.csv", "--geometry", "g.toml"])?;
    assert_eq!((code, &answer["specimen"]), (0, &"P7-23 -left-".into()), "{stderr}");
    let (code, stderr) = message(here, &["check", "a/specimen.toml"])?;
    assert_eq!(code, Some(0), "{stderr}");
    fs::write(here.join("bad.toml"), format!("name = \"P7/23\"\n{sides}"))?;
    let (code, stderr) = message(here, &["import", "a.csv", "--geometry", "bad.toml", "--out", "b"])?;
    assert!(code == Some(2) && stderr.contains("bad.toml:1:8: error: `name` is \"P7/23\""), "{stderr}");
    assert!(!here.join("b").exists());
    Ok(())
}

/// What a geometry file says must be right, key by key; what it leaves out comes from the record's header, or is left to be
/// filled in, and then nothing is called complete.
#[test]
fn a_geometry_file_is_right_or_refused_and_may_be_a_part() -> Tested {
    let folder = tempfile::tempdir()?;
    let here = folder.path();
    let rows = "Time [s],Extension [mm],Load [N]\n0,0,0\n1,0.1,0.2\n2,0.2,0.4\n";
    fs::write(here.join("a.csv"), rows)?;
    fs::write(here.join("b.csv"), format!("Specimen width: 6.0 mm\nThickness: 0.8 mm\n{rows}"))?;
    for (geometry, expected) in [
        ("length_mm = -5", "g.toml:2:13: error: `length_mm` is -5; expected a number from"),
        (
            "lenght_mm = 5",
            "g.toml:2:1: error: unknown key `lenght_mm` in [geometry]; did you mean `length_mm`?",
        ),
        ("width_mm = \"6\"", "g.toml:2:12: error: `width_mm` is the text"),
        ("width_mm = 6\ncut_mm = 7", "g.toml:3:1: error: `cut_mm` is 7 mm, but the width is 6 mm"),
    ] {
        fs::write(here.join("g.toml"), format!("[geometry]\n{geometry}\n"))?;
        let (code, stderr) = message(here, &["import", "a.csv", "--geometry", "g.toml"])?;
        assert!(code == Some(2) && stderr.matches(expected).count() == 1, "{geometry}: {stderr}");
        assert!(!here.join("a").exists());
    }
    fs::write(here.join("g.toml"), "[geometry]\nlength_mm = 8\n")?;
    let (code, answer, stderr) = json(here, &["import", "a.csv", "--geometry", "g.toml"])?;
    assert_eq!((code, &answer["geometry_complete"]), (0, &false.into()), "{stderr}");
    let specimen = fs::read_to_string(here.join("a/specimen.toml"))?;
    assert!(specimen.contains("[geometry]\nlength_mm = 8\n# width_mm =     # along the tear"), "{specimen}");
    let (code, answer, stderr) = json(here, &["import", "b.csv", "--geometry", "g.toml"])?;
    assert_eq!((code, &answer["geometry_complete"]), (0, &true.into()), "{stderr}");
    let (code, stderr) = message(here, &["check", "b/specimen.toml", "--quick"])?;
    assert_eq!(code, Some(0), "{stderr}");
    Ok(())
}

#[test]
fn other_commands_point_to_import() -> Tested {
    let folder = tempfile::tempdir()?;
    let here = folder.path();
    let geometry = "[geometry]\nlength_mm = 8\nwidth_mm = 6\nthickness_mm = 1\n[[tests]]\nkind = \"uniaxial\"\ndata = \"a.csv\"\n";
    fs::write(here.join("s.toml"), geometry)?;
    for raw in [
        &b"Zeit;Weg;Kraft\n0;0;0\n"[..],
        b"Time,Load\n0,1\n",
        b"\xFF\xFEZ\0e\0",
        b"1,2,3\n",
        b"Pr\xFCfzeit\n",
    ] {
        fs::write(here.join("a.csv"), raw)?;
        let (code, stderr) = message(here, &["check", "s.toml"])?;
        assert!(code == Some(2) && stderr.contains("`fct import "), "{stderr}");
    }
    Ok(())
}

#[test]
fn a_long_record_is_kept_whole_or_thinned_out_with_the_whole_beside() -> Tested {
    let folder = tempfile::tempdir()?;
    let here = folder.path();
    // A cube modulo a prime is noise enough.
    let noise = |i: usize| ((i * i * i * 7919 % 1009) as f64 - 504.0) * 1e-5;
    let row = |i: usize, noise: f64| {
        format!("{},{},{}\n", i as f64 / 100.0, i as f64 / 2000.0, (i as f64 / 1000.0).powi(2) + noise)
    };
    let head = "Time [s],Extension [mm],Load [N]\n";
    fs::write(here.join("tear.csv"), (0..6000).fold(head.to_owned(), |t, i| t + &row(i, noise(i))))?;
    fs::write(here.join("quiet.csv"), (0..6000).fold(head.to_owned(), |t, i| t + &row(i, 0.0)))?;
    fs::write(
        here.join("g.toml"),
        "[geometry]\nlength_mm = 8\nwidth_mm = 6.0\nthickness_um = 800\ncut_mm = 1\n",
    )?;
    let (code, answer, stderr) =
        json(here, &["import", "tear.csv", "--geometry", "g.toml", "--points", "400"])?;
    assert_eq!(code, 0, "{stderr}");
    let test = &answer["tests"][0];
    assert_eq!((&test["kind"], &test["rows"]), (&"tearing".into(), &6000.into()));
    assert!(test["points"].as_u64().is_some_and(|n| (200..=400).contains(&n)), "{test}");
    let lines =
        |f: &str| fs::read_to_string(here.join(f)).map(|t| t.lines().filter(|l| !l.starts_with('#')).count());
    assert_eq!(lines("tear/full/tearing.csv")?, 6001);
    let specimen = fs::read_to_string(here.join("tear/specimen.toml"))?;
    assert!(specimen.contains("force_sd_N = "), "{specimen}");
    // On a mesh of few elements: what the record may show is not asked here.
    let checks = |specimen: &str| -> Result<bool, Box<dyn std::error::Error>> {
        let text = format!("specimen = \"{specimen}\"\n[mesh]\ndivisions = [4, 4, 1]\n");
        fs::write(here.join("check.toml"), text)?;
        Ok(fct(here, &["check", "check.toml"])?.status.success())
    };
    assert!(checks("tear/specimen.toml")?);
    // No noise shows: none is declared, and `check` takes the specimen.
    assert!(fct(here, &["import", "quiet.csv", "--geometry", "g.toml", "--points", "400"])?.status.success());
    assert!(!fs::read_to_string(here.join("quiet/specimen.toml"))?.contains("force_sd_N"));
    assert!(checks("quiet/specimen.toml")?);
    let all = json(here, &["import", "tear.csv", "--geometry", "g.toml", "--out", "all"])?.1;
    assert_eq!(all["tests"][0]["points"], 6000);
    Ok(())
}

#[test]
fn what_can_be_no_record_is_refused_at_once() -> Tested {
    let folder = tempfile::tempdir()?;
    let here = folder.path();
    fs::write(here.join("p.png"), b"\x89PNG\r\n\x1a\n0000")?;
    fs::write(here.join("a.zip"), b"PK\x03\x04\x14\0\0\0\0\0photo.jpg")?;
    fs::write(here.join("b.dat"), (0..200_000_u32).flat_map(u32::to_le_bytes).collect::<Vec<_>>())?;
    fs::write(here.join("e.csv"), b"")?;
    fs::File::create(here.join("big.csv"))?.set_len(10_000_000_000)?;
    for (file, what) in [
        ("p.png", "a picture (PNG)"),
        ("a.zip", "an archive"),
        ("b.dat", "a binary file"),
        ("e.csv", "empty"),
        ("big.csv", "10000 MB"),
        (".", "a directory"),
        ("none.csv", "no such file"),
        ("/dev/zero", "no regular file"),
    ] {
        let started = Instant::now();
        let (code, stderr) = message(here, &["import", file])?;
        assert!(code == Some(2) && stderr.contains(what), "{file}: {stderr}");
        assert!(started.elapsed() < Duration::from_secs(5), "{file}: {:?}", started.elapsed());
    }
    Ok(())
}

/// The page of the book: its commands run, and print what stands there.
#[test]
fn the_page_of_the_book_shows_what_is_printed() -> Tested {
    let folder = tempfile::tempdir()?;
    let here = folder.path();
    let mut printed = String::new();
    let mut compared = 0;
    for (head, lines) in blocks(&fs::read_to_string(Path::new(BOOK).join("how-to/import.md"))?) {
        for line in lines.iter().filter(|_| head == "console").filter_map(|l| l.strip_prefix("$ fct ")) {
            let out = fct(here, &line.split_whitespace().collect::<Vec<_>>())?;
            assert!(out.status.success(), "fct {line}: {}", String::from_utf8_lossy(&out.stderr));
            if line.starts_with("import ") {
                printed = String::from_utf8(out.stdout)?;
            }
        }
        if head == "text printed" {
            compared += 1;
            assert_eq!(lines.join("\n"), printed.trim_end());
        }
    }
    assert_eq!(compared, 1);
    Ok(())
}
