//! A finished part takes its place in a directory that is there already. The directory itself never moves (it may be a
//! mount point, or somebody's working directory), and nothing in it that fct did not write is touched.
//!
//! The part's manifest is written into it last, as `commit.json`. From then on the part is the run: whoever meets it, after
//! a kill too, moves the rest of its files to their place. All steps can be repeated.

use super::files;
use super::manifest::{MANIFEST, Manifest};
use crate::ReportError;
use std::fs;
use std::path::Path;

/// Marks a part whose files are complete.
const COMMIT: &str = "commit.json";

/// Puts the files of `part` into `place`; those of the earlier manifest that the new one does not name go, unless `keep`.
///
/// # Errors
/// [`ReportError::InTheWay`] if something that fct did not write stands where a file is to be; if the disk refuses.
pub fn commit(place: &Path, part: &Path, force: bool, keep: bool) -> Result<(), ReportError> {
    let earlier = Manifest::read(place)?.unwrap_or_default();
    let mut manifest = Manifest::of(part)?;
    let known = earlier.all(place)?;
    if let Some(name) = manifest.all(part)?.iter().find(|n| in_the_way(place, n, &known, force)) {
        return Err(ReportError::InTheWay(place.join(name)));
    }
    if keep {
        for (name, hash) in earlier.files {
            manifest.files.entry(name).or_insert(hash);
        }
        manifest.runs.extend(earlier.runs);
        manifest.runs.sort();
        manifest.runs.dedup();
    }
    files::write_atomic(&part.join(COMMIT), &manifest.bytes()?)?;
    roll_forward(place, part)
}

/// Whether something that is not fct's stands where a file is to be, or where a folder above it is to be.
fn in_the_way(place: &Path, name: &str, known: &[String], force: bool) -> bool {
    let there = |path: &Path| fs::symlink_metadata(place.join(path)).ok();
    let name = Path::new(name);
    let folder = |p: &Path| there(p).is_some_and(|m| !m.is_dir());
    if name.ancestors().skip(1).filter(|p| !p.as_os_str().is_empty()).any(folder) {
        return true;
    }
    match there(name) {
        None => false,
        Some(meta) if meta.is_file() => !force && !known.iter().any(|k| Path::new(k) == name),
        Some(_) => true,
    }
}

/// Finishes a commit that was begun, if there is one.
///
/// # Errors
/// If the disk refuses.
pub fn roll_forward(place: &Path, part: &Path) -> Result<(), ReportError> {
    let marker = part.join(COMMIT);
    if !marker.is_file() {
        return Ok(());
    }
    let damaged = |e: serde_json::Error| ReportError::NotARun { path: marker.clone(), reason: e.to_string() };
    let manifest: Manifest =
        serde_json::from_slice(&files::read(&marker, files::LARGEST)?).map_err(damaged)?;
    let earlier = Manifest::read(place)?.unwrap_or_default().all(place)?;
    move_all(part, place, "")?;
    let now = manifest.all(place)?;
    for name in earlier.iter().filter(|n| !now.contains(n)) {
        remove(place, name)?;
    }
    fs::rename(&marker, place.join(MANIFEST)).map_err(ReportError::io(place, "write the manifest of"))?;
    fs::remove_dir_all(part).map_err(ReportError::io(part, "remove"))
}

/// Moves every file of a folder to its place, but for the marker.
fn move_all(part: &Path, place: &Path, prefix: &str) -> Result<(), ReportError> {
    let folder = part.join(prefix);
    for entry in fs::read_dir(&folder).map_err(ReportError::io(&folder, "read the directory"))? {
        let entry = entry.map_err(ReportError::io(&folder, "read the directory"))?;
        let name = format!("{prefix}{}", entry.file_name().to_string_lossy());
        if name == COMMIT {
            continue;
        }
        if entry.path().is_dir() {
            move_all(part, place, &format!("{name}/"))?;
        } else {
            let to = place.join(&name);
            files::make_folder_of(&to)?;
            fs::rename(entry.path(), &to).map_err(ReportError::io(&to, "write"))?;
        }
    }
    Ok(())
}

/// Removes a file of an earlier run, and folders that are empty then.
fn remove(place: &Path, name: &str) -> Result<(), ReportError> {
    let path = place.join(name);
    match fs::remove_file(&path) {
        Err(e) if e.kind() != std::io::ErrorKind::NotFound => {
            return Err(ReportError::io(&path, "remove an earlier run's file")(e));
        }
        _ => {}
    }
    for folder in Path::new(name).ancestors().skip(1).filter(|p| !p.as_os_str().is_empty()) {
        // A folder that holds something of the user's stays.
        if fs::remove_dir(place.join(folder)).is_err() {
            break;
        }
    }
    Ok(())
}
