//! `fct add`: a config with an effect added.

use super::edit::{source, write};
use super::effects::find;
use crate::outcome::{Failure, Outcome};
use crate::session::Session;
use ::report::answer::SCHEMA;
use input::edit::add_effect;
use model::Options;
use serde_json::json;
use std::path::PathBuf;

/// Arguments of `fct add`.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Name of the effect (`fct effects` lists them)
    #[arg(value_name = "EFFECT")]
    pub effect: String,
    /// A run directory, or a config or specimen file
    #[arg(value_name = "RUN|FILE")]
    pub file: PathBuf,
}

/// Writes the config with the effect, comments and order kept.
///
/// # Errors
/// An unknown effect, one that is there already or excluded by another, an unreadable file.
pub fn run(arguments: &Arguments, session: &Session) -> Result<Outcome, Failure> {
    let effect = find(session, &arguments.effect)?;
    let card = effect.card();
    let from = source(&arguments.file)?;
    let specs = effect.parameters(&Options::new());
    let keys: Vec<String> = specs.iter().map(|s| s.key()).collect();
    let parameters: Vec<(&str, f64, &str)> = specs
        .iter()
        .zip(&keys)
        .map(|(s, k)| (k.as_str(), s.in_file_unit(s.start), &*s.description))
        .collect();
    let reason = format!("{}: {}", card.name, card.summary);
    let text = add_effect(&from.text, card.name, &parameters, &reason)
        .map_err(|e| Failure::usage(format!("fct: {}: {e}", from.file.display())))?;
    let file = write(&from, &text, &format!("+{}", card.name), session)?;
    let shown = file.display().to_string();
    let json = json!({ "schema": SCHEMA, "file": file, "effect": card.name, "parameters": keys });
    Outcome::new(&json, format!("{shown}\nnext: fct identify {shown}\n"))
}
