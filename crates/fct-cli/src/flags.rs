//! Flags that commands share. Each command takes those that matter to it, and no others.

use clap::Args;
use std::path::PathBuf;

/// What a session needs to know of all flags; those that a command does not take are at rest.
#[derive(Clone, Debug, Default)]
pub struct Common {
    /// `--out`
    pub out: Option<PathBuf>,
    /// `--json`
    pub json: bool,
    /// `--threads`
    pub threads: Option<u16>,
    /// `--quiet`
    pub quiet: bool,
    /// `--figures`
    pub figures: Option<Vec<Format>>,
    /// `--resume`
    pub resume: bool,
    /// `--force`
    pub force: bool,
}

/// A command's own arguments and the shared flags that it takes.
#[derive(Clone, Debug, Args)]
pub struct With<A: Args, F: Args> {
    /// Its own.
    #[command(flatten)]
    pub own: A,
    /// The shared ones.
    #[command(flatten)]
    pub flags: F,
}

/// What a command tells.
#[derive(Clone, Debug, Args)]
pub struct Tells {
    /// The answer as one JSON document on stdout, everything else on stderr
    #[arg(long)]
    pub json: bool,
    /// No progress, no remarks; errors only
    #[arg(long)]
    pub quiet: bool,
}

/// Flags that every command takes, though some have no use for them.
#[derive(Clone, Debug, Args)]
pub struct Idle {
    /// Not shown: there is nothing to do on several threads.
    #[arg(long, hide = true, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub threads: Option<u16>,
    /// Not shown: there is nothing to take up.
    #[arg(long, hide = true)]
    pub resume: bool,
}

/// Of a command that tells what it knows.
#[derive(Clone, Debug, Args)]
pub struct Shows {
    /// What it tells.
    #[command(flatten)]
    pub tells: Tells,
    /// Flags of other commands.
    #[command(flatten)]
    pub idle: Idle,
}

/// Of a command that computes, but makes no run.
#[derive(Clone, Debug, Args)]
pub struct Answers {
    /// How it computes.
    #[command(flatten)]
    pub computes: Computes,
    /// Not shown: there is nothing to take up.
    #[arg(long, hide = true)]
    pub resume: bool,
}

/// How a command computes.
#[derive(Clone, Debug, Args)]
pub struct Computes {
    /// What it tells.
    #[command(flatten)]
    pub tells: Tells,
    /// Number of threads; default: one per core. The answer does not depend on it
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub threads: Option<u16>,
}

/// Of a command that makes a run directory.
#[derive(Clone, Debug, Args)]
pub struct Runs {
    /// Run directory; default runs/NAME/
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// How it computes.
    #[command(flatten)]
    pub computes: Computes,
    /// Formats of the figures, each plot in a file of its own; default: what the file says, else svg
    #[arg(long, value_name = "FORMATS", value_delimiter = ',')]
    pub figures: Option<Vec<Format>>,
    /// Take up a run where it stopped; a finished one only gives its answer again
    #[arg(long)]
    pub resume: bool,
    /// Write over what fct did not write
    #[arg(long)]
    pub force: bool,
}

/// Of a command that writes one file.
#[derive(Clone, Debug, Args)]
pub struct Writes {
    /// The file to write
    #[arg(long, value_name = "FILE")]
    pub out: Option<PathBuf>,
    /// Write over what fct did not write
    #[arg(long)]
    pub force: bool,
    /// Flags of other commands.
    #[command(flatten)]
    pub idle: Idle,
    /// What it tells.
    #[command(flatten)]
    pub tells: Tells,
}

/// Of a command that makes a folder.
#[derive(Clone, Debug, Args)]
pub struct Makes {
    /// The folder to make; default NAME
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Flags of other commands.
    #[command(flatten)]
    pub idle: Idle,
    /// What it tells.
    #[command(flatten)]
    pub tells: Tells,
}

/// Of the command that makes pages.
#[derive(Clone, Debug, Args)]
pub struct Draws {
    /// The page to write; default report.html in each run directory
    #[arg(long, value_name = "FILE")]
    pub out: Option<PathBuf>,
    /// Write over what fct did not write
    #[arg(long)]
    pub force: bool,
    /// How it computes.
    #[command(flatten)]
    pub computes: Computes,
    /// Not shown: there is nothing to take up.
    #[arg(long, hide = true)]
    pub resume: bool,
    /// Besides, each plot in a file of its own, in these formats, in the run's figures/
    #[arg(long, value_name = "FORMATS", value_delimiter = ',')]
    pub figures: Option<Vec<Format>>,
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

impl From<&Tells> for Common {
    fn from(f: &Tells) -> Self {
        Self { json: f.json, quiet: f.quiet, ..Self::default() }
    }
}

impl From<&Computes> for Common {
    fn from(f: &Computes) -> Self {
        Self { threads: f.threads, ..(&f.tells).into() }
    }
}

impl From<&Shows> for Common {
    fn from(f: &Shows) -> Self {
        (&f.tells).into()
    }
}

impl From<&Answers> for Common {
    fn from(f: &Answers) -> Self {
        (&f.computes).into()
    }
}

impl From<&Runs> for Common {
    fn from(f: &Runs) -> Self {
        let (out, figures) = (f.out.clone(), f.figures.clone());
        Self { out, figures, resume: f.resume, force: f.force, ..(&f.computes).into() }
    }
}

impl From<&Writes> for Common {
    fn from(f: &Writes) -> Self {
        Self { out: f.out.clone(), force: f.force, ..(&f.tells).into() }
    }
}

impl From<&Makes> for Common {
    fn from(f: &Makes) -> Self {
        Self { out: f.out.clone(), ..(&f.tells).into() }
    }
}

impl From<&Draws> for Common {
    fn from(f: &Draws) -> Self {
        Self { out: f.out.clone(), figures: f.figures.clone(), force: f.force, ..(&f.computes).into() }
    }
}
