//! Where the tables of a text are: runs of rows with numbers, the names and units above them, what stands before.

use crate::number::{is_missing, looks_numeric};
use crate::text::Text;
use crate::units;
use std::ops::Range;

/// Fewest rows of a table that could be a record.
pub(crate) const FEWEST: usize = 3;
/// Blank lines that may stand between names and rows.
const MOST_BLANK: usize = 3;

/// A run of rows with one header.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Block {
    /// Names as written, one per column; empty where there is none.
    pub names: Vec<String>,
    /// Units of the line below the names.
    pub units: Vec<Option<String>>,
    /// Line of the names, from 0.
    pub header: Option<usize>,
    /// Lines of the rows, from 0; a few of them may be blank or damaged.
    pub rows: Range<usize>,
    /// Cells of a row.
    pub width: usize,
    /// Rows with numbers.
    pub count: usize,
}

impl Block {
    /// The name of a column as it is shown: as written, or its number.
    pub fn shown(&self, index: usize) -> String {
        let name = self.names.get(index).map_or("", String::as_str);
        let unit = self.units.get(index).and_then(Option::as_deref);
        match (name, unit) {
            ("", _) => format!("column {}", index + 1),
            (name, Some(unit)) => format!("{name} [{}]", unit.trim_matches(['(', ')', '[', ']'])),
            (name, None) => name.to_owned(),
        }
    }
}

/// What a line is made of.
struct Line {
    cells: usize,
    numbers: usize,
    missing: usize,
    texts: usize,
}

fn look(text: &Text, k: usize, delimiter: char, ranges: &mut Vec<Range<usize>>) -> Line {
    let line = text.cells(k, delimiter, ranges);
    let mut seen = Line { cells: ranges.len(), numbers: 0, missing: 0, texts: 0 };
    for r in ranges.iter() {
        let cell = &line[r.clone()];
        if looks_numeric(cell) {
            seen.numbers += 1;
        } else if is_missing(cell) {
            seen.missing += 1;
        } else {
            seen.texts += 1;
        }
    }
    seen
}

/// The tables of a text, from top to bottom; lines before `skip` are no part of any.
pub(crate) fn blocks(text: &Text, delimiter: char, skip: usize) -> Vec<Block> {
    let mut out: Vec<Block> = Vec::new();
    let mut open: Option<Block> = None;
    let mut ranges = Vec::new();
    for k in skip..text.len() {
        let line = text.line(k);
        if line.trim().is_empty() {
            continue;
        }
        let seen = look(text, k, delimiter, &mut ranges);
        let comment = line.trim_start().starts_with('#');
        let row = !comment && seen.numbers >= 2 && seen.numbers >= seen.texts;
        match &mut open {
            Some(block) if row => {
                block.rows.end = k + 1;
                block.count += 1;
            }
            // Damaged rows stay in their table: they are faults, not its end.
            Some(block)
                if !comment
                    && seen.cells == block.width
                    && seen.numbers + seen.missing > 0
                    && damaged(&seen) =>
            {
                block.rows.end = k + 1;
            }
            Some(_) if comment => {}
            Some(_) => out.extend(open.take()),
            None if row => {
                let empty = Block {
                    names: Vec::new(),
                    units: Vec::new(),
                    header: None,
                    rows: k..k + 1,
                    width: seen.cells,
                    count: 1,
                };
                let above = out.last();
                open = Some(named(text, delimiter, skip, above, empty));
            }
            None => {}
        }
    }
    out.extend(open);
    out
}

/// A row that lost its numbers still has one of them, or nothing but signs for "no value".
fn damaged(seen: &Line) -> bool {
    seen.numbers > 0 || seen.texts == 0
}

/// Gives a table the names above its first row, or those of the table before it.
fn named(text: &Text, delimiter: char, skip: usize, before: Option<&Block>, mut block: Block) -> Block {
    let floor = before.map_or(skip, |b| b.rows.end).max(skip);
    let mut above = Vec::new();
    let mut blank = 0;
    for k in (floor..block.rows.start).rev() {
        if text.line(k).trim().is_empty() {
            blank += 1;
            if blank > MOST_BLANK {
                break;
            }
            continue;
        }
        above.push((k, header_cells(text, k, delimiter, block.width)));
        if above.len() == 2 {
            break;
        }
    }
    let units_first = above.first().is_some_and(|(_, cells)| is_unit_row(cells));
    let names = if units_first { above.get(1) } else { above.first() };
    let filled = |cells: &[String]| cells.iter().filter(|c| !c.is_empty()).count();
    if let Some((k, cells)) = names.filter(|(_, cells)| filled(cells) >= 2) {
        block.header = Some(*k);
        block.names = cells.clone();
    } else if let Some(before) = before.filter(|b| b.width == block.width) {
        block.names = before.names.clone();
        block.units = before.units.clone();
        block.header = before.header;
        return block;
    }
    if units_first && let Some((_, cells)) = above.first() {
        block.units = cells.iter().map(|c| Some(c.clone()).filter(|c| !c.is_empty())).collect();
    }
    block.names.resize(block.width.max(block.names.len()), String::new());
    block.units.resize(block.names.len(), None);
    block
}

/// The cells of a header line: without a comment sign, and put together again where blanks separate columns.
fn header_cells(text: &Text, k: usize, delimiter: char, width: usize) -> Vec<String> {
    let mut cells = text.row(k, delimiter);
    if let Some(first) = cells.first_mut() {
        *first = first.trim_start_matches('#').trim().to_owned();
    }
    if delimiter != ' ' || cells.len() == width {
        return cells;
    }
    cells.retain(|c| !c.is_empty());
    let line = text.line(k).trim().trim_start_matches('#');
    let wide: Vec<String> =
        line.replace('\t', "  ").split("  ").map(|c| c.trim().to_owned()).filter(|c| !c.is_empty()).collect();
    if wide.len() == width {
        return wide;
    }
    let mut joined: Vec<String> = Vec::new();
    for cell in cells {
        match joined.last_mut() {
            Some(last) if cell.starts_with(['(', '[']) => {
                last.push(' ');
                last.push_str(&cell);
            }
            _ => joined.push(cell),
        }
    }
    joined
}

/// Whether a line holds units: most of its cells are some, none is long.
fn is_unit_row(cells: &[String]) -> bool {
    let filled: Vec<&String> = cells.iter().filter(|c| !c.is_empty()).collect();
    let known = filled.iter().filter(|c| units::parse(c).is_some()).count();
    known >= 2 && known * 2 > filled.len() && filled.iter().all(|c| c.chars().count() <= 12)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(text: &str, delimiter: char) -> Vec<Block> {
        blocks(&Text::new(text.to_owned()), delimiter, 0)
    }

    #[test]
    fn names_and_units_are_above_the_rows() {
        let text = "General : Start,13/11/2018\n\nTime,Load,Segment ID\n(sec),(N),\n0,1,2\n1,2,2\n\n2,,2\n2,x,2\n3,4,2\n";
        let found = of(text, ',');
        assert_eq!(found.len(), 1);
        assert_eq!(found[0].names, ["Time", "Load", "Segment ID"]);
        assert_eq!(found[0].units, [Some("(sec)".into()), Some("(N)".into()), None]);
        assert_eq!((found[0].header, found[0].rows.clone(), found[0].count), (Some(2), 4..10, 5));
        assert_eq!(found[0].shown(1), "Load [N]");
    }

    #[test]
    fn tables_end_where_text_begins() {
        let text = "Results;Max [N]\n1;12.5\n2;13\n\nt [s];F [N]\n0;1\n1;2\n2;3\nend of scan 1\n3;4\n4;5\n";
        let found = of(text, ';');
        assert_eq!(found.iter().map(|b| b.rows.clone()).collect::<Vec<_>>(), [1..3, 5..8, 9..11]);
        assert_eq!(found[1].names, ["t [s]", "F [N]"]);
        assert_eq!(found[2].names, found[1].names);
        let blank = of("# Time (s)  Load (N)\n0 1\n1 2\n2 3\n", ' ');
        assert_eq!(blank[0].names, ["Time (s)", "Load (N)"]);
        assert_eq!(of("1,2\n2,3\n3,4\n", ',')[0].shown(1), "column 2");
    }
}
