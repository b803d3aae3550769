//! Reading run directories back.

use crate::answer::{IdentifyAnswer, SimulateAnswer};
use crate::rundir::{LARGEST, Manifest, read_file, settle};
use crate::{Curve, ReportError};
use input::InputFile;
use serde::{Deserialize, Serialize};
use serde_json::Value;
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
    /// What was written; `None` while the run is being written.
    manifest: Option<Manifest>,
}

impl StoredRun {
    /// Reads a run directory.
    ///
    /// # Errors
    /// If it is none, or is damaged: every file that is read must be as it was written.
    pub fn read(path: &Path) -> Result<Self, ReportError> {
        let not = |reason: &str| ReportError::NotARun { path: path.to_owned(), reason: reason.into() };
        if !path.exists() {
            return Err(not("no such run directory"));
        }
        if !path.is_dir() {
            return Err(not("this is a file; expected a run directory"));
        }
        settle(path)?;
        if !path.join("summary.json").is_file() {
            return Err(not("this is no run directory: it holds no summary.json"));
        }
        let manifest = Manifest::read(path)?.ok_or_else(|| {
            not("this run directory holds no manifest.json: it is damaged, or of an earlier version of fct; make it anew")
        })?;
        Self::with_manifest(path, Some(manifest))
    }

    /// Reads a run directory that is being written.
    ///
    /// # Errors
    /// If it holds no answer yet.
    pub(crate) fn read_part(path: &Path) -> Result<Self, ReportError> {
        Self::with_manifest(path, None)
    }

    fn with_manifest(path: &Path, manifest: Option<Manifest>) -> Result<Self, ReportError> {
        let empty = RunInfo {
            command: String::new(),
            arguments: Vec::new(),
            version: String::new(),
            inputs: Vec::new(),
            complete: false,
        };
        let mut run =
            Self { path: path.to_owned(), info: empty, input: String::new(), answer: Value::Null, manifest };
        let summary = path.join("summary.json");
        let not = |reason: String| ReportError::NotARun { path: summary.clone(), reason };
        let mut answer: Value =
            serde_json::from_slice(&run.file("summary.json")?).map_err(|e| not(e.to_string()))?;
        let info = answer.as_object_mut().and_then(|o| o.shift_remove("run")).unwrap_or_default();
        run.info = serde_json::from_value(info).map_err(|e| not(format!("field `run`: {e}")))?;
        run.input = run.text("run.toml")?;
        run.answer = answer;
        Ok(run)
    }

    /// The same run with its files in another folder (where it is being written).
    pub(crate) fn in_folder(&self, files: &Path) -> Self {
        Self { path: files.to_owned(), ..self.clone() }
    }

    /// Whether a file belongs to the run.
    pub fn holds(&self, name: &str) -> bool {
        match &self.manifest {
            Some(m) => m.files.contains_key(name),
            None => self.path.join(name).is_file(),
        }
    }

    /// The content of a file of the run, as it was written.
    ///
    /// # Errors
    /// [`ReportError::Damaged`] if it is missing or was changed.
    pub fn file(&self, name: &str) -> Result<Vec<u8>, ReportError> {
        let path = self.path.join(name);
        let damaged = |reason| ReportError::Damaged { path: path.clone(), reason };
        let Some(manifest) = &self.manifest else { return read_file(&path, LARGEST) };
        let hash = manifest.files.get(name).ok_or_else(|| damaged("is not in its manifest"))?;
        if !path.exists() {
            return Err(damaged("is missing"));
        }
        let bytes = read_file(&path, LARGEST)?;
        if input::sha256(&bytes) == *hash { Ok(bytes) } else { Err(damaged("is not as it was written")) }
    }

    /// The same as text.
    ///
    /// # Errors
    /// As [`StoredRun::file`]; if it is no UTF-8.
    pub fn text(&self, name: &str) -> Result<String, ReportError> {
        let path = self.path.join(name);
        String::from_utf8(self.file(name)?).map_err(|_| ReportError::Damaged { path, reason: "is no text" })
    }

    /// What `fct diagnose` left in it, if it did.
    ///
    /// # Errors
    /// If that is damaged.
    pub fn diagnosis(&self) -> Result<Option<Value>, ReportError> {
        const NAME: &str = "diagnosis.json";
        if !self.holds(NAME) {
            return Ok(None);
        }
        let not =
            |e: serde_json::Error| ReportError::NotARun { path: self.path.join(NAME), reason: e.to_string() };
        serde_json::from_slice(&self.file(NAME)?).map(Some).map_err(not)
    }

    /// Files that the run was made from and that are not any more as they were read: changed, or gone.
    pub fn changed_inputs(&self) -> Vec<PathBuf> {
        let same = |i: &InputFile| read_file(&i.file, LARGEST).is_ok_and(|b| input::sha256(&b) == i.sha256);
        self.info.inputs.iter().filter(|i| !same(i)).map(|i| i.file.clone()).collect()
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
    ///
    /// # Errors
    /// If one of them is missing or damaged.
    pub fn curves(&self) -> Result<Vec<Curve>, ReportError> {
        let tests = self.answer.get("tests").and_then(Value::as_object);
        let input: Option<toml::Table> = self.input.parse().ok();
        let cut = input.and_then(|t| t.get("geometry")?.get("cut_mm")?.as_float()).unwrap_or(0.0);
        let one = |(name, test): (&String, &Value)| {
            let file = format!("curves/{name}.csv");
            let damaged = || ReportError::Damaged { path: self.path.join(&file), reason: "holds no curve" };
            let curve = Curve::parse(name, &self.file(&file)?).ok_or_else(damaged)?;
            Ok(Curve { noise: test.get("noise_N").and_then(Value::as_f64).unwrap_or(0.0), cut, ..curve })
        };
        tests.into_iter().flatten().map(one).collect()
    }

    fn typed<T: for<'a> Deserialize<'a>>(&self, command: &str) -> Option<T> {
        let right = self.info.command == command && self.info.complete;
        right.then(|| serde_json::from_value(self.answer.clone()).ok()).flatten()
    }
}
