//! `fct identify`: the paper's inverse analysis.

use super::unfinished::kept;
use crate::outcome::{Failure, Outcome};
use crate::progress::Progress;
use crate::session::Session;
use ::report::answer::IdentifyAnswer;
use ::report::{
    Curve, Partial, Published, ReportError, RunDir, SearchLog, store_identify, store_partial, terminal,
};
use analysis::{AnalysisError, Control, Meter, Metered, SimulateControl};
use input::{Case, Mode};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Instant;

/// Arguments of `fct identify`.
#[derive(Clone, Debug, clap::Args)]
pub struct Arguments {
    /// A specimen or a config
    #[arg(value_name = "FILE")]
    pub file: PathBuf,
    /// No search: one run at the file's values, with derivatives
    #[arg(long)]
    pub at_start: bool,
}

/// An identification that gave an answer.
pub struct Answered {
    /// The answer.
    pub answer: IdentifyAnswer,
    /// Its curves.
    pub curves: Vec<Curve>,
    /// Where it stands, or why it could not be stored.
    pub stored: Result<PathBuf, ReportError>,
}

/// Identifies one specimen and writes its run directory.
///
/// # Errors
/// Bad input, a search that cannot begin, a directory that cannot be written.
pub fn run(arguments: &Arguments, session: &Session) -> Result<Outcome, Failure> {
    let case = session.fitted_case(&arguments.file)?;
    let case = if arguments.at_start { Arc::new(still(&case)) } else { case };
    let place = session.place("identify", &case);
    let progress = session.progress(&case.name);
    let done = identify(&case, &place, session, &progress, &Meter::new(true))?;
    drop(progress);
    let text = terminal::identify(&done.answer, &done.curves, session.style());
    let outcome = Outcome::new(&done.answer, text)?;
    Ok(match done.stored {
        Ok(place) => outcome.at(&place),
        Err(why) => outcome.unstored(&why),
    })
}

/// The case of one run at its start values: an identification that takes no step.
fn still(case: &Case) -> Case {
    let mut out = case.clone();
    (out.identify.max_iterations, out.identify.multi_start) = (0, 0);
    (out.identify.coarse_first, out.identify.mode) = (false, Mode::Joint);
    // Pictures of the strip are for runs that stay.
    out.output.fields = 0;
    out
}

/// The work of `fct identify`, for one specimen or one of a batch.
///
/// # Errors
/// As [`run`]; that a finished answer cannot be stored is no error here.
pub fn identify(
    case: &Arc<Case>,
    place: &Path,
    session: &Session,
    progress: &Progress,
    meter: &Meter,
) -> Result<Answered, Failure> {
    if let Some(run) = session.finished("identify", case, place)
        && let Some(answer) = run.identify()
    {
        return Ok(Answered { answer, curves: run.curves()?, stored: Ok(place.to_owned()) });
    }
    let published = Published::of(case)?;
    let dir = RunDir::begin(place, session.how())?;
    let begun = Instant::now();
    let (log, journal) = (SearchLog::new(&dir), dir.journal());
    let watch = |p: &analysis::Progress| {
        log.note(p);
        progress.search(p);
    };
    let cancelled = || session.cancelled();
    let metered = Metered::new(&cancelled, meter);
    let control = Control { progress: &watch, cancelled: &metered, journal: &journal };
    let still = SimulateControl { progress: &|_, _| {}, cancelled: &metered };
    let done = analysis::identify(case.clone(), &session.catalogue, &control)
        .and_then(|done| analysis::replay(&done, &still).map(|replayed| (done, replayed)));
    let (done, replayed) = match done {
        Ok(done) => done,
        Err(e) => {
            let history = log.history();
            return Err(interrupted(dir, case, session, history, e));
        }
    };
    let mut answer = IdentifyAnswer::new(&done, &replayed, published.as_ref(), begun.elapsed().as_secs_f64());
    answer.cost = meter.spent();
    let curves = ::report::identified_curves(&done, &replayed);
    let stored = store_identify(&dir, &done, &replayed, &answer, &session.info("identify", case, true))
        .and_then(|()| dir.finish());
    Ok(Answered { answer, curves, stored })
}

/// Keeps what was found before a search ended early.
fn interrupted(
    dir: RunDir,
    case: &Case,
    session: &Session,
    history: Vec<::report::answer::StageHistory>,
    e: AnalysisError,
) -> Failure {
    if history.is_empty() && !session.cancelled() {
        return Failure::from(e);
    }
    let why = if session.cancelled() {
        "stopped by the user".to_owned()
    } else {
        Failure::from(e).reason().to_owned()
    };
    let partial = Partial::new(case, history, &why);
    let stored = store_partial(&dir, case, &partial, &session.info("identify", case, false))
        .and_then(|()| dir.finish_partial(session.cancelled()));
    kept(stored, &why, serde_json::to_value(&partial).ok(), "the best values so far are")
}
