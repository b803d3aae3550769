//! `fct ladder`: the staircase of error against effects added.

use crate::outcome::{Failure, Outcome};
use crate::session::Session;
use ::report::answer::SCHEMA;
use ::report::terminal;
use serde_json::json;
use std::path::PathBuf;

/// Arguments of `fct ladder`.
#[derive(Clone, Debug, clap::Args)]
pub struct Arguments {
    /// Run directories of `fct identify` on one specimen
    #[arg(value_name = "RUN", required = true)]
    pub runs: Vec<PathBuf>,
}

/// Reads the runs and orders them by their number of effects.
///
/// # Errors
/// If one of them is no finished identification, or they are of different specimens.
pub fn run(arguments: &Arguments, session: &Session) -> Result<Outcome, Failure> {
    let mut runs = Vec::new();
    for path in &arguments.runs {
        let run = session.stored(path)?;
        let answer = run.identify().ok_or_else(|| {
            Failure::usage(format!("fct: {}: expected a finished run of `fct identify`", path.display()))
        })?;
        runs.push((run, answer));
    }
    if let Some((run, a)) = runs.iter().find(|(_, a)| a.specimen != runs[0].1.specimen) {
        let path = run.path.display();
        return Err(Failure::usage(format!(
            "fct: {path}: specimen {}, but the first run is of {}",
            a.specimen, runs[0].1.specimen
        )));
    }
    let rows = terminal::ladder_rows(&runs);
    let specimen = runs.first().map(|r| r.1.specimen.clone());
    let json = json!({ "schema": SCHEMA, "specimen": specimen, "ladder": rows });
    Outcome::new(&json, format!("{}\n", terminal::ladder(&rows, session.style())))
}
