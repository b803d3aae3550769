//! One record in every dialect: each file of `tests/data` gives the same numbers to the last bit.

use crate::common;

use common::{import, pull, twin, variants};
use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

const DATA: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data");

/// `UPDATE=1` writes the files anew from `common/variants.rs`.
#[test]
fn the_files_are_what_the_helper_writes() -> std::io::Result<()> {
    let all = variants::all();
    for variant in &all {
        let file = Path::new(DATA).join(variant.file);
        if std::env::var_os("UPDATE").is_some() {
            fs::write(&file, &variant.bytes)?;
        }
        let stands = fs::read(&file).unwrap_or_default();
        assert!(stands == variant.bytes, "{}: UPDATE=1 cargo test -p records dialects::", file.display());
    }
    let names: BTreeSet<&str> = all.iter().map(|v| v.file).collect();
    let dialects: BTreeSet<&str> = all.iter().map(|v| v.dialect).collect();
    assert!(names.len() == all.len() && names.len() >= 60, "{} files", names.len());
    assert!(dialects.len() >= 9, "{dialects:?}");
    Ok(())
}

#[test]
fn every_file_holds_the_same_record() {
    let [time, displacement, force] = twin();
    let mut wrong = Vec::new();
    for variant in variants::all() {
        let read = match import(variant.file, &variant.bytes, variant.flags) {
            Ok(read) => read,
            Err(error) => {
                wrong.push(format!("{error}"));
                continue;
            }
        };
        let name = variant.file;
        if read.reading.dialect != variant.dialect {
            wrong.push(format!("{name}: taken for {}, is {}", read.reading.dialect, variant.dialect));
        }
        let [test] = read.tests.as_slice() else {
            wrong.push(format!("{name}: {} tests", read.tests.len()));
            continue;
        };
        // A strain times a length is rounded once more.
        let exact = !variant.flags.iter().any(|f| f.0 == "geometry");
        for (channel, expected, what) in [
            (&test.full.time, &time, "time"),
            (&test.full.displacement, &displacement, "displacement"),
            (&test.full.force, &force, "force"),
        ] {
            let same = |(a, b): (&f64, &f64)| if exact { a == b } else { (a - b).abs() < 1e-12 };
            if channel.len() != expected.len() || !channel.iter().zip(expected).all(same) {
                let at = channel.iter().zip(expected).position(|p| !same(p));
                wrong.push(format!(
                    "{name}: {what} differs at {at:?}: {:?}",
                    at.map(|k| (channel[k], expected[k]))
                ));
            }
        }
    }
    assert!(wrong.is_empty(), "{} wrong:\n{}", wrong.len(), wrong.join("\n"));
}

#[test]
fn segments_and_cameras_come_along() {
    let labels = |file: &str| {
        let variant = variants::all().into_iter().find(|v| v.file == file).expect("a file");
        import(file, &variant.bytes, variant.flags).expect("read").tests[0].segments.clone()
    };
    assert_eq!(labels("cellscale.csv"), ["1-Stretch", "1-Hold", "1-Recover"]);
    assert_eq!(labels("steps.csv"), ["1", "2", "3", "4"]);
    assert_eq!(labels("mts-blocks.dat"), ["table 1", "table 2"]);
    assert_eq!(labels("bluehill-cyclic.csv"), ["22476 0", "22476 1", "22477 2", "22477 3"]);
    assert!(labels("bluehill.csv").is_empty());
    let variant = variants::all().into_iter().find(|v| v.file == "camera.csv").expect("a file");
    let test = import("camera.csv", &variant.bytes, &[]).expect("read").tests.remove(0);
    let [None, Some(front), Some(width)] = &test.full.camera else { panic!("{:?}", test.full.camera) };
    assert!(front[0] == 1.0 && front[1].is_nan() && front[3] == 1.3 && width[7] == -0.007);
    let csv = test.csv(&["from a camera".into()]);
    let mut lines = csv.lines();
    assert_eq!(lines.next(), Some("# from a camera"));
    assert_eq!(lines.next(), Some("time_s,displacement_mm,force_N,tear_front_mm,width_change_mm"));
    assert_eq!(lines.next(), Some("0,0,0.0012,1,0"));
    assert_eq!(lines.next(), Some("0.5,0.125,0.0043,,-0.001"));
    assert_eq!(lines.count() + 2, pull().len());
}

/// Cells of a sheet are cells, whatever the user says of files that are texts.
#[test]
fn a_sheet_needs_no_delimiter() {
    let variant = variants::all().into_iter().find(|v| v.file == "book.xlsx").expect("a file");
    let flags = [variant.flags, &[("delimiter", ";")]].concat();
    let read = import("book.xlsx", &variant.bytes, &flags).expect("read");
    assert_eq!(read.tests[0].full.force, twin()[2]);
}

#[test]
fn headers_fill_the_geometry() {
    for (file, expected) in [
        ("bluehill.csv", [Some(10.0), Some(6.0), Some(0.8)]),
        ("testxpert.tra", [None, Some(6.0), Some(0.8)]),
        ("deben.mtr", [Some(10.0), Some(6.0), Some(0.8)]),
        ("book.xlsx", [None, Some(6.0), None]),
    ] {
        let variant = variants::all().into_iter().find(|v| v.file == file).expect("a file");
        let mut geometry = records::Geometry::default();
        let choices = records::Choices::new();
        records::import_bytes(Path::new(file), variant.bytes, &choices, &mut geometry).expect("read");
        assert_eq!([geometry.length, geometry.width, geometry.thickness], expected, "{file}");
        assert_eq!(geometry.name.as_deref(), Some("A 7"), "{file}");
    }
}

/// Two actuators and two load cells: what is along y is the displacement and the force, what is along x stands beside them.
#[test]
fn both_axes_of_a_biaxial_test_are_read() {
    let read = |name: &str, text: &[u8], flags: &[(&str, &str)]| {
        let mut choices = records::Choices { two_axes: true, ..records::Choices::new() };
        for (flag, value) in flags {
            choices.answer(flag, value).expect("a flag");
        }
        records::import_bytes(Path::new(name), text.to_vec(), &choices, &mut records::Geometry::default())
    };
    let [time, displacement, force] = twin();
    let rows = |cells: &dyn Fn(usize) -> String| -> String {
        (0..time.len()).map(|i| format!("{},{}\n", time[i], cells(i))).collect()
    };
    let (u, f) = (&displacement, &force);
    let named = [
        (
            "Time (s),Fx (N),Fy (N),Ux (mm),Uy (mm)\n",
            rows(&|i| format!("{},{},{},{}", 2.0 * f[i], f[i], 0.5 * u[i], u[i])),
        ),
        (
            "time_s,displacement_mm,force_N,displacement_x_mm,force_x_N\n",
            rows(&|i| format!("{},{},{},{}", u[i], f[i], 0.5 * u[i], 2.0 * f[i])),
        ),
        (
            "Time [s],X Displacement [mm],Y Displacement [mm],X Force [N],Y Force [N]\n",
            rows(&|i| format!("{},{},{},{}", 0.5 * u[i], u[i], 2.0 * f[i], f[i])),
        ),
    ];
    for (head, body) in &named {
        let test = read("both.csv", format!("{head}{body}").as_bytes(), &[]).expect(head).tests.remove(0);
        assert_eq!((&test.full.displacement, &test.full.force), (u, f), "{head}");
        let [Some(across), Some(force_x)] = &test.full.across else { panic!("{head}") };
        assert!(across.iter().zip(u).all(|(x, u)| *x == 0.5 * u), "{head}");
        assert!(force_x.iter().zip(f).all(|(x, f)| *x == 2.0 * f), "{head}");
        let csv = test.csv(&[]);
        assert!(csv.starts_with("time_s,displacement_mm,force_N,displacement_x_mm,force_x_N\n"), "{head}");
    }
    // A testing machine's own file; its sizes are no displacements.
    let cellscale = fs::read(Path::new(DATA).join("cellscale-biaxial.csv")).expect("a file");
    let columns = read("cellscale-biaxial.csv", &cellscale, &[]).expect("read").reading.columns;
    let names: Vec<&str> = columns.iter().map(|c| c.name.as_str()).collect();
    for (role, name) in [
        (records::words::Role::Displacement, "YDisplacement_um"),
        (records::words::Role::Force, "YForce_mN"),
        (records::words::Role::DisplacementX, "XDisplacement_um"),
        (records::words::Role::ForceX, "XForce_mN"),
    ] {
        assert!(columns.iter().any(|c| c.role == role && c.name == name), "{role:?} of {names:?}");
    }
    // What is missing is asked for by its flag, and can be named.
    let one = format!(
        "Time (s),F1 (N),Fy (N),Ux (mm),Uy (mm)\n{}",
        rows(&|i| format!("{},{},{},{}", 2.0 * f[i], f[i], u[i], u[i]))
    );
    let Err(records::ImportError::Undecided { questions, .. }) = read("f1.csv", one.as_bytes(), &[]) else {
        panic!("a force along x was guessed")
    };
    assert_eq!(questions.iter().map(|q| q.flag.as_str()).collect::<Vec<_>>(), ["force-x"]);
    assert!(read("f1.csv", one.as_bytes(), &[("force-x", "F1 (N)")]).is_ok());
}
