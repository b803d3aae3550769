//! `fct workbench`: one page on this machine that fits a specimen, asks what is missing, adds it and shows the error fall.
//!
//! The page does nothing of its own. What it does is an `fct` command on files of the opened folder, run by whoever
//! implements [`Commands`], and every command stands on the page to be copied. What was done stands in
//! `steps.json` ([`Bench::open`]), so that a reload, a crash or a second look from a terminal sees the same.
//!
//! [`Server`] listens on 127.0.0.1 only and lets nobody in who has not the token of the opened address.

mod action;
mod assets;
mod bench;
mod events;
mod guard;
mod numbers;
mod opened;
mod perform;
mod queue;
mod routes;
mod server;
mod set;
mod shell;
mod steps;
mod tried;
mod view;

pub use bench::Bench;
pub use opened::Opened;
pub use server::Server;

use serde_json::Value;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use thiserror::Error;

/// Largest body of a request, bytes.
pub const LARGEST_BODY: usize = 64 << 20;

/// Why a workbench cannot be opened, or cannot do what was asked.
#[derive(Debug, Error)]
pub enum BenchError {
    /// What was named cannot be opened, or a request asks for what is not there.
    #[error("{0}")]
    Asked(String),
    /// The disk refuses.
    #[error("{}: cannot {action}: {source}", path.display())]
    Io {
        /// File or folder.
        path: PathBuf,
        /// What was tried.
        action: &'static str,
        /// What the system says.
        source: std::io::Error,
    },
    /// The address cannot be listened on.
    #[error("cannot listen on 127.0.0.1:{port}: {source}")]
    Listen {
        /// Port.
        port: u16,
        /// What the system says.
        source: std::io::Error,
    },
}

impl BenchError {
    /// For `map_err`: what was tried with a path.
    pub(crate) fn io(path: impl Into<PathBuf>, action: &'static str) -> impl FnOnce(std::io::Error) -> Self {
        let path = path.into();
        move |source| Self::Io { path, action, source }
    }
}

/// Hears what a command does while it runs.
pub trait Listener: Send + Sync {
    /// A remark, or what is being done now.
    fn note(&self, text: &str);
    /// A run of the model in a search.
    fn iterate(&self, progress: &analysis::Progress);
}

/// How a command ended.
#[derive(Clone, Debug)]
pub struct Told {
    /// Exit code: 0 done, 1 could not compute, 2 bad input.
    pub code: u8,
    /// The document of `--json`.
    pub json: Value,
    /// Why it failed, for people; empty if it did not.
    pub message: String,
}

/// Runs `fct` commands in this process.
pub trait Commands: Send + Sync {
    /// Runs `fct ARGUMENTS --json` in the opened folder. A command ends soon after `cancelled` becomes true, and keeps what
    /// it then has, as it does after Ctrl-C. Never panics.
    fn run(&self, arguments: &[String], cancelled: &Arc<AtomicBool>, listener: &Arc<dyn Listener>) -> Told;
}

/// The example of the README is compiled.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
