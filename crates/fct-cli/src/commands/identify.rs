//! `fct identify`: the paper's inverse analysis.

use crate::outcome::{Failure, Outcome};
use crate::progress::Progress;
use crate::session::Session;
use ::report::answer::{IdentifyAnswer, StageHistory};
use ::report::{Partial, Published, RunDir, SearchLog, StoredRun, store_identify, store_partial, terminal};
use analysis::{AnalysisError, Control, SimulateControl};
use input::Case;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Instant;

/// Arguments of `fct identify`.
#[derive(Clone, Debug, clap::Args)]
pub struct Arguments {
    /// A specimen or a config
    #[arg(value_name = "FILE")]
    pub file: PathBuf,
}

/// Identifies one specimen and writes its run directory.
///
/// # Errors
/// Bad input, a search that cannot begin, a directory that cannot be written.
pub fn run(arguments: &Arguments, session: &Session) -> Result<Outcome, Failure> {
    let case = session.fitted_case(&arguments.file)?;
    let place = session.place(&case);
    let progress = session.progress(&case.name);
    let (answer, place) = identify(&case, &place, session, &progress)?;
    drop(progress);
    let curves = StoredRun::read(&place).map(|r| r.curves()).unwrap_or_default();
    let mut text = terminal::identify(&answer, &curves, session.style());
    text.push_str(&format!("Run directory: {}\n", place.display()));
    Outcome::new(&answer, text)
}

/// The work of `fct identify`, for one specimen or one of a batch.
///
/// # Errors
/// As [`run`].
pub fn identify(
    case: &Arc<Case>,
    place: &Path,
    session: &Session,
    progress: &Progress,
) -> Result<(IdentifyAnswer, PathBuf), Failure> {
    if let Some(answer) = session.finished("identify", case, place).and_then(|r| r.identify()) {
        return Ok((answer, place.to_owned()));
    }
    let published = Published::of(case)?;
    let dir = RunDir::begin(place)?;
    let begun = Instant::now();
    let log = SearchLog::new(&dir);
    let watch = |p: &analysis::Progress| {
        log.note(p);
        progress.search(p);
    };
    let control = Control { progress: &watch, cancelled: &|| session.cancelled() };
    let done = match analysis::identify(case.clone(), &session.catalogue, &control) {
        Ok(done) => done,
        Err(e) => {
            let history = log.history();
            return Err(interrupted(dir, case, session, history, e));
        }
    };
    let watch = SimulateControl { progress: &|_, _| {}, cancelled: &|| session.cancelled() };
    let replayed = analysis::replay(&done, &watch)?;
    let answer = IdentifyAnswer::new(&done, &replayed, published.as_ref(), begun.elapsed().as_secs_f64());
    store_identify(&dir, &done, &replayed, &answer, &session.info("identify", case, true))?;
    Ok((answer, dir.finish()?))
}

/// Keeps what was found before a search ended early.
fn interrupted(
    dir: RunDir,
    case: &Case,
    session: &Session,
    history: Vec<StageHistory>,
    e: AnalysisError,
) -> Failure {
    let mut failure = Failure::from(e);
    if history.is_empty() {
        return failure;
    }
    let why =
        if session.cancelled() { "stopped by the user".to_owned() } else { failure.reason().to_owned() };
    let partial = Partial::new(case, history, &why);
    let stored = store_partial(&dir, case, &partial, &session.info("identify", case, false))
        .and_then(|()| dir.finish());
    failure.code = 1;
    match stored {
        Ok(place) => {
            failure.message = format!("fct: {why}; the best values so far are in {}", place.display());
            failure.json = serde_json::to_value(&partial).unwrap_or(failure.json);
        }
        Err(e) => failure.message = format!("fct: {why}; and what was found could not be kept: {e}"),
    }
    failure
}
