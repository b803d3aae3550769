//! Which table of a text is the record, what its columns are, and how its numbers are written.

use crate::choices::Choices;
use crate::columns::{Assigner, Column};
use crate::dialects::Hints;
use crate::error::{Fault, Question};
use crate::layout::Block;
use crate::number::{self, Locale};
use crate::sniff;
use crate::text::Text;
use crate::trouble::Trouble;

/// The table that is the record: the longest of those whose names can be it, with its columns.
pub(crate) fn table<'a>(
    text: &Text,
    delimiter: char,
    blocks: &'a [Block],
    choices: &Choices,
    hints: &Hints,
) -> Result<(&'a Block, Vec<Column>), Trouble> {
    let longest = |named: bool| {
        blocks
            .iter()
            .filter(|b| !named || with(text, delimiter, b, choices, hints, |a| a.has_names()))
            .max_by_key(|b| b.count)
    };
    let block = longest(true).or_else(|| longest(false)).ok_or(Trouble::NoTable)?;
    let names = block.names.iter().filter(|n| !n.is_empty()).count();
    if delimiter == ',' && names >= 2 && block.width == 2 * names {
        return Err(Trouble::Wrong(vec![Fault {
            row: Some(block.rows.start + 1),
            column: None,
            message: format!(
                "{names} names, but {} cells a row: commas both between cells and in numbers",
                block.width
            ),
            remedy: "export with semicolons or tabs between cells, or with decimal points".into(),
        }]));
    }
    let columns = with(text, delimiter, block, choices, hints, |a| a.assign());
    columns.map(|c| (block, c)).map_err(|open| {
        // Flags that do not fit come first: their mending may settle the questions.
        if open.faults.is_empty() { Trouble::Ask(open.questions) } else { Trouble::Wrong(open.faults) }
    })
}

/// An assigner for a table, which may ask for its cells.
fn with<T>(
    text: &Text,
    delimiter: char,
    block: &Block,
    choices: &Choices,
    hints: &Hints,
    then: impl FnOnce(&Assigner<'_>) -> T,
) -> T {
    let cell = |k: usize, i: usize, ranges: &mut Vec<std::ops::Range<usize>>| {
        let line = text.cells(k, delimiter, ranges);
        ranges.get(i).map_or(String::new(), |r| line[r.clone()].to_owned())
    };
    let lines = || block.rows.clone().filter(|k| !text.line(*k).trim().is_empty());
    let constant = |i: usize| {
        let mut ranges = Vec::new();
        let mut cells = lines().map(|k| cell(k, i, &mut ranges));
        let first = cells.next();
        cells.all(|c| Some(&c) == first.as_ref())
    };
    let same = |i: usize, j: usize| {
        let mut ranges = Vec::new();
        i == j || lines().all(|k| cell(k, i, &mut ranges) == cell(k, j, &mut ranges))
    };
    let clock = |i: usize| {
        let mut ranges = Vec::new();
        let is_clock =
            |c: String| ['.', ','].iter().any(|d| number::clock(&c, Locale { decimal: *d }).is_some());
        lines().next().is_some_and(|k| is_clock(cell(k, i, &mut ranges)))
    };
    then(&Assigner { block, choices, hints, same: &same, constant: &constant, clock: &clock })
}

/// The decimal mark: said, declared, or counted over all cells that are used.
pub(crate) fn locale(
    text: &Text,
    delimiter: char,
    blocks: &[&Block],
    columns: &[Column],
    choices: &Choices,
    hints: &Hints,
) -> Result<(Locale, String), Question> {
    if let Some(decimal) = choices.decimal {
        return Ok((Locale { decimal }, "said".into()));
    }
    if let Some(decimal) = hints.decimal {
        return Ok((Locale { decimal }, "the file's own rule".into()));
    }
    let mut marks = sniff::Marks::default();
    let mut ranges = Vec::new();
    for k in blocks.iter().flat_map(|b| b.rows.clone()) {
        let line = text.cells(k, delimiter, &mut ranges);
        for column in columns.iter().filter(|c| c.role.measure().is_some()) {
            if let Some(r) = ranges.get(column.index) {
                marks.add(&line[r.clone()]);
            }
        }
    }
    let decided = marks.decide(delimiter)?;
    Ok(decided.map_or((Locale { decimal: '.' }, "no number has a mark".into()), |(decimal, why)| {
        (Locale { decimal }, why)
    }))
}
