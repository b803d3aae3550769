//! The hidden-effect study: makes specimen folders in which a known effect is hidden, lets the search
//! ([`analysis::FeLadder::weighed`]) loose on them, and reports how often its answer was right.
//!
//! The records are computed on other meshes, with other steps and another integration of the interface than the
//! identification uses, and carry noise. Laws are shared with the product, though, but for those of [`foreign`]: the outside
//! suite of practice records covers that side. Nothing here feeds back into the product.
#![warn(missing_docs)]

pub mod amplitude;
pub mod archive;
pub mod draw;
pub mod files;
pub mod foreign;
pub mod forward;
pub mod generate;
pub mod imitate;
pub mod outcome;
pub mod outside;
pub mod protocol;
pub mod report;
pub mod run;
pub mod signal;
pub mod spec;

use thiserror::Error;

/// Why a case could not be made or read.
#[derive(Debug, Error)]
pub enum GenerateError {
    /// A file.
    #[error("{path}: {why}")]
    File {
        /// Which.
        path: String,
        /// What is wrong with it.
        why: String,
    },
    /// The model of the generator.
    #[error("{0}")]
    Model(String),
    /// Building or running a model.
    #[error(transparent)]
    Analysis(#[from] analysis::AnalysisError),
    /// Running a model.
    #[error(transparent)]
    Predict(#[from] inverse::PredictError),
    /// Building a model.
    #[error(transparent)]
    Build(#[from] model::BuildError),
}

impl GenerateError {
    /// A fault of a file.
    pub fn file(path: &str, why: &dyn std::fmt::Display) -> Self {
        Self::File { path: path.to_owned(), why: why.to_string() }
    }
}
