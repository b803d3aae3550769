//! Dimensions: a file's in any unit, before those of a record's header; a specimen file has what is known.

use crate::common::{HEAD, import};
use records::{Geometry, ImportError, specimen};
use std::fs;
use std::path::Path;

fn geometry(folder: &Path, text: &str) -> Geometry {
    let file = folder.join("g.toml");
    fs::write(&file, text).expect("written");
    Geometry::read(&file).expect("a geometry")
}

#[test]
fn dimensions_are_lengths_in_any_unit() {
    let folder = tempfile::tempdir().expect("a folder");
    let read = |text: &str| geometry(folder.path(), text);
    let g = read("[geometry]\nlength_cm = 1\nwidth_mm = 6.5\nthickness_um = 800\ncut_mm = 0\n");
    assert_eq!([g.length, g.width, g.thickness, g.cut], [Some(10.0), Some(6.5), Some(0.8), Some(0.0)]);
    assert!(g.is_complete() && g.name.is_none());
    // A profile beside the thickness is not the thickness.
    let g = read("name = \"A 7\"\n[geometry]\nthickness_um = 800\nthickness_profile = [[0, 1], [10, 1]]\n");
    assert_eq!((g.thickness, g.name.as_deref(), g.is_complete()), (Some(0.8), Some("A 7"), false));
    for two in
        ["length_mm = 9\nwidth_mm = 6", "length_mm = 9\nthickness_mm = 1", "width_mm = 6\nthickness_mm = 1"]
    {
        assert!(!read(&format!("[geometry]\n{two}\n")).is_complete(), "{two}");
    }
    for none in ["length_mm = 0", "length_mm = -1.0", "length_mm = nan", "length_s = 1", "length_mm = \"1\""]
    {
        assert_eq!(read(&format!("[geometry]\n{none}\n")).length, None, "{none}");
    }
}

#[test]
fn what_is_no_geometry_is_named_with_its_file() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("g.toml");
    for (text, expected) in [
        (None, "g.toml: error: --geometry: "),
        (Some("length_mm = 1\n"), "no [geometry] table; expected length_mm, width_mm, thickness_mm"),
        (Some("[geometry\n"), "not valid TOML"),
    ] {
        let _ = fs::remove_file(&file);
        if let Some(text) = text {
            fs::write(&file, text).expect("written");
        }
        let message = Geometry::read(&file).map_err(|e| e.to_string()).expect_err("no geometry");
        assert!(message.contains(expected), "{message}");
    }
}

#[test]
fn a_specimen_has_what_is_known_and_asks_for_the_rest() {
    let folder = tempfile::tempdir().expect("a folder");
    let rows = format!("Width: 6.0 mm\nThickness: 0.8 mm\n{HEAD}0,0,0\n1,1,2\n2,2,4\n");
    let choices = records::Choices::new();
    let name = Path::new("a.csv");
    let mut g =
        geometry(folder.path(), "[geometry]\nlength_mm = 10\nwidth_mm = 5\noutline = \"edges.csv\"\n");
    let read = records::import_bytes(name, rows.into_bytes(), &choices, &mut g).expect("read");
    assert_eq!([g.length, g.width, g.thickness, g.cut], [Some(10.0), Some(5.0), Some(0.8), None]);
    assert!(read.remarks.iter().any(|r| r.contains("the header says width 6 mm; 5 mm was taken")));
    let text = specimen("a", "", &g, &[]);
    let table: toml::Table = toml::from_str(&text).expect("TOML");
    let written = &table["geometry"];
    assert_eq!(written["width_mm"].as_integer(), Some(5));
    assert_eq!(written["thickness_mm"].as_float(), Some(0.8));
    let edges = written["outline"].as_str().expect("a file");
    assert_eq!(Path::new(edges), folder.path().join("edges.csv"));
    // Nothing known: all four are asked for.
    let text = specimen("a", "", &Geometry::default(), &[]);
    assert_eq!(text.matches("fill it in").count(), 4, "{text}");
    let bare = geometry(folder.path(), "[geometry]\nwidth_mm = 5\n");
    let text = specimen("a", "", &bare, &[]);
    assert!(text.contains("# length_mm =") && text.contains("# thickness_mm ="), "{text}");
    assert_eq!(text.matches("fill it in").count(), 2, "{text}");
}

/// A file that is not there, a folder, and one that has no record are told apart.
#[test]
fn files_that_cannot_be_read_are_named() {
    let folder = tempfile::tempdir().expect("a folder");
    let choices = records::Choices::new();
    let told = |path: &Path| {
        let read = records::import(path, &choices, &mut Geometry::default());
        read.map(|_| ()).expect_err("no record").to_string()
    };
    let message = told(&folder.path().join("a.csv"));
    assert!(
        message.contains("a.csv: error: no such file; expected the file that the testing machine wrote"),
        "{message}"
    );
    assert!(told(folder.path()).contains("director"), "{}", told(folder.path()));
    fs::write(folder.path().join("b.csv"), "").expect("written");
    assert!(told(&folder.path().join("b.csv")).contains("the file is empty"));
    assert!(told(&folder.path().join("b.csv/c")).contains("not a directory"));
}

/// A unit that measures something else is asked about, not taken; every question has a line of its own.
#[test]
fn a_unit_of_another_kind_is_asked_about() {
    let text = "Time [s],Extension [mm],Load\n0,0,0\n1,1,2\n2,2,4\n";
    let asked = import("a.csv", text.as_bytes(), &[("units", "force=mm")]);
    let Err(error @ ImportError::Undecided { .. }) = asked else { panic!("taken: {asked:?}") };
    let message = error.to_string();
    assert!(message.contains("the unit `mm` of column 3 `Load` is none of a force"), "{message}");
    let both =
        import("a.csv", text.replace(" [mm]", "").as_bytes(), &[]).map(|_| ()).expect_err("two questions");
    let message = both.to_string();
    assert_eq!(message.lines().filter(|l| l.starts_with("a.csv: error: column ")).count(), 2, "{message}");
}
