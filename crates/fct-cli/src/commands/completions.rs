//! `fct completions`: a script for the shell.

use crate::cli::Cli;
use crate::outcome::{Failure, Outcome};
use ::report::answer::SCHEMA;
use clap::CommandFactory;
use clap_complete::Shell;
use serde_json::json;

/// Arguments of `fct completions`.
#[derive(Clone, Debug, clap::Args)]
pub struct Arguments {
    /// The shell
    #[arg(value_name = "SHELL", value_enum)]
    pub shell: Shell,
}

/// Prints the script.
///
/// # Errors
/// If the script is no text, which it always is.
pub fn run(arguments: &Arguments) -> Result<Outcome, Failure> {
    let mut script = Vec::new();
    clap_complete::generate(arguments.shell, &mut Cli::command(), "fct", &mut script);
    let script = String::from_utf8(script)
        .map_err(|e| Failure::compute(format!("fct: the script is no text: {e}")))?;
    let json = json!({ "schema": SCHEMA, "shell": arguments.shell.to_string(), "script": script });
    Outcome::new(&json, script)
}
