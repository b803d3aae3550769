//! Faults with file, line and column, shown the way compilers show them.

use crate::inputs::InputFile;
use crate::text::{SourceFile, visible};
use serde::Serialize;
use std::cell::RefCell;
use std::fmt;
use std::ops::Range;
use std::path::PathBuf;

/// How bad it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Severity {
    /// The input cannot be used.
    Error,
    /// The input is used, but the user should know.
    Warning,
}

/// The line of a file that a diagnostic is about, ready to print.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Excerpt {
    /// The line: control characters escaped, the middle of an overlong line only.
    pub line: String,
    /// Characters before the place in question.
    pub indent: usize,
    /// Characters of the place in question.
    pub width: usize,
}

/// One fault, or one warning.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Diagnostic {
    /// The file as the user named it.
    pub file: PathBuf,
    /// Line, from 1.
    pub line: Option<usize>,
    /// Column in characters, from 1.
    pub column: Option<usize>,
    /// The key or CSV column in question.
    pub key: Option<String>,
    /// What is wrong: found and expected. Safe to print on a terminal.
    pub message: String,
    /// What to do about it.
    pub help: Option<String>,
    /// Error or warning.
    pub severity: Severity,
    /// The line of the file.
    pub excerpt: Option<Excerpt>,
}

impl fmt::Display for Diagnostic {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", visible(&self.file.display().to_string()))?;
        if let Some(line) = self.line {
            write!(f, ":{line}")?;
            if let Some(column) = self.column {
                write!(f, ":{column}")?;
            }
        }
        let severity = match self.severity {
            Severity::Error => "error",
            Severity::Warning => "warning",
        };
        write!(f, ": {severity}: {}", self.message)?;
        let gutter = self.line.map_or(1, |l| l.to_string().len());
        if let (Some(line), Some(excerpt)) = (self.line, &self.excerpt) {
            write!(f, "\n {line} | {}", excerpt.line)?;
            let carets = "^".repeat(excerpt.width.max(1));
            write!(f, "\n {:gutter$} | {:indent$}{carets}", "", "", indent = excerpt.indent)?;
        }
        if let Some(help) = &self.help {
            write!(f, "\n {:gutter$} = help: {help}", "")?;
        }
        Ok(())
    }
}

/// Everything that is wrong with an input, in the order of files and lines.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Diagnostics(pub Vec<Diagnostic>);

impl Diagnostics {
    /// Whether at least one of them is an error.
    pub fn has_errors(&self) -> bool {
        self.0.iter().any(|d| d.severity == Severity::Error)
    }
}

impl fmt::Display for Diagnostics {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (i, diagnostic) in self.0.iter().enumerate() {
            if i > 0 {
                writeln!(f)?;
            }
            write!(f, "{diagnostic}")?;
        }
        Ok(())
    }
}

impl std::error::Error for Diagnostics {}

/// Most TOML diagnostics kept per file; the rest are counted.
const MOST_PER_FILE: usize = 100;

/// Where readers put what they find, so that reading goes on after a fault.
#[derive(Debug, Default)]
pub(crate) struct Sink {
    found: RefCell<Vec<Diagnostic>>,
    read: RefCell<Vec<InputFile>>,
}

impl Sink {
    /// Adds a diagnostic, unless its file has had more than enough of them.
    pub fn push(&self, diagnostic: Diagnostic) {
        let mut found = self.found.borrow_mut();
        let same_file = found.iter().filter(|d| d.file == diagnostic.file).count();
        if same_file < MOST_PER_FILE {
            found.push(diagnostic);
        } else if same_file == MOST_PER_FILE {
            let message = format!("… and more: only the first {MOST_PER_FILE} faults are shown");
            found.push(Report::error(message).about(diagnostic.file));
        }
    }

    /// Notes a file whose content goes into the case.
    pub fn was_read(&self, file: &SourceFile) {
        let mut read = self.read.borrow_mut();
        let path = crate::case::absolute(&file.path);
        if let Some(sha256) = file.sha256.clone().filter(|_| !read.iter().any(|r| r.file == path)) {
            read.push(InputFile { file: path, sha256 });
        }
    }

    /// The files that were read so far.
    pub fn files(&self) -> Vec<InputFile> {
        self.read.borrow().clone()
    }

    /// Whether an error was found so far.
    pub fn has_errors(&self) -> bool {
        self.found.borrow().iter().any(|d| d.severity == Severity::Error)
    }

    /// Whether a file already has so many diagnostics that more would not be shown.
    pub fn is_full(&self, file: &SourceFile) -> bool {
        self.found.borrow().iter().filter(|d| d.file == file.path).count() > MOST_PER_FILE
    }

    /// All of them: files in the order in which they were met, lines in order within a file.
    pub fn into_sorted(self) -> Vec<Diagnostic> {
        let mut found = self.found.into_inner();
        let mut files: Vec<PathBuf> = Vec::new();
        for diagnostic in &found {
            if !files.contains(&diagnostic.file) {
                files.push(diagnostic.file.clone());
            }
        }
        found.sort_by_key(|d| {
            let file = files.iter().position(|f| *f == d.file);
            (file, d.line.unwrap_or(usize::MAX), d.column)
        });
        // A table that is asked twice says twice what is wrong with it.
        found.dedup_by(|a, b| {
            (&a.file, a.line, a.column, &a.message) == (&b.file, b.line, b.column, &b.message)
        });
        found
    }
}

/// A diagnostic being written: message first, then where.
pub(crate) struct Report {
    message: String,
    key: Option<String>,
    help: Option<String>,
    severity: Severity,
}

impl Report {
    /// An error with this message. User text in it must have gone through [`visible`].
    pub fn error(message: impl Into<String>) -> Self {
        Self { message: message.into(), key: None, help: None, severity: Severity::Error }
    }

    /// A warning.
    pub fn warning(message: impl Into<String>) -> Self {
        Self { severity: Severity::Warning, ..Self::error(message) }
    }

    /// With the key in question.
    pub fn key(mut self, key: impl Into<String>) -> Self {
        self.key = Some(key.into());
        self
    }

    /// With advice.
    pub fn help(mut self, help: impl Into<String>) -> Self {
        self.help = Some(help.into());
        self
    }

    /// About a file as a whole.
    pub fn about(self, file: impl Into<PathBuf>) -> Diagnostic {
        Diagnostic {
            file: file.into(),
            line: None,
            column: None,
            key: self.key,
            message: self.message,
            help: self.help,
            severity: self.severity,
            excerpt: None,
        }
    }

    /// About a place in a file, in bytes of its text.
    pub fn at(self, file: &SourceFile, span: Range<usize>) -> Diagnostic {
        let place = file.place(span);
        Diagnostic {
            line: Some(place.line),
            column: Some(place.column),
            excerpt: Some(place.excerpt),
            ..self.about(file.path.clone())
        }
    }
}
