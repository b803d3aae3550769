//! The header line of a CSV file, and the numbers in its cells.

use super::{Cell, Faults};
use crate::diagnostics::Report;
use crate::keys::{Fallback, Key, Kind, Limits, Match, Speller, either};
use crate::text::short;
use params::Quantity;

/// A column that a kind of file may have.
#[derive(Clone, Copy)]
pub(crate) struct Column {
    /// Name without unit.
    pub name: &'static str,
    /// Physical kind; a pure number stands for text.
    pub quantity: Quantity,
    /// Whether it must be there.
    pub required: bool,
}

/// Where a column stands in this file.
pub(crate) struct Found {
    /// Index among the cells of a row.
    pub index: usize,
    /// Name as written.
    pub written: String,
    /// Factor of its unit to the internal unit.
    pub factor: f64,
}

/// For each known column, where it stands. `None` if the header is unusable (reported).
pub(crate) fn header(cells: &[Cell<'_>], known: &[Column], faults: &mut Faults<'_>) -> Option<Vec<Option<Found>>> {
    let keys: Vec<Key> = known.iter().map(key).collect();
    let mut found: Vec<Option<Found>> = known.iter().map(|_| None).collect();
    let mut good = true;
    for (index, cell) in cells.iter().enumerate() {
        match (Speller { title: "the header", keys: &keys }).find(&cell.text) {
            Match::Known(k, factor) => {
                if let Some(first) = &found[k] {
                    let message = format!("column `{}` is given twice: it is also field {}", cell.text, first.index + 1);
                    faults.add(Report::error(message).key(cell.text.as_ref()), cell.span.clone());
                    good = false;
                    continue;
                }
                found[k] = Some(Found { index, written: cell.text.to_string(), factor });
            }
            Match::Unknown(message, help) => {
                let report = Report::error(message.replace("unknown key", "unknown column").replacen("key `", "column `", 1));
                let report = report.key(short(&cell.text));
                faults.add(if let Some(help) = help { report.help(help) } else { report }, cell.span.clone());
                good = false;
            }
        }
    }
    let missing: Vec<String> =
        keys.iter().zip(known).zip(&found).filter(|((_, c), f)| c.required && f.is_none()).map(|((k, _), _)| k.spelling()).collect();
    if good && !missing.is_empty() {
        let names: Vec<String> = missing.iter().map(|m| format!("`{m}`")).collect();
        let columns = if missing.len() == 1 { "column" } else { "columns" };
        let mut report = Report::error(format!("the header lacks {columns} {}", names.join(", ")));
        report = report.help(advice(cells, &keys));
        let span = cells.first().map_or(0..0, |c| c.span.start..c.span.end);
        faults.add(report, span);
        good = false;
    }
    good.then_some(found)
}

fn advice(cells: &[Cell<'_>], keys: &[Key]) -> String {
    let first = cells.first().map_or("", |c| c.text.as_ref());
    if cells.len() == 1 && first.contains([';', '\t']) {
        return "separate fields with commas, and write decimals with a point".to_owned();
    }
    if cells.iter().all(|c| c.text.parse::<f64>().is_ok()) {
        return "the first line that is not a comment must name the columns".to_owned();
    }
    let spellings: Vec<String> = keys.iter().map(Key::spelling).collect();
    format!("known columns are {}", either(spellings.iter().map(String::as_str)).replace(" or ", " and "))
}

fn key(column: &Column) -> Key {
    let kind = match column.quantity {
        Quantity::Dimensionless => Kind::Text,
        quantity => Kind::Number { quantity, limits: Limits::within(f64::NEG_INFINITY, f64::INFINITY) },
    };
    Key {
        section: "".into(),
        name: column.name.into(),
        kind,
        default: Fallback::Absent("".into()),
        description: "".into(),
    }
}

/// The number in a cell, in the internal unit, or a fault.
pub(crate) fn number(cell: &Cell<'_>, column: &Found, faults: &mut Faults<'_>) -> Option<f64> {
    let (text, name) = (cell.text.as_ref(), short(&column.written));
    let place = format!("`{name}` (field {})", column.index + 1);
    let fault = match text.parse::<f64>() {
        Ok(x) if (x * column.factor).is_finite() => return Some(x * column.factor),
        Ok(_) => format!("{place} is `{}`; expected a finite number", short(text)),
        Err(_) if text.is_empty() => format!("{place} is empty; expected a number"),
        Err(_) => format!("{place} is `{}`; expected a number", short(text)),
    };
    faults.add(Report::error(fault).key(name), cell.span.clone());
    None
}

/// Reports a row with the wrong number of fields; whether it is right.
pub(crate) fn right_count(row: &[Cell<'_>], expected: usize, faults: &mut Faults<'_>) -> bool {
    if row.len() == expected {
        return true;
    }
    let span = match row.get(expected) {
        Some(extra) => extra.span.clone(),
        None => row.last().map_or(0..0, |c| c.span.end..c.span.end),
    };
    let fields = if row.len() == 1 { "field" } else { "fields" };
    let message = format!("this row has {} {fields}; expected {expected}, as in the header", row.len());
    faults.add(Report::error(message), span);
    false
}
