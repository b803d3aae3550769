//! `fct`: parse, dispatch, exit code. Everything else is done by the libraries.

mod cli;
mod commands;
mod flags;
mod outcome;
mod progress;
mod session;

use clap::Parser;
use std::process::ExitCode;

fn main() -> ExitCode {
    let cli = cli::Cli::parse_from(cli::arranged(std::env::args_os()));
    let common = cli.command.common();
    let session = match session::Session::new(&common) {
        Ok(session) => session,
        Err(failure) => return failure.tell(common.json),
    };
    match commands::run(&cli.command, &session) {
        Ok(outcome) => outcome.tell(&session),
        Err(failure) => failure.tell(common.json),
    }
}
