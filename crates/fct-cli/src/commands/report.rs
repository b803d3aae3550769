//! `fct report`: one self-contained HTML file per run, or one over the ladder of several runs.

use crate::outcome::{Failure, Outcome};
use crate::session::{Session, unoffered};
use ::report::answer::SCHEMA;
use ::report::{StoredRun, amend, exported, figures, html, write_named};
use serde_json::json;
use std::path::{Path, PathBuf};

/// Arguments of `fct report`.
#[derive(Clone, Debug, clap::Args)]
pub struct Arguments {
    /// Run directories; several with --out: one page with their ladder
    #[arg(value_name = "RUN", required = true)]
    pub runs: Vec<PathBuf>,
}

/// Writes `report.html` into each run directory, or to the file named by `--out`: of several runs one
/// page with their ladder.
///
/// # Errors
/// If a directory is no run, or the file cannot be written.
pub fn run(arguments: &Arguments, session: &Session) -> Result<Outcome, Failure> {
    let runs = arguments.runs.iter().map(|p| session.stored(p)).collect::<Result<Vec<_>, _>>()?;
    let mut files = Vec::new();
    match (&session.common.out, runs.as_slice()) {
        (Some(out), [one]) => files.push(written(out, &html::page(one, &one.path)?, session)?),
        (Some(out), many) => files.push(written(out, &html::runs_page(many)?, session)?),
        (None, many) => {
            for run in many {
                let page = html::page(run, &run.path)?;
                amend(&run.path, &[("report.html", page.as_bytes())])?;
                files.push(run.path.join("report.html"));
            }
        }
    }
    for run in &runs {
        plots(run, session)?;
    }
    let text = files.iter().map(|f| format!("{}\n", f.display())).collect();
    Outcome::new(&json!({ "schema": SCHEMA, "files": files }), text)
}

/// A page that the user named: an earlier page of ours is made anew, anything else stays.
fn written(file: &Path, page: &str, session: &Session) -> Result<PathBuf, Failure> {
    write_named(file, page.as_bytes(), session.common.force, html::is_page)?;
    Ok(file.to_owned())
}

/// With `--figures`: every plot of the run alone, in these formats.
fn plots(run: &StoredRun, session: &Session) -> Result<(), Failure> {
    let Some(formats) = &session.common.figures else { return Ok(()) };
    let formats: Vec<input::Figure> = formats.iter().map(|f| (*f).into()).collect();
    formats.iter().try_for_each(|f| unoffered(*f))?;
    let figures = exported(&figures::of_run(run)?, &formats)?;
    let figures: Vec<(&str, &[u8])> =
        figures.iter().map(|(name, content)| (name.as_str(), content.as_slice())).collect();
    Ok(amend(&run.path, &figures)?)
}
