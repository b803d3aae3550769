//! `fct compare`: how far the model is off, and where.

use crate::outcome::{Failure, Outcome};
use crate::session::Session;
use ::report::terminal;
use std::path::PathBuf;

/// Arguments of `fct compare`.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// A run directory of `fct identify`, a specimen or a config
    #[arg(value_name = "RUN")]
    pub run: PathBuf,
}

/// Compares the identified model with its records.
///
/// # Errors
/// Bad input, or a model that cannot be computed.
pub fn run(arguments: &Arguments, session: &Session) -> Result<Outcome, Failure> {
    let case = session.identified_case(&arguments.run)?;
    let progress = session.progress(&case.name);
    let answer = analysis::compare(case, &session.catalogue, &|s| progress.note(s), &|| session.cancelled())?;
    drop(progress);
    let outcome = Outcome::new(&answer, String::new())?;
    let text = terminal::compare(&outcome.json, session.style());
    Ok(Outcome { text, ..outcome })
}
