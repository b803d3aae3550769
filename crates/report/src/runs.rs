//! Reading run directories back.

use crate::answer::{IdentifyAnswer, SimulateAnswer};
use crate::{Curve, ReportError};
use serde::{Deserialize, Serialize};
use serde_json::Value;
use sha2::{Digest, Sha256};
use std::fs;
use std::path::{Path, PathBuf};

/// How a run was made; stands in `summary.json` under `run`.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct RunInfo {
    /// `identify`, `simulate`, ….
    pub command: String,
    /// The whole command line.
    pub arguments: Vec<String>,
    /// Version of fct.
    pub version: String,
    /// Files that were read, with the SHA-256 of their content.
    pub inputs: Vec<InputFile>,
    /// Whether the run came to its end.
    pub complete: bool,
}

/// A file that was read.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct InputFile {
    /// Absolute path.
    pub file: PathBuf,
    /// SHA-256 of the content, hexadecimal; null where it could not be read again.
    pub sha256: Option<String>,
}

/// Hashes of the files of a case.
pub fn inputs_of(case: &input::Case) -> Vec<InputFile> {
    let records = case.tests.iter().filter_map(|t| t.record.as_ref()).map(|r| &r.path);
    let mut files: Vec<PathBuf> = Vec::new();
    for file in case.config_file.iter().chain(&case.specimen_file).chain(records) {
        let file = std::path::absolute(file).unwrap_or_else(|_| file.clone());
        if !files.contains(&file) {
            files.push(file);
        }
    }
    files
        .into_iter()
        .map(|file| {
            let sha256 = fs::read(&file).ok().map(|bytes| hex(&Sha256::digest(&bytes)));
            InputFile { file, sha256 }
        })
        .collect()
}

fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|b| format!("{b:02x}")).collect()
}

/// What a run directory says.
#[derive(Clone, Debug)]
pub struct StoredRun {
    /// The directory.
    pub path: PathBuf,
    /// How it was made.
    pub info: RunInfo,
    /// `run.toml`.
    pub input: String,
    /// The answer as it was printed (without `run`).
    pub answer: Value,
}

impl StoredRun {
    /// Reads a run directory.
    ///
    /// # Errors
    /// If it is none, or was not finished.
    pub fn read(path: &Path) -> Result<Self, ReportError> {
        let not = |reason: &str| ReportError::NotARun { path: path.to_owned(), reason: reason.into() };
        if !path.exists() {
            return Err(not("no such run directory"));
        }
        if !path.is_dir() {
            return Err(not("this is a file; expected a run directory"));
        }
        let summary = path.join("summary.json");
        if !summary.is_file() {
            return Err(not("this is no run directory: it holds no summary.json"));
        }
        let text = fs::read_to_string(&summary).map_err(ReportError::io(&summary, "read"))?;
        let mut answer: Value = serde_json::from_str(&text)
            .map_err(|e| ReportError::NotARun { path: summary.clone(), reason: e.to_string() })?;
        let info = answer.as_object_mut().and_then(|o| o.shift_remove("run")).unwrap_or_default();
        let info: RunInfo = serde_json::from_value(info).map_err(|e| ReportError::NotARun {
            path: summary.clone(),
            reason: format!("field `run`: {e}"),
        })?;
        let input = path.join("run.toml");
        let input = fs::read_to_string(&input).map_err(ReportError::io(&input, "read"))?;
        Ok(Self { path: path.to_owned(), info, input, answer })
    }

    /// The answer of an identification, if the run is one.
    pub fn identify(&self) -> Option<IdentifyAnswer> {
        self.typed("identify")
    }

    /// The answer of a simulation, if the run is one.
    pub fn simulate(&self) -> Option<SimulateAnswer> {
        self.typed("simulate")
    }

    /// Its curves, as stored in `curves/`, in the order of the answer.
    pub fn curves(&self) -> Vec<Curve> {
        let tests = self.answer.get("tests").and_then(Value::as_object);
        let names = tests.into_iter().flat_map(|t| t.keys());
        let input: Option<toml::Table> = self.input.parse().ok();
        let cut = input.and_then(|t| t.get("geometry")?.get("cut_mm")?.as_float());
        let noise = |name: &str| tests?.get(name)?.get("noise_N")?.as_f64();
        names
            .filter_map(|name| Curve::read(&self.path.join("curves").join(format!("{name}.csv"))))
            .map(|c| Curve { noise: noise(&c.test).unwrap_or(0.0), cut: cut.unwrap_or(0.0), ..c })
            .collect()
    }

    fn typed<T: for<'a> Deserialize<'a>>(&self, command: &str) -> Option<T> {
        let right = self.info.command == command && self.info.complete;
        right.then(|| serde_json::from_value(self.answer.clone()).ok()).flatten()
    }
}
