//! Files of an import: all are made in memory first, none is written over another.

use crate::outcome::Failure;
use crate::session::{Session, unoffered};
use ::report::figures::{Channels, ending, export, of_record};
use ::report::write_atomic;
use input::Figure as Format;
use records::words::Dimension;
use records::{Geometry, Import, Rows, Test};
use serde_json::Value;
use std::path::{Path, PathBuf};

/// What will be written, and where.
pub struct Plan {
    folder: PathBuf,
    files: Vec<(PathBuf, Vec<u8>)>,
}

impl Plan {
    /// Every path, the log's last.
    pub fn paths(&self) -> Vec<PathBuf> {
        self.files.iter().map(|f| f.0.clone()).chain([self.log()]).collect()
    }

    fn log(&self) -> PathBuf {
        self.folder.join("import.json")
    }

    /// Writes everything, each file whole.
    ///
    /// # Errors
    /// If the disk refuses.
    pub fn write(&self, answer: &Value) -> Result<(), Failure> {
        let log = format!("{answer:#}\n").into_bytes();
        let log = (self.log(), log);
        for (path, content) in self.files.iter().chain([&log]) {
            if let Some(folder) = path.parent() {
                std::fs::create_dir_all(folder).map_err(|source| ::report::ReportError::Io {
                    path: folder.to_owned(),
                    action: "create the directory",
                    source,
                })?;
            }
            write_atomic(path, content)?;
        }
        Ok(())
    }
}

/// Makes the files of an import.
///
/// # Errors
/// If one of them exists already, or a picture cannot be drawn.
pub fn plan(
    folder: &Path,
    name: &str,
    geometry: &Geometry,
    read: &[Import],
    session: &Session,
) -> Result<Plan, Failure> {
    let formats: Vec<Format> = match &session.common.figures {
        Some(formats) => formats.iter().map(|f| (*f).into()).collect(),
        None => vec![Format::Svg],
    };
    formats.iter().try_for_each(|f| unoffered(*f))?;
    let mut files = Vec::new();
    for (import, test) in read.iter().flat_map(|i| i.tests.iter().map(move |t| (i, t))) {
        let comments = comments(import, test);
        files.push((folder.join(format!("{}.csv", test.name)), test.csv(&comments).into_bytes()));
        if let Some(full) = test.full_csv(&comments[..comments.len() - 1]) {
            files.push((folder.join("full").join(format!("{}.csv", test.name)), full.into_bytes()));
        }
        let picture = of_record(&test.name, channels(&test.full), test.reduced.as_ref().map(channels))?;
        for format in &formats {
            let file = folder.join(format!("{}.{}", test.name, ending(*format)));
            files.push((file, export(&picture, *format)?));
        }
    }
    let tests: Vec<Test> = read.iter().flat_map(|i| i.tests.iter().cloned()).collect();
    let specimen = records::specimen(name, &provenance(read), geometry, &tests);
    files.push((folder.join("specimen.toml"), specimen.into_bytes()));
    let plan = Plan { folder: folder.to_owned(), files };
    let there: Vec<String> = plan
        .paths()
        .iter()
        .filter(|p| p.symlink_metadata().is_ok())
        .map(|p| p.display().to_string())
        .collect();
    if there.is_empty() {
        Ok(plan)
    } else {
        Err(Failure::usage(format!(
            "fct import: {}: this exists already; nothing was written\n  = help: name another folder: --out NAME",
            there.join(", ")
        )))
    }
}

fn channels(rows: &Rows) -> Channels<'_> {
    Channels { time: &rows.time, displacement: &rows.displacement, force: &rows.force }
}

/// Where the record of a test is from, and what was done to it: lines above its header. The last one is about the
/// reduction, if there was one.
fn comments(import: &Import, test: &Test) -> Vec<String> {
    let file = import.file.file_name().map_or_else(String::new, |f| f.to_string_lossy().into_owned());
    let (first, last) = test.file_rows;
    let mut out = vec![format!(
        "imported by fct {} from {file} ({}), rows {first} to {last}",
        env!("CARGO_PKG_VERSION"),
        import.reading.dialect
    )];
    out.extend(import.done.iter().chain(&test.done).cloned());
    for found in import.faults.iter().chain(&test.faults).filter(|f| f.rule == "dropped") {
        out.push(format!("dropped: {}", found.what));
    }
    if let Some(r) = &test.reduction {
        let each = if r.rows_per_point > 1 {
            format!("means of {} rows, and the corners", r.rows_per_point)
        } else {
            "single rows".into()
        };
        out.push(format!(
            "{} points of {} rows: {each}; all rows are in full/{}.csv",
            r.points, r.rows, test.name
        ));
    }
    out
}

/// One sentence for the specimen and every report.
fn provenance(read: &[Import]) -> String {
    let files: Vec<String> = read
        .iter()
        .map(|i| {
            let name = i.file.file_name().map_or_else(String::new, |f| f.to_string_lossy().into_owned());
            let note = i.header.iter().find(|s| s.about == Dimension::Note);
            let note = note.map_or_else(String::new, |n| format!(", which says: {}", n.text));
            format!("{name} ({}{note})", i.reading.dialect)
        })
        .collect();
    let mut done: Vec<String> = Vec::new();
    for d in read.iter().flat_map(|i| i.done.iter().chain(i.tests.iter().flat_map(|t| &t.done))) {
        if !done.contains(d) {
            done.push(d.clone());
        }
    }
    let done = if done.is_empty() { String::new() } else { format!("; {}", done.join("; ")) };
    format!("imported by fct {} from {}{done}", env!("CARGO_PKG_VERSION"), files.join(", "))
}
