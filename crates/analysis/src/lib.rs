//! The loop on a specimen: identify, compare, diagnose, add, discover.
#![warn(missing_docs)]

mod data;
mod identify;
mod problem;

pub use data::{Measured, RecordError, Slot};
pub use identify::{
    AnalysisError, Control, HistoryEntry, Identified, Progress, Stage, frees, identify, run_options,
};
pub use problem::{Cancelled, FeProblem};
