//! `fct diagnose`: which effect is missing.

use crate::outcome::{Failure, Outcome};
use crate::session::Session;
use ::report::{StoredRun, html, terminal, write_atomic};
use std::path::PathBuf;

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
    let answer =
        analysis::diagnose(case, &session.catalogue, &|s| progress.note(s), &|| session.cancelled())?;
    drop(progress);
    let outcome = Outcome::new(&answer, String::new())?;
    if arguments.run.is_dir() {
        write_atomic(&arguments.run.join("diagnosis.json"), format!("{:#}\n", outcome.json).as_bytes())?;
        // The page answers what is missing as soon as that is known.
        if let Ok(run) = StoredRun::read(&arguments.run) {
            let page = html::page(&run, &run.path)?;
            write_atomic(&arguments.run.join("report.html"), page.as_bytes())?;
        }
    }
    let text = terminal::discover(&outcome.json, session.style());
    Ok(Outcome { text, ..outcome })
}
