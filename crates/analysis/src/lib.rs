//! The loop on a specimen: identify, compare, diagnose, add, discover.

mod answer;
mod columns;
pub mod compare;
mod data;
mod identify;
mod ladder;
mod needs;
mod priors;
mod problem;
mod simulate;
mod start;
mod strip;

pub use answer::{DiscoverAnswer, LadderRow, NextTest, ScreenRow, diagnose, discover};
pub use columns::{Base, Screened, scales};
pub use compare::{CompareAnswer, compare};
pub use data::{Measured, RecordError, Slot};
pub use identify::{
    AnalysisError, Control, HistoryEntry, Identified, Progress, Stage, frees, identify, run_options,
};
pub use ladder::{FeLadder, Fitted};
pub use needs::{Need, needs};
pub use problem::{Cancelled, FeProblem};
pub use simulate::{SimulateControl, Simulated, SimulatedTest, replay, simulate};
pub use start::start_at;
