//! `fct man`: manual pages.

use crate::cli::Cli;
use crate::outcome::{Failure, Outcome};
use ::report::answer::SCHEMA;
use clap::CommandFactory;
use serde_json::json;

/// Arguments of `fct man`.
#[derive(Clone, Debug, clap::Args)]
pub struct Arguments {
    /// A command; the page of fct itself when left out
    #[arg(value_name = "COMMAND")]
    pub command: Option<String>,
}

/// Prints the page in the form that `man -l` reads.
///
/// # Errors
/// If there is no such command.
pub fn run(arguments: &Arguments) -> Result<Outcome, Failure> {
    let mut cli = Cli::command();
    cli.build();
    let command = match &arguments.command {
        None => cli,
        Some(name) => cli.find_subcommand(name).cloned().ok_or_else(|| unknown(name))?,
    };
    let name = command.get_display_name().unwrap_or(command.get_name()).to_owned();
    let mut page = Vec::new();
    let rendered = clap_mangen::Man::new(command).render(&mut page);
    rendered.map_err(|e| Failure::compute(format!("fct: cannot write the page: {e}")))?;
    let page =
        String::from_utf8(page).map_err(|e| Failure::compute(format!("fct: the page is no text: {e}")))?;
    Outcome::new(&json!({ "schema": SCHEMA, "name": name, "page": page }), page)
}

fn unknown(name: &str) -> Failure {
    Failure::usage(format!("fct: unknown command `{name}`; `fct --help` lists them"))
}
