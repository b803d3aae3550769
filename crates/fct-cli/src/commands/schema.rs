//! `fct schema`: JSON Schema of the input.

use crate::outcome::{Failure, Outcome};
use crate::session::Session;

/// Arguments of `fct schema`: none of its own.
#[derive(Clone, Debug, clap::Args)]
pub struct Arguments {}

/// Prints the schema that specimens and configs are read by; with `--json` the same document.
///
/// # Errors
/// None of its own.
pub fn run(_: &Arguments, session: &Session) -> Result<Outcome, Failure> {
    let schema = input::json_schema(&session.catalogue);
    Outcome::new(&schema, format!("{schema}\n"))
}
