//! One record in many dialects: integers in the smallest unit, written as each program writes them.
#![allow(dead_code)]

pub mod generic;
pub mod office;
pub mod variants;

use encoding_rs::{Encoding, UTF_16BE, UTF_16LE};
use records::{Choices, Geometry, Import, ImportError};
use std::path::Path;

/// The record that every file holds: time in ms, displacement in 0.1 µm, force in 0.1 mN; a ramp, a hold, a return.
pub fn pull() -> Vec<[i64; 3]> {
    let up = (0..14).map(|i| [i * 500, i * 1250, 12 + i * i * 31]);
    let hold = (1..9).map(|i| [6500 + i * 500, 16_250, 5251 - 900 + 900 / i]);
    let down = (1..10).map(|i| [10_500 + i * 500, 16_250 - i * 1250, 4463 - i * 480]);
    up.chain(hold).chain(down).collect()
}

/// mm, s and N of the record, as the decimal texts that mean them.
pub fn twin() -> [Vec<f64>; 3] {
    let rows = pull();
    let column = |k: usize, places: i32| {
        rows.iter().map(|r| decimal(r[k], places, '.', None).parse().expect("a number")).collect()
    };
    [column(0, 3), column(1, 4), column(2, 4)]
}

/// An integer as a decimal number with `places` digits after the mark (fewer than none: zeros behind), thousands
/// grouped by a sign.
pub fn decimal(x: i64, places: i32, mark: char, group: Option<char>) -> String {
    let digits = x.unsigned_abs().to_string();
    let (mut whole, fraction) = if places <= 0 {
        (format!("{digits}{}", "0".repeat(places.unsigned_abs() as usize)), String::new())
    } else {
        let places = places as usize;
        let padded = format!("{digits:0>width$}", width = places + 1);
        let (whole, fraction) = padded.split_at(padded.len() - places);
        (whole.to_owned(), fraction.to_owned())
    };
    if x == 0 {
        whole = "0".into();
    }
    if let Some(group) = group {
        let n = whole.len();
        let parted = |(i, c): (usize, char)| {
            let sign = (i > 0 && (n - i).is_multiple_of(3)).then_some(group);
            sign.into_iter().chain([c])
        };
        whole = whole.chars().enumerate().flat_map(parted).collect();
    }
    let sign = if x < 0 { "-" } else { "" };
    if fraction.is_empty() { format!("{sign}{whole}") } else { format!("{sign}{whole}{mark}{fraction}") }
}

/// A text in an encoding, with or without its mark.
pub fn encoded(text: &str, encoding: &'static Encoding, mark: bool) -> Vec<u8> {
    let mut out: Vec<u8> = Vec::new();
    let wide = |unit: fn(u16) -> [u8; 2]| text.encode_utf16().flat_map(unit).collect::<Vec<u8>>();
    if encoding == UTF_16LE {
        out.extend(if mark { &b"\xFF\xFE"[..] } else { b"" });
        out.extend(wide(u16::to_le_bytes));
    } else if encoding == UTF_16BE {
        out.extend(if mark { &b"\xFE\xFF"[..] } else { b"" });
        out.extend(wide(u16::to_be_bytes));
    } else {
        out.extend(if mark && encoding == encoding_rs::UTF_8 { &b"\xEF\xBB\xBF"[..] } else { b"" });
        out.extend(encoding.encode(text).0.as_ref());
    }
    out
}

/// Imports bytes with flags, as on the command line; `--geometry` has 10, 6 and 0.8 mm.
pub fn import(name: &str, bytes: &[u8], flags: &[(&str, &str)]) -> Result<Import, ImportError> {
    let mut choices = Choices::new();
    let mut geometry = Geometry::default();
    for (flag, value) in flags {
        match *flag {
            "geometry" => {
                geometry.length = Some(10.0);
                geometry.width = Some(6.0);
                geometry.thickness = Some(0.8);
            }
            "frequency" => choices.frequency = value.parse().ok(),
            "skip-rows" => choices.skip_rows = value.parse().expect("a number"),
            "flip" => {
                choices.flip = Some(match *value {
                    "force" => records::Flip::Force,
                    "displacement" => records::Flip::Displacement,
                    "both" => records::Flip::Both,
                    _ => records::Flip::Found,
                })
            }
            "two-axes" => choices.two_axes = true,
            "zero" => choices.zero = true,
            "tare" => choices.tare = true,
            "drop" => choices.drop.push(match *value {
                "missing" => records::FaultKind::Missing,
                "unreadable" => records::FaultKind::Unreadable,
                "spike" => records::FaultKind::Spike,
                _ => records::FaultKind::Clipped,
            }),
            "points" => choices.points = Some(value.parse().expect("a number")),
            _ => choices.answer(flag, value).unwrap_or_else(|e| panic!("{flag} {value}: {e}")),
        }
    }
    records::import_bytes(Path::new(name), bytes.to_vec(), &choices, &mut geometry)
}

/// Names of a table that leaves nothing open.
pub const HEAD: &str = "Time [s],Extension [mm],Load [N]\n";

/// A text that must be a record.
pub fn read(text: &str, flags: &[(&str, &str)]) -> Import {
    import("a.csv", text.as_bytes(), flags).unwrap_or_else(|e| panic!("{e}"))
}

/// What is said of a text that is none; empty of one that is.
pub fn told(text: &str, flags: &[(&str, &str)]) -> String {
    import("a.csv", text.as_bytes(), flags).map(|_| String::new()).unwrap_or_else(|e| e.to_string())
}

/// Three decimals in a line, in the units of a dialect.
pub struct Look {
    /// Digits after the mark: time, displacement, force.
    pub places: [i32; 3],
    /// The mark.
    pub mark: char,
    /// Between thousands.
    pub group: Option<char>,
    /// Between cells.
    pub between: &'static str,
    /// Around numbers.
    pub quote: &'static str,
}

impl Look {
    /// s, mm, N with a point and commas.
    pub const PLAIN: Look = Look { places: [3, 4, 4], mark: '.', group: None, between: ",", quote: "" };
    /// The same with a comma and semicolons.
    pub const COMMA: Look = Look { mark: ',', between: ";", ..Look::PLAIN };

    /// The cells of a row: time, displacement, force.
    pub fn cells(&self, row: &[i64; 3]) -> [String; 3] {
        let cell = |k: usize| {
            format!("{q}{}{q}", decimal(row[k], self.places[k], self.mark, self.group), q = self.quote)
        };
        [cell(0), cell(1), cell(2)]
    }

    /// Every row, made by `line` from its number and cells.
    pub fn rows(&self, line: impl Fn(usize, [String; 3]) -> Vec<String>) -> String {
        let all = pull();
        let lines = all.iter().enumerate().map(|(i, r)| line(i, self.cells(r)).join(self.between) + "\n");
        lines.collect()
    }

    /// Time, displacement, force.
    pub fn table(&self) -> String {
        self.rows(|_, [t, u, f]| vec![t, u, f])
    }
}
