//! `fct`: parse, dispatch, exit code. Everything else is done by the libraries.

mod cli;
mod commands;
mod outcome;
mod progress;
mod session;

use clap::Parser;
use std::process::ExitCode;

fn main() -> ExitCode {
    let cli = cli::Cli::parse();
    let session = match session::Session::new(&cli.common) {
        Ok(session) => session,
        Err(failure) => return failure.tell(cli.common.json),
    };
    match commands::run(&cli.command, &session) {
        Ok(outcome) => outcome.tell(cli.common.json),
        Err(failure) => failure.tell(cli.common.json),
    }
}
