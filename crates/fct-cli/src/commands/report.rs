//! `fct report`: one self-contained HTML file per run.

use crate::outcome::{Failure, Outcome};
use crate::session::Session;
use ::report::answer::SCHEMA;
use ::report::{StoredRun, html, write_atomic};
use serde_json::json;
use std::path::PathBuf;

/// Arguments of `fct report`.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Run directories
    #[arg(value_name = "RUN", required = true)]
    pub runs: Vec<PathBuf>,
}

/// Writes `report.html` into each run directory (or, for one run, to the file named by `--out`).
///
/// # Errors
/// If a directory is no run, or the file cannot be written.
pub fn run(arguments: &Arguments, session: &Session) -> Result<Outcome, Failure> {
    let mut files = Vec::new();
    for path in &arguments.runs {
        let run = StoredRun::read(path)?;
        let file = match (&session.common.out, arguments.runs.len()) {
            (Some(out), 1) => out.clone(),
            (Some(_), _) => {
                return Err(Failure::usage("fct: --out names one file, but several runs are given"));
            }
            (None, _) => path.join("report.html"),
        };
        write_atomic(&file, html::page(&run, &run.curves())?.as_bytes())?;
        files.push(file);
    }
    let text = files.iter().map(|f| format!("{}\n", f.display())).collect();
    Outcome::new(&json!({ "schema": SCHEMA, "files": files }), text)
}
