//! One run at a time on a directory. The lock is the system's: a killed run cannot leave it behind.

use crate::ReportError;
use std::fs::{self, File, TryLockError};
use std::path::{Path, PathBuf};

/// Held while a directory is written.
#[derive(Debug)]
pub struct Lock {
    path: PathBuf,
    _file: File,
}

impl Lock {
    /// Locks `path` for the directory `place`.
    ///
    /// # Errors
    /// [`ReportError::Locked`] if another run holds it; if the disk refuses.
    pub fn take(path: PathBuf, place: &Path) -> Result<Self, ReportError> {
        loop {
            let file = File::create(&path).map_err(ReportError::io(place, "write there"))?;
            match file.try_lock() {
                // A run that ended just now removes its lock file: one that no name leads to locks nothing.
                Ok(()) if is_at(&file, &path) => return Ok(Self { path, _file: file }),
                Ok(()) => {}
                Err(TryLockError::WouldBlock) => return Err(ReportError::Locked(place.to_owned())),
                Err(TryLockError::Error(source)) => {
                    return Err(ReportError::Io { path, action: "lock", source });
                }
            }
        }
    }
}

impl Drop for Lock {
    fn drop(&mut self) {
        let _ = fs::remove_file(&self.path);
    }
}

#[cfg(unix)]
fn is_at(file: &File, path: &Path) -> bool {
    use std::os::unix::fs::MetadataExt;
    match (file.metadata(), fs::metadata(path)) {
        (Ok(a), Ok(b)) => (a.dev(), a.ino()) == (b.dev(), b.ino()),
        _ => false,
    }
}

#[cfg(not(unix))]
fn is_at(_: &File, _: &Path) -> bool {
    // A file that is open cannot be removed there.
    true
}
