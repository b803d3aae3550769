//! `fct drop`: a config with an effect taken away.

use super::edit::{next, refused, source, write};
use crate::outcome::{Failure, Outcome};
use crate::session::Session;
use ::report::answer::SCHEMA;
use input::edit::drop_effect;
use serde_json::json;
use std::path::PathBuf;

/// Arguments of `fct drop`.
#[derive(Clone, Debug, clap::Args)]
pub struct Arguments {
    /// Name of the effect
    #[arg(value_name = "EFFECT")]
    pub effect: String,
    /// A run directory, or a config file
    #[arg(value_name = "RUN|FILE")]
    pub file: PathBuf,
}

/// Writes the config without the effect, comments and order kept.
///
/// # Errors
/// An effect that is not there, an unreadable file.
pub fn run(arguments: &Arguments, session: &Session) -> Result<Outcome, Failure> {
    let from = source(&arguments.file)?;
    let text = drop_effect(&from.text, &arguments.effect, "").map_err(|e| refused(&from, &e, session))?;
    let file = write(&from, &text, &format!("-{}", arguments.effect), session)?;
    let shown = file.display().to_string();
    let json = json!({ "schema": SCHEMA, "file": file, "effect": arguments.effect });
    Outcome::new(&json, format!("{shown}\nnext: {}\n", next(&from, &file)))
}
