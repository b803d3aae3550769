//! What is printed on a terminal: tables of at most 100 columns and small plots.

mod compare;
mod design;
mod discover;
mod doctor;
mod identify;
mod overview;
mod plot;
mod simulate;

pub use compare::compare;
pub use design::design;
pub use discover::discover;
pub(crate) use discover::{called, chance, p_value};
pub use doctor::doctor_lines;
pub use identify::identify;
pub(crate) use identify::{SLOPPY_SHOWN, interval, path_means, published_value, remark};
pub use overview::{
    BatchMean, BatchRow, LadderRow, LeftOut, batch, batch_mean, batch_rows, ladder, ladder_rows,
};
pub(crate) use overview::{along_path, known, mean_in_words, mean_sd, pair};
pub use plot::sparkline;
pub use simulate::simulate;

use comfy_table::{CellAlignment, ContentArrangement, Table, TableComponent, presets};
use input::visible;

/// Most columns that anything fills, and what is filled where nobody says how wide the terminal is.
pub const WIDTH: usize = 100;
/// Fewer columns than these are not written for: tables would fall apart.
const NARROWEST: usize = 60;

/// What the terminal can show.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Style {
    /// Escape sequences allowed.
    pub colour: bool,
    /// Columns that text and tables fill.
    pub width: usize,
}

impl Style {
    /// For a terminal of so many columns; `None`: not known, or none.
    pub fn new(colour: bool, columns: Option<usize>) -> Self {
        Self { colour, width: columns.unwrap_or(WIDTH).clamp(NARROWEST, WIDTH) }
    }

    /// Text that follows `head` on its line, broken at the width, continued below where it began.
    pub fn after(self, head: &str, text: &str) -> String {
        let indent = head.chars().count();
        format!("{head}{}", wrap(text, self.width, indent))
    }

    /// A remark after a mark that is painted already.
    pub(crate) fn marked(self, mark: &str, text: &str) -> String {
        format!("{mark} {}", wrap(text, self.width, 2))
    }

    fn paint(self, code: &str, text: &str) -> String {
        let text = visible(text);
        if self.colour { format!("\x1b[{code}m{text}\x1b[0m") } else { text }
    }
    /// A headline.
    pub fn bold(self, text: &str) -> String {
        self.paint("1", text)
    }
    /// Good news.
    pub fn good(self, text: &str) -> String {
        self.paint("1;32", text)
    }
    /// Bad news.
    pub fn bad(self, text: &str) -> String {
        self.paint("1;31", text)
    }
    /// Something to be noticed.
    pub fn notice(self, text: &str) -> String {
        self.paint("33", text)
    }
    /// Something of less weight.
    pub fn faint(self, text: &str) -> String {
        self.paint("2", text)
    }
}

/// A table with a headline; all columns but those in `left` are right-aligned.
pub(crate) fn table(style: Style, header: &[&str], left: &[usize], rows: Vec<Vec<String>>) -> String {
    let mut t = Table::new();
    t.load_preset(presets::NOTHING);
    t.set_style(TableComponent::HeaderLines, '─').set_style(TableComponent::MiddleHeaderIntersections, '─');
    t.set_content_arrangement(ContentArrangement::Dynamic)
        .set_width(u16::try_from(style.width).unwrap_or(u16::MAX));
    t.set_header(header.iter().copied());
    for row in rows {
        t.add_row(row.iter().map(|cell| visible(cell)));
    }
    for (i, column) in t.column_iter_mut().enumerate() {
        if !left.contains(&i) {
            column.set_cell_alignment(CellAlignment::Right);
        }
    }
    t.trim_fmt()
}

/// Escape sequences of [`Style`].
const OURS: [&str; 6] = ["\x1b[1m", "\x1b[1;32m", "\x1b[1;31m", "\x1b[33m", "\x1b[2m", "\x1b[0m"];

/// A whole output as it may go to a terminal: lines, `style`'s own colours where there are any, and text that can be
/// seen. What is shown of files is made visible where it enters a table or a sentence; this stands behind all that.
pub fn printable(text: &str, style: Style) -> String {
    let mut out = String::with_capacity(text.len());
    let mut rest = text;
    while let Some(c) = rest.chars().next() {
        let ours = OURS.iter().find(|code| style.colour && rest.starts_with(**code));
        let piece = ours.map_or(&rest[..c.len_utf8()], |code| *code);
        if ours.is_some() || c == '\n' {
            out.push_str(piece);
        } else {
            out.push_str(&visible(piece));
        }
        rest = &rest[piece.len()..];
    }
    out
}

/// A JSON document with invisible characters escaped as JSON does it: the same document, and nothing that drives a
/// terminal.
pub fn printable_json(document: &str) -> String {
    let mut out = String::with_capacity(document.len());
    for c in document.chars() {
        let plain = c.is_ascii_graphic()
            || c == ' '
            || c == '\n'
            || visible(c.encode_utf8(&mut [0; 4])).len() == c.len_utf8();
        if plain { out.push(c) } else { out.push_str(&format!("\\u{:04x}", c as u32)) }
    }
    out
}

/// A number with `digits` significant digits, without an exponent where that stays readable.
pub fn significant(x: f64, digits: i32) -> String {
    if x == 0.0 || !x.is_finite() {
        return if x == 0.0 { "0".into() } else { x.to_string() };
    }
    let magnitude = x.abs().log10().floor() as i32;
    if (-4..6).contains(&magnitude) {
        let decimals = (digits - 1 - magnitude).max(0) as usize;
        format!("{x:.decimals$}")
    } else {
        format!("{x:.*e}", (digits - 1).max(0) as usize)
    }
}

/// The unit a reader expects, and the factor to it.
pub fn readable_unit(path: &str, unit: &str) -> (&'static str, f64) {
    match unit {
        "rad" => ("°", 180.0 / std::f64::consts::PI),
        "MPa" if path.starts_with("bulk.") => ("kPa", 1e3),
        "MPa" => ("MPa", 1.0),
        "N/mm" => ("N/mm", 1.0),
        "mm" => ("mm", 1.0),
        "s" => ("s", 1.0),
        "N" => ("N", 1.0),
        "1/MPa" => ("1/MPa", 1.0),
        "N/mm3" => ("N/mm³", 1.0),
        "mm/s" => ("mm/s", 1.0),
        "1/s" => ("1/s", 1.0),
        "N/s" => ("N/s", 1.0),
        "mm/N" => ("mm/N", 1.0),
        "g/cm3" => ("g/cm³", 1.0),
        _ => ("", 1.0),
    }
}

/// Text that begins after `indent` columns, broken into lines that end at column `width`, each continued after
/// `indent` blanks.
pub fn wrap(text: &str, width: usize, indent: usize) -> String {
    let (mut out, mut column) = (String::new(), indent);
    for word in text.split_whitespace().map(visible) {
        let length = word.chars().count();
        if column > indent && column + 1 + length > width {
            out.push('\n');
            out.push_str(&" ".repeat(indent));
            column = indent;
        } else if column > indent {
            out.push(' ');
            column += 1;
        }
        out.push_str(&word);
        column += length;
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    const EVIL: &str = "load\u{1b}[31m\u{9b}2J\u{202e} 1\u{7}";

    #[test]
    fn text_of_files_cannot_drive_a_terminal() {
        for colour in [false, true] {
            let style = Style::new(colour, None);
            let table = table(style, &["a"], &[0], vec![vec![EVIL.into()]]);
            let all = [style.bold(EVIL), wrap(EVIL, 80, 0), table, EVIL.to_owned()].join("\n");
            let shown = printable(&all, style);
            let mut bare = shown.clone();
            OURS.iter().for_each(|code| bare = bare.replace(code, ""));
            let driven = bare.chars().filter(|c| *c != '\n' && visible(&c.to_string()) != c.to_string());
            assert_eq!(driven.count(), 0, "{bare:?}");
            assert_eq!(shown.contains("\x1b[1m"), colour);
        }
        let json = serde_json::json!({ "segment": EVIL });
        let printed = printable_json(&json.to_string());
        assert!(printed.is_ascii() && !printed.contains(char::is_control), "{printed:?}");
        assert_eq!(serde_json::from_str::<serde_json::Value>(&printed).ok(), Some(json));
    }

    #[test]
    fn lines_are_broken_once_and_filled() {
        let text = "aaaa ".repeat(30);
        let shown = Style::new(false, Some(60)).after(&format!("{:<26}", "name"), &text);
        let lines: Vec<&str> = shown.lines().collect();
        // Seven words of five columns each after 26 columns, on every line but the last.
        assert!(lines.iter().all(|l| l.chars().count() <= 60), "{shown}");
        assert!(lines[..lines.len() - 1].iter().all(|l| l.matches("aaaa").count() == 7), "{shown}");
    }

    /// A value never stands without the unit it has in the files.
    #[test]
    fn every_quantity_has_a_unit_for_the_reader() {
        use params::Quantity::{self, Angle, Dimensionless};
        for quantity in Quantity::ALL.into_iter().filter(|q| *q != Dimensionless) {
            let (shown, factor) = readable_unit("interface.area[1].x", quantity.unit());
            let kept = quantity == Angle || shown == quantity.unit().replace('3', "³");
            assert!(
                !shown.is_empty() && kept && (factor == 1.0 || quantity == Angle),
                "{quantity:?}: {shown}"
            );
        }
        assert_eq!(readable_unit("bulk.mu", "MPa"), ("kPa", 1000.0));
        assert_eq!(readable_unit("bulk.gamma", "rad").0, "°");
        assert!((std::f64::consts::FRAC_PI_4 * readable_unit("bulk.gamma", "rad").1 - 45.0).abs() < 1e-12);
        assert_eq!(readable_unit("bulk.k2", ""), ("", 1.0));
    }
}
