//! The header line of a CSV file, and the numbers in its cells.

use super::{Cell, Faults};
use crate::diagnostics::Report;
use crate::keys::{Fallback, Key, Kind, Limits, Match, Speller, list};
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
pub(crate) fn header(
    cells: &[Cell<'_>],
    known: &[Column],
    faults: &mut Faults<'_>,
) -> Option<Vec<Option<Found>>> {
    let keys: Vec<Key> = known.iter().map(key).collect();
    if let Some((message, help)) = no_header(cells) {
        let span = cells[0].span.start..cells[cells.len() - 1].span.end;
        faults.add(Report::error(message).help(help), span);
        return None;
    }
    let speller = Speller::new("the header", &keys);
    let mut found: Vec<Option<Found>> = known.iter().map(|_| None).collect();
    let mut good = true;
    for (index, cell) in cells.iter().enumerate() {
        let fault = match speller.find(&cell.text) {
            Match::Known(k, factor) => match &found[k] {
                None => {
                    found[k] = Some(Found { index, written: cell.text.to_string(), factor });
                    continue;
                }
                Some(first) => {
                    let (column, field) = (&first.written, first.index + 1);
                    Report::error(format!("`{}` is given twice: field {field} is `{column}`", cell.text))
                }
            },
            Match::Unknown(unknown) => {
                let message = unknown.message.replacen("key `", "column `", 1);
                let report = Report::error(message);
                if let Some(help) = unknown.help { report.help(help) } else { report }
            }
        };
        faults.add(fault.key(short(&cell.text)), cell.span.clone());
        good = false;
    }
    good.then_some(found).filter(|found| complete(cells, known, found, faults))
}

/// Whether every required column is there, else a fault.
fn complete(cells: &[Cell<'_>], known: &[Column], found: &[Option<Found>], faults: &mut Faults<'_>) -> bool {
    let lacking = known.iter().zip(found).filter(|(c, f)| c.required && f.is_none());
    let missing: Vec<String> = lacking.map(|(c, _)| format!("`{}`", c.quantity.key(c.name))).collect();
    if missing.is_empty() {
        return true;
    }
    let columns = if missing.len() == 1 { "column" } else { "columns" };
    let message = format!("the header lacks {columns} {}", list(missing.into_iter(), "and"));
    let span = cells.first().map_or(0, |c| c.span.start)..cells.last().map_or(0, |c| c.span.end);
    faults.add(Report::error(message), span);
    false
}

/// A first line that cannot be a header at all, in one fault instead of one per field.
fn no_header(cells: &[Cell<'_>]) -> Option<(&'static str, &'static str)> {
    let first = cells.first()?.text.as_ref();
    if cells.len() == 1 && first.contains([';', '\t']) {
        return Some((
            "the fields are not separated by commas",
            "separate fields with commas, write decimals with a point",
        ));
    }
    let numbers = cells.iter().all(|c| c.text.parse::<f64>().is_ok());
    numbers.then_some((
        "numbers where the header should be",
        "the first line that is no comment names the columns",
    ))
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
    let text = cell.text.as_ref();
    let read = text.parse::<f64>();
    // Of millions of cells nearly all are good: words are made for the others alone.
    if let Some(x) = read.as_ref().ok().map(|x| x * column.factor).filter(|x| x.is_finite()) {
        return Some(x);
    }
    let name = short(&column.written);
    let place = format!("`{name}` (field {})", column.index + 1);
    let fault = match read {
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
