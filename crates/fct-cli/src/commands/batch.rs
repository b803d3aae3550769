//! `fct batch`: many specimens; one that fails does not stop the others.

use super::identify::{Answered, identify};
use crate::outcome::{Failure, Outcome};
use crate::place::Job;
use crate::session::Session;
use ::report::answer::{IdentifyAnswer, SCHEMA};
use ::report::{html, terminal, write_named};
use analysis::Meter;
use rayon::prelude::*;
use serde_json::json;
use std::collections::HashSet;
use std::path::{Path, PathBuf};

/// Arguments of `fct batch`.
#[derive(Clone, Debug, clap::Args)]
pub struct Arguments {
    /// Specimens or configs
    #[arg(value_name = "FILE", required = true)]
    pub files: Vec<PathBuf>,
}

/// A specimen that gave no answer.
type Failed = (PathBuf, Box<Failure>);

/// Identifies every file; `--out` is the directory of the run directories.
///
/// # Errors
/// None but the writing of the answer: failures are part of it (exit code 1, or 2 if every file is
/// bad input).
pub fn run(arguments: &Arguments, session: &Session) -> Result<Outcome, Failure> {
    let base = session.common.out.clone().unwrap_or_else(|| "runs".into());
    let places = places(&arguments.files, &base, session);
    // CPU time is the process's: side by side, nobody's own.
    let alone = places.len() == 1;
    let results: Vec<Result<Answered, Failed>> = places
        .into_par_iter()
        .map(|(file, read)| {
            let (case, place) = read.map_err(|e| (file.clone(), Box::new(e)))?;
            let progress = session.progress(&case.name);
            let meter = Meter::new(alone);
            identify(&case, &place, session, &progress, &meter).map_err(|e| (file, Box::new(e)))
        })
        .collect();
    let (mut answers, mut failed, mut unstored) = (Vec::new(), Vec::new(), Vec::new());
    for result in results {
        match result {
            Ok(Answered { answer, stored: Ok(place), .. }) => answers.push((answer, Some(place))),
            Ok(Answered { answer, stored: Err(why), .. }) => {
                answers.push((answer, None));
                unstored.push(why.to_string());
            }
            Err(failure) => failed.push(failure),
        }
    }
    if !answers.is_empty()
        && let Err(why) = overview(&base, &answers, &failed, session)
    {
        unstored.push(why.message);
    }
    let (answers, page): (Vec<IdentifyAnswer>, _) =
        (answers.into_iter().map(|a| a.0).collect(), base.join("batch.html"));
    let mut outcome = tell(&answers, failed, &page, session)?;
    if let Some(why) = unstored.first() {
        outcome.partial = Some(format!("the answer is above, but not all of it could be stored: {why}"));
    }
    Ok(outcome)
}

type Read = (PathBuf, Result<(std::sync::Arc<input::Case>, PathBuf), Failure>);

/// Reads all files; two specimens of one name get run directories of their own.
fn places(files: &[PathBuf], base: &Path, session: &Session) -> Vec<Read> {
    let mut taken = HashSet::new();
    files
        .iter()
        .map(|file| {
            let read = session.fitted_case(file).map(|case| {
                let place = Job { command: "identify", case: &case }.place_under(base, &mut taken);
                (case, place)
            });
            (file.clone(), read)
        })
        .collect()
}

/// `batch.html` beside the run directories: all specimens on one page.
fn overview(
    base: &Path,
    answers: &[(IdentifyAnswer, Option<PathBuf>)],
    failed: &[Failed],
    session: &Session,
) -> Result<(), Failure> {
    let link = |place: &Option<PathBuf>| {
        let name = place.as_deref().and_then(Path::file_name);
        name.map_or_else(String::new, |n| format!("{}/report.html", n.to_string_lossy()))
    };
    let specimens: Vec<_> = answers.iter().map(|(a, place)| (a.clone(), link(place))).collect();
    let failed: Vec<_> =
        failed.iter().map(|(f, e)| (f.display().to_string(), e.reason().to_owned())).collect();
    let page = html::batch_page(&specimens, &failed);
    Ok(write_named(&base.join("batch.html"), page.as_bytes(), session.common.force, html::is_page)?)
}

fn tell(
    answers: &[IdentifyAnswer],
    failed: Vec<Failed>,
    page: &Path,
    session: &Session,
) -> Result<Outcome, Failure> {
    let rows = terminal::batch_rows(answers);
    let mut text = terminal::batch(&rows, session.style());
    text.push('\n');
    for (file, failure) in &failed {
        text.push_str(&format!("failed: {}: {}\n", file.display(), failure.reason()));
    }
    let reasons: Vec<_> =
        failed.iter().map(|(file, f)| json!({ "file": file, "reason": f.reason() })).collect();
    let json = json!({ "schema": SCHEMA, "specimens": answers, "failed": reasons, "table": rows,
        "over_all": terminal::batch_mean(&rows) });
    if answers.is_empty() && failed.iter().all(|f| f.1.code == 2) {
        let message = failed.iter().map(|f| f.1.message.clone()).collect::<Vec<_>>().join("\n");
        return Err(Failure { code: 2, message, json });
    }
    text.push_str(&format!("Page: {}\n", page.display()));
    let mut outcome = Outcome::new(&json, text)?;
    if !failed.is_empty() {
        outcome.partial = Some(format!("{} of {} files failed", failed.len(), failed.len() + answers.len()));
    }
    Ok(outcome)
}
