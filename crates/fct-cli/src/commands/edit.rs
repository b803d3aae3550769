//! What `add` and `drop` share: from a run or a file to the text of a config, and writing it.

use crate::outcome::Failure;
use crate::session::Session;
use ::report::{StoredRun, quoted_path, write_atomic, write_named};
use input::edit::{self, EditError};
use std::path::{Path, PathBuf};

/// The text to be changed and where it comes from.
pub struct Source {
    /// The TOML file.
    pub file: PathBuf,
    /// The run, if one was named.
    pub run: Option<StoredRun>,
    /// Its text.
    pub text: String,
}

/// Reads a config, or the input of a run.
///
/// # Errors
/// If there is no such file, or it is none that can be a config.
pub fn source(path: &Path) -> Result<Source, Failure> {
    if path.is_dir() {
        let stored = StoredRun::read(path)?;
        return Ok(Source { file: path.join("run.toml"), text: stored.input.clone(), run: Some(stored) });
    }
    let text = input::read_text(path, input::LARGEST_TOML, "a config or specimen file (TOML)")?;
    Ok(Source { file: path.to_owned(), run: None, text })
}

/// Checks the changed text by reading it, then writes it; the file's relative paths follow it.
///
/// # Errors
/// If the changed config is not valid, or cannot be written.
pub fn write(source: &Source, text: &str, ending: &str, session: &Session) -> Result<PathBuf, Failure> {
    let out = session.common.out.clone().unwrap_or_else(|| beside(source, ending));
    if out.is_dir() {
        return Err(Failure::usage(format!(
            "fct: {}: this is a directory; --out names a file here",
            out.display()
        )));
    }
    let fault = |e: EditError| Failure::usage(format!("fct: {}: {e}", source.file.display()));
    let (from, to) = (folder(&source.file), folder(&out));
    let mut text = edit::rebase(text, from, to, source.run.is_some()).map_err(fault)?;
    if let Some(run) = &source.run {
        let whole = |path: &Path| std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
        let parent = edit::near(&whole(&run.path), &whole(to));
        text = edit::set_parent(&text, &parent.to_string_lossy()).map_err(fault)?;
    }
    validate(&text, &out, session).map_err(|changed| own_faults(source, session).unwrap_or(changed))?;
    write_named(&out, text.as_bytes(), session.common.force, |_| false)?;
    Ok(out)
}

/// What to do with the written config: identify it, with a run directory of its own; that of its name may hold the run
/// that it came from.
pub fn next(source: &Source, file: &Path) -> String {
    let stem = file.file_stem().map_or_else(|| "run".into(), |n| n.to_string_lossy().into_owned());
    let beside = source.run.as_ref().and_then(|r| r.path.parent()).filter(|p| !p.as_os_str().is_empty());
    let runs = beside.unwrap_or(if source.run.is_some() { Path::new("") } else { Path::new("runs") });
    let place = runs.join(&stem);
    // Never the run that it came from.
    let taken = source.run.as_ref().is_some_and(|r| r.path == place);
    let place = if taken { runs.join(format!("{stem}-next")) } else { place };
    format!("fct identify {} --out {}", quoted_path(file), quoted_path(&place))
}

/// Why a text cannot be changed; of one that is no TOML, with its line.
pub fn refused(source: &Source, why: &EditError, session: &Session) -> Failure {
    let own = if matches!(why, EditError::Syntax(_)) { own_faults(source, session) } else { None };
    own.unwrap_or_else(|| Failure::usage(format!("fct: {}: {why}", source.file.display())))
}

/// What is wrong with the user's own file, with its own lines.
fn own_faults(source: &Source, session: &Session) -> Option<Failure> {
    if source.run.is_some() {
        return None;
    }
    input::read_case(&source.file, &session.catalogue).err().map(Failure::from)
}

/// Reads the changed text as the commands will, from a file beside the one to be written.
fn validate(text: &str, out: &Path, session: &Session) -> Result<(), Failure> {
    let name = out.file_name().map_or_else(String::new, |n| n.to_string_lossy().into_owned());
    let trial = out.with_file_name(format!(".{name}.check.toml"));
    write_atomic(&trial, text.as_bytes())?;
    let read = input::read_case(&trial, &session.catalogue);
    let _ = std::fs::remove_file(&trial);
    // What is told is of the file that would have been written.
    read.map(|_| ()).map_err(|mut faults| {
        faults.0.iter_mut().filter(|d| d.file == trial).for_each(|d| d.file = out.to_owned());
        Failure::from(faults)
    })
}

fn folder(file: &Path) -> &Path {
    file.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// `strip+viscoelastic.toml` beside `strip.toml`; for a run, named after its directory, beside it.
fn beside(source: &Source, ending: &str) -> PathBuf {
    match &source.run {
        Some(run) => {
            // A run named as `.` or `a/..` has no last name of its own.
            let run = &run.path;
            let own = run.file_name().is_some();
            let run = if own { run.clone() } else { run.canonicalize().unwrap_or_else(|_| run.clone()) };
            let name = run.file_name().map_or_else(|| "run".into(), |n| n.to_string_lossy().into_owned());
            run.with_file_name(format!("{name}{ending}.toml"))
        }
        None => {
            let stem =
                source.file.file_stem().map_or_else(|| "config".into(), |n| n.to_string_lossy().into_owned());
            source.file.with_file_name(format!("{stem}{ending}.toml"))
        }
    }
}
