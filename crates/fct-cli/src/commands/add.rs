//! `fct add`: a config with an effect added.

use super::edit::{next, source, write};
use super::effects::find;
use crate::outcome::{Failure, Outcome};
use crate::session::Session;
use ::report::answer::SCHEMA;
use ::report::{ReportError, StoredRun};
use input::edit::add_effect;
use model::Options;
use serde_json::{Value, json};
use std::path::PathBuf;

/// Arguments of `fct add`.
#[derive(Clone, Debug, clap::Args)]
pub struct Arguments {
    /// Name of the effect (`fct effects` lists them)
    #[arg(value_name = "EFFECT")]
    pub effect: String,
    /// A run directory, or a config or specimen file
    #[arg(value_name = "RUN|FILE")]
    pub file: PathBuf,
}

/// What the screen of a run found out about an effect: start values and the reason. `diagnose` leaves it beside the answer,
/// `discover` in it.
fn finding(run: &StoredRun, effect: &str) -> Result<Option<Value>, ReportError> {
    let diagnosis = run.diagnosis()?;
    Ok(diagnosis
        .iter()
        .chain([&run.answer])
        .find_map(|answer| answer["screen"].as_array()?.iter().find(|f| f["effect"] == effect).cloned()))
}

/// Writes the config with the effect, started from the run's screen where there is one; comments and order kept.
///
/// # Errors
/// An unknown effect, one that is there already or excluded by another, an unreadable file.
pub fn run(arguments: &Arguments, session: &Session) -> Result<Outcome, Failure> {
    let effect = find(session, &arguments.effect)?;
    let card = effect.card();
    let from = source(&arguments.file)?;
    let specs = effect.parameters(&Options::new());
    let keys: Vec<String> = specs.iter().map(|s| s.key()).collect();
    let finding = match &from.run {
        Some(run) => finding(run, card.name)?,
        None => None,
    };
    let start = |default: f64, bounds: [f64; 2], key: &str| {
        let estimated = finding.as_ref().and_then(|f| f["estimate"][key].as_f64());
        estimated.filter(|x| (bounds[0]..=bounds[1]).contains(x)).unwrap_or(default)
    };
    let parameters: Vec<(&str, f64, &str)> = specs
        .iter()
        .zip(&keys)
        .map(|(s, k)| {
            let bounds = [s.lower, s.upper].map(|b| s.in_file_unit(b));
            (k.as_str(), start(s.in_file_unit(s.start), bounds, k), &*s.description)
        })
        .collect();
    let sentence = finding.as_ref().and_then(|f| f["sentence"].as_str());
    let reason = sentence.map_or_else(|| format!("{}: {}", card.name, card.summary), str::to_owned);
    let text = add_effect(&from.text, card.name, &parameters, &reason)
        .map_err(|e| Failure::usage(format!("fct: {}: {e}", from.file.display())))?;
    let file = write(&from, &text, &format!("+{}", card.name), session)?;
    let shown = file.display().to_string();
    let json = json!({ "schema": SCHEMA, "file": file, "effect": card.name, "parameters": keys });
    Outcome::new(&json, format!("{shown}\nnext: {}\n", next(&from, &file)))
}
