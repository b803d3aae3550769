//! The table of specimens, as a CSV file or as `[[specimens]]`.

use super::{Item, Reader, Row};
use crate::csv::{self, Cell, Faults};
use crate::diagnostics::{Diagnostic, Diagnostics, Report, Sink};
use crate::text::{SourceFile, short};
use std::path::Path;
use toml::de::{DeTable, DeValue};

const COLUMNS: [&str; 4] = ["file", "group", "donor", "exclude"];

impl Reader<'_> {
    /// `[[specimens]]`.
    pub(super) fn listed(&self, here: &Item) -> Vec<Result<Row, Diagnostics>> {
        let DeValue::Array(items) = here.get_ref() else {
            self.fault(here, "specimens", "expected [[specimens]] with `file`");
            return Vec::new();
        };
        items.iter().enumerate().map(|(k, item)| self.listed_row(item, k + 1)).collect()
    }

    fn listed_row(&self, item: &Item, number: usize) -> Result<Row, Diagnostics> {
        let DeValue::Table(table) = item.get_ref() else {
            let fault =
                self.report(item, "specimens", &format!("row {number}: expected [[specimens]] with `file`"));
            return Err(Diagnostics(vec![fault]));
        };
        // Faults of a row are its own.
        let sink = Sink::default();
        let own = Reader { file: self.file, sink: &sink };
        own.known(table, &COLUMNS, &format!("row {number} of [[specimens]]"));
        let row = own.row_of(table, number);
        if row.file.as_os_str().is_empty() && !sink.has_errors() {
            own.fault(item, "file", &format!("row {number}: missing `file`, a specimen or a config"));
        }
        if sink.has_errors() { Err(Diagnostics(sink.into_sorted())) } else { Ok(row) }
    }

    fn row_of(&self, table: &DeTable, number: usize) -> Row {
        let text = |key| self.text(table, key).map(|t| t.trim().to_owned()).filter(|t| !t.is_empty());
        Row {
            number,
            file: text("file").map(|f| self.beside(&f)).unwrap_or_default(),
            group: text("group").unwrap_or_default(),
            donor: text("donor").unwrap_or_default(),
            exclude: text("exclude"),
        }
    }

    /// `table = "specimens.csv"`; paths in it are relative to it.
    pub(super) fn csv(&self, top: &DeTable, at: &Item) -> Vec<Result<Row, Diagnostics>> {
        let Some(given) = self.text(top, "table") else { return Vec::new() };
        let path = self.beside(&given);
        match csv::load(&path, "a table of specimens (CSV)") {
            Ok(table) => rows(&table, self.sink),
            Err(fault) => {
                self.sink.push(self.report(at, "table", "this table cannot be used"));
                self.sink.push(*fault);
                Vec::new()
            }
        }
    }
}

fn rows(table: &SourceFile, sink: &Sink) -> Vec<Result<Row, Diagnostics>> {
    let mut lines = csv::lines(table);
    let mut faults = Faults::new(table, sink);
    let header = lines.next().and_then(|line| csv::cells(table, line, &mut faults)).unwrap_or_default();
    for cell in header.iter().filter(|c| !COLUMNS.contains(&c.text.as_ref())) {
        let text = format!("unknown column `{}`; expected {}", short(&cell.text), COLUMNS.join(", "));
        faults.add(Report::error(text).key(cell.text.clone()), cell.span.clone());
    }
    if !header.iter().any(|c| c.text == "file") && !faults.any() {
        faults.add(
            Report::error("missing the column `file`, a specimen or a config per row").key("file"),
            0..0,
        );
    }
    if faults.finish() {
        return Vec::new();
    }
    lines.enumerate().map(|(k, line)| row(table, &header, line, k + 1)).collect()
}

fn row(
    table: &SourceFile,
    header: &[Cell],
    line: std::ops::Range<usize>,
    number: usize,
) -> Result<Row, Diagnostics> {
    let sink = Sink::default();
    let mut faults = Faults::new(table, &sink);
    let cells = csv::cells(table, line.clone(), &mut faults).unwrap_or_default();
    if !faults.any() && cells.len() != header.len() {
        let text = format!("row {number} has {} cells; the header has {}", cells.len(), header.len());
        faults.add(Report::error(text), line.clone());
    }
    let of = |name: &str| {
        let cell = header.iter().position(|h| h.text == name).and_then(|i| cells.get(i));
        cell.map(|c| c.text.clone().into_owned()).unwrap_or_default()
    };
    let file = of("file");
    if !faults.any() && file.is_empty() {
        let text = format!("row {number}: the cell of `file` is empty; expected a specimen or a config");
        faults.add(Report::error(text).key("file"), line);
    }
    if faults.finish() {
        return Err(Diagnostics(sink.into_sorted()));
    }
    let folder = table.path.parent().unwrap_or(Path::new(""));
    let exclude = Some(of("exclude")).filter(|t| !t.is_empty());
    Ok(Row { number, file: folder.join(file), group: of("group"), donor: of("donor"), exclude })
}

impl From<Diagnostic> for Diagnostics {
    fn from(fault: Diagnostic) -> Self {
        Self(vec![fault])
    }
}
