//! `fct report`: one self-contained HTML file per run, or one over the ladder of several runs.

use crate::outcome::{Failure, Outcome};
use crate::session::Session;
use ::report::answer::SCHEMA;
use ::report::{StoredRun, figure_files, figures, html, write_atomic};
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
    let runs = arguments.runs.iter().map(|p| StoredRun::read(p)).collect::<Result<Vec<_>, _>>()?;
    let mut files = Vec::new();
    match (&session.common.out, runs.as_slice()) {
        (Some(out), [one]) => files.push(written(out, &html::page(one, &one.path)?)?),
        (Some(out), many) => files.push(written(out, &html::runs_page(many)?)?),
        (None, many) => {
            for run in many {
                files.push(written(&run.path.join("report.html"), &html::page(run, &run.path)?)?);
            }
        }
    }
    for run in &runs {
        plots(run, session)?;
    }
    let text = files.iter().map(|f| format!("{}\n", f.display())).collect();
    Outcome::new(&json!({ "schema": SCHEMA, "files": files }), text)
}

fn written(file: &Path, page: &str) -> Result<PathBuf, Failure> {
    write_atomic(file, page.as_bytes())?;
    Ok(file.to_owned())
}

/// With `--figures`: every plot of the run alone, in these formats.
fn plots(run: &StoredRun, session: &Session) -> Result<(), Failure> {
    let Some(formats) = &session.common.figures else { return Ok(()) };
    let formats: Vec<input::Figure> = formats.iter().map(|f| (*f).into()).collect();
    figure_files(&run.path.join("figures"), &figures::of_run(run)?, &formats)?;
    Ok(())
}
