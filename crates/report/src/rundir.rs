//! The run directory: written beside its place and moved there whole, one run at a time.

use crate::ReportError;
use std::fs::{self, File, TryLockError};
use std::io::Write;
use std::path::{Path, PathBuf};

/// What fct writes at the top of a run directory. Anything else there belongs to the user.
const OURS: [&str; 12] = [
    "run.toml",
    "summary.json",
    "state.json",
    "history.csv",
    "jacobian.csv",
    "diagnosis.json",
    "report.html",
    "curves",
    "fields",
    "figures",
    "rungs",
    "ladder.json",
];

/// A run directory being written. Nothing is seen at its place before [`RunDir::finish`].
pub struct RunDir {
    place: PathBuf,
    part: PathBuf,
    _lock: File,
}

impl RunDir {
    /// Begins a run directory that will stand at `place`.
    ///
    /// # Errors
    /// If something else stands there, another run writes it, or the disk refuses.
    pub fn begin(place: &Path) -> Result<Self, ReportError> {
        check_place(place)?;
        let place = std::path::absolute(place).map_err(ReportError::io(place, "find its absolute path"))?;
        let parent = place.parent().unwrap_or(Path::new("/")).to_owned();
        fs::create_dir_all(&parent).map_err(ReportError::io(&parent, "create the directory"))?;
        let lock = lock(&place)?;
        let (part, old) = (sibling(&place, "part"), sibling(&place, "old"));
        if old.exists() && !place.exists() {
            // A run that was killed between its last two moves: the earlier run was safe beside its place.
            fs::rename(&old, &place).map_err(ReportError::io(&old, "put an earlier run back"))?;
        }
        if part.exists() {
            // A run that was killed left it; its state was of use only to a resumed run.
            fs::remove_dir_all(&part).map_err(ReportError::io(&part, "remove what a killed run left"))?;
        }
        fs::create_dir_all(&part).map_err(ReportError::io(&part, "create the directory"))?;
        Ok(Self { place, part, _lock: lock })
    }

    /// Where the directory will stand.
    pub fn place(&self) -> &Path {
        &self.place
    }

    /// Where it is being written.
    pub fn part(&self) -> &Path {
        &self.part
    }

    /// Writes a file of the directory, making folders on the way.
    ///
    /// # Errors
    /// If the disk refuses.
    pub fn write(&self, name: impl AsRef<Path>, content: &[u8]) -> Result<(), ReportError> {
        let path = self.part.join(name);
        if let Some(folder) = path.parent() {
            fs::create_dir_all(folder).map_err(ReportError::io(folder, "create the directory"))?;
        }
        write_atomic(&path, content)
    }

    /// Puts the directory in its place; the user's own files of an earlier run there stay.
    ///
    /// # Errors
    /// If the disk refuses; the earlier directory is then still there.
    pub fn finish(self) -> Result<PathBuf, ReportError> {
        let old = sibling(&self.place, "old");
        let replaces = self.place.exists();
        if replaces {
            if old.exists() {
                fs::remove_dir_all(&old).map_err(ReportError::io(&old, "remove an earlier run"))?;
            }
            fs::rename(&self.place, &old)
                .map_err(ReportError::io(&self.place, "move the earlier run away"))?;
        }
        if let Err(source) = fs::rename(&self.part, &self.place) {
            if replaces {
                // Whatever happens here, the first error is the one to tell.
                let _ = fs::rename(&old, &self.place);
            }
            return Err(ReportError::Io {
                path: self.place.clone(),
                action: "put the run in its place",
                source,
            });
        }
        if replaces {
            keep_foreign(&old, &self.place)?;
            fs::remove_dir_all(&old).map_err(ReportError::io(&old, "remove an earlier run"))?;
        }
        Ok(self.place.clone())
    }
}

impl Drop for RunDir {
    fn drop(&mut self) {
        // After `finish` there is nothing left; after an error nothing half-written stays.
        let _ = fs::remove_dir_all(&self.part);
        let _ = fs::remove_file(sibling(&self.place, "lock"));
    }
}

/// Writes a file whole or not at all.
///
/// # Errors
/// If the disk refuses; what stood there before is then untouched.
pub fn write_atomic(path: &Path, content: &[u8]) -> Result<(), ReportError> {
    let temporary = sibling(path, "tmp");
    let result = File::create(&temporary)
        .and_then(|mut f| f.write_all(content))
        .and_then(|()| fs::rename(&temporary, path));
    result.map_err(|source| {
        let _ = fs::remove_file(&temporary);
        ReportError::Io { path: path.to_owned(), action: "write", source }
    })
}

/// A run directory may be made where nothing is, in an empty directory, or over an earlier run.
fn check_place(place: &Path) -> Result<(), ReportError> {
    if !place.exists() {
        return Ok(());
    }
    if !place.is_dir() {
        return Err(ReportError::NotADirectory(place.to_owned()));
    }
    let mut entries = fs::read_dir(place).map_err(ReportError::io(place, "read the directory"))?;
    let empty = entries.next().is_none();
    if empty || place.join("run.toml").is_file() {
        Ok(())
    } else {
        Err(ReportError::Foreign(place.to_owned()))
    }
}

/// The lock is the system's: a killed run cannot leave it behind.
fn lock(place: &Path) -> Result<File, ReportError> {
    let path = sibling(place, "lock");
    let file = File::create(&path).map_err(ReportError::io(&path, "create the lock file"))?;
    match file.try_lock() {
        Ok(()) => Ok(file),
        Err(TryLockError::WouldBlock) => Err(ReportError::Locked(place.to_owned())),
        Err(TryLockError::Error(source)) => Err(ReportError::Io { path, action: "lock", source }),
    }
}

/// `.name.what` beside `name`.
fn sibling(path: &Path, what: &str) -> PathBuf {
    let name = path.file_name().map_or_else(|| "run".into(), |n| n.to_string_lossy().into_owned());
    path.with_file_name(format!(".{name}.{what}"))
}

/// Moves what fct did not write from the earlier directory to the new one.
fn keep_foreign(old: &Path, new: &Path) -> Result<(), ReportError> {
    for entry in fs::read_dir(old).map_err(ReportError::io(old, "read the directory"))? {
        let entry = entry.map_err(ReportError::io(old, "read the directory"))?;
        let name = entry.file_name();
        let ours = OURS.iter().any(|o| name == **o);
        let to = new.join(&name);
        if !ours && !to.exists() {
            fs::rename(entry.path(), &to).map_err(ReportError::io(&to, "keep"))?;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_is_seen_before_the_end_and_foreign_files_stay() -> Result<(), Box<dyn std::error::Error>> {
        let folder = tempfile::tempdir()?;
        let place = folder.path().join("run");
        let run = RunDir::begin(&place)?;
        run.write("curves/a.csv", b"1")?;
        assert!(!place.exists());
        assert!(matches!(RunDir::begin(&place), Err(ReportError::Locked(_))));
        run.write("run.toml", b"")?;
        run.finish()?;
        fs::write(place.join("notes.txt"), "mine")?;
        let again = RunDir::begin(&place)?;
        again.write("run.toml", b"2")?;
        again.finish()?;
        assert!(place.join("notes.txt").exists() && !place.join("curves").exists());
        assert_eq!(fs::read_dir(folder.path())?.count(), 1);
        Ok(())
    }

    #[test]
    fn a_run_killed_between_its_last_two_moves_loses_nothing() -> Result<(), Box<dyn std::error::Error>> {
        let folder = tempfile::tempdir()?;
        let place = folder.path().join("run");
        fs::create_dir(sibling(&place, "old"))?;
        fs::write(sibling(&place, "old").join("run.toml"), "earlier")?;
        fs::create_dir(sibling(&place, "part"))?;
        drop(RunDir::begin(&place)?);
        assert_eq!(fs::read_to_string(place.join("run.toml"))?, "earlier");
        assert_eq!(fs::read_dir(folder.path())?.count(), 1);
        Ok(())
    }

    #[test]
    fn a_directory_of_the_user_is_left_alone() -> Result<(), Box<dyn std::error::Error>> {
        let folder = tempfile::tempdir()?;
        fs::write(folder.path().join("thesis.tex"), "")?;
        assert!(matches!(RunDir::begin(folder.path()), Err(ReportError::Foreign(_))));
        assert!(matches!(
            RunDir::begin(&folder.path().join("thesis.tex")),
            Err(ReportError::NotADirectory(_))
        ));
        Ok(())
    }
}
