//! `fct check`: validate, print what is resolved.

use crate::outcome::{Failure, Outcome};
use crate::session::Session;
use ::report::terminal::wrap;
use analysis::AnalysisError;
use input::{Case, resolved_toml};
use model::{Discretisation, Model};
use serde_json::json;
use std::path::PathBuf;

/// Arguments of `fct check`.
#[derive(Clone, Debug, clap::Args)]
pub struct Arguments {
    /// A specimen or a config
    #[arg(value_name = "FILE")]
    pub file: PathBuf,
}

/// Reads the file, builds the model, prints the resolved configuration.
///
/// # Errors
/// Everything that is wrong with the file.
pub fn run(arguments: &Arguments, session: &Session) -> Result<Outcome, Failure> {
    let case = session.case(&arguments.file)?;
    let model = Model::new(case.clone(), &session.catalogue, Discretisation::default())
        .map_err(AnalysisError::Build)?;
    let resolved = resolved_toml(&case);
    let tests: Vec<_> = model
        .tests
        .iter()
        .map(|t| {
            json!({
                "name": t.test.name, "kind": t.test.kind.word(), "unknowns": t.unknowns(),
                "points": t.test.record.as_ref().map(input::Record::len),
            })
        })
        .collect();
    let free: Vec<&str> = model.free().into_iter().map(|i| model.parameters[i].path.as_str()).collect();
    let answer = json!({
        "schema": ::report::answer::SCHEMA, "specimen": case.name, "provenance": case.provenance,
        "effects": model.effects(), "tests": tests, "free_parameters": free,
        "warnings": case.warnings, "resolved": resolved,
    });
    let text = format!("{}{resolved}", heading(&case, &model, &free));
    Outcome::new(&answer, text)
}

/// A comment above the resolved file, so that the output is a valid config.
fn heading(case: &Case, model: &Model, free: &[&str]) -> String {
    let mut out = format!("# {}: valid.", case.name);
    for t in &model.tests {
        let points = t.test.record.as_ref().map_or("a protocol".into(), |r| format!("{} points", r.len()));
        out.push_str(&format!("\n# test {}: {points}, {} unknowns", t.test.name, t.unknowns()));
    }
    let list = wrap(&free.join(", "), 94, 0).replace('\n', "\n#   ");
    out.push_str(&format!("\n# {} free parameters: {list}\n", free.len()));
    if let Some(held) = ::report::answer::held_at_limits(&model.parameters) {
        out.push_str(&format!("# {}\n", wrap(&held, 94, 0).replace('\n', "\n#   ")));
    }
    out.push('\n');
    out
}
