//! The way from a file to its tests.

use crate::bytes::{self, Content};
use crate::choices::Choices;
use crate::columns::{Column, Understood};
use crate::dialects;
use crate::encoding;
use crate::error::{Fault, ImportError, Question};
use crate::faults::{self, Found};
use crate::geometry::Geometry;
use crate::header::{self, HeaderEntry};
use crate::inspect::inspect;
use crate::layout::{self, Block, FEWEST};
use crate::physics::{self, Proposal};
use crate::reduce::{self, Reduction};
use crate::rows::{self, Rows};
use crate::sniff;
use crate::table::{Trouble, locale, table};
use crate::text::Text;
use crate::workbook::{self, Unopened};
use crate::{noise, output};
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
    let content =
        bytes::content(bytes).map_err(|reason| ImportError::NotARecord { path: path.to_owned(), reason })?;
    from_content(path, content, choices, geometry)
}

/// Where the text came from.
struct Source {
    text: Text,
    encoding: String,
    because: &'static str,
    sheet: Option<String>,
    numbers: bool,
}

fn source(content: Content, choices: &Choices) -> Result<Source, Unopened> {
    match content {
        Content::Text(bytes) => {
            let decoded = encoding::decode(&bytes, choices.encoding.as_deref()).map_err(Unopened::Bad)?;
            let encoding = decoded.encoding.to_owned();
            Ok(Source {
                text: Text::new(decoded.text),
                encoding,
                because: decoded.why,
                sheet: None,
                numbers: false,
            })
        }
        Content::Workbook(bytes) => {
            let sheet = workbook::read(bytes, choices.sheet.as_deref())?;
            Ok(Source {
                text: Text::new(sheet.text),
                encoding: "workbook".into(),
                because: "its first bytes",
                sheet: Some(sheet.name),
                numbers: sheet.numbers,
            })
        }
    }
}

fn from_content(
    path: &Path,
    content: Content,
    choices: &Choices,
    geometry: &mut Geometry,
) -> Result<Import, ImportError> {
    let no_record = |reason: String| ImportError::NotARecord { path: path.to_owned(), reason };
    let ask = |q: Question| ImportError::Undecided { path: path.to_owned(), questions: vec![q] };
    let faulty = |faults: Vec<Fault>| ImportError::Faulty { path: path.to_owned(), faults };
    let source = source(content, choices).map_err(|e| match e {
        Unopened::Bad(reason) => no_record(reason),
        Unopened::Ask(question) => ask(question),
    })?;
    let text = &source.text;
    let (dialect, mut hints) = dialects::recognise(text);
    if source.sheet.is_some() {
        hints.delimiter = Some('\t');
        hints.decimal = source.numbers.then_some('.');
    }
    let delimiter = match choices.delimiter.filter(|_| source.sheet.is_none()).or(hints.delimiter) {
        Some(said) => said,
        None => sniff::delimiter(text).map_err(|q| q.map_or_else(|| no_record(no_table()), ask))?,
    };
    let mut blocks = layout::blocks(text, delimiter, choices.skip_rows);
    blocks.retain(|b| b.count >= FEWEST);
    let (main, columns) = table(text, delimiter, &blocks, choices, &hints).map_err(|t| match t {
        Trouble::None => no_record(no_table()),
        Trouble::Ask(questions) => ImportError::Undecided { path: path.to_owned(), questions },
        Trouble::Wrong(faults) => faulty(faults),
    })?;
    let used: Vec<&Block> = blocks
        .iter()
        .filter(|b| b.names == main.names && b.units == main.units && b.width == main.width)
        .collect();
    let (locale, because) = locale(text, delimiter, &used, &columns, choices, &hints).map_err(ask)?;
    let header = header::read(text, delimiter, &blocks, locale, &hints);
    let mut remarks: Vec<String> = hints.remarks.iter().map(|r| (*r).to_owned()).collect();
    remarks.extend(geometry.add(&header));
    if used.len() < blocks.len() {
        let n = blocks.len() - used.len();
        remarks.push(format!("{n} other table{} of the file not used", if n == 1 { "" } else { "s" }));
    }
    let (mut rows, unread) = rows::read(text, delimiter, &used, &columns, locale);
    let count = rows.len();
    let mut found = Vec::new();
    let mut wrong = faults::unread(&mut rows, &unread, choices, &mut found);
    let mut done = match physics::convert(&mut rows, &columns, geometry, choices) {
        Ok(done) => done,
        Err(faults) => {
            wrong.extend(faults);
            Vec::new()
        }
    };
    if !wrong.is_empty() {
        return Err(faulty(wrong));
    }
    done.extend(physics::clock(&mut rows, choices).map_err(|f| faulty(vec![f]))?);
    by_table(&mut rows, used.len());
    let parts = faults::clock(&mut rows, choices, &mut found).map_err(ask)?;
    let tests =
        parts.into_iter().map(|part| test(part, choices)).collect::<Result<Vec<_>, _>>().map_err(faulty)?;
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

fn no_table() -> String {
    "no table of numbers in this text; expected rows of time, displacement and force".into()
}

/// Tables without named segments are segments themselves.
fn by_table(rows: &mut Rows, tables: usize) {
    if tables > 1 && rows.label.is_empty() && tables < 2000 {
        rows.labels = (1..=tables).map(|k| format!("table {k}")).collect();
        rows.label = rows.table.clone();
    }
}

/// Less than this share of the largest force is rounding, no noise: none is declared then.
const NO_NOISE: f64 = 1e-5;

/// A test of the rows between two starts of the clock.
fn test(mut rows: Rows, choices: &Choices) -> Result<Test, Vec<Fault>> {
    let fault = |row: Option<u32>, message: String, remedy: &str| {
        vec![Fault { row: row.map(|r| r as usize), column: None, message, remedy: remedy.into() }]
    };
    let mut found = Vec::new();
    inspect(&mut rows, choices, &mut found);
    let first = rows.row.first().copied();
    if rows.len() < FEWEST {
        let message = format!("{} rows are left; expected at least {FEWEST}", rows.len());
        return Err(fault(
            first,
            message,
            "look at the faults of the rows before; --skip-rows and --restart say what belongs together",
        ));
    }
    let still = |u: &[f64]| physics::range(u) <= 0.0;
    if still(&rows.displacement) && rows.across[0].as_deref().is_none_or(still) {
        let message = "the displacement is the same in every row; expected a test that moves".to_owned();
        return Err(fault(first, message, "name the column of the actuator: --displacement N"));
    }
    let noise = noise::sd(&rows.force);
    let (done, proposals) = physics::settle(&mut rows, choices, noise);
    if rows.label.windows(2).all(|w| w[0] == w[1]) {
        rows.label.clear();
    }
    let mut segments: Vec<String> = Vec::new();
    for l in rows.label.chunk_by(|a, b| a == b).filter_map(|c| rows.labels.get(c[0] as usize)) {
        if !segments.contains(l) {
            segments.push(l.clone());
        }
    }
    // One standard deviation for all points is made for one force.
    let points = choices.points.filter(|_| !choices.two_axes);
    let reduced = points.and_then(|points| reduce::reduce(&rows, points));
    let size = reduced.as_ref().map_or(1, |r| r.1.rows_per_point);
    let (of_rows, of_points) = reduce::deviations(&rows, size);
    let last = rows.row.last().copied();
    let peak = rows.force.iter().fold(0.0_f64, |m, f| m.max(f.abs()));
    Ok(Test {
        name: String::new(),
        kind: String::new(),
        file_rows: (first.unwrap_or(0), last.unwrap_or(0)),
        force_sd_of_rows: of_rows,
        force_sd_of_points: reduced.as_ref().map(|_| of_points).filter(|sd| *sd > NO_NOISE * peak),
        segments,
        done,
        proposals,
        faults: found,
        reduction: reduced.as_ref().map(|r| r.1.clone()),
        reduced: reduced.map(|r| r.0),
        full: rows,
    })
}
