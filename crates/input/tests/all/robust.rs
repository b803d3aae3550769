//! No file can bring the reader down: not a folder, not garbage, not a line of 100 MB.

use crate::common;

use common::{Catalogue, STRIP};
use input::{edit, read_case, resolved_toml};
use proptest::prelude::*;
use std::fs;
use std::path::Path;
use std::time::{Duration, Instant};

thread_local! {
    /// One folder for all cases of a thread: making one costs more than reading.
    static FOLDER: tempfile::TempDir = tempfile::tempdir().expect("a folder");
}

/// The messages for these files, of which the first is the specimen; empty if they are right.
fn faults(files: &[(&str, &[u8])]) -> String {
    FOLDER.with(|folder| {
        for (name, bytes) in files {
            fs::write(folder.path().join(name), bytes).expect("written");
        }
        read_case(&folder.path().join(files[0].0), &Catalogue).map_or_else(
            |e| e.to_string(),
            |case| {
                assert!(!resolved_toml(&case).is_empty());
                String::new()
            },
        )
    })
}

/// The messages for a specimen file of these bytes; empty if it is right.
fn toml_faults(bytes: &[u8]) -> String {
    faults(&[("s.toml", bytes)])
}

/// The messages for a record of these bytes; empty if it is right.
fn csv_faults(bytes: &[u8]) -> String {
    let text = STRIP.replace("protocol = [{ to_mm = 4.0, rate_mm_per_s = 0.05 }]", "data = \"r.csv\"");
    faults(&[("s.toml", text.as_bytes()), ("r.csv", bytes)])
}

fn assert_quick(started: Instant) {
    assert!(started.elapsed() < Duration::from_secs(20), "took {:?}", started.elapsed());
}

#[test]
fn a_folder_a_missing_file_and_strange_names_are_told() {
    let folder = tempfile::tempdir().expect("a folder");
    fs::write(folder.path().join("specimen.toml"), STRIP).expect("written");
    let told = |path: &Path| read_case(path, &Catalogue).expect_err("an error").to_string();
    let message = told(folder.path());
    assert!(message.contains("this is a directory") && message.contains("specimen.toml`?"), "{message}");
    assert!(told(&folder.path().join("no.toml")).contains("no such file"));
    assert!(told(Path::new("a\0b")).contains("not a valid file name"));
    assert!(told(Path::new("")).contains("no such file"));
    assert!(told(&folder.path().join("specimen.toml/x")).contains("not a directory"));
    assert!(told(&folder.path().join("x".repeat(5000))).contains("cannot be read"));
}

#[test]
fn bytes_that_are_no_text_are_told_with_line_and_column() {
    let bad = toml_faults(b"name = \"a\"\n# caf\xE9\n");
    assert!(bad.contains("s.toml:2:6: error: invalid UTF-8: byte 0xE9"), "{bad}");
    assert!(
        csv_faults(b"time_s,displacement_mm,force_N\n0,0,\xFF\n").contains("r.csv:2:5: error: invalid UTF-8")
    );
    assert!(toml_faults(b"\xFF\xFEn\0").contains("UTF-16"));
    assert!(toml_faults(b"name = \"a\0b\"\n").contains("not valid TOML"));
    assert!(csv_faults(b"\0\0\0\0").contains("unknown column"));
}

#[test]
fn a_line_of_100_mb_does_not_hang() {
    let started = Instant::now();
    let mut line = b"time_s,displacement_mm,force_N\n".to_vec();
    line.resize(100_000_000, b',');
    let message = csv_faults(&line);
    assert!(message.contains("r.csv:2:1: error: this line has 99999969 bytes"), "{message}");
    let message = toml_faults(&line);
    assert!(
        message.contains("the file has 100.0 MB; expected a specimen or config file (TOML) of at most 10 MB")
    );
    let message = toml_faults(&line[..9_000_000]);
    assert!(message.contains("not valid TOML"), "{message}");
    assert_quick(started);
}

#[test]
fn a_file_too_large_is_refused_before_it_is_read() {
    let folder = tempfile::tempdir().expect("a folder");
    let text = STRIP.replace("protocol = [{ to_mm = 4.0, rate_mm_per_s = 0.05 }]", "data = \"r.csv\"");
    fs::write(folder.path().join("s.toml"), text).expect("written");
    let file = fs::File::create(folder.path().join("r.csv")).expect("created");
    file.set_len(50_000_000_000).expect("a sparse file");
    let message = read_case(&folder.path().join("s.toml"), &Catalogue).expect_err("an error").to_string();
    assert!(message.contains("the file has 50000.0 MB"), "{message}");
}

#[test]
fn many_keys_deep_nesting_and_endless_faults_end() {
    let started = Instant::now();
    let deep = format!("x = {}1{}", "[".repeat(100_000), "]".repeat(100_000));
    assert!(toml_faults(deep.as_bytes()).contains("not valid TOML"));
    let dotted = format!("{}x = 1\n", "a.".repeat(50_000));
    assert!(!toml_faults(dotted.as_bytes()).is_empty());
    let tables = format!("x = {}1{}", "{ a = ".repeat(5_000), "}".repeat(5_000));
    assert!(!toml_faults(tables.as_bytes()).is_empty());
    let inline: String = (0..50_000).map(|i| format!("k{i} = 1, ")).collect();
    let message = toml_faults(format!("{STRIP}[bulk]\nmu_kPa = {{ {inline} z = 1 }}\n").as_bytes());
    assert!(message.lines().count() < 500, "{} lines", message.lines().count());
    let keys: String = (0..500_000).map(|i| format!("key{i} = 1\n")).collect();
    assert!(toml_faults(format!("{STRIP}{keys}").as_bytes()).contains("only the first 100"));
    let twice = "name = 1\n".repeat(100_000);
    assert!(toml_faults(twice.as_bytes()).contains("given twice"));
    let legs: String = (0..15_000).map(|_| "5,").collect();
    assert!(toml_faults(STRIP.replace("{ hold_s = 60.0 }", &legs).as_bytes()).contains("only the first 100"));
    assert_quick(started);
}

/// A valid text with some bytes replaced, taken out or repeated.
fn mutated(text: &'static str) -> impl Strategy<Value = Vec<u8>> {
    let change = (0..text.len(), any::<u8>(), 0..3u8);
    proptest::collection::vec(change, 1..6).prop_map(move |changes| {
        let mut bytes = text.as_bytes().to_vec();
        for (at, byte, how) in changes {
            let at = at.min(bytes.len().saturating_sub(1));
            match how {
                0 => bytes[at] = byte,
                1 => drop(bytes.remove(at)),
                _ => bytes.insert(at, byte),
            }
        }
        bytes
    })
}

const CONFIG: &str = "\
name = \"c\"
geometry = { length_mm = 10.0, width_mm = 6.0, thickness_mm = 0.8, outline_mm = [[0, 0, 6], [10, 0, 6]] }
[[tests]]
kind = \"tearing\"
protocol = [{ to_mm = 2.0, rate_mm_per_s = 0.05 }, { hold_s = 60.0 }]
[bulk]
mu_kPa = { start = 5.1, min = 1, max = 9, fixed = true }
kappa = 0.2
[interface]
areas = 2
gc_N_per_mm = [0.1, { start = 0.2 }]
[effects.viscoelastic]
g = 0.2
tau_s = 1e1
[identify]
priors.bulk.k2 = { mean = 3, relative_sd = 0.5 }
[output]
fields = 3
figures = [\"svg\"]
";

const RECORD: &str = "# c\ntime_s,displacement_mm,force_mN,segment,tear_front_mm\n0,0,0,load,\n1,0.5,2,\"a,b\",1.5\n2,1,3,,2\n";

/// How many cases: `FCT_CASES`, or the few of every day.
fn cases(usual: u32) -> u32 {
    std::env::var("FCT_CASES").ok().and_then(|n| n.parse().ok()).unwrap_or(usual)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: cases(400), ..ProptestConfig::default() })]

    #[test]
    fn arbitrary_bytes_never_panic(bytes in proptest::collection::vec(any::<u8>(), 0..300)) {
        toml_faults(&bytes);
        csv_faults(&bytes);
    }

    #[test]
    fn arbitrary_text_never_panics(text in "[\\PC\n=\\[\\]{}\",.#0-9]{0,200}") {
        toml_faults(text.as_bytes());
        csv_faults(text.as_bytes());
        let _ = edit::add_effect(&text, "slack", &[("u0_mm", 0.1, "why\nnot")], &text);
        let _ = edit::drop_effect(&text, "slack", &text);
        let _ = edit::set_parent(&text, &text);
        let _ = edit::rebase(&text, Path::new("/a"), Path::new("/b"), true);
    }

    #[test]
    fn damaged_configs_never_panic(bytes in mutated(CONFIG)) {
        let message = toml_faults(&bytes);
        prop_assert!(!message.bytes().any(|b| b == 0x1b));
    }

    #[test]
    fn damaged_records_never_panic(bytes in mutated(RECORD)) {
        let message = csv_faults(&bytes);
        prop_assert!(!message.bytes().any(|b| b == 0x1b));
    }
}

#[test]
fn what_is_damaged_in_these_tests_is_right_before() {
    assert_eq!(toml_faults(CONFIG.as_bytes()), "");
    assert_eq!(csv_faults(RECORD.as_bytes()), "");
}
