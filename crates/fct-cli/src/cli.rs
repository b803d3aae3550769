//! The command line.

use crate::commands::{
    add, batch, check, compare, design, diagnose, discover, drop, effects, identify, import, ladder, new,
    report, simulate,
};
use clap::{Args, Parser, Subcommand};
use std::path::PathBuf;

/// Identifies the strength of torn soft tissue from tearing tests, and names the physical effect
/// that a model lacks.
#[derive(Debug, Parser)]
#[command(name = "fct", version, max_term_width = 100, arg_required_else_help = true)]
pub struct Cli {
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
    /// Flags of every command.
    #[command(flatten)]
    pub common: Common,
}

/// Flags of every command.
#[derive(Clone, Debug, Args)]
pub struct Common {
    /// Run directory (add, drop: the file to write); default runs/NAME/
    #[arg(long, global = true, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// The answer as one JSON document on stdout, everything else on stderr
    #[arg(long, global = true)]
    pub json: bool,
    /// Number of threads; default: one per core. The answer does not depend on it
    #[arg(long, global = true, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub threads: Option<u16>,
    /// No progress, no remarks; errors only
    #[arg(long, global = true)]
    pub quiet: bool,
    /// Formats of the figures, each plot in a file of its own; default: what the file says, else svg
    #[arg(long, global = true, value_name = "FORMATS", value_delimiter = ',')]
    pub figures: Option<Vec<Format>>,
    /// Write into a directory, or over a file, that holds something fct did not write
    #[arg(long, global = true)]
    pub force: bool,
    /// Take up a run where it stopped; a finished one only gives its answer again
    #[arg(long, global = true)]
    pub resume: bool,
}

/// A figure format on the command line.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum Format {
    /// For browsers and drawing programs
    Svg,
    /// For papers
    Pdf,
    /// For slides
    Png,
}

impl From<Format> for input::Figure {
    fn from(f: Format) -> Self {
        match f {
            Format::Svg => Self::Svg,
            Format::Pdf => Self::Pdf,
            Format::Png => Self::Png,
        }
    }
}

/// The commands.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Scaffold a specimen: files, sample records, ready to run
    New(new::Arguments),
    /// From whatever a testing machine wrote to a record and a specimen
    Import(Box<import::Arguments>),
    /// Validate a file, print what is resolved with every default, say what its records are good for
    Check(check::Arguments),
    /// Before the test: which protocol would show which effects, and how well strength would be known
    Design(design::Arguments),
    /// Forward runs: curves, fields, energy ledger
    Simulate(simulate::Arguments),
    /// The paper's inverse analysis: bulk, then the strength along the tear path
    Identify(identify::Arguments),
    /// Where and how far the model is off
    Compare(compare::Arguments),
    /// Which effect is missing
    Diagnose(diagnose::Arguments),
    /// A config with an effect added
    Add(add::Arguments),
    /// A config with an effect taken away
    Drop(drop::Arguments),
    /// The whole loop until the record is explained, or honestly not
    Discover(discover::Arguments),
    /// The staircase of error against effects added
    Ladder(ladder::Arguments),
    /// Identify many specimens; a table over all
    Batch(batch::Arguments),
    /// The catalogue of effects, or one card
    Effects(effects::Arguments),
    /// One self-contained HTML file per run
    Report(report::Arguments),
}
