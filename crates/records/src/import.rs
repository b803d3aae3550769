//! The way from a file to its tests.

use crate::bytes::{self, Content};
use crate::choices::Choices;
use crate::clock;
use crate::columns::{Column, Understood};
use crate::error::{Fault, ImportError};
use crate::faults::{self, Found};
use crate::geometry::Geometry;
use crate::header::{self, HeaderEntry};
use crate::layout::{self, Block, FEWEST};
use crate::output;
use crate::physics;
use crate::reduce::Reduction;
use crate::rows::{self, Rows, Unread};
use crate::settle::Proposal;
use crate::sniff;
use crate::source::Source;
use crate::table::{locale, table};
use crate::test::test;
use crate::trouble::Trouble;
use serde::Serialize;
use std::path::{Path, PathBuf};

/// How a file was read.
#[derive(Clone, Debug, Serialize)]
pub struct Reading {
    /// The program that wrote it.
    pub dialect: &'static str,
    /// Of the text; `workbook` for sheets.
    pub encoding: String,
    /// Why.
    pub encoding_because: &'static str,
    /// Sheet of a workbook.
    pub sheet: Option<String>,
    /// Between cells.
    pub delimiter: &'static str,
    /// The decimal mark.
    pub decimal: char,
    /// Why.
    pub decimal_because: String,
    /// Line of the names, from 1.
    pub header_row: Option<usize>,
    /// Tables with these columns.
    pub tables: usize,
    /// Rows of them.
    pub rows: usize,
    /// What the columns are.
    pub columns: Vec<Understood>,
}

/// One test of a file.
#[derive(Clone, Debug, Serialize)]
pub struct Test {
    /// Key of the test, and the file's name without `.csv`; given by the caller.
    pub name: String,
    /// Experiment; given by the caller.
    pub kind: String,
    /// Every row that was kept.
    #[serde(skip)]
    pub full: Rows,
    /// The points, if there were more rows.
    #[serde(skip)]
    pub reduced: Option<Rows>,
    /// How they were made.
    pub reduction: Option<Reduction>,
    /// First and last row of the file.
    pub file_rows: (u32, u32),
    /// White noise of a row's force, N.
    #[serde(rename = "force_sd_of_rows_N")]
    pub force_sd_of_rows: f64,
    /// Noise of a point's force, N: of a mean, allowing for noise that neighbouring rows share; `None` where nothing was
    /// reduced, or no noise shows.
    #[serde(rename = "force_sd_of_points_N")]
    pub force_sd_of_points: Option<f64>,
    /// Names of its segments.
    pub segments: Vec<String>,
    /// Changes that flags asked for.
    pub done: Vec<String>,
    /// Changes that flags might make.
    pub proposals: Vec<Proposal>,
    /// Faults that were dropped or kept.
    pub faults: Vec<Found>,
}

impl Test {
    /// The record as the other commands take it: points if it was reduced, else all rows.
    pub fn csv(&self, comments: &[String]) -> String {
        output::csv(self.reduced.as_ref().unwrap_or(&self.full), comments)
    }

    /// Every row in the same form; `None` if [`Test::csv`] has them.
    pub fn full_csv(&self, comments: &[String]) -> Option<String> {
        self.reduced.as_ref().map(|_| output::csv(&self.full, comments))
    }
}

/// A file that was understood.
#[derive(Clone, Debug, Serialize)]
pub struct Import {
    /// The file.
    pub file: PathBuf,
    /// How it was read.
    pub reading: Reading,
    /// What stands before its tables.
    pub header: Vec<HeaderEntry>,
    /// Conversions.
    pub done: Vec<String>,
    /// What the user should know.
    pub remarks: Vec<String>,
    /// Faults of the file as a whole.
    pub faults: Vec<Found>,
    /// Its tests, in order.
    pub tests: Vec<Test>,
}

/// Reads a file. Dimensions that its header gives are added to `geometry`.
///
/// # Errors
/// What the file is instead of a record, what must be decided, what must be mended.
pub fn import(path: &Path, choices: &Choices, geometry: &mut Geometry) -> Result<Import, ImportError> {
    from_content(path, bytes::read(path)?, choices, geometry)
}

/// The same for bytes in memory; `path` is for messages.
///
/// # Errors
/// As [`import`].
pub fn import_bytes(
    path: &Path,
    bytes: Vec<u8>,
    choices: &Choices,
    geometry: &mut Geometry,
) -> Result<Import, ImportError> {
    let content = bytes::content(bytes).map_err(|reason| Trouble::NotARecord(reason).of(path))?;
    from_content(path, content, choices, geometry)
}

fn from_content(
    path: &Path,
    content: Content,
    choices: &Choices,
    geometry: &mut Geometry,
) -> Result<Import, ImportError> {
    let source = Source::of(content, choices);
    source.and_then(|s| understand(path, s, choices, geometry)).map_err(|trouble| trouble.of(path))
}

fn understand(
    path: &Path,
    source: Source,
    choices: &Choices,
    geometry: &mut Geometry,
) -> Result<Import, Trouble> {
    let text = &source.text;
    let (dialect, hints) = source.hints();
    let delimiter = source.delimiter(choices, &hints)?;
    let mut blocks = layout::blocks(text, delimiter, choices.skip_rows);
    blocks.retain(|b| b.count >= FEWEST);
    let (main, columns) = table(text, delimiter, &blocks, choices, &hints)?;
    let used: Vec<&Block> = blocks
        .iter()
        .filter(|b| b.names == main.names && b.units == main.units && b.width == main.width)
        .collect();
    let (locale, because) = locale(text, delimiter, &used, &columns, choices, &hints)?;
    let header = header::read(text, delimiter, &blocks, locale, &hints);
    let mut remarks: Vec<String> = hints.remarks.iter().map(|r| (*r).to_owned()).collect();
    remarks.extend(geometry.add(&header));
    if used.len() < blocks.len() {
        let n = blocks.len() - used.len();
        remarks.push(format!("{n} other table{} of the file not used", if n == 1 { "" } else { "s" }));
    }
    let (mut rows, unread) = rows::read(text, delimiter, &used, &columns, locale);
    let (count, mut found) = (rows.len(), Vec::new());
    let done = in_channels(&mut rows, &unread, &columns, geometry, choices, &mut found)?;
    by_table(&mut rows, used.len());
    let parts = clock::parts(&mut rows, choices, &mut found)?;
    let tests = parts.into_iter().map(|part| test(part, choices)).collect::<Result<Vec<_>, _>>()?;
    let reading = Reading {
        dialect,
        encoding: source.encoding,
        encoding_because: source.because,
        sheet: source.sheet,
        delimiter: sniff::name(delimiter),
        decimal: locale.decimal,
        decimal_because: because,
        header_row: main.header.map(|h| h + 1),
        tables: used.len(),
        rows: count,
        columns: columns.iter().map(Column::understood).collect(),
    };
    Ok(Import { file: path.to_owned(), reading, header, done, remarks, faults: found, tests })
}

/// Makes rows as read time, displacement and force; says what was converted. All faults at once.
fn in_channels(
    rows: &mut Rows,
    unread: &Unread,
    columns: &[Column],
    geometry: &Geometry,
    choices: &Choices,
    found: &mut Vec<Found>,
) -> Result<Vec<String>, Vec<Fault>> {
    let mut wrong = faults::unread(rows, unread, choices, found);
    let mut done = physics::convert(rows, columns, geometry, choices).unwrap_or_else(|faults| {
        wrong.extend(faults);
        Vec::new()
    });
    if !wrong.is_empty() {
        return Err(wrong);
    }
    done.extend(physics::time(rows, choices).map_err(|f| vec![f])?);
    Ok(done)
}

/// Tables without named segments are segments themselves.
fn by_table(rows: &mut Rows, tables: usize) {
    if tables > 1 && rows.label.is_empty() && tables < 2000 {
        rows.labels = (1..=tables).map(|k| format!("table {k}")).collect();
        rows.label = rows.table.clone();
    }
}
