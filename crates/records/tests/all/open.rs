//! What a file does not settle is asked with its flag; what is wrong is told with row, column and remedy.

use crate::common;

use common::{HEAD, Look, import, read, told};
use records::{FaultKind, Import, ImportError};

/// Flags of the questions that a file leaves open.
fn asked(text: &str, flags: &[(&str, &str)]) -> Vec<String> {
    match import("a.csv", text.as_bytes(), flags) {
        Err(ImportError::Undecided { questions, .. }) => questions.into_iter().map(|q| q.flag).collect(),
        Err(other) => panic!("{other}"),
        Ok(_) => Vec::new(),
    }
}

#[test]
fn nothing_is_guessed() {
    let rows = Look::PLAIN.table();
    let with = |head: &str| format!("{head}\n{rows}");
    assert_eq!(asked(&with("Time [s],Extension [mm],Load"), &[]), ["units"]);
    assert_eq!(asked(&with("Time,Extension,Load"), &[]), ["units", "units", "units"]);
    assert_eq!(asked(&with("Time [s],Extension [mm],Channel 7"), &[]), ["force"]);
    assert_eq!(asked(&with("Elapsed,Extension [mm],Load [N]"), &[]), ["time"]);
    assert_eq!(asked(&with("Clock,Way,Pull"), &[]), ["time", "displacement", "force"]);
    assert_eq!(asked(&with("Time [s],Load [N],Force [N]"), &[]).len(), 2);
    assert_eq!(asked(&with("Time [s],Strain,Load [N]"), &[("geometry", "")]), ["units"]);
    assert_eq!(asked(&with("Time [s],Extension [V],Load [N]"), &[]), ["units"]);
    assert_eq!(asked(&with("Time [s],Extension [mm],Load [N]"), &[]), Vec::<String>::new());
    // 1,234 may be a thousand or a bit more than one.
    let either: String = (1..9).map(|i| format!("{i},000;{i},125;{i},500\n")).collect();
    let either = format!("Time [s];Extension [mm];Load [N]\n{either}");
    assert_eq!(asked(&either, &[]), ["decimal"]);
    assert_eq!(read(&either, &[("decimal", ",")]).tests[0].full.force[1], 2.5);
    assert_eq!(read(&either, &[("decimal", ".")]).tests[0].full.force[1], 2500.0);
    let message = told(&with("Time [s],Extension [mm],Load"), &[]);
    assert!(message.contains("a.csv: error: column 3 `Load` (the force) has no unit"), "{message}");
    assert!(message.contains("--units force=N"), "{message}");
}

#[test]
fn two_columns_that_fit_are_asked_for() {
    let rows = Look::PLAIN.rows(|i, [t, u, f]| vec![t, u, format!("{i}"), f]);
    let text = format!("Time [s],Standardweg [mm],Traversenweg [mm],Load [N]\n{rows}");
    let message = told(&text, &[]);
    assert!(message.contains("2 columns could be the displacement"), "{message}");
    assert!(message.contains("--displacement 2") && message.contains("`Traversenweg [mm]`"), "{message}");
    assert_eq!(read(&text, &[("displacement", "3")]).tests[0].full.displacement[4], 4.0);
    let message = told(&text, &[("displacement", "Weg")]);
    assert!(message.contains("names no column") && message.contains("2 `Standardweg [mm]`"), "{message}");
}

/// A deformation in mm is a displacement, whatever the word means elsewhere.
#[test]
fn a_strain_in_millimetres_is_a_displacement() {
    let test = &read("Time [s],Dehnung [mm],Load [N]\n0,0,0\n1,0.5,1\n2,1,2\n", &[]).tests[0];
    assert_eq!(test.full.displacement, [0.0, 0.5, 1.0]);
}

#[test]
fn commas_for_everything_are_told() {
    let text =
        "Time [s],Extension [mm],Load [N]\n0,0,0,00,0,12\n0,5,0,02,0,34\n1,0,0,05,0,55\n1,5,0,07,0,77\n";
    assert!(told(text, &[]).contains("commas both between cells and in numbers"), "{}", told(text, &[]));
}

#[test]
fn a_rate_stands_for_the_time_of_a_motion_that_never_stops() {
    let rows = "0,0\n0.1,1\n0.3,2\n0.1,1\n";
    let text = format!("Extension [mm],Load [N]\n{rows}");
    let close =
        |a: &[f64], b: &[f64]| a.len() == b.len() && a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-12);
    assert!(close(&read(&text, &[("rate", "0.1")]).tests[0].full.time, &[0.0, 1.0, 3.0, 5.0]));
    assert!(close(&read(&text, &[("rate", "6 mm/min")]).tests[0].full.time, &[0.0, 1.0, 3.0, 5.0]));
    let message = told("Extension [mm],Load [N]\n0,0\n0.1,1\n0.1,1\n0.2,3\n", &[("rate", "0.1")]);
    assert!(message.contains("a.csv:4: error") && message.contains("--frequency HZ"), "{message}");
}

#[test]
fn all_faults_are_told_at_once() {
    let text = format!("{HEAD}0,0,0.1\n1,abc,0.2\n2,0.2,x y\n3,0.3,0.4\n4,0.4,0.5\n5,0.5,0.6\n");
    let message = told(&text, &[]);
    assert!(message.contains("a.csv:3:2: error: `Extension [mm]` is `abc`; expected a number"), "{message}");
    assert!(message.contains("a.csv:4:3: error: `Load [N]` is `x y`"), "{message}");
    assert!(message.contains("--drop unreadable"), "{message}");
    let left = read(&text, &[("drop", "unreadable")]);
    assert_eq!((left.tests[0].full.row.clone(), left.faults[0].count), (vec![2, 5, 6, 7], 2));
}

/// Many good rows, some replaced.
fn record(change: impl Fn(usize) -> Option<[String; 3]>) -> String {
    let row = |i: usize| {
        let good = [
            format!("{}", i as f64 / 4.0),
            format!("{}", i as f64 / 100.0),
            format!("{}", (i * i) as f64 / 1000.0),
        ];
        change(i).unwrap_or(good).join(",") + "\n"
    };
    format!("{HEAD}{}", (0..200).map(row).collect::<String>())
}

fn kinds(read: &Import) -> Vec<(FaultKind, usize, &'static str)> {
    read.faults.iter().chain(&read.tests[0].faults).map(|f| (f.kind, f.count, f.rule)).collect()
}

#[test]
fn faults_of_rows_are_counted_with_their_rule() {
    let s = |a: &str, b: &str, c: &str| Some([a.to_owned(), b.to_owned(), c.to_owned()]);
    let clean = read(&record(|_| None), &[]);
    assert_eq!((kinds(&clean), clean.tests[0].full.row.len()), (vec![], 200));
    // A turn between two rows is no spike, however far apart they are.
    let turn =
        |i: usize| [i as f64, 20.0 - (i as f64 - 20.0).abs(), 400.0 - (i as f64 - 20.0).powi(2).min(400.0)];
    let rows: String = (0..41).map(turn).map(|[t, u, f]| format!("{t},{u},{f}\n")).collect();
    assert_eq!(kinds(&read(&format!("{HEAD}{rows}"), &[])), []);
    let blank = read(&record(|i| if i == 7 || i == 90 { s("22.5", "NaN", "") } else { None }), &[]);
    assert_eq!(kinds(&blank), [(FaultKind::Missing, 2, "dropped")]);
    assert_eq!(blank.faults[0].rows, [9, 92]);
    let twice = read(&record(|i| if i == 41 { s("10", "0.4", "1.6") } else { None }), &[]);
    assert_eq!(kinds(&twice), [(FaultKind::Repeated, 1, "dropped")]);
    assert!(twice.faults[0].what.contains("(1 the same in all"), "{}", twice.faults[0].what);
    let other = read(&record(|i| if i == 41 { s("10", "0.4", "1.7") } else { None }), &[]);
    assert!(other.faults[0].what.contains("(0 the same in all"), "{}", other.faults[0].what);
    assert_eq!(other.tests[0].full.force[40], 1.6);
    let back = read(&record(|i| if i == 50 { s("3", "0.5", "2.5") } else { None }), &[]);
    assert_eq!(kinds(&back), [(FaultKind::Backward, 1, "dropped")]);
    let ahead = read(&record(|i| if i == 50 { s("999", "0.5", "2.5") } else { None }), &[]);
    assert_eq!(
        (kinds(&ahead), ahead.faults[0].rows.clone()),
        (vec![(FaultKind::Backward, 1, "dropped")], vec![52])
    );
    let spike =
        |flags: &[(&str, &str)]| read(&record(|i| if i == 60 { s("15", "0.6", "33") } else { None }), flags);
    assert_eq!(kinds(&spike(&[])), [(FaultKind::Spike, 1, "kept")]);
    assert_eq!(spike(&[("drop", "spike")]).tests[0].full.row.len(), 199);
    let gap = read(
        &record(|_| None)
            .replace("\n20,0.8,", "\n#20,0.8,")
            .replace("\n20.25,", "\n#")
            .replace("\n20.5,", "\n#"),
        &[],
    );
    assert_eq!(kinds(&gap), [(FaultKind::Gap, 1, "kept")]);
    let clip = |flags: &[(&str, &str)]| {
        let limit = |i: usize| {
            if i >= 150 {
                Some([format!("{}", i as f64 / 4.0), format!("{}", i as f64 / 100.0), "22.5".into()])
            } else {
                None
            }
        };
        read(&record(limit), flags)
    };
    assert_eq!(kinds(&clip(&[])), [(FaultKind::Clipped, 50, "kept")]);
    assert_eq!(clip(&[("drop", "clipped")]).tests[0].full.row.len(), 150);
    let coarse = read(&record(|i| Some([format!("{i}"), format!("{i}"), format!("{}", (i / 10) * 2)])), &[]);
    assert!(kinds(&coarse).iter().any(|k| k.0 == FaultKind::Quantised), "{:?}", kinds(&coarse));
    // Few rows have few values.
    let few: String = (0..48).map(|i| format!("{i},{i},{}\n", (i / 10) * 2)).collect();
    assert_eq!(kinds(&read(&format!("{HEAD}{few}"), &[])), []);
    // Too many blanks are no accident.
    let many = record(|i| if i % 5 == 0 { s(&format!("{}", i as f64 / 4.0), "", "1") } else { None });
    assert!(told(&many, &[]).contains("a.csv:2:2: error: `Extension [mm]` is blank"), "{}", told(&many, &[]));
    assert_eq!(read(&many, &[("drop", "missing")]).tests[0].full.row.len(), 160);
}

#[test]
fn a_clock_that_starts_again_is_asked_about() {
    let rows: String =
        (0..30).map(|i| format!("{},{},{}\n", i % 10, i % 10, (i % 10) * 2 + i / 10)).collect();
    let text = format!("{HEAD}{rows}");
    assert_eq!(asked(&text, &[]), ["restart"]);
    let split = read(&text, &[("restart", "split")]);
    assert_eq!(split.tests.iter().map(|t| t.file_rows).collect::<Vec<_>>(), [(2, 11), (12, 21), (22, 31)]);
    let append = read(&text, &[("restart", "append")]);
    assert_eq!(append.tests[0].full.time, (0..30).map(f64::from).collect::<Vec<_>>());
}

#[test]
fn what_is_no_table_is_refused() {
    for (text, what) in [
        ("", "no table"),
        ("hello\nworld\n", "no table"),
        ("Time [s],Load [N]\n", "no table"),
        (&format!("{HEAD}0,0,0\n1,0,1\n2,0,2\n3,0,3\n"), "expected a test that moves"),
        ("{\"time\": [1, 2, 3]}\n", "no table"),
    ] {
        assert!(told(text, &[]).contains(what), "{text:?}: {}", told(text, &[]));
    }
}
