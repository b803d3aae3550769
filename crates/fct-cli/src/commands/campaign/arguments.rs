//! The command line of `fct campaign`.

use crate::flags::{Answers, Common, Shows, With, Writes};
use ::campaign::Shard;
use clap::Subcommand;
use std::path::PathBuf;

/// Arguments of `fct campaign`.
#[derive(Clone, Debug, clap::Args)]
pub struct Arguments {
    /// What to do.
    #[command(subcommand)]
    pub what: What,
}

/// The commands.
#[derive(Clone, Debug, Subcommand)]
pub enum What {
    /// The tasks of a study, and what is wrong with rows of its table
    #[command(
        after_help = "Examples:\n  fct campaign plan study.toml\n  fct campaign plan study.toml --json > plan.json"
    )]
    Plan(With<Study, Shows>),
    /// Do tasks until none is left; any number of these may run at once, on any machine that sees the folder
    #[command(
        after_help = "Examples:\n  fct campaign run study.toml --workers 4 --threads 1\n  fct campaign run study.toml --shard 3/16"
    )]
    Run(With<Run, Answers>),
    /// How the tasks stand, at any moment
    #[command(
        after_help = "Examples:\n  fct campaign status study.toml\n  fct campaign status study-study --json"
    )]
    Status(With<Study, Shows>),
    /// The study page, its tables as CSV, a paragraph for the methods
    #[command(
        after_help = "Examples:\n  fct campaign report study.toml\n  fct campaign report study.toml --out plaques.html"
    )]
    Report(With<Study, Writes>),
    /// A Slurm job script whose array does the study
    #[command(
        after_help = "Examples:\n  fct campaign slurm study.toml --array 20 > job.sh && sbatch job.sh\n  fct campaign slurm study.toml --cores 4 --time 08:00:00"
    )]
    Slurm(With<Slurm, Shows>),
}

/// A study.
#[derive(Clone, Debug, clap::Args)]
pub struct Study {
    /// The file of the study, or its folder
    #[arg(value_name = "STUDY")]
    pub study: PathBuf,
}

/// `fct campaign run`.
#[derive(Clone, Debug, clap::Args)]
pub struct Run {
    /// The file of the study, or its folder
    #[arg(value_name = "STUDY")]
    pub study: PathBuf,
    /// The share of this process, 1/N to N/N; default: everything
    #[arg(long, value_name = "I/N", default_value = "1/1", hide_default_value = true)]
    pub shard: Shard,
    /// Processes on this machine; one that ends is replaced, and costs its task only
    #[arg(long, value_name = "N", default_value = "1", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub workers: u16,
    /// Try again what failed or was set aside
    #[arg(long)]
    pub retry: bool,
}

/// `fct campaign slurm`.
#[derive(Clone, Debug, clap::Args)]
pub struct Slurm {
    /// The file of the study, or its folder
    #[arg(value_name = "STUDY")]
    pub study: PathBuf,
    /// Members of the array; default: one per fit, at most 100
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=10000))]
    pub array: Option<u16>,
    /// Cores of each
    #[arg(long, value_name = "N", default_value = "1", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub cores: u16,
    /// Time limit of each
    #[arg(long, value_name = "HH:MM:SS", default_value = "04:00:00", value_parser = plain)]
    pub time: String,
    /// Memory of each
    #[arg(long, value_name = "SIZE", default_value = "4G", value_parser = plain)]
    pub memory: String,
}

/// A word that a line of the script can hold.
fn plain(text: &str) -> Result<String, String> {
    let good = !text.is_empty() && text.chars().all(|c| c.is_ascii_alphanumeric() || ":-.".contains(c));
    if good { Ok(text.to_owned()) } else { Err("expected digits and letters, as 04:00:00 or 4G".into()) }
}

impl What {
    /// The shared flags.
    pub fn common(&self) -> Common {
        match self {
            Self::Plan(a) | Self::Status(a) => (&a.flags).into(),
            Self::Run(a) => (&a.flags).into(),
            Self::Report(a) => (&a.flags).into(),
            Self::Slurm(a) => (&a.flags).into(),
        }
    }
}
