//! The folder of a study: `plan.json`, `results/KEY.json`, `failed/KEY.json`, `claims/`, `work/`, the page and its tables.

use report::answer::IdentifyAnswer;
use report::{ReportError, RunJournal};
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::collections::HashSet;
use std::fs::{self, File};
use std::io::Write;
use std::path::{Path, PathBuf};

/// The folder of a study. Any number of processes may use it at once.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Folder {
    path: PathBuf,
}

/// What became of a task.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", tag = "status")]
pub enum Outcome {
    /// It has an answer.
    Done {
        /// The answer of `fct identify`, without its history; of a search that of the model it chose.
        identify: Box<IdentifyAnswer>,
        /// The answer of `fct discover`, where the task is a search.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        discover: Option<Value>,
    },
    /// It cannot be computed.
    Failed {
        /// Why.
        reason: String,
    },
}

/// The result of a task, as it is stored.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct TaskResult {
    /// Version of this file's form.
    pub schema: u32,
    /// The task.
    pub key: String,
    /// Version of the program.
    pub version: String,
    /// Name of the specimen.
    pub specimen: String,
    /// Which repeat.
    pub repeat: usize,
    /// What became of it.
    #[serde(flatten)]
    pub outcome: Outcome,
    /// Wall time, s.
    pub seconds: f64,
}

impl Folder {
    /// The folder at a path; nothing is written.
    pub const fn new(path: PathBuf) -> Self {
        Self { path }
    }

    /// Where it is.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The plan.
    pub fn plan(&self) -> PathBuf {
        self.path.join("plan.json")
    }

    /// Where claims stand.
    pub fn claims(&self) -> PathBuf {
        self.path.join("claims")
    }

    /// Where results of tasks with an answer stand.
    pub fn results(&self) -> PathBuf {
        self.path.join("results")
    }

    /// Where results of tasks that failed stand.
    pub fn failures(&self) -> PathBuf {
        self.path.join("failed")
    }

    /// The result of a task that has an answer.
    pub fn result(&self, key: &str) -> PathBuf {
        self.results().join(format!("{key}.json"))
    }

    /// The result of a task that failed.
    pub fn failure(&self, key: &str) -> PathBuf {
        self.failures().join(format!("{key}.json"))
    }

    /// Whether a task has a result, of either kind.
    pub fn has(&self, key: &str) -> bool {
        self.result(key).is_file() || self.failure(key).is_file()
    }

    /// What a task keeps while it runs, so that who takes it up goes on where it was.
    pub fn journal(&self, key: &str) -> RunJournal {
        RunJournal::new(self.work(key))
    }

    /// Removes what a finished task kept.
    pub fn forget(&self, key: &str) {
        // What stays is found again, or in nobody's way.
        let _ = fs::remove_dir_all(self.work(key));
    }

    fn work(&self, key: &str) -> PathBuf {
        self.path.join("work").join(key)
    }

    /// Keys of all tasks with an answer.
    pub fn done(&self) -> HashSet<String> {
        keys(&self.results())
    }

    /// Keys of all tasks that failed.
    pub fn failed(&self) -> HashSet<String> {
        keys(&self.failures())
    }

    /// The result of a task; `None` where there is none, or one that cannot be read.
    pub fn read(&self, key: &str) -> Option<TaskResult> {
        let bytes = fs::read(self.result(key)).or_else(|_| fs::read(self.failure(key))).ok()?;
        let result: TaskResult = serde_json::from_slice(&bytes).ok()?;
        (result.key == key).then_some(result)
    }

    /// Puts a result in its place.
    ///
    /// # Errors
    /// If the disk refuses.
    pub fn store(&self, result: &TaskResult) -> Result<(), ReportError> {
        let path = match result.outcome {
            Outcome::Done { .. } => self.result(&result.key),
            Outcome::Failed { .. } => self.failure(&result.key),
        };
        let mut bytes = serde_json::to_vec(result).map_err(|e| ReportError::NotARun {
            path: path.clone(),
            reason: format!("the result is no JSON: {e}"),
        })?;
        bytes.push(b'\n');
        publish(&path, &bytes)
    }

    /// Removes the result of a task that failed, so that it is tried again.
    ///
    /// # Errors
    /// If the disk refuses.
    pub fn remove(&self, key: &str) -> Result<(), ReportError> {
        let path = self.failure(key);
        fs::remove_file(&path).map_err(ReportError::io(&path, "remove"))
    }
}

fn keys(folder: &Path) -> HashSet<String> {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    let key = |e: fs::DirEntry| Some(e.file_name().to_str()?.strip_suffix(".json")?.to_owned());
    entries.filter_map(key).filter(|k| !k.starts_with('.')).collect()
}

/// Writes a file whole or not at all, whoever else writes it at the same time: each under a name of its own, then renamed.
///
/// # Errors
/// If the disk refuses.
pub fn publish(path: &Path, content: &[u8]) -> Result<(), ReportError> {
    let folder = path.parent().unwrap_or(Path::new("."));
    fs::create_dir_all(folder).map_err(ReportError::io(folder, "create the directory"))?;
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let own = folder.join(format!(".{name}.{}.tmp", crate::claim::unique()));
    let written = File::create(&own)
        .and_then(|mut f| f.write_all(content).and_then(|()| f.sync_all()))
        .and_then(|()| fs::rename(&own, path));
    written.map_err(|source| {
        let _ = fs::remove_file(&own);
        ReportError::Io { path: path.to_owned(), action: "write", source }
    })
}
