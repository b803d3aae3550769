//! `fct compare`: where and how far the model is off.

use crate::outcome::{Failure, Outcome};
use crate::session::Session;
use std::path::PathBuf;

/// Arguments of `fct compare`.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// A run directory of `fct identify`
    #[arg(value_name = "RUN")]
    pub run: PathBuf,
}

/// Will ask crate `analysis` and show its answer.
///
/// # Errors
/// Always, until crate `analysis` has the function.
pub fn run(arguments: &Arguments, session: &Session) -> Result<Outcome, Failure> {
    let _case = session.case(&arguments.run)?;
    Err(Failure::not_available("compare"))
}
