//! `fct diagnose`: which effect is missing.

use crate::outcome::{Failure, Outcome};
use crate::session::Session;
use ::report::answer::weighed;
use ::report::{ReportError, StoredRun, amend, html, terminal};
use analysis::Adds;
use serde_json::Value;
use std::path::{Path, PathBuf};

/// Arguments of `fct diagnose`.
#[derive(Clone, Debug, clap::Args)]
pub struct Arguments {
    /// A run directory of `fct identify`, a specimen or a config
    #[arg(value_name = "RUN")]
    pub run: PathBuf,
}

/// Screens the catalogue at the identified model; `diagnosis.json` goes into the run directory.
///
/// # Errors
/// Bad input, a model that cannot be computed, a directory that cannot be written.
pub fn run(arguments: &Arguments, session: &Session) -> Result<Outcome, Failure> {
    let case = session.identified_case(&arguments.run)?;
    let progress = session.progress(&case.name);
    let (note, cancelled) = (|s: &str| progress.note(s), || session.cancelled());
    let weighed = weighed(&case);
    let mut answer = analysis::diagnose(case, &session.catalogue, &note, &cancelled, &analysis::NoJournal)?;
    drop(progress);
    answer.words.extend(weighed);
    let outcome = Outcome::new(&answer, String::new())?;
    let text = terminal::discover(&outcome.json, session.style());
    let outcome = Outcome { text, ..outcome };
    if !arguments.run.is_dir() {
        return Ok(outcome);
    }
    Ok(match store(&arguments.run, &outcome.json, &table(&answer.adds)) {
        Ok(()) => outcome,
        Err(why) => outcome.unstored(&why),
    })
}

/// Adds the diagnosis to the run, and makes its page anew: it answers what is missing as soon as that is known.
fn store(place: &Path, diagnosis: &Value, adds: &str) -> Result<(), ReportError> {
    let diagnosis = format!("{diagnosis:#}\n");
    amend(place, &[("diagnosis.json", diagnosis.as_bytes()), ("adds.csv", adds.as_bytes())])?;
    let page = html::page(&StoredRun::read(place)?, place)?;
    amend(place, &[("report.html", page.as_bytes())])
}

/// What each effect would add to the forces, N: a line per point, a column per effect.
fn table(adds: &Adds) -> String {
    let mut out = format!("test,row,{}\n", adds.effects.join(","));
    for (test, columns) in &adds.tests {
        for row in 0..columns.first().map_or(0, Vec::len) {
            let numbers: Vec<String> = columns.iter().map(|c| format!("{:e}", c[row])).collect();
            out.push_str(&format!("{test},{row},{}\n", numbers.join(",")));
        }
    }
    out
}
