//! Single files of a run directory: read within limits, hashed, written whole or not at all.

use crate::ReportError;
use std::fs::{self, File};
use std::io::{Read, Write};
use std::path::Path;

/// Largest file that is read back, bytes.
pub const LARGEST: u64 = 1_000_000_000;

/// Reads a regular file of at most `limit` bytes.
///
/// # Errors
/// If it is no regular file (a pipe would never end), too large, or the disk refuses.
pub fn read(path: &Path, limit: u64) -> Result<Vec<u8>, ReportError> {
    let not = |reason: String| ReportError::NotARun { path: path.to_owned(), reason };
    let meta = fs::metadata(path).map_err(ReportError::io(path, "read"))?;
    if !meta.is_file() {
        return Err(not("this is not a regular file".into()));
    }
    if meta.len() > limit {
        return Err(not(format!("{} bytes; a file of a run has at most {limit}", meta.len())));
    }
    let mut bytes = Vec::new();
    let file = File::open(path).map_err(ReportError::io(path, "read"))?;
    file.take(limit).read_to_end(&mut bytes).map_err(ReportError::io(path, "read"))?;
    Ok(bytes)
}

/// SHA-256 of a file, hexadecimal; of something that is no regular file, a word that is no hash.
///
/// # Errors
/// If the disk refuses.
pub fn hash(path: &Path) -> Result<String, ReportError> {
    let meta = fs::symlink_metadata(path).map_err(ReportError::io(path, "read"))?;
    if !meta.is_file() || meta.len() > LARGEST {
        return Ok("no file of fct's".into());
    }
    Ok(input::sha256(&read(path, LARGEST)?))
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

/// Writes a file that the user named. What stands there is replaced only if it is the same, if fct made it (`ours`
/// recognises that), or if the user insists.
///
/// # Errors
/// [`ReportError::Exists`]; if the disk refuses.
pub fn write_named(
    path: &Path,
    content: &[u8],
    force: bool,
    ours: impl Fn(&[u8]) -> bool,
) -> Result<(), ReportError> {
    if let Ok(meta) = fs::symlink_metadata(path) {
        let there = if meta.is_file() { read(path, LARGEST).ok() } else { None };
        match there {
            Some(bytes) if bytes == content => return Ok(()),
            Some(bytes) if force || ours(&bytes) => {}
            _ => return Err(ReportError::Exists(path.to_owned())),
        }
    }
    write_atomic(path, content)
}

/// Makes the folders above a file.
///
/// # Errors
/// If the disk refuses.
pub fn make_folder_of(path: &Path) -> Result<(), ReportError> {
    match path.parent() {
        Some(folder) => fs::create_dir_all(folder).map_err(ReportError::io(folder, "create the directory")),
        None => Ok(()),
    }
}

/// `.name.what` beside `name`.
pub fn sibling(path: &Path, what: &str) -> std::path::PathBuf {
    let mut name = std::ffi::OsString::from(".");
    name.push(path.file_name().unwrap_or(std::ffi::OsStr::new("run")));
    name.push(".");
    name.push(what);
    path.with_file_name(name)
}
