//! One file per command: arguments, what is asked of the libraries, what is shown.

pub mod add;
pub mod batch;
pub mod campaign;
pub mod check;
pub mod compare;
pub mod completions;
pub mod design;
pub mod diagnose;
pub mod discover;
pub mod drop;
mod edit;
pub mod effects;
pub mod export;
mod fitted_models;
pub mod identify;
pub mod import;
pub mod ladder;
pub mod man;
pub mod new;
pub mod report;
pub mod schema;
pub mod set;
pub mod simulate;
mod unfinished;
pub mod workbench;

use crate::cli::Command;
use crate::outcome::{Failure, Outcome};
use crate::session::Session;

/// Runs a command.
///
/// # Errors
/// Why it gave no answer.
pub fn run(command: &Command, session: &Session) -> Result<Outcome, Failure> {
    match command {
        Command::New(a) => new::run(&a.own, session),
        Command::Import(a) => import::run(&a.own, session),
        Command::Check(a) => check::run(&a.own, session),
        Command::Design(a) => design::run(&a.own, session),
        Command::Simulate(a) => simulate::run(&a.own, session),
        Command::Identify(a) => identify::run(&a.own, session),
        Command::Compare(a) => compare::run(&a.own, session),
        Command::Diagnose(a) => diagnose::run(&a.own, session),
        Command::Add(a) => add::run(&a.own, session),
        Command::Drop(a) => drop::run(&a.own, session),
        Command::Set(a) => set::run(&a.own, session),
        Command::Discover(a) => discover::run(&a.own, session),
        Command::Ladder(a) => ladder::run(&a.own, session),
        Command::Batch(a) => batch::run(&a.own, session),
        Command::Effects(a) => effects::run(&a.own, session),
        Command::Report(a) => report::run(&a.own, session),
        Command::Campaign(a) => campaign::run(&a.what, session),
        Command::Export(a) => export::run(&a.own, session),
        Command::Schema(a) => schema::run(&a.own, session),
        Command::Completions(a) => completions::run(&a.own),
        Command::Man(a) => man::run(&a.own),
        Command::Workbench(a) => workbench::run(&a.own, session),
    }
}
