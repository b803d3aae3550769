//! A study: specimens × models × repeats as independent tasks, and what they say together.
//!
//! A task is known by a hash of what it computes ([`Task::key`]): its resolved input, what is done, the version of the
//! program. Its result is one file of that name ([`Folder`]), put in place by renaming. What is done is never done again,
//! what failed is not missing, and any number of processes on any machines that see the folder may work at once
//! ([`run`]): each claims a task before it begins, and a claim whose worker is gone is another's to take, three times at
//! most. [`summary`] pools what was found by group with a random-effects model ([`pooled`]).

mod boot;
mod claim;
mod error;
mod files;
mod plan;
mod pool;
mod run;
mod status;
mod summary;
mod words;
mod work;

pub use claim::{ATTEMPTS, Claim, ClaimState, HEARTBEAT, SILENCE, state as claim_state};
pub use error::CampaignError;
pub use files::{Folder, Outcome, TaskResult};
pub use plan::{Plan, Specimen, Task, WrongRow, read_or_plan};
pub use pool::{Difference, Observation, Pooled, difference, pooled};
pub use run::{Ran, Shard, Went, Worker, attempt, forget_failures, run};
pub use status::{State, Status, TaskState, status};
pub use summary::{
    EffectCount, GroupDifference, GroupSummary, ModelSummary, Quantity, SpecimenRow, Strength, StudySummary,
    csv_files, summary,
};
pub use words::{Job, methods, page, slurm};
pub use work::{Tools, do_task};

/// The example of the README is compiled and run.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
