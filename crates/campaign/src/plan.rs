//! From the file of a study to its tasks.

use crate::error::CampaignError;
use crate::files::{Folder, publish};
use input::{Case, Reading, Study, StudyModel, Task as Doing};
use model::Catalogue;
use serde::{Deserialize, Serialize};
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Program version that stands in every key: another one computes other bits.
pub const VERSION: &str = env!("CARGO_PKG_VERSION");

/// One specimen of the plan.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Specimen {
    /// Number of its row, from 1.
    pub row: usize,
    /// Its name.
    pub name: String,
    /// The file, absolute.
    pub file: PathBuf,
    /// Group; may be empty.
    pub group: String,
    /// Donor; may be empty.
    pub donor: String,
    /// Why it is in no mean.
    pub exclude: Option<String>,
}

/// One task.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Task {
    /// SHA-256 of what is computed, hexadecimal: the name of its result.
    pub key: String,
    /// Index of the specimen in the plan.
    pub specimen: usize,
    /// Index of the model in the plan.
    pub model: usize,
    /// 0: the records as they are; from 1: records with their misfit drawn anew.
    pub repeat: usize,
    /// Key of the fit whose misfit is drawn from; none for that fit itself.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub base: Option<String>,
}

/// A model of the plan.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Model {
    /// Its name.
    pub name: String,
    /// Its config, absolute; none: what each specimen's file says.
    pub config: Option<PathBuf>,
    /// Effects added.
    pub effects: Vec<String>,
    /// `identify` or `discover`.
    pub task: String,
}

/// A row of the table that cannot be used.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct WrongRow {
    /// Its number, from 1.
    pub row: usize,
    /// Why, with file and line.
    pub reason: String,
}

/// All tasks of a study, specimen by specimen.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Plan {
    /// Version of this file's form.
    pub schema: u32,
    /// Name of the study.
    pub study: String,
    /// Its file, absolute.
    pub file: PathBuf,
    /// SHA-256 of that file as it was planned from.
    pub sha256: String,
    /// Version of the program.
    pub version: String,
    /// Seed of the repeats.
    pub seed: u64,
    /// Specimens that can be read.
    pub specimens: Vec<Specimen>,
    /// Models.
    pub models: Vec<Model>,
    /// Tasks.
    pub tasks: Vec<Task>,
    /// Rows that are left out, and why.
    pub wrong: Vec<WrongRow>,
}

impl Plan {
    /// Plans a study: reads every specimen with every model.
    ///
    /// # Errors
    /// What is wrong with the study's own file. A specimen that cannot be read is a [`WrongRow`].
    pub fn of(file: &Path, catalogue: &Catalogue) -> Result<(Self, Folder), CampaignError> {
        let study = input::read_study(file)?;
        let text = input::read_text(file, input::LARGEST_TOML, "a study (TOML)")?;
        let mut plan = Self {
            schema: 1,
            study: study.name.clone(),
            file: absolute(file),
            sha256: input::sha256(text.as_bytes()),
            version: VERSION.to_owned(),
            seed: study.seed,
            specimens: Vec::new(),
            models: study.models.iter().map(Model::of).collect(),
            tasks: Vec::new(),
            wrong: Vec::new(),
        };
        plan.add_rows(&study, catalogue);
        Ok((plan, Folder::new(absolute(&study.folder))))
    }

    fn add_rows(&mut self, study: &Study, catalogue: &Catalogue) {
        let mut seen: HashMap<String, usize> = HashMap::new();
        for (k, row) in study.rows.iter().enumerate() {
            let row = match row {
                Ok(row) => row,
                Err(faults) => {
                    self.wrong.push(WrongRow { row: k + 1, reason: faults.to_string() });
                    continue;
                }
            };
            let file = absolute(&row.file);
            let cases: Result<Vec<Arc<Case>>, String> =
                self.models.iter().map(|m| case_of(&file, m, catalogue)).collect();
            let wrong = |reason| WrongRow { row: row.number, reason };
            match cases {
                Err(reason) => self.wrong.push(wrong(reason)),
                Ok(cases) => {
                    let first = cases.first().map_or_else(String::new, |c| c.fingerprint());
                    // Twice the same records would count twice.
                    match seen.insert(first, row.number) {
                        Some(twin) => self.wrong.push(wrong(format!(
                            "{}: the same specimen as row {twin}; it counts once",
                            row.file.display()
                        ))),
                        None => self.add(row, file, &cases, study.bootstrap),
                    }
                }
            }
        }
    }

    fn add(&mut self, row: &input::Row, file: PathBuf, cases: &[Arc<Case>], bootstrap: usize) {
        let specimen = self.specimens.len();
        let name = cases.first().map_or_else(String::new, |c| c.name.clone());
        for (model, case) in cases.iter().enumerate() {
            let doing = self.models[model].task.clone();
            let key = key(case, &doing, self.seed, 0);
            self.tasks.push(Task { key: key.clone(), specimen, model, repeat: 0, base: None });
            // A search is not repeated: what it would find in records drawn anew is another question.
            let repeats = if self.models[model].searches() { 0 } else { bootstrap };
            for repeat in 1..=repeats {
                let own = self::key(case, &doing, self.seed, repeat);
                self.tasks.push(Task { key: own, specimen, model, repeat, base: Some(key.clone()) });
            }
        }
        let (group, donor, exclude) = (row.group.clone(), row.donor.clone(), row.exclude.clone());
        self.specimens.push(Specimen { row: row.number, name, file, group, donor, exclude });
    }

    /// The case of a task, if it still is what was planned.
    ///
    /// # Errors
    /// What is wrong with its files now, or that they have changed.
    pub fn case(&self, task: &Task, catalogue: &Catalogue) -> Result<Arc<Case>, String> {
        let file = &self.specimens[task.specimen].file;
        let case = case_of(file, &self.models[task.model], catalogue)?;
        if key(&case, &self.models[task.model].task, self.seed, task.repeat) != task.key {
            return Err(format!(
                "{}: this specimen, or its model, has changed since the study was planned; plan it again",
                file.display()
            ));
        }
        Ok(case)
    }

    /// Writes the plan into its folder.
    ///
    /// # Errors
    /// If the disk refuses.
    pub fn store(&self, folder: &Folder) -> Result<(), CampaignError> {
        let mut bytes = serde_json::to_vec_pretty(self).unwrap_or_default();
        bytes.push(b'\n');
        Ok(publish(&folder.plan(), &bytes)?)
    }

    /// Reads a stored plan.
    ///
    /// # Errors
    /// If there is none, or it is damaged.
    pub fn read(folder: &Folder) -> Result<Self, CampaignError> {
        let path = folder.plan();
        if !path.is_file() {
            return Err(CampaignError::NoPlan(folder.path().to_owned()));
        }
        let bad = |reason: String| CampaignError::BadPlan { path: path.clone(), reason };
        let bytes = std::fs::read(&path).map_err(|e| bad(e.to_string()))?;
        let plan: Self = serde_json::from_slice(&bytes).map_err(|e| bad(e.to_string()))?;
        let whole = plan.tasks.iter().all(|t| {
            let hash = t.key.len() == 64 && t.key.bytes().all(|b| b.is_ascii_hexdigit());
            hash && t.specimen < plan.specimens.len() && t.model < plan.models.len()
        });
        if whole { Ok(plan) } else { Err(bad("a task names what is not there".into())) }
    }
}

/// The plan of a study: of its folder the stored one, of its file the stored one if that is of this file and this version
/// of the program, else a new one, which is stored.
///
/// # Errors
/// As [`Plan::of`], [`Plan::read`].
pub fn read_or_plan(study: &Path, catalogue: &Catalogue) -> Result<(Plan, Folder), CampaignError> {
    if study.is_dir() {
        let folder = Folder::new(absolute(study));
        return Ok((Plan::read(&folder)?, folder));
    }
    let named = input::read_study(study)?;
    let folder = Folder::new(absolute(&named.folder));
    let text = input::read_text(study, input::LARGEST_TOML, "a study (TOML)")?;
    match Plan::read(&folder) {
        Ok(plan) if plan.sha256 == input::sha256(text.as_bytes()) && plan.version == VERSION => {
            Ok((plan, folder))
        }
        _ => {
            let (plan, folder) = Plan::of(study, catalogue)?;
            plan.store(&folder)?;
            Ok((plan, folder))
        }
    }
}

impl Model {
    fn of(model: &StudyModel) -> Self {
        Self {
            name: model.name.clone(),
            config: model.config.as_deref().map(absolute),
            effects: model.effects.clone(),
            task: model.task.word().to_owned(),
        }
    }

    /// Whether missing effects are searched for.
    pub fn searches(&self) -> bool {
        self.task == Doing::Discover.word()
    }
}

/// A specimen with a model, its records fit to be used.
fn case_of(file: &Path, model: &Model, catalogue: &Catalogue) -> Result<Arc<Case>, String> {
    let more: String = model.effects.iter().map(|e| format!("[effects.{e}]\n")).collect();
    let read = match &model.config {
        Some(config) => {
            let reading = Reading { specimen: Some(file), more: &more };
            input::read_case_as(config, reading, catalogue)
        }
        None => input::read_case_as(file, Reading { specimen: None, more: &more }, catalogue),
    };
    let case = Arc::new(read.map_err(|faults| faults.to_string())?);
    let (faults, _) = analysis::needs(&case, catalogue);
    match faults.first() {
        Some((place, fault)) => Err(format!("{place}: error: {fault}")),
        None => Ok(case),
    }
}

/// What a task computes, as a hash.
fn key(case: &Case, doing: &str, seed: u64, repeat: usize) -> String {
    let seed = if repeat == 0 { 0 } else { seed };
    let text = format!("fct {VERSION}|{doing}|{}|{seed}|{repeat}", case.fingerprint());
    input::sha256(text.as_bytes())
}

fn absolute(path: &Path) -> PathBuf {
    std::path::absolute(path).unwrap_or_else(|_| path.to_owned())
}
