//! Any table written in any dialect is read back to the last bit; nothing damaged brings the reader down.

use crate::common;

use common::{decimal, encoded, import, variants};
use encoding_rs::{Encoding, UTF_8, UTF_16BE, UTF_16LE, WINDOWS_1252};
use proptest::prelude::*;
use records::ImportError;

/// How a table is written.
#[derive(Clone, Debug)]
struct Style {
    delimiter: char,
    mark: char,
    group: bool,
    quote: bool,
    ending: &'static str,
    encoding: &'static Encoding,
    bom: bool,
    /// Names with units in them, a row of units, or names in a sentence.
    names: u8,
    /// Power of ten of force and displacement unit against mN and µm.
    larger: bool,
    preamble: u8,
}

fn styles() -> impl Strategy<Value = Style> {
    let marks = prop_oneof![
        Just((',', '.')),
        Just((';', '.')),
        Just((';', ',')),
        Just(('\t', '.')),
        Just(('\t', ',')),
        Just((' ', '.')),
        Just((' ', ',')),
        Just(('|', ',')),
        Just((',', ',')),
    ];
    let encodings = prop_oneof![Just(UTF_8), Just(UTF_16LE), Just(UTF_16BE), Just(WINDOWS_1252)];
    let endings = prop_oneof![Just("\n"), Just("\r\n"), Just("\r")];
    (marks, any::<[bool; 4]>(), endings, encodings, 0..3_u8, 0..3_u8).prop_map(
        |((delimiter, mark), [group, quote, bom, larger], ending, encoding, names, preamble)| Style {
            delimiter,
            mark,
            // Blanks separate cells there; a comma that groups where a comma separates needs quotes.
            group: group && delimiter != ' ',
            quote: quote || (delimiter == ',' && (mark == ',' || group)),
            ending,
            encoding,
            bom,
            names,
            larger,
            preamble,
        },
    )
}

/// Rows in ms, nm and µN; time grows.
fn tables() -> impl Strategy<Value = Vec<[i64; 3]>> {
    let row = (1..5_000_i64, -9_000_000..9_000_000_i64, -9_000_000..9_000_000_i64);
    proptest::collection::vec(row, 4..40).prop_map(|rows| {
        let mut t = 0;
        rows.into_iter()
            .map(|(dt, u, f)| {
                t += dt;
                [t, u, f]
            })
            .collect()
    })
}

fn written(rows: &[[i64; 3]], style: &Style) -> Vec<u8> {
    let units = if style.larger { ["s", "mm", "N"] } else { ["ms", "um", "mN"] };
    let places = if style.larger { [3, 6, 6] } else { [0, 3, 3] };
    let names = ["Zeit", "Längenänderung", "Kraft"];
    let between = style.delimiter.to_string();
    let line = |cells: Vec<String>| cells.join(&between) + style.ending;
    let mut text = match style.preamble {
        0 => String::new(),
        1 => format!("Prüfprotokoll{e}Probe: A 7{e}{e}", e = style.ending),
        _ => format!("# written by a test, for tests; nothing else{e}", e = style.ending),
    };
    // Blanks separate cells: a name is one word then.
    let joined = |open: &str, close: &str| {
        line(names.iter().zip(units).map(|(n, u)| format!("{n}{open}{u}{close}")).collect())
    };
    text += &match (style.names, style.delimiter) {
        (0, _) | (2, ' ') => joined("[", "]"),
        (1, _) => {
            line(names.iter().map(|n| (*n).to_owned()).collect())
                + &line(units.iter().map(|u| (*u).to_owned()).collect())
        }
        _ => joined(" in ", ""),
    };
    let group = style.group.then_some(if style.mark == '.' { ',' } else { '.' });
    let group = if style.delimiter == ',' && !style.quote { None } else { group };
    let quote = if style.quote { "\"" } else { "" };
    for row in rows {
        let cell = |k: usize| format!("{quote}{}{quote}", decimal(row[k], places[k], style.mark, group));
        text += &line((0..3).map(cell).collect());
    }
    encoded(&text, style.encoding, style.bom)
}

/// How many cases: `FCT_CASES`, or the few of every day.
fn cases(usual: u32) -> u32 {
    std::env::var("FCT_CASES").ok().and_then(|n| n.parse().ok()).unwrap_or(usual)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: cases(400), ..ProptestConfig::default() })]

    #[test]
    fn any_table_in_any_dialect_is_read_back(rows in tables(), style in styles()) {
        prop_assume!(rows.iter().any(|r| r[1] != rows[0][1]));
        let bytes = written(&rows, &style);
        let mut read = import("a.csv", &bytes, &[]);
        // 1.234 alone settles no decimal mark, and must be asked about: never taken wrongly.
        if let Err(ImportError::Undecided { questions, .. }) = &read {
            let flags: Vec<&str> = questions.iter().map(|q| q.flag.as_str()).collect();
            prop_assert_eq!(flags, ["decimal"]);
            read = import("a.csv", &bytes, &[("decimal", &style.mark.to_string())]);
        }
        let read = read.map_err(|e| TestCaseError::fail(format!("{e}\n{}", String::from_utf8_lossy(&bytes))))?;
        let number = |x: i64, places| decimal(x, places, '.', None).parse::<f64>().expect("a number");
        let full = &read.tests[0].full;
        prop_assert_eq!(&full.time, &rows.iter().map(|r| number(r[0], 3)).collect::<Vec<_>>());
        prop_assert_eq!(&full.displacement, &rows.iter().map(|r| number(r[1], 6)).collect::<Vec<_>>());
        prop_assert_eq!(&full.force, &rows.iter().map(|r| number(r[2], 6)).collect::<Vec<_>>());
    }

    #[test]
    fn arbitrary_bytes_never_panic(bytes in proptest::collection::vec(any::<u8>(), 0..400)) {
        let _ = import("a.csv", &bytes, &[]);
    }

    #[test]
    fn arbitrary_text_never_panics(text in "[\\PC\n\t=\\[\\]\",.;:0-9 e+-]{0,300}") {
        let _ = import("a.csv", text.as_bytes(), &[]);
        let _ = import("a.csv", text.as_bytes(), &[("time", "1"), ("displacement", "2"), ("force", "2"), ("units", "time=s,displacement=mm,force=N")]);
    }

    #[test]
    fn damaged_files_never_panic(which in 0..1000_usize, changes in proptest::collection::vec((any::<u32>(), any::<u8>(), 0..4_u8), 1..8)) {
        let all = files();
        let (name, bytes) = &all[which % all.len()];
        let mut bytes = bytes.clone();
        for (at, byte, how) in changes {
            let at = at as usize % bytes.len().max(1);
            match how {
                _ if bytes.is_empty() => {}
                0 => bytes[at] = byte,
                1 => drop(bytes.remove(at)),
                2 => bytes.insert(at, byte),
                _ => bytes.truncate(at),
            }
        }
        for flags in [&[][..], &[("restart", "append"), ("drop", "unreadable"), ("drop", "missing"), ("points", "20")]] {
            let told = import(name, &bytes, flags).map_or_else(|e| e.to_string(), |i| i.tests[0].csv(&[]));
            prop_assert!(!told.bytes().any(|b| b == 0x1b));
        }
    }
}

/// All files of the dialects.
fn files() -> &'static [(&'static str, Vec<u8>)] {
    static FILES: std::sync::OnceLock<Vec<(&'static str, Vec<u8>)>> = std::sync::OnceLock::new();
    FILES.get_or_init(|| variants::all().into_iter().map(|v| (v.file, v.bytes)).collect())
}
