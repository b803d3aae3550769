//! What was done, step by step: `steps.json` in the workbench's folder.
//! Names of fields are those of the JSON.
#![allow(non_snake_case)]

use crate::BenchError;
use report::answer::IdentifyAnswer;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::path::Path;

/// Layout of the file.
const VERSION: u32 = 1;
/// Name of the file.
pub const STEPS: &str = "steps.json";

/// One step.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Step {
    /// `open`, `import`, `fit`, `add`, `drop`, `set`, `discover`.
    pub kind: String,
    /// In words.
    pub title: String,
    /// Lines for a shell in the opened folder that do the same.
    pub commands: Vec<String>,
    /// The specimen or config after the step; paths are relative to the opened folder.
    pub config: Option<String>,
    /// The run directory after the step.
    pub run: Option<String>,
    /// How good the model of that run is.
    pub fit: Option<Fit>,
}

impl Step {
    /// What the next step is made from: the run with what it found, or the config. The run of values that were set was told
    /// to take no step; what follows it is to search again, from the same values.
    pub fn source(&self) -> Option<&str> {
        let run = self.run.as_deref().filter(|_| self.kind != "set");
        run.or(self.config.as_deref())
    }
}

/// What the staircase shows of a run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Fit {
    /// Effects in the model.
    pub effects: Vec<String>,
    /// Root mean square misfit over all force points, N.
    pub rms_N: f64,
    /// The same as a share of the largest force.
    pub share_of_peak: f64,
    /// Noise over all force points, N.
    pub noise_N: f64,
    /// χ² per degree of freedom.
    pub reduced_chi2: f64,
    /// Whether the model explains the records.
    pub explained: bool,
}

impl From<&IdentifyAnswer> for Fit {
    fn from(a: &IdentifyAnswer) -> Self {
        let peak = a.tests.values().fold(0.0_f64, |m, t| m.max(t.peak_N.abs()));
        let points: f64 = a.tests.values().map(|t| t.points as f64).sum();
        let squares: f64 = a.tests.values().map(|t| t.noise_N.powi(2) * t.points as f64).sum();
        Self {
            effects: a.effects.clone(),
            rms_N: a.rms_N,
            share_of_peak: if peak > 0.0 { a.rms_N / peak } else { 0.0 },
            noise_N: (squares / points.max(1.0)).sqrt(),
            reduced_chi2: a.reduced_chi2_total,
            explained: a.explained,
        }
    }
}

/// Every step, and which of them is looked at.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Steps {
    version: u32,
    /// In the order in which they were done; those after `cursor` were undone.
    pub steps: Vec<Step>,
    /// Index of the present one.
    pub cursor: usize,
    /// The number of the next file or folder.
    pub next: u32,
    /// The last import: what was asked, and `fct import`'s answer.
    pub import: Option<Value>,
    /// What `fct check` said of the records of a config: `{ "config": …, "doctor": … }`.
    #[serde(default)]
    pub checked: Option<Value>,
}

impl Steps {
    /// What the doctor says of the records of a config, if it was asked.
    pub fn doctor_of(&self, config: Option<&str>) -> Option<&Value> {
        self.checked
            .as_ref()
            .filter(|c| c["config"].as_str() == config && config.is_some())
            .map(|c| &c["doctor"])
    }

    /// Reads the steps of a folder; none if it has none.
    ///
    /// # Errors
    /// If the file is damaged.
    pub fn read(folder: &Path) -> Result<Self, BenchError> {
        let path = folder.join(STEPS);
        if !path.exists() {
            return Ok(Self { version: VERSION, next: 1, ..Self::default() });
        }
        let text = std::fs::read(&path).map_err(BenchError::io(&path, "read"))?;
        let bad =
            |why: String| BenchError::Asked(format!("{}: {why}; move it away to begin anew", path.display()));
        let out: Self = serde_json::from_slice(&text).map_err(|e| bad(e.to_string()))?;
        if out.version != VERSION {
            return Err(bad(format!("layout {}; expected {VERSION}", out.version)));
        }
        if out.cursor > 0 && out.cursor >= out.steps.len() {
            return Err(bad(format!("step {} of {}", out.cursor, out.steps.len())));
        }
        Ok(out)
    }

    /// Writes them whole.
    ///
    /// # Errors
    /// If the disk refuses.
    pub fn write(&self, folder: &Path) -> Result<(), BenchError> {
        let path = folder.join(STEPS);
        let text = serde_json::to_string_pretty(self).unwrap_or_default();
        report::write_atomic(&path, text.as_bytes()).map_err(|e| BenchError::Asked(e.to_string()))
    }

    /// The present step.
    pub fn present(&self) -> Option<&Step> {
        self.steps.get(self.cursor)
    }

    /// A new step after the present one; what was undone before is forgotten. A step of the same kind as the present one takes
    /// its place where `instead`; what is made from the one before needs that one's lines too, an import stands alone.
    pub fn push(&mut self, mut step: Step, instead: bool) {
        self.steps.truncate(self.cursor + 1);
        if instead
            && self.present().is_some_and(|p| p.kind == step.kind)
            && let Some(before) = self.steps.pop()
            && step.kind != "import"
        {
            step.commands.splice(0..0, before.commands);
        }
        self.steps.push(step);
        self.cursor = self.steps.len() - 1;
    }

    /// A number that no file has yet.
    pub fn number(&mut self) -> u32 {
        let n = self.next.max(1);
        self.next = n.saturating_add(1);
        n
    }

    /// What a shell needs to come to the present step.
    pub fn commands(&self) -> Vec<String> {
        self.steps.iter().take(self.cursor + 1).flat_map(|s| s.commands.clone()).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn step(kind: &str, title: &str) -> Step {
        Step { kind: kind.into(), title: title.into(), commands: vec![title.into()], ..Step::default() }
    }

    #[test]
    fn a_new_step_forgets_what_was_undone_and_a_slider_moved_twice_is_one() {
        let mut all = Steps::default();
        for (kind, title) in [("open", "a"), ("fit", "b"), ("add", "c")] {
            all.push(step(kind, title), false);
        }
        all.cursor = 1;
        all.push(step("set", "d"), true);
        all.push(step("set", "e"), true);
        assert_eq!(all.commands(), ["a", "b", "d", "e"]);
        assert_eq!(all.steps.len(), 3);
        all.push(step("import", "f"), true);
        all.push(step("import", "g"), true);
        assert_eq!(all.commands(), ["a", "b", "d", "e", "g"]);
    }

    #[test]
    fn what_is_written_is_read_and_damage_is_told() -> Result<(), Box<dyn std::error::Error>> {
        let folder = tempfile::tempdir()?;
        let mut all = Steps::read(folder.path())?;
        all.push(step("open", "a"), false);
        all.write(folder.path())?;
        assert_eq!(Steps::read(folder.path())?.steps, all.steps);
        for bad in ["{", "{}", "[]", r#"{"version":9,"steps":[],"cursor":0,"next":1,"import":null}"#] {
            std::fs::write(folder.path().join(STEPS), bad)?;
            assert!(Steps::read(folder.path()).is_err_and(|e| e.to_string().contains(STEPS)), "{bad}");
        }
        std::fs::write(
            folder.path().join(STEPS),
            r#"{"version":1,"steps":[],"cursor":7,"next":1,"import":null}"#,
        )?;
        assert!(Steps::read(folder.path()).is_err());
        Ok(())
    }
}
