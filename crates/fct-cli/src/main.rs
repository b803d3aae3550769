//! `fct`: parse, dispatch, exit code. Everything else is done by the libraries.

mod cli;
mod commands;
mod guard;
mod outcome;
mod place;
mod progress;
mod session;

use clap::Parser;
use std::process::ExitCode;

fn main() -> ExitCode {
    guard::panics_are_told();
    let cli = match cli::Cli::try_parse() {
        Ok(cli) => cli,
        // Help that nobody reads to its end (`fct --help | head -1`) is no fault.
        Err(e) => return outcome::usage(&e),
    };
    guard::guarded(cli.common.json, || run(&cli))
}

fn run(cli: &cli::Cli) -> ExitCode {
    let done = session::Session::new(&cli.common).and_then(|session| commands::run(&cli.command, &session));
    match done {
        Ok(outcome) => outcome.tell(cli.common.json),
        Err(failure) => failure.tell(cli.common.json),
    }
}
