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
pub(crate) use discover::chance;
pub use discover::discover;
pub use doctor::doctor_lines;
pub use identify::identify;
pub(crate) use identify::{SLOPPY_SHOWN, interval, remark};
pub(crate) use overview::mean_sd;
pub use overview::{BatchRow, LadderRow, batch, batch_rows, ladder, ladder_rows};
pub use plot::sparkline;
pub use simulate::simulate;

use comfy_table::{CellAlignment, ContentArrangement, Table, TableComponent, presets};

/// Columns that a table may fill.
pub const WIDTH: u16 = 100;

/// Whether colours may be used.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Style {
    /// Escape sequences allowed.
    pub colour: bool,
}

impl Style {
    fn paint(self, code: &str, text: &str) -> String {
        if self.colour { format!("\x1b[{code}m{text}\x1b[0m") } else { text.to_owned() }
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
pub(crate) fn table(header: &[&str], left: &[usize], rows: Vec<Vec<String>>) -> String {
    let mut t = Table::new();
    t.load_preset(presets::NOTHING);
    t.set_style(TableComponent::HeaderLines, '─').set_style(TableComponent::MiddleHeaderIntersections, '─');
    t.set_content_arrangement(ContentArrangement::Dynamic).set_width(WIDTH);
    t.set_header(header.iter().copied());
    for row in rows {
        t.add_row(row);
    }
    for (i, column) in t.column_iter_mut().enumerate() {
        if !left.contains(&i) {
            column.set_cell_alignment(CellAlignment::Right);
        }
    }
    t.trim_fmt()
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

/// Text broken into lines of at most `width` characters, continued with `indent` blanks.
pub fn wrap(text: &str, width: usize, indent: usize) -> String {
    let (mut out, mut column) = (String::new(), 0);
    for word in text.split_whitespace() {
        let length = word.chars().count();
        if column > 0 && column + 1 + length > width {
            out.push('\n');
            out.push_str(&" ".repeat(indent));
            column = indent;
        } else if column > 0 {
            out.push(' ');
            column += 1;
        }
        out.push_str(word);
        column += length;
    }
    out
}
