//! CSV files: records and profiles.
//!
//! Lines are split here, not by a CSV library, because every fault is to be told with its exact line and
//! column: comments, blank lines and blanks around cells are allowed, quoted cells must end on their line.

mod columns;
mod profile;
mod record;
mod sanity;

pub(crate) use profile::read_rows;
pub(crate) use record::read_record;

use crate::diagnostics::{Diagnostic, Report, Sink};
use crate::text::SourceFile;
use std::borrow::Cow;
use std::ops::Range;

/// Largest CSV file, bytes.
pub(crate) const LIMIT: u64 = 200_000_000;
/// Longest line, bytes.
const LONGEST_LINE: usize = 65_536;
/// Bad rows shown per file; the rest are counted.
const SHOWN: usize = 20;

/// A cell with its place in the file.
pub(crate) struct Cell<'a> {
    /// Content without quotes and outer blanks.
    pub text: Cow<'a, str>,
    /// Where it stands.
    pub span: Range<usize>,
}

/// Faults of one file: the first are kept, the rest counted.
pub(crate) struct Faults<'a> {
    file: &'a SourceFile,
    sink: &'a Sink,
    count: usize,
}

impl<'a> Faults<'a> {
    pub fn new(file: &'a SourceFile, sink: &'a Sink) -> Self {
        Self { file, sink, count: 0 }
    }

    /// Adds an error at a place.
    pub fn add(&mut self, report: Report, span: Range<usize>) {
        self.count += 1;
        if self.count <= SHOWN {
            self.sink.push(report.at(self.file, span));
        }
    }

    /// Whether there were any so far.
    pub fn any(&self) -> bool {
        self.count > 0
    }

    /// Says how many were not shown; whether there were any at all.
    pub fn finish(self) -> bool {
        if self.count > SHOWN {
            let more = self.count - SHOWN;
            let plural = if more == 1 { "fault" } else { "faults" };
            let report = Report::error(format!("… and {more} more {plural} in this file"));
            self.sink.push(report.about(self.file.path.clone()));
        }
        self.count > 0
    }
}

/// Reads the text of a CSV file; blank files are errors.
pub(crate) fn load(path: &std::path::Path, what: &str) -> Result<SourceFile, Box<Diagnostic>> {
    let file = SourceFile::read(path, LIMIT, what)?;
    if file.is_blank() {
        let report = Report::error(format!("the file is empty; expected {what}"));
        return Err(Box::new(report.about(path)));
    }
    Ok(file)
}

/// The lines that hold something: not blank, not a comment.
pub(crate) fn lines(file: &SourceFile) -> impl Iterator<Item = Range<usize>> + '_ {
    let mut start = 0;
    file.text.split_inclusive('\n').filter_map(move |line| {
        let at = start;
        start += line.len();
        let body = line.trim_end_matches(['\n', '\r']);
        let content = body.trim_start();
        (!content.is_empty() && !content.starts_with('#')).then(|| at..at + body.len())
    })
}

/// Splits a line at its commas; a fault is reported and gives `None`.
pub(crate) fn cells<'a>(
    file: &'a SourceFile,
    line: Range<usize>,
    faults: &mut Faults<'_>,
) -> Option<Vec<Cell<'a>>> {
    if line.len() > LONGEST_LINE {
        let message = format!("this line has {} bytes; expected at most {LONGEST_LINE}", line.len());
        faults.add(Report::error(message), line.start..line.start + 1);
        return None;
    }
    let (text, mut cells, mut at) = (&file.text[line.clone()], Vec::new(), 0);
    loop {
        let rest = &text[at..];
        let blanks = rest.len() - rest.trim_start_matches([' ', '\t']).len();
        let (cell, end) = if rest[blanks..].starts_with('"') {
            let Some((content, len)) = quoted(&rest[blanks..]) else {
                let start = line.start + at + blanks;
                faults.add(
                    Report::error("this quote is never closed, or text follows its end; expected `\"…\"`"),
                    start..line.end,
                );
                return None;
            };
            let start = line.start + at + blanks;
            (Cell { text: content, span: start..start + len }, at + blanks + len)
        } else {
            let len = rest.find(',').unwrap_or(rest.len());
            let content = rest[..len].trim();
            let start = line.start + at + if content.is_empty() { 0 } else { blanks };
            (Cell { text: Cow::Borrowed(content), span: start..start + content.len() }, at + len)
        };
        cells.push(cell);
        let tail = &text[end..];
        let skip = tail.len() - tail.trim_start_matches([' ', '\t']).len();
        match tail[skip..].chars().next() {
            Some(',') => at = end + skip + 1,
            _ => return Some(cells),
        }
    }
}

/// Content and length of a quoted cell; `None` if it does not end, or not at a comma.
fn quoted(text: &str) -> Option<(Cow<'_, str>, usize)> {
    let mut at = 1;
    loop {
        let close = at + text[at..].find('"')?;
        if text[close + 1..].starts_with('"') {
            at = close + 2;
            continue;
        }
        let after = text[close + 1..].trim_start_matches([' ', '\t']);
        if !after.is_empty() && !after.starts_with(',') {
            return None;
        }
        let inner = &text[1..close];
        let content =
            if inner.contains("\"\"") { inner.replace("\"\"", "\"").into() } else { Cow::Borrowed(inner) };
        return Some((content, close + 1));
    }
}
