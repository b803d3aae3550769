//! The run directory: written aside and put in its place whole, one run at a time, with a manifest of what fct wrote.
//!
//! A directory that is not there yet is written as `.name.part` beside its place and renamed. In one that is there
//! (empty, or an earlier run's) the part is `.part` inside, and its files take their places one by one ([`commit`]).
//! Either is found again by a run that takes up where a killed one stopped.

mod commit;
mod files;
mod journal;
mod lock;
mod manifest;

pub use files::{write_atomic, write_named};
pub use journal::RunJournal;
pub use manifest::{MANIFEST, Manifest};

pub(crate) use files::{LARGEST, read as read_file};

use crate::ReportError;
use files::sibling;
use lock::Lock;
use std::fs;
use std::path::{Path, PathBuf};

/// Folder of finished parts of a search, for a run that takes it up again.
const RESUME: &str = "resume";
/// What a run in progress has inside a directory that is there already.
const PART: &str = ".part";
const AMEND: &str = ".amend";
const LOCK: &str = ".lock";
const KEPT: &str = ".resume";

/// How a run directory is begun.
#[derive(Clone, Copy, Debug, Default)]
pub struct Begin {
    /// Keep what an unfinished run left for being taken up.
    pub resume: bool,
    /// Replace files that fct did not write, if need be.
    pub force: bool,
}

/// A run directory being written. Nothing is seen at its place before [`RunDir::finish`].
#[derive(Debug)]
pub struct RunDir {
    place: PathBuf,
    part: PathBuf,
    inside: bool,
    force: bool,
    keep_part: bool,
    _lock: Lock,
}

/// Where an unfinished run went.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Kept {
    /// Here, as a run directory.
    At(PathBuf),
    /// A finished run stands here and stays; what is needed to go on is kept beside it.
    Aside(PathBuf),
}

impl RunDir {
    /// Begins a run directory that will stand at `place`, and tries whether it can be written.
    ///
    /// # Errors
    /// If something else stands there, another run writes it, or the disk refuses.
    pub fn begin(place: &Path, how: Begin) -> Result<Self, ReportError> {
        let place = std::path::absolute(place).map_err(ReportError::io(place, "find its absolute path"))?;
        check_place(&place, how.force)?;
        let inside = place.exists();
        if !inside {
            files::make_folder_of(&place)?;
        }
        let (lock, part) = if inside {
            (place.join(LOCK), place.join(PART))
        } else {
            (sibling(&place, "lock"), sibling(&place, "part"))
        };
        let lock = Lock::take(lock, &place)?;
        if inside {
            recover(&place)?;
            check_unchanged(&place, how.force)?;
        }
        let dir = Self { place, part, inside, force: how.force, keep_part: false, _lock: lock };
        dir.clear(how.resume)?;
        dir.write(".probe", b"fct")?;
        let probe = dir.part.join(".probe");
        fs::remove_file(&probe).map_err(ReportError::io(&probe, "remove"))?;
        Ok(dir)
    }

    /// An empty part, but for what an unfinished run left to be taken up, if that is wanted.
    fn clear(&self, resume: bool) -> Result<(), ReportError> {
        let kept = if self.inside { self.place.join(KEPT) } else { sibling(&self.place, RESUME) };
        let beside = sibling(&self.place, "part");
        if resume {
            for from in [&self.part, &beside, &self.place] {
                take_over(&from.join(RESUME), &kept)?;
            }
        }
        for part in [&self.part, &beside] {
            if part.exists() {
                fs::remove_dir_all(part).map_err(ReportError::io(part, "remove what a killed run left"))?;
            }
        }
        let folder = self.part.join(RESUME);
        fs::create_dir_all(&folder).map_err(ReportError::io(&folder, "create the directory"))?;
        take_over(&kept, &folder)?;
        if kept.exists() {
            fs::remove_dir_all(&kept).map_err(ReportError::io(&kept, "remove"))?;
        }
        Ok(())
    }

    /// Where the directory will stand.
    pub fn place(&self) -> &Path {
        &self.place
    }

    /// Where it is being written.
    pub fn part(&self) -> &Path {
        &self.part
    }

    /// Where finished parts of a search are kept.
    pub fn journal(&self) -> RunJournal {
        RunJournal::new(self.part.join(RESUME))
    }

    /// Writes a file of the directory, making folders on the way.
    ///
    /// # Errors
    /// If the disk refuses.
    pub fn write(&self, name: impl AsRef<Path>, content: &[u8]) -> Result<(), ReportError> {
        let path = self.part.join(name);
        files::make_folder_of(&path)?;
        write_atomic(&path, content)
    }

    /// Puts a finished run in its place; what a run that takes it up would need goes.
    ///
    /// # Errors
    /// If the disk refuses; what stood there before is then still there.
    pub fn finish(self) -> Result<PathBuf, ReportError> {
        let resume = self.part.join(RESUME);
        if resume.exists() {
            fs::remove_dir_all(&resume).map_err(ReportError::io(&resume, "remove"))?;
        }
        self.put()
    }

    /// Puts an unfinished run in its place, with what is needed to take it up; never over a finished one: a run that the user
    /// `stopped` then leaves only what is needed to go on, one that could not go on takes the next free number.
    ///
    /// # Errors
    /// As [`RunDir::finish`].
    pub fn finish_partial(mut self, stopped: bool) -> Result<Kept, ReportError> {
        let resume = self.part.join(RESUME);
        let nothing_to_take_up = fs::remove_dir(&resume).is_ok();
        if !crate::StoredRun::read(&self.place).is_ok_and(|r| r.info.complete) {
            return self.put().map(Kept::At);
        }
        if !stopped {
            return self.put_beside().map(Kept::At);
        }
        self.keep_part = !nothing_to_take_up;
        for entry in fs::read_dir(&self.part).into_iter().flatten().flatten() {
            let path = entry.path();
            if entry.file_name() != RESUME {
                let gone = if path.is_dir() { fs::remove_dir_all(&path) } else { fs::remove_file(&path) };
                gone.map_err(ReportError::io(&path, "remove"))?;
            }
        }
        Ok(Kept::Aside(self.place.clone()))
    }

    fn put(self) -> Result<PathBuf, ReportError> {
        if self.inside {
            return match commit::commit(&self.place, &self.part, self.force, false) {
                Ok(()) => Ok(self.place.clone()),
                // The user put something in the way meanwhile: their file stays, the run goes elsewhere.
                Err(ReportError::InTheWay(_)) => self.put_beside(),
                Err(e) => Err(e),
            };
        }
        self.with_manifest()?;
        if fs::read_dir(&self.place).is_ok_and(|mut d| d.next().is_some()) {
            return self.put_beside();
        }
        fs::rename(&self.part, &self.place)
            .map_err(ReportError::io(&self.place, "put the run in its place"))?;
        Ok(self.place.clone())
    }

    fn with_manifest(&self) -> Result<(), ReportError> {
        write_atomic(&self.part.join(MANIFEST), &Manifest::of(&self.part)?.bytes()?)
    }

    /// Puts the run under the next free number.
    fn put_beside(&self) -> Result<PathBuf, ReportError> {
        self.with_manifest()?;
        let place = numbered(&self.place).find(|p| !p.exists()).unwrap_or_else(|| self.place.clone());
        fs::rename(&self.part, &place).map_err(ReportError::io(&place, "put the run in its place"))?;
        Ok(place)
    }
}

impl Drop for RunDir {
    fn drop(&mut self) {
        // After `finish` there is nothing left; after an error nothing half-written stays.
        if !self.keep_part {
            let _ = fs::remove_dir_all(&self.part);
        }
    }
}

/// `run-2`, `run-3`, … beside `run`.
pub fn numbered(place: &Path) -> impl Iterator<Item = PathBuf> + use<> {
    let place = place.to_owned();
    (2..100_000).map(move |k| {
        let mut name = place.file_name().unwrap_or(std::ffi::OsStr::new("run")).to_owned();
        name.push(format!("-{k}"));
        place.with_file_name(name)
    })
}

/// Adds files to a finished run, or replaces files that fct wrote there.
///
/// # Errors
/// If it is no run, another command writes it, something else is in the way, or the disk refuses.
pub fn amend(place: &Path, added: &[(&str, &[u8])]) -> Result<(), ReportError> {
    let _lock = Lock::take(place.join(LOCK), place)?;
    recover(place)?;
    let part = place.join(AMEND);
    for (name, content) in added {
        let path = part.join(name);
        files::make_folder_of(&path)?;
        write_atomic(&path, content)?;
    }
    let done = commit::commit(place, &part, false, true);
    if done.is_err() {
        let _ = fs::remove_dir_all(&part);
    }
    done
}

/// Finishes what a killed run had begun to put in place. Only for who holds the lock.
fn recover(place: &Path) -> Result<(), ReportError> {
    [PART, AMEND].iter().try_for_each(|part| commit::roll_forward(place, &place.join(part)))
}

/// The same for a reader, who has no lock yet; a run that is being put in place right now is let finish.
pub(crate) fn settle(place: &Path) -> Result<(), ReportError> {
    let begun = || [PART, AMEND].iter().any(|part| place.join(part).join("commit.json").is_file());
    if !begun() {
        return Ok(());
    }
    match Lock::take(place.join(LOCK), place) {
        Ok(_lock) => recover(place),
        Err(e) => {
            for _ in 0..100 {
                std::thread::sleep(std::time::Duration::from_millis(20));
                if !begun() {
                    return Ok(());
                }
            }
            Err(e)
        }
    }
}

/// Links (or copies) the files of a folder into another; files there already stay.
fn take_over(from: &Path, to: &Path) -> Result<(), ReportError> {
    let Ok(entries) = fs::read_dir(from) else { return Ok(()) };
    fs::create_dir_all(to).map_err(ReportError::io(to, "create the directory"))?;
    for entry in entries.flatten().filter(|e| e.path().is_file()) {
        let (path, target) = (entry.path(), to.join(entry.file_name()));
        if !target.exists() && fs::hard_link(&path, &target).is_err() {
            fs::copy(&path, &target).map_err(ReportError::io(&target, "write"))?;
        }
    }
    Ok(())
}

/// A run directory may be made where nothing is, in an empty directory, or over an earlier run.
fn check_place(place: &Path, force: bool) -> Result<(), ReportError> {
    if !place.exists() {
        return Ok(());
    }
    if !place.is_dir() {
        return Err(ReportError::NotADirectory(place.to_owned()));
    }
    let entries = fs::read_dir(place).map_err(ReportError::io(place, "read the directory"))?;
    let ours = |name: &std::ffi::OsStr| [PART, AMEND, LOCK, KEPT].iter().any(|n| name == *n);
    let empty = entries.flatten().all(|e| ours(&e.file_name()));
    let run = place.join(MANIFEST).is_file() || place.join(PART).join("commit.json").is_file();
    if empty || run || force { Ok(()) } else { Err(ReportError::Foreign(place.to_owned())) }
}

/// What the user changed in an earlier run is theirs.
fn check_unchanged(place: &Path, force: bool) -> Result<(), ReportError> {
    if force {
        return Ok(());
    }
    match Manifest::read(place)?.map_or(Ok(None), |m| m.changed(place))? {
        Some(name) => Err(ReportError::Changed(place.join(name))),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests;
