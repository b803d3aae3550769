//! Why something could not be written or read back.

use std::io;
use std::path::{Path, PathBuf};
use thiserror::Error;

/// Why a run directory or a file could not be written or read.
#[derive(Debug, Error)]
pub enum ReportError {
    /// The operating system refuses.
    #[error("{}: cannot {action}: {}", .path.display(), plain(.source))]
    Io {
        /// The file or directory.
        path: PathBuf,
        /// What was to be done.
        action: &'static str,
        /// What the system says.
        source: io::Error,
    },
    /// Another run is writing there.
    #[error("{}: another fct run is writing this directory; wait for it, or choose another with --out", .0.display())]
    Locked(PathBuf),
    /// The directory holds something that fct did not write.
    #[error("{}: this directory exists and is no run directory of this program (it holds no manifest.json and is not empty); \
             choose another with --out, or let --force write into it", .0.display())]
    Foreign(PathBuf),
    /// A file stands where a directory is to be.
    #[error("{}: this is a file; --out names a directory", .0.display())]
    NotADirectory(PathBuf),
    /// A file that stands there already and is not fct's.
    #[error("{}: this file exists and holds something else; choose another name with --out, or let --force replace it", .0.display())]
    Exists(PathBuf),
    /// Something that fct did not write stands where a file of the run is to be.
    #[error("{}: this is in the way and was not written by fct; move it, or choose another directory with --out", .0.display())]
    InTheWay(PathBuf),
    /// A file of an earlier run that was changed since.
    #[error("{}: this file of an earlier run was changed since fct wrote it; choose another directory with --out, or let \
             --force replace it", .0.display())]
    Changed(PathBuf),
    /// A file of a stored run that is missing, or is not as it was written.
    #[error("{}: this file of the run {reason}: the run is damaged; make it anew", .path.display())]
    Damaged {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        reason: &'static str,
    },
    /// Not a run directory, or not one with an answer.
    #[error("{}: {reason}", .path.display())]
    NotARun {
        /// The directory or file.
        path: PathBuf,
        /// What is missing or wrong.
        reason: String,
    },
    /// A figure could not be drawn.
    #[error("figure {name}: {reason}")]
    Figure {
        /// Its file name.
        name: String,
        /// What the plotting library says.
        reason: String,
    },
}

impl ReportError {
    /// For `map_err`: an input/output error with its file and action.
    pub fn io<'a>(path: &'a Path, action: &'static str) -> impl FnOnce(io::Error) -> Self + 'a {
        move |source| Self::Io { path: path.to_owned(), action, source }
    }
}

/// What to do about the usual faults, in words.
fn plain(e: &io::Error) -> String {
    match e.kind() {
        io::ErrorKind::StorageFull | io::ErrorKind::QuotaExceeded => "the disk is full".into(),
        io::ErrorKind::ReadOnlyFilesystem => "the file system is read-only".into(),
        io::ErrorKind::PermissionDenied => "no permission to write there".into(),
        io::ErrorKind::NotFound => "no such file or directory".into(),
        _ => e.to_string(),
    }
}
