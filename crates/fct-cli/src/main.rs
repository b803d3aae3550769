//! `fct`: parse, dispatch, exit code. Everything else is done by the libraries.

mod cli;
mod commands;
mod flags;
mod guard;
mod outcome;
mod place;
mod progress;
mod session;

use clap::Parser;
use std::process::ExitCode;

fn main() -> ExitCode {
    guard::panics_are_told();
    let cli = match cli::Cli::try_parse_from(cli::arranged(std::env::args_os())) {
        Ok(cli) => cli,
        // Help that nobody reads to its end (`fct --help | head -1`) is no fault.
        Err(e) => return outcome::usage(&e),
    };
    let common = cli.command.common();
    guard::guarded(common.json, || run(&cli, &common))
}

fn run(cli: &cli::Cli, common: &flags::Common) -> ExitCode {
    let session = match session::Session::new(common) {
        Ok(session) => session,
        Err(failure) => return failure.tell(common.json),
    };
    match commands::run(&cli.command, &session) {
        Ok(outcome) => outcome.tell(&session),
        Err(failure) => failure.tell(common.json),
    }
}
