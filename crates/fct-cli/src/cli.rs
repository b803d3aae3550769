//! The command line.

use crate::commands::{
    add, batch, campaign, check, compare, completions, design, diagnose, discover, drop, effects, export,
    identify, import, ladder, man, new, report, schema, set, simulate, workbench,
};
pub use crate::flags::Common;
use crate::flags::{Answers, Draws, Makes, Runs, Shows, With, Writes};
use clap::{CommandFactory, Parser, Subcommand};
use std::ffi::OsString;

/// Identifies the strength of torn soft tissue from tearing tests, and names the physical effect
/// that a model lacks.
#[derive(Debug, Parser)]
#[command(
    name = "fct",
    version,
    max_term_width = 100,
    arg_required_else_help = true,
    after_help = "Examples:\n  fct new strip && fct identify strip/strip.toml\n  fct discover strip/strip.toml --out runs/search"
)]
pub struct Cli {
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
}

/// The commands.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Scaffold a specimen: files, sample records, ready to run
    #[command(after_help = "Examples:\n  fct new strip\n  fct new strip --out specimens/strip")]
    New(With<new::Arguments, Makes>),
    /// From whatever a testing machine wrote to a record and a specimen
    #[command(
        after_help = "Examples:\n  fct import strip_RawData_1.csv --geometry strip.toml --out strip\n  fct import Zug.TRA Riss.TRA --kind uniaxial,tearing --decimal , --force 'Load [kN]'"
    )]
    Import(Box<With<import::Arguments, Makes>>),
    /// Validate a file, print what is resolved with every default, say what its records are good for
    #[command(after_help = "Examples:\n  fct check strip.toml\n  fct check strip.toml > whole.toml")]
    Check(With<check::Arguments, Answers>),
    /// Before the test: which protocol would show which effects, and how well strength would be known
    #[command(
        after_help = "Examples:\n  fct design strip.toml\n  fct design strip.toml --budget 30min --json"
    )]
    Design(With<design::Arguments, Answers>),
    /// Forward runs: curves, fields, energy ledger
    #[command(
        after_help = "Examples:\n  fct simulate strip.toml\n  fct simulate strip.toml --out runs/forward --figures svg"
    )]
    Simulate(With<simulate::Arguments, Runs>),
    /// The paper's inverse analysis: bulk, then the strength along the tear path
    #[command(
        after_help = "Examples:\n  fct identify configs/FCT1.toml\n  fct identify strip.toml --out runs/base --threads 4"
    )]
    Identify(With<identify::Arguments, Runs>),
    /// Where and how far the model is off
    #[command(after_help = "Examples:\n  fct compare runs/base\n  fct compare runs/base --json > base.json")]
    Compare(With<compare::Arguments, Runs>),
    /// Which effect is missing
    #[command(
        after_help = "Examples:\n  fct diagnose runs/base\n  fct diagnose runs/base --json > diagnosis.json"
    )]
    Diagnose(With<diagnose::Arguments, Runs>),
    /// A config with an effect added
    #[command(
        after_help = "Examples:\n  fct add viscoelastic runs/base --out more.toml\n  fct add drift strip.toml"
    )]
    Add(With<add::Arguments, Writes>),
    /// A config with an effect taken away
    #[command(
        after_help = "Examples:\n  fct drop viscoelastic more.toml --out less.toml\n  fct drop drift runs/more"
    )]
    Drop(With<drop::Arguments, Writes>),
    /// A config with other values, held or free parameters, another mesh
    #[command(
        after_help = "Examples:\n  fct set runs/base bulk.mu=0.0051 --out other.toml\n  fct set strip.toml --hold bulk.kappa --areas 3"
    )]
    Set(With<set::Arguments, Writes>),
    /// The whole loop until the record is explained, or honestly not
    #[command(
        after_help = "Examples:\n  fct discover strip.toml --out runs/search\n  fct discover strip.toml --out runs/search --resume"
    )]
    Discover(With<discover::Arguments, Runs>),
    /// The staircase of error against effects added
    #[command(
        after_help = "Examples:\n  fct ladder runs/base runs/more\n  fct ladder runs/base runs/more --json"
    )]
    Ladder(With<ladder::Arguments, Answers>),
    /// Identify many specimens; a table over all
    #[command(
        after_help = "Examples:\n  fct batch configs/FCT*.toml\n  fct batch a.toml b.toml --out runs/all --resume"
    )]
    Batch(With<batch::Arguments, Runs>),
    /// The catalogue of effects, or one card
    #[command(after_help = "Examples:\n  fct effects\n  fct effects viscoelastic")]
    Effects(With<effects::Arguments, Shows>),
    /// One self-contained HTML file per run
    #[command(
        after_help = "Examples:\n  fct report runs/base\n  fct report runs/base runs/more --out ladder.html"
    )]
    Report(With<report::Arguments, Draws>),
    /// The identified law as input of another program, with a deck of one element
    #[command(
        after_help = "Examples:\n  fct export felupe runs/base\n  fct export abaqus runs/base --out tissue.inp"
    )]
    Export(With<export::Arguments, Writes>),
    /// A study of many specimens, on one machine or many
    #[command(
        after_help = "Examples:\n  fct campaign plan study.toml\n  fct campaign run study.toml --shard 1/4"
    )]
    Campaign(Box<campaign::Arguments>),
    /// JSON Schema of specimens and configs, for editors that complete and check while one types
    #[command(
        after_help = "Examples:\n  fct schema > fct.schema.json\n  fct schema --json > fct.schema.json"
    )]
    Schema(With<schema::Arguments, Shows>),
    /// Completions of the command line for a shell
    #[command(
        after_help = "Examples:\n  fct completions bash > ~/.local/share/bash-completion/completions/fct\n  fct completions zsh > ~/.zfunc/_fct"
    )]
    Completions(With<completions::Arguments, Shows>),
    /// The manual page of fct, or of one command
    #[command(after_help = "Examples:\n  fct man > fct.1\n  fct man identify > fct-identify.1")]
    Man(With<man::Arguments, Shows>),
    /// One page in the browser: fit, ask what is missing, add it, watch the error fall
    #[command(after_help = "Examples:\n  fct workbench\n  fct workbench strip_RawData_1.csv --port 8080")]
    Workbench(With<workbench::Arguments, Answers>),
}

impl Command {
    /// The shared flags, as far as the command takes them.
    pub fn common(&self) -> Common {
        match self {
            Self::New(a) => (&a.flags).into(),
            Self::Import(a) => (&a.flags).into(),
            Self::Check(a) => (&a.flags).into(),
            Self::Design(a) => (&a.flags).into(),
            Self::Simulate(a) => (&a.flags).into(),
            Self::Identify(a) => (&a.flags).into(),
            Self::Compare(a) => (&a.flags).into(),
            Self::Diagnose(a) => (&a.flags).into(),
            Self::Add(a) => (&a.flags).into(),
            Self::Drop(a) => (&a.flags).into(),
            Self::Set(a) => (&a.flags).into(),
            Self::Discover(a) => (&a.flags).into(),
            Self::Ladder(a) => (&a.flags).into(),
            Self::Batch(a) => (&a.flags).into(),
            Self::Effects(a) => (&a.flags).into(),
            Self::Report(a) => (&a.flags).into(),
            Self::Export(a) => (&a.flags).into(),
            Self::Campaign(a) => a.what.common(),
            Self::Schema(a) => (&a.flags).into(),
            Self::Completions(a) => (&a.flags).into(),
            Self::Man(a) => (&a.flags).into(),
            Self::Workbench(a) => (&a.flags).into(),
        }
    }
}

/// Shared flags that take a value.
const VALUED: [&str; 3] = ["--out", "--threads", "--figures"];

/// The words of a command line with flags that stand before the command put behind it, where they belong to it.
pub fn arranged(words: impl Iterator<Item = OsString>) -> Vec<OsString> {
    let words: Vec<OsString> = words.collect();
    let cli = Cli::command();
    let known = |word: &OsString| word.to_str().is_some_and(|w| cli.find_subcommand(w).is_some());
    let mut at = 1;
    while let Some(word) = words.get(at).filter(|w| !known(w)) {
        // What is no flag is a mistake, and is told as it was written.
        if !word.to_str().is_some_and(|w| w.starts_with("--")) {
            return words;
        }
        at += if word.to_str().is_some_and(|w| VALUED.contains(&w)) { 2 } else { 1 };
    }
    let Some(command) = words.get(at) else { return words };
    // A command of commands: they are the second one's.
    let inner = command.to_str().and_then(|c| cli.find_subcommand(c)).is_some_and(|c| c.has_subcommands());
    let end = (at + 1 + usize::from(inner)).min(words.len());
    let (named, after) = (words.get(at..end).unwrap_or_default(), words.get(end..).unwrap_or_default());
    let before = words.get(1..at).unwrap_or_default();
    words.iter().take(1).chain(named).chain(before).chain(after).cloned().collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parsed(line: &str) -> Result<Cli, clap::Error> {
        Cli::try_parse_from(arranged(line.split_whitespace().map(OsString::from)))
    }

    #[test]
    fn every_help_ends_with_two_examples_that_are_valid() {
        let cli = Cli::command();
        for command in cli.get_subcommands() {
            let help = command.get_after_help().map(ToString::to_string).unwrap_or_default();
            let examples: Vec<&str> = help.lines().skip(1).map(str::trim).collect();
            assert!(help.starts_with("Examples:\n") && examples.len() == 2, "{}", command.get_name());
            for example in examples {
                assert!(example.starts_with(&format!("fct {}", command.get_name())), "{example}");
                let plain = example.split(" > ").next().unwrap_or_default();
                assert!(parsed(plain).is_ok(), "{example}");
            }
        }
    }

    #[test]
    fn a_command_takes_the_flags_that_matter_to_it_and_no_others() {
        for line in [
            "fct effects --figures pdf",
            "fct effects --out x",
            "fct effects --force",
            "fct ladder r --out x",
            "fct check f --figures pdf",
        ] {
            assert!(parsed(line).is_err(), "{line}");
        }
        // Those of the contract are taken everywhere, shown or not.
        for command in [
            "effects",
            "new n",
            "add drift f",
            "check f",
            "simulate f",
            "identify f",
            "compare r",
            "diagnose r",
            "discover f",
            "batch f",
            "report r",
            "ladder r",
        ] {
            assert!(
                parsed(&format!("fct {command} --json --quiet --threads 2 --resume")).is_ok(),
                "{command}"
            );
        }
        for command in ["simulate f", "identify f", "compare r", "diagnose r", "discover f", "batch f"] {
            assert!(parsed(&format!("fct {command} --out d --resume --figures pdf")).is_ok(), "{command}");
        }
    }

    #[test]
    fn flags_before_the_command_are_the_command_s() {
        let common = parsed("fct --json --threads 3 --out x identify f.toml").map(|c| c.command.common());
        assert!(common.is_ok_and(|c| c.json && c.threads == Some(3) && c.out == Some("x".into())));
        assert!(parsed("fct frobnicate").is_err() && parsed("fct --frobnicate identify f").is_err());
        assert!(parsed("fct --version").is_err_and(|e| e.exit_code() == 0));
    }
}
