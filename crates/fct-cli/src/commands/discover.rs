//! `fct discover`: the whole loop until the record is explained, or honestly not.

use super::fitted_models;
use super::unfinished::kept;
use crate::outcome::{Failure, Outcome};
use crate::progress::Progress;
use crate::session::Session;
use ::report::answer::{Evaluated, weighed};
use ::report::{Partial, RunDir, store_discover, store_unfinished, terminal};
use analysis::{DiscoverAnswer, Meter, Metered};
use input::Case;
use serde_json::Value;
use std::path::PathBuf;
use std::sync::Arc;

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
    let place = session.place("discover", &case);
    if let Some(run) = session.finished("discover", &case, &place) {
        let text = terminal::discover(&run.answer, session.style());
        return Ok(Outcome { json: run.answer, text, partial: None }.at(&place));
    }
    let dir = RunDir::begin(&place, session.how())?;
    let (found, top) = match search(&dir, &case, session) {
        Ok(found) if !session.cancelled() => found,
        Ok((answer, _)) => return Err(interrupted(dir, &case, session, Some(&answer))),
        Err(_) if session.cancelled() => return Err(interrupted(dir, &case, session, None)),
        Err(failure) => return Err(failure),
    };
    let info = session.info("discover", &case, true);
    let top = top.as_ref().map(|t| (&t.done, t.replayed.as_slice(), &t.answer));
    let stored = store_discover(&dir, &case, &found, top, &info).and_then(|_| dir.finish());
    let json = serde_json::to_value(&found).unwrap_or_default();
    let text = terminal::discover(&json, session.style());
    let outcome = Outcome { json, text, partial: None };
    Ok(match stored {
        Ok(place) => outcome.at(&place),
        Err(why) => outcome.unstored(&why),
    })
}

/// The search, and every rung of its ladder on the file's mesh. Ends early where the user stops it.
fn search(
    dir: &RunDir,
    case: &Arc<Case>,
    session: &Session,
) -> Result<(DiscoverAnswer, Option<Evaluated>), Failure> {
    let (progress, journal) = (session.progress(&case.name), dir.journal());
    let (note, cancelled) = (|s: &str| progress.note(s), || session.cancelled());
    let meter = Meter::new(true);
    let metered = Metered::new(&cancelled, &meter);
    let look = || first_look(&progress, case, session);
    let whole = || analysis::discover(case.clone(), &session.catalogue, &note, &metered, &journal);
    let ((), answer) = rayon::join(look, whole);
    let mut answer = answer?;
    if session.cancelled() {
        return Ok((answer, None));
    }
    let case = &answer.case.clone();
    let one = analysis::one_strength(case, &session.catalogue, &answer, &note, &metered, &journal);
    answer.one_strength = one.unwrap_or_else(|why| {
        session.say(&format!("one strength along the path could not be tried: {why}"));
        None
    });
    answer.words.extend(answer.one_strength.iter().map(|o| o.words.clone()));
    answer.words.extend(weighed(case));
    progress.note("curves and intervals of every rung, on the file's mesh");
    let top = fitted_models::store(dir, case, &answer, session, &metered)?;
    answer.cost = meter.spent();
    Ok((answer, top))
}

/// What stands out by a rough fit, said while the search is at its base; where there is none, the search says why.
fn first_look(progress: &Progress, case: &Arc<Case>, session: &Session) {
    if !progress.heard() {
        return;
    }
    if let Ok(look) = analysis::first_look(case, &session.catalogue, &|| session.cancelled()) {
        progress.found(&look);
    }
}

/// Keeps what a search found before the user stopped it.
fn interrupted(dir: RunDir, case: &Case, session: &Session, answer: Option<&DiscoverAnswer>) -> Failure {
    const WHY: &str = "stopped by the user";
    let mut partial = serde_json::to_value(Partial::new(case, Vec::new(), WHY)).unwrap_or_default();
    if let (Some(all), Some(Value::Object(found))) =
        (partial.as_object_mut(), answer.and_then(|a| serde_json::to_value(a).ok()))
    {
        // What was found so far; that it is no answer stands beside it.
        all.extend(found.into_iter().filter(|(key, _)| key == "ladder" || key == "screen"));
    }
    let stored = store_unfinished(&dir, case, &partial, &session.info("discover", case, false))
        .and_then(|()| dir.finish_partial(true));
    kept(stored, WHY, Some(partial), "what was found so far is")
}
