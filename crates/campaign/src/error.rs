//! Why a study could not be planned, worked on or read.

use input::Diagnostics;
use report::ReportError;
use std::path::PathBuf;
use thiserror::Error;

/// Why a study could not be planned, worked on or read.
#[derive(Debug, Error)]
pub enum CampaignError {
    /// The file of the study.
    #[error(transparent)]
    Study(#[from] Diagnostics),
    /// The disk refuses, or something of the user's is in the way.
    #[error(transparent)]
    Files(#[from] ReportError),
    /// A folder without a plan.
    #[error("{}: this is no folder of a study (it holds no plan.json); `fct campaign plan STUDY.toml` makes one", .0.display())]
    NoPlan(PathBuf),
    /// A plan that cannot be read.
    #[error("{}: this plan is damaged ({reason}); `fct campaign plan STUDY.toml` makes it anew", .path.display())]
    BadPlan {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        reason: String,
    },
    /// A share that does not exist.
    #[error("shard {0}: expected i/n with 1 ≤ i ≤ n")]
    Shard(String),
}
