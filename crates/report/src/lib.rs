//! The only writer: run directories, answers, curves, fields, figures, HTML, terminal tables.
//!
//! A run directory is written beside its place and moved there whole ([`RunDir`]); answers are plain
//! structures that serialise to the JSON of the contract ([`answer`]); everything that is shown
//! (terminal, HTML, figures) is made from those answers, so that a stored run shows the same.

pub mod answer;
mod averaged;
mod curves;
mod error;
pub mod export;
pub mod fields;
pub mod figures;
pub mod html;
mod law_columns;
mod peek;
mod published;
mod rundir;
mod runs;
mod search_log;
mod shell;
mod store;
mod synthetic;
mod tables;
pub mod terminal;

pub use curves::{Curve, identified_curves, simulated_curve};
pub use error::ReportError;
pub use published::Published;
pub use rundir::{
    Begin, Kept, MANIFEST, Manifest, RunDir, RunJournal, amend, numbered, write_atomic, write_named,
};
pub use runs::{RunInfo, StoredRun};
pub use search_log::SearchLog;
pub use shell::{quoted, quoted_path};
pub use store::{
    Partial, exported, store_discover, store_fitted_model, store_identify, store_partial, store_simulate,
    store_unfinished,
};
pub use synthetic::{SyntheticFile, synthetic_files};
pub use tables::{history_csv, jacobian_csv};
