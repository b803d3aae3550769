//! `fct discover`: the whole loop until the record is explained, or honestly not.

use crate::outcome::{Failure, Outcome};
use crate::session::Session;
use std::path::PathBuf;

/// Arguments of `fct discover`.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// A specimen or a config
    #[arg(value_name = "FILE")]
    pub file: PathBuf,
}

/// Will ask crate `analysis` and show its answer.
///
/// # Errors
/// Always, until crate `analysis` has the function.
pub fn run(arguments: &Arguments, session: &Session) -> Result<Outcome, Failure> {
    let _case = session.case(&arguments.file)?;
    Err(Failure::not_available("discover"))
}
