//! What fct wrote into a run directory: every file with its hash. Anything else there belongs to the user.

use super::files::{self, LARGEST};
use crate::ReportError;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

/// Name of the manifest in a run directory.
pub const MANIFEST: &str = "manifest.json";

/// The files of a run.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Manifest {
    /// Layout version.
    pub schema: u32,
    /// Program and version.
    pub program: String,
    /// SHA-256 (hexadecimal) of every file, by its path in the directory, with `/` between folders.
    pub files: BTreeMap<String, String>,
    /// Runs inside this one (`rungs/0`), each with a manifest of its own.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub runs: Vec<String>,
}

impl Manifest {
    /// Of everything in a directory that holds nothing but what fct wrote.
    ///
    /// # Errors
    /// If the disk refuses.
    pub fn of(folder: &Path) -> Result<Self, ReportError> {
        let mut manifest = Self {
            schema: crate::answer::SCHEMA,
            program: format!("fct {}", env!("CARGO_PKG_VERSION")),
            ..Self::default()
        };
        manifest.add(folder, "")?;
        Ok(manifest)
    }

    fn add(&mut self, folder: &Path, prefix: &str) -> Result<(), ReportError> {
        for entry in fs::read_dir(folder).map_err(ReportError::io(folder, "read the directory"))? {
            let entry = entry.map_err(ReportError::io(folder, "read the directory"))?;
            let (path, name) = (entry.path(), entry.file_name().to_string_lossy().into_owned());
            if prefix.is_empty() && name == MANIFEST {
                continue;
            }
            let name = format!("{prefix}{name}");
            if !path.is_dir() {
                self.files.insert(name, files::hash(&path)?);
            } else if path.join(MANIFEST).is_file() {
                self.runs.push(name);
            } else {
                self.add(&path, &format!("{name}/"))?;
            }
        }
        self.runs.sort();
        Ok(())
    }

    /// The manifest of a run directory; `None` if it has none.
    ///
    /// # Errors
    /// If there is one that cannot be read, or that is damaged.
    pub fn read(place: &Path) -> Result<Option<Self>, ReportError> {
        let path = place.join(MANIFEST);
        if !path.exists() {
            return Ok(None);
        }
        let damaged = |reason: String| ReportError::NotARun { path: path.clone(), reason };
        let manifest: Self = serde_json::from_slice(&files::read(&path, LARGEST)?)
            .map_err(|e| damaged(format!("this manifest is damaged: {e}")))?;
        let names = manifest.files.keys().chain(&manifest.runs);
        match names.into_iter().find(|n| !stays_inside(n)) {
            Some(name) => {
                Err(damaged(format!("this manifest is damaged: `{name}` is no file of this directory")))
            }
            None => Ok(Some(manifest)),
        }
    }

    /// The manifest as it is stored.
    ///
    /// # Errors
    /// Never in practice: it is plain text.
    pub fn bytes(&self) -> Result<Vec<u8>, ReportError> {
        let mut out = serde_json::to_vec_pretty(self)
            .map_err(|e| ReportError::NotARun { path: MANIFEST.into(), reason: e.to_string() })?;
        out.push(b'\n');
        Ok(out)
    }

    /// The first file that is there but is not as fct wrote it.
    ///
    /// # Errors
    /// If the disk refuses.
    pub fn changed(&self, place: &Path) -> Result<Option<String>, ReportError> {
        for (name, hash) in &self.files {
            let path = place.join(name);
            if fs::symlink_metadata(&path).is_ok() && files::hash(&path)? != *hash {
                return Ok(Some(name.clone()));
            }
        }
        for run in &self.runs {
            let inner = place.join(run);
            let changed = Self::read(&inner)?.map_or(Ok(None), |m| m.changed(&inner))?;
            if let Some(name) = changed {
                return Ok(Some(format!("{run}/{name}")));
            }
        }
        Ok(None)
    }

    /// Every file, those of the runs inside and the manifests themselves too.
    ///
    /// # Errors
    /// If a manifest inside cannot be read.
    pub fn all(&self, place: &Path) -> Result<Vec<String>, ReportError> {
        let mut out: Vec<String> = self.files.keys().cloned().collect();
        for run in &self.runs {
            if let Some(inner) = Self::read(&place.join(run))? {
                out.extend(inner.all(&place.join(run))?.into_iter().map(|n| format!("{run}/{n}")));
            }
        }
        out.push(MANIFEST.to_owned());
        Ok(out)
    }
}

/// A relative path without `..`: a damaged manifest must not lead elsewhere.
fn stays_inside(name: &str) -> bool {
    let mut parts = Path::new(name).components();
    !name.is_empty() && parts.all(|p| matches!(p, std::path::Component::Normal(_)))
}
