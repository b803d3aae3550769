#![doc = include_str!("../README.md")]

pub mod bic;
mod columns;
mod decide;
mod frontier;
mod integral;
mod intervals;
mod likeness;
mod linear;
mod mode;
mod model;
mod node;
mod orthogonal;
mod path;
mod posterior;
mod process;
mod record;
mod remains;
mod rest;
pub mod scores;
mod shares;
pub mod special;
mod spectrum;
mod truncated;

pub use decide::{CREDIBLE, Decision, LIKELY, Verdict, WRONG_NAME, decide};
pub use frontier::{Extension, HOPELESS, LEFT, extend, hopeless, to_fit};
pub use intervals::Interval;
pub use linear::{Linear, Parameter};
pub use mode::{Mode, at_the_mode, density};
pub use model::{Evidence, Kernel, View};
pub use path::path;
pub use posterior::{Brief, Judged, Posterior, SetPrior, SetProbability};
pub use process::{Points, Process};
pub use record::{EvidenceError, Place, Record};
pub use remains::{ExplainedTo, Remains, Share, excess, remains};
pub use rest::{RestForm, RestPrior, RestSize};
pub use truncated::Belief;
