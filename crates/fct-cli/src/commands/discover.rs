//! `fct discover`: the whole loop until the record is explained, or honestly not.

use super::rungs;
use crate::outcome::{Failure, Outcome};
use crate::session::Session;
use ::report::{RunDir, store_discover, terminal};
use std::path::PathBuf;

/// Arguments of `fct discover`.
#[derive(Clone, Debug, clap::Args)]
pub struct Arguments {
    /// A specimen or a config
    #[arg(value_name = "FILE")]
    pub file: PathBuf,
}

/// Searches for the missing effects and writes the run directory.
///
/// # Errors
/// Bad input, a model that cannot be computed, a directory that cannot be written.
pub fn run(arguments: &Arguments, session: &Session) -> Result<Outcome, Failure> {
    let case = session.fitted_case(&arguments.file)?;
    let place = session.place(&case);
    if let Some(run) = session.finished("discover", &case, &place) {
        let text = terminal::discover(&run.answer, session.style());
        return Ok(Outcome { json: run.answer, text, partial: None });
    }
    let dir = RunDir::begin(&place)?;
    let progress = session.progress(&case.name);
    let (note, cancelled) = (|s: &str| progress.note(s), || session.cancelled());
    let mut answer = analysis::discover(case.clone(), &session.catalogue, &note, &cancelled)?;
    let one = analysis::one_strength(&case, &session.catalogue, &answer, &note, &cancelled);
    answer.one_strength = one.unwrap_or_else(|why| {
        session.say(&format!("one strength along the path could not be tried: {why}"));
        None
    });
    answer.words.extend(answer.one_strength.iter().map(|o| o.words.clone()));
    progress.note("curves and intervals of every rung, on the file's mesh");
    let top = rungs::store(&dir, &case, &answer, session)?;
    drop(progress);
    let info = session.info("discover", &case, !session.cancelled());
    let top = top.as_ref().map(|t| (&t.done, t.replayed.as_slice(), &t.answer));
    let json = store_discover(&dir, &case, &answer, top, &info)?;
    let place = dir.finish()?;
    let mut text = terminal::discover(&json, session.style());
    text.push_str(&format!("Run directory: {}\n", place.display()));
    Ok(Outcome { json, text, partial: session.cancelled().then(|| "stopped by the user".to_owned()) })
}
