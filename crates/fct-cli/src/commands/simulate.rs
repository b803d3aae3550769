//! `fct simulate`: forward runs at the file's values.

use crate::outcome::{Failure, Outcome};
use crate::session::Session;
use ::report::answer::SimulateAnswer;
use ::report::{Kept, RunDir, store_simulate, terminal};
use analysis::SimulateControl;
use std::path::PathBuf;
use std::time::Instant;

/// Arguments of `fct simulate`.
#[derive(Clone, Debug, clap::Args)]
pub struct Arguments {
    /// A specimen or a config
    #[arg(value_name = "FILE")]
    pub file: PathBuf,
}

/// Runs every test and writes the run directory.
///
/// # Errors
/// Bad input, or a directory that cannot be written. A run that ends early is a partial answer.
pub fn run(arguments: &Arguments, session: &Session) -> Result<Outcome, Failure> {
    let case = session.case(&arguments.file)?;
    let place = session.place("simulate", &case);
    if let Some(answer) = session.finished("simulate", &case, &place).and_then(|r| r.simulate()) {
        return Ok(shown(&answer, session)?.at(&place));
    }
    let dir = RunDir::begin(&place, session.how())?;
    let begun = Instant::now();
    let done = {
        let progress = session.progress(&case.name);
        let control = SimulateControl {
            progress: &|done, total| progress.steps(done, total),
            cancelled: &|| session.cancelled(),
        };
        analysis::simulate(case.clone(), &session.catalogue, &control)?
    };
    let answer = SimulateAnswer::new(&done, begun.elapsed().as_secs_f64());
    let outcome = shown(&answer, session)?;
    let complete = answer.stopped_because.is_none();
    let info = session.info("simulate", &case, complete);
    let stored = store_simulate(&dir, &done, &answer, &info).and_then(|()| {
        if complete { dir.finish().map(Kept::At) } else { dir.finish_partial(session.cancelled()) }
    });
    Ok(match stored {
        Ok(Kept::At(place)) => outcome.at(&place),
        Ok(Kept::Aside(_)) => outcome,
        Err(why) => outcome.unstored(&why),
    })
}

fn shown(answer: &SimulateAnswer, session: &Session) -> Result<Outcome, Failure> {
    let mut outcome = Outcome::new(answer, terminal::simulate(answer, session.style()))?;
    outcome.partial.clone_from(&answer.stopped_because);
    Ok(outcome)
}
