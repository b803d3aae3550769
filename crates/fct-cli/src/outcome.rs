//! How a command ends: what goes to stdout, what to stderr, and the exit code.

use crate::session::Session;
use analysis::AnalysisError;
use input::Diagnostics;
use report::ReportError;
use report::answer::SCHEMA;
use report::terminal::{Style, printable, printable_json};
use serde::Serialize;
use serde_json::{Value, json};
use std::io::{ErrorKind, Write};
use std::path::Path;
use std::process::ExitCode;

/// A command that gave an answer.
#[derive(Debug)]
pub struct Outcome {
    /// The answer for `--json`.
    pub json: Value,
    /// The answer for people.
    pub text: String,
    /// Why it is only a partial answer (exit code 1).
    pub partial: Option<String>,
}

/// A command that gave none.
#[derive(Debug)]
pub struct Failure {
    /// 1: could not compute; 2: bad input or usage.
    pub code: u8,
    /// The reason, for people.
    pub message: String,
    /// The same as data.
    pub json: Value,
}

impl Outcome {
    /// An answer.
    ///
    /// # Errors
    /// If the answer cannot be written as JSON.
    pub fn new<T: Serialize>(answer: &T, text: String) -> Result<Self, Failure> {
        let json = serde_json::to_value(answer)
            .map_err(|e| Failure::compute(format!("the answer is no JSON: {e}")))?;
        Ok(Self { json, text, partial: None })
    }

    /// Adds where the run is.
    pub fn at(mut self, place: &Path) -> Self {
        self.text.push_str(&format!("Run directory: {}\n", place.display()));
        self
    }

    /// The same answer, which could not be stored.
    pub fn unstored(self, why: &ReportError) -> Self {
        Self { partial: Some(format!("the answer is above, but could not be stored: {why}")), ..self }
    }

    /// Prints the answer.
    pub fn tell(self, session: &Session) -> ExitCode {
        let printed = if session.common.json {
            print(&format!("{}\n", printable_json(&self.json.to_string())))
        } else {
            print(&printable(&self.text, session.style()))
        };
        match (printed, self.partial) {
            (Ok(()), None) => ExitCode::SUCCESS,
            (Err(e), _) => {
                say(&format!("fct: cannot print the answer: {e}"));
                ExitCode::from(1)
            }
            (Ok(()), Some(why)) => {
                say(&format!("fct: {why}"));
                ExitCode::from(1)
            }
        }
    }
}

impl Failure {
    /// Could not compute.
    pub fn compute(message: impl Into<String>) -> Self {
        Self::new(1, message.into())
    }

    /// Bad input or usage.
    pub fn usage(message: impl Into<String>) -> Self {
        Self::new(2, message.into())
    }

    fn new(code: u8, message: String) -> Self {
        let json = json!({ "schema": SCHEMA, "error": { "code": code, "reason": bare(&message) } });
        Self { code, message, json }
    }

    /// The reason without the program's name, to be said inside another sentence.
    pub fn reason(&self) -> &str {
        bare(&self.message)
    }

    /// Prints the reason.
    pub fn tell(self, json: bool) -> ExitCode {
        let text = |v: &Value| format!("{}\n", printable_json(&v.to_string()));
        let printed = if json { print(&text(&self.json)) } else { Ok(()) };
        say(&self.message);
        if let Err(e) = printed {
            say(&format!("fct: cannot print the answer: {e}"));
        }
        ExitCode::from(self.code)
    }
}

/// A message without the name of the program before it.
fn bare(message: &str) -> &str {
    message.strip_prefix("fct: ").unwrap_or(message)
}

/// Prints to stdout. A closed pipe (`fct … | head`) is no fault of the user's; a full disk is one to be told.
pub fn print(text: &str) -> std::io::Result<()> {
    let mut out = std::io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(e) if e.kind() == ErrorKind::BrokenPipe => Ok(()),
        done => done,
    }
}

/// A message on stderr, whatever names and files put into it; that nobody reads it is no fault.
pub fn say(text: &str) {
    let _ = writeln!(std::io::stderr().lock(), "{}", printable(text, Style::new(false, None)));
}

/// Help, version, or what is wrong with the command line.
pub fn usage(e: &clap::Error) -> ExitCode {
    let code = u8::try_from(e.exit_code()).unwrap_or(2);
    match e.print() {
        Err(io) if io.kind() != ErrorKind::BrokenPipe => ExitCode::from(1),
        _ => ExitCode::from(code),
    }
}

impl From<Diagnostics> for Failure {
    fn from(faults: Diagnostics) -> Self {
        let message = faults.to_string();
        let json = json!({ "schema": SCHEMA, "error": { "code": 2, "reason": message, "faults": faults } });
        Self { code: 2, message, json }
    }
}

impl From<ReportError> for Failure {
    fn from(e: ReportError) -> Self {
        let usage = !matches!(e, ReportError::Io { .. } | ReportError::Figure { .. });
        if usage { Self::usage(format!("fct: {e}")) } else { Self::compute(format!("fct: {e}")) }
    }
}

impl From<AnalysisError> for Failure {
    fn from(e: AnalysisError) -> Self {
        match e {
            AnalysisError::Build(_) | AnalysisError::Record(_) | AnalysisError::Case(_) => {
                Self::usage(format!("fct: {e}"))
            }
            _ => Self::compute(format!("fct: {e}")),
        }
    }
}
