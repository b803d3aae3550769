//! What stands before the table: dimensions of the specimen, its name, the speed of the test.

use crate::dialects::Hints;
use crate::layout::Block;
use crate::number::{Evidence, Locale, evidence, value};
use crate::text::Text;
use crate::units::{self, Measure};
use crate::words::{Dimension, Role, dimension};
use serde::Serialize;

/// One thing that the header says.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct HeaderEntry {
    /// What it is about.
    pub about: Dimension,
    /// In mm or mm/s; `None` for a name, or a number without a unit.
    pub value: Option<f64>,
    /// As written.
    pub text: String,
    /// Line of the file, from 1.
    pub row: usize,
}

/// Lines that are looked at.
const MOST_LINES: usize = 500;

/// Everything that the lines before the tables say, the first mention of each.
pub(crate) fn read(
    text: &Text,
    delimiter: char,
    blocks: &[Block],
    locale: Locale,
    hints: &Hints,
) -> Vec<HeaderEntry> {
    let mut out: Vec<HeaderEntry> = Vec::new();
    let in_table = |k: usize| {
        blocks
            .iter()
            .any(|b| b.count >= crate::layout::FEWEST && (b.rows.contains(&k) || b.header == Some(k)))
    };
    for k in (0..text.len().min(MOST_LINES)).filter(|&k| !in_table(k)) {
        let mut cells = text.row(k, delimiter);
        if let Some(first) = cells.first_mut() {
            *first = first.trim_start_matches('#').trim().to_owned();
        }
        if let Some(said) = of_line(&cells, k, locale, hints)
            && !out.iter().any(|s| s.about == said.about)
        {
            out.push(said);
        }
    }
    out
}

/// `key, value, unit`, or `key: value unit` in one cell.
fn of_line(cells: &[String], k: usize, locale: Locale, hints: &Hints) -> Option<HeaderEntry> {
    let first = cells.first()?;
    let (bare, unit) = units::split(first.trim_end_matches([':', '=', ' ']));
    let (about, unit, written, unit_after) = match dimension(&bare) {
        Some(about) => {
            let mut rest = cells[1..].iter().filter(|c| !c.is_empty());
            let written = rest.next()?.trim_start_matches(['=', ':']).trim().to_owned();
            (about, unit, written, rest.next().cloned())
        }
        None => {
            let at = first.rfind(": ").or_else(|| first.find(['=', ':']))?;
            let (bare, unit) = units::split(first[..at].trim());
            (dimension(&bare)?, unit, first[at + 1..].trim().to_owned(), cells.get(1).cloned())
        }
    };
    if written.is_empty() {
        return None;
    }
    let measure = match about {
        Dimension::Name | Dimension::Note => {
            return Some(HeaderEntry { about, value: None, text: written, row: k + 1 });
        }
        Dimension::Rate => Measure::Speed,
        _ => Measure::Length,
    };
    let unit_after = unit_after.filter(|u| units::parse(u).is_some());
    let (number, attached) = parted(&written);
    let no_unit =
        hints.units.iter().find(|(role, _)| *role == Role::Displacement && measure == Measure::Length);
    let unit = attached.or(unit).or(unit_after).or_else(|| no_unit.map(|u| u.1.to_owned()));
    let locale = match evidence(&number) {
        Evidence::Point => Locale { decimal: '.' },
        Evidence::Comma => Locale { decimal: ',' },
        _ => locale,
    };
    value(&number, locale, 0)?;
    let found = unit.as_deref().and_then(units::parse).filter(|u| u.measure == measure);
    let scaled = found.and_then(|u| value(&number, locale, u.exponent).map(|x| x * u.factor));
    let text = match (&unit, written.contains(char::is_alphabetic)) {
        (Some(unit), false) => format!("{written} {unit}"),
        _ => written,
    };
    Some(HeaderEntry { about, value: scaled, text, row: k + 1 })
}

/// `0.1 mm/min` into number and unit.
fn parted(text: &str) -> (String, Option<String>) {
    match text.find(|c: char| c.is_alphabetic() || c == 'µ' || c == '%') {
        Some(at) if at > 0 => (text[..at].trim().to_owned(), Some(text[at..].trim().to_owned())),
        _ => (text.to_owned(), None),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dimensions_are_read_however_they_are_written() {
        let lines = "Dimension : Width,20,mm\n\"Span : 10,0\"\nProbendicke [mm]:   0.8\nRate 1,3.00000,mm/min\nSpecimen label,\"A 7\"\n\
                     Cut = 1500 µm\nComment: none\n";
        let point = Locale { decimal: '.' };
        let said = |hints: &Hints| read(&Text::new(lines.to_owned()), ',', &[], point, hints);
        let values: Vec<_> = said(&Hints::default()).iter().map(|s| (s.about, s.value)).collect();
        assert_eq!(
            values,
            [
                (Dimension::Width, Some(20.0)),
                (Dimension::Length, None),
                (Dimension::Thickness, Some(0.8)),
                (Dimension::Rate, Some(0.05)),
                (Dimension::Name, None),
                (Dimension::Cut, Some(1.5)),
                (Dimension::Note, None),
            ]
        );
        let deben = Hints { units: &[(Role::Displacement, "mm")], ..Hints::default() };
        assert_eq!(said(&deben)[1].value, Some(10.0));
        assert_eq!(said(&deben)[4].text, "A 7");
    }
}
