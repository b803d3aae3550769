//! Where a run goes: `--out`, or the first directory of the case's name under `runs` that is free or holds the same run.

use crate::outcome::Failure;
use crate::session::file_name;
use input::Case;
use report::{MANIFEST, StoredRun, numbered};
use std::collections::HashSet;
use std::path::{Path, PathBuf};

/// What is done to which case: two runs are the same if both are.
#[derive(Clone, Copy)]
pub struct Job<'a> {
    /// `identify`, `simulate`, ….
    pub command: &'a str,
    /// The case.
    pub case: &'a Case,
}

impl Job<'_> {
    /// Whether a stored run is of this job: the same command on the same input, compared by content.
    pub fn is_of(&self, run: &StoredRun) -> bool {
        let hashes = |files: &[input::InputFile]| files.iter().map(|f| f.sha256.clone()).collect::<Vec<_>>();
        run.info.command == self.command
            && moved(&run.input) == moved(&input::resolved_toml(self.case))
            && hashes(&run.info.inputs) == hashes(&self.case.inputs)
    }

    /// Whether a run of this job may go to a place: nothing is there, or the same job's run.
    fn may_take(&self, place: &Path) -> bool {
        if !place.join(MANIFEST).is_file() {
            let mut entries = std::fs::read_dir(place).into_iter().flatten().flatten();
            // Hidden entries are a run's that was killed before it was put in place.
            return !place.exists() || entries.all(|e| e.file_name().to_string_lossy().starts_with('.'));
        }
        StoredRun::read(place).is_ok_and(|run| self.is_of(&run))
    }

    /// The first place of the case's name under `base` that this job may take, and that is not `taken`.
    pub fn place_under(&self, base: &Path, taken: &mut HashSet<PathBuf>) -> PathBuf {
        let plain = base.join(file_name(&self.case.name));
        let own = base.join(file_name(&format!("{}-{}", self.case.name, self.command)));
        let further: Box<dyn Iterator<Item = PathBuf>> = match self.command {
            "identify" => Box::new(numbered(&plain)),
            _ => Box::new(std::iter::once(own.clone()).chain(numbered(&own))),
        };
        let mut places = std::iter::once(plain.clone()).chain(further);
        let place = places.find(|p| !taken.contains(p) && self.may_take(p)).unwrap_or(plain);
        taken.insert(place.clone());
        place
    }
}

/// A resolved input with its files named without their folders: their content is compared by hash, and a folder that was
/// moved as a whole is the same input.
fn moved(resolved: &str) -> String {
    let file = |line: &str| {
        let (key, value) = line.split_once(" = \"")?;
        let path = Path::new(value.strip_suffix('"')?);
        path.is_absolute()
            .then(|| format!("{key} = \"{}\"", path.file_name().unwrap_or_default().to_string_lossy()))
    };
    resolved.lines().map(|l| file(l).unwrap_or_else(|| l.to_owned()) + "\n").collect()
}

/// A path that files and answers can name.
///
/// # Errors
/// If it is not valid UTF-8: no TOML file and no JSON document can hold it.
pub fn nameable(path: &Path) -> Result<(), Failure> {
    if path.to_str().is_some() {
        return Ok(());
    }
    Err(Failure::usage(format!(
        "fct: {}: this path is not valid UTF-8, which no configuration could name; rename it",
        path.display()
    )))
}

#[cfg(test)]
mod tests {
    use super::moved;

    #[test]
    fn only_the_folder_of_a_file_may_change() {
        let of = |data: &str, kappa: &str| {
            moved(&format!("[[tests]]\ndata = \"{data}\"\nkappa = {kappa}\nname = \"a/b\"\n"))
        };
        assert_eq!(of("/here/tear.csv", "0.2"), of("/there/far/tear.csv", "0.2"));
        assert_ne!(of("/here/tear.csv", "0.2"), of("/here/other.csv", "0.2"));
        assert_ne!(of("/here/tear.csv", "0.2"), of("/here/tear.csv", "0.3"));
    }
}
