//! Claims: who works on a task, and whether they still do.
//!
//! A claim is a file `claims/KEY.ATTEMPT` that only one process can create, and that it touches every
//! [`HEARTBEAT`] while it works. A claim is lost when its process is gone (told by who made it on the same machine), or
//! when nobody touched it for [`SILENCE`] by the clock of the file system. Who meets a lost claim creates the next
//! attempt's: none is removed or renamed under another's hands, so no two can take one task. After [`ATTEMPTS`] lost ones
//! the task is set aside.

use crate::files::Folder;
use report::ReportError;
use serde::{Deserialize, Serialize};
use std::collections::HashSet;
use std::fs::{self, File, OpenOptions};
use std::io::{ErrorKind, Seek, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::thread::JoinHandle;
use std::time::Duration;

/// How often a worker says that it is there.
pub const HEARTBEAT: Duration = Duration::from_secs(10);
/// Silence after which a worker is taken to be gone.
pub const SILENCE: Duration = Duration::from_secs(180);
/// Age at which a file that was never finished is nobody's any more.
const ABANDONED: Duration = Duration::from_secs(3600);
/// How many workers a task may take with it.
pub const ATTEMPTS: u32 = 3;

/// What stands in a claim.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
struct Owner {
    /// Machine, boot and process name space: where a process number means something.
    place: String,
    pid: u32,
    /// Start of the process in ticks, which tells it from a later one of its number; empty where the system does not say.
    began: String,
}

/// What the claims on a task say.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ClaimState {
    /// Nobody works on it; so many workers were lost with it.
    Free(u32),
    /// Somebody does.
    Held,
    /// It took [`ATTEMPTS`] workers with it.
    SetAside,
}

/// A claim that is held; let go when dropped.
pub struct Claim {
    path: PathBuf,
    stop: Option<Sender<()>>,
    pulse: Option<JoinHandle<()>>,
}

impl Claim {
    /// Claims a task that is free; `None` if another was faster.
    ///
    /// # Errors
    /// If the disk refuses.
    pub fn take(folder: &Folder, key: &str, lost: u32) -> Result<Option<Self>, ReportError> {
        let path = place(folder, key, lost + 1);
        let parent = folder.claims();
        fs::create_dir_all(&parent).map_err(ReportError::io(&parent, "create the directory"))?;
        let owner = serde_json::to_vec(&Owner::me()).unwrap_or_default();
        match create_whole(&path, &owner) {
            Ok(file) => Ok(Some(Self::alive(path, file, owner))),
            Err(e) if e.kind() == ErrorKind::AlreadyExists => Ok(None),
            Err(e) => Err(ReportError::io(&path, "write")(e)),
        }
    }

    /// Keeps touching the claim until it is dropped.
    fn alive(path: PathBuf, mut file: File, owner: Vec<u8>) -> Self {
        let (stop, stopped) = channel();
        let pulse = std::thread::spawn(move || {
            while stopped.recv_timeout(HEARTBEAT) == Err(RecvTimeoutError::Timeout) {
                // Written, not dated: the date is then that of the machine that holds the files. A pulse that fails once
                // is heard the next time.
                let _ = file.rewind().and_then(|()| file.write_all(&owner));
            }
        });
        Self { path, stop: Some(stop), pulse: Some(pulse) }
    }

    /// The work is done: all claims on the task go, those of lost workers too.
    pub fn done(self, folder: &Folder, key: &str) {
        drop(self);
        clear(folder, key);
    }
}

impl Drop for Claim {
    fn drop(&mut self) {
        drop(self.stop.take());
        if let Some(pulse) = self.pulse.take() {
            let _ = pulse.join();
        }
        let _ = fs::remove_file(&self.path);
    }
}

/// Creates a file with its content, or fails because it is there: nobody ever sees it without its content, which a
/// process that is killed between the two would leave, and which says of nobody that they are gone.
fn create_whole(path: &Path, content: &[u8]) -> std::io::Result<File> {
    let own = path.with_file_name(format!(".new.{}", unique()));
    let mut file = OpenOptions::new().write(true).create_new(true).open(&own)?;
    let linked = file.write_all(content).and_then(|()| fs::hard_link(&own, path));
    let _ = fs::remove_file(&own);
    match linked {
        Ok(()) => Ok(file),
        Err(e) if e.kind() == ErrorKind::AlreadyExists => Err(e),
        // A file system without links: the claim is made first, then written.
        Err(_) => {
            let mut file = OpenOptions::new().write(true).create_new(true).open(path)?;
            file.write_all(content)?;
            Ok(file)
        }
    }
}

/// Removes all claims on a task.
pub fn clear(folder: &Folder, key: &str) {
    (1..=ATTEMPTS).for_each(|n| {
        let _ = fs::remove_file(place(folder, key, n));
    });
}

/// What the claims on a task say now.
pub fn state(folder: &Folder, key: &str) -> ClaimState {
    let there = |n: &u32| place(folder, key, *n).exists();
    // The last attempt decides; those before it were lost.
    match (1..=ATTEMPTS).rev().find(there) {
        None => ClaimState::Free(0),
        Some(n) if is_held(folder, &place(folder, key, n)) => ClaimState::Held,
        Some(ATTEMPTS) => ClaimState::SetAside,
        Some(n) => ClaimState::Free(n),
    }
}

fn place(folder: &Folder, key: &str, attempt: u32) -> PathBuf {
    folder.claims().join(format!("{key}.{attempt}"))
}

fn is_held(folder: &Folder, path: &Path) -> bool {
    let owner = fs::read(path).ok().and_then(|b| serde_json::from_slice::<Owner>(&b).ok());
    match owner.map(|o| o.is_gone()) {
        Some(Some(gone)) => !gone,
        // Made elsewhere, or not yet written where files cannot be linked: silence decides.
        _ => silence(folder, path).is_none_or(|s| s < SILENCE),
    }
}

/// Time since a claim was touched, by the clock of the machine that holds the files.
fn silence(folder: &Folder, path: &Path) -> Option<Duration> {
    let touched = fs::metadata(path).and_then(|m| m.modified()).ok()?;
    let probe = folder.claims().join(format!(".clock.{}", unique()));
    fs::write(&probe, b"").ok()?;
    let now = fs::metadata(&probe).and_then(|m| m.modified());
    let _ = fs::remove_file(&probe);
    Some(now.ok()?.duration_since(touched).unwrap_or_default())
}

impl Owner {
    fn me() -> Self {
        let pid = std::process::id();
        Self { place: here(), pid, began: began(pid).unwrap_or_default() }
    }

    /// Whether the process is gone; `None`: cannot be told from here.
    fn is_gone(&self) -> Option<bool> {
        if self.place != here() || self.began.is_empty() {
            return None;
        }
        Some(began(self.pid).is_none_or(|now| now != self.began))
    }
}

/// A part of a file's name that no other file of any process that may see the folder has.
pub fn unique() -> String {
    static COUNT: AtomicU64 = AtomicU64::new(0);
    let count = COUNT.fetch_add(1, Ordering::Relaxed);
    format!("{}.{}.{count}", here().replace('/', "_"), std::process::id())
}

/// Removes what processes that were killed left beside claims and results: claims on tasks that are done, and files that
/// were never finished, after an hour.
pub fn tidy(folder: &Folder, done: &HashSet<String>) {
    let old = |e: &fs::DirEntry| e.metadata().and_then(|m| m.modified()).ok()?.elapsed().ok();
    let files = |path: PathBuf| fs::read_dir(path).into_iter().flatten().flatten();
    for entry in files(folder.claims()) {
        let name = entry.file_name();
        let claimed =
            name.to_str().and_then(|n| n.split_once('.')).is_some_and(|(key, _)| done.contains(key));
        if claimed {
            let _ = fs::remove_file(entry.path());
        }
    }
    for entry in [folder.claims(), folder.results(), folder.failures()].into_iter().flat_map(files) {
        let unfinished = entry.file_name().as_encoded_bytes().starts_with(b".");
        if unfinished && old(&entry).is_some_and(|age| age > ABANDONED) {
            let _ = fs::remove_file(entry.path());
        }
    }
}

/// Where process numbers mean what they mean here. Empty parts where the system does not say.
fn here() -> String {
    let read = |path: &str| fs::read_to_string(path).unwrap_or_default().trim().to_owned();
    let space = fs::read_link("/proc/self/ns/pid").map(|p| p.to_string_lossy().into_owned());
    let space: String = space.unwrap_or_default().chars().filter(char::is_ascii_digit).collect();
    format!("{}-{}-{space}", read("/proc/sys/kernel/hostname"), read("/proc/sys/kernel/random/boot_id"))
}

/// When a process began, in ticks since the machine did; `None` if there is none (a zombie does no work), or the system
/// does not say.
fn began(pid: u32) -> Option<String> {
    let stat = fs::read_to_string(format!("/proc/{pid}/stat")).ok()?;
    // The name of the program may hold blanks and brackets: what counts stands after the last one.
    let mut fields = stat.rsplit_once(')')?.1.split_whitespace();
    let state = fields.next()?;
    if matches!(state, "Z" | "X") { None } else { fields.nth(18).map(str::to_owned) }
}
