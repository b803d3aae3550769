//! Why a file is no record yet: it cannot be one, something must be decided, or rows are wrong.

use serde::Serialize;
use std::fmt;
use std::path::PathBuf;

/// A decision that the file does not settle, with the flag that does.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Question {
    /// What is to be decided, as a sentence.
    pub what: String,
    /// The flag without dashes (`force`, `decimal`).
    pub flag: String,
    /// Values the flag may take here, each with what it would mean. Empty: the user writes one.
    pub options: Vec<Choice>,
}

/// One answer to a [`Question`].
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Choice {
    /// What stands after the flag.
    pub value: String,
    /// What it means.
    pub meaning: String,
}

impl Question {
    /// A question with the values that its flag may take.
    pub(crate) fn new(flag: &str, what: impl Into<String>, options: Vec<(String, String)>) -> Self {
        let options = options.into_iter().map(|(value, meaning)| Choice { value, meaning }).collect();
        Self { what: what.into(), flag: flag.into(), options }
    }
}

/// A fault of the rows that keeps the file from being a record.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Fault {
    /// Row of the file, from 1; `None`: the whole file.
    pub row: Option<usize>,
    /// Column, from 1.
    pub column: Option<usize>,
    /// What was found and what was expected.
    pub message: String,
    /// The flag or edit that mends it.
    pub remedy: String,
}

/// Why there is no record.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ImportError {
    /// The file cannot be a record whatever is said: a picture, a directory, text without a table.
    NotARecord {
        /// The file.
        path: PathBuf,
        /// What it is, and what was expected.
        reason: String,
    },
    /// Flags must decide; all questions that could be asked at once.
    Undecided {
        /// The file.
        path: PathBuf,
        /// What is open.
        questions: Vec<Question>,
    },
    /// Rows are wrong, or a flag does not fit the file.
    Faulty {
        /// The file.
        path: PathBuf,
        /// All that was found, the first of each kind with its place.
        faults: Vec<Fault>,
    },
}

impl fmt::Display for ImportError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotARecord { path, reason } => {
                write!(f, "{}: error: {reason}", visible(&path.display().to_string()))
            }
            Self::Undecided { path, questions } => {
                for (k, q) in questions.iter().enumerate() {
                    let line = if k > 0 { "\n" } else { "" };
                    let path = visible(&path.display().to_string());
                    write!(f, "{line}{path}: error: {}\n  = help: say ", q.what)?;
                    if q.options.is_empty() {
                        write!(f, "--{} …", q.flag)?;
                    }
                    for (i, o) in q.options.iter().enumerate() {
                        let or = if i > 0 { "\n    or   " } else { "" };
                        write!(f, "{or}--{} {}   ({})", q.flag, quoted(&o.value), o.meaning)?;
                    }
                }
                Ok(())
            }
            Self::Faulty { path, faults } => {
                for (k, fault) in faults.iter().enumerate() {
                    let line = if k > 0 { "\n" } else { "" };
                    write!(f, "{line}{}", visible(&path.display().to_string()))?;
                    if let Some(row) = fault.row {
                        write!(f, ":{row}")?;
                        if let Some(column) = fault.column {
                            write!(f, ":{column}")?;
                        }
                    }
                    write!(f, ": error: {}\n  = help: {}", fault.message, fault.remedy)?;
                }
                Ok(())
            }
        }
    }
}

impl std::error::Error for ImportError {}

/// A value as it is typed into a shell.
pub fn quoted(value: &str) -> String {
    let plain = value.chars().all(|c| c.is_alphanumeric() || "-_.=/%+".contains(c));
    if plain && !value.is_empty() {
        value.to_owned()
    } else {
        format!("'{}'", visible(value).replace('\'', r"'\''"))
    }
}

/// Text of a file, safe to print: control and direction characters escaped, and not too long.
pub fn visible(text: &str) -> String {
    let mut out = String::new();
    for (k, c) in text.chars().enumerate() {
        if k == 200 {
            out.push('…');
            break;
        }
        match c {
            '\t' => out.push(' '),
            '\u{200B}'..='\u{200F}' | '\u{2028}'..='\u{202E}' | '\u{2060}'..='\u{206F}' | '\u{FEFF}' => {
                out.extend(c.escape_unicode());
            }
            c if c.is_control() => out.extend(c.escape_default()),
            c => out.push(c),
        }
    }
    out
}

/// A number for a sentence: six digits, no trailing zeros.
pub(crate) fn short(x: f64) -> String {
    if x == 0.0 {
        return "0".into();
    }
    let text = format!("{x:.5e}");
    let rounded: f64 = text.parse().unwrap_or(x);
    if (1e-4..1e7).contains(&rounded.abs()) { format!("{rounded}") } else { format!("{rounded:e}") }
}
