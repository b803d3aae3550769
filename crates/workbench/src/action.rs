//! What a page may ask for.

use crate::BenchError;
use crate::set::Change;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// One request of a page.
#[derive(Clone, Debug, Deserialize)]
#[serde(tag = "do", rename_all = "snake_case")]
pub enum Action {
    /// `fct import`.
    Import(ImportRequest),
    /// Other values, held or free parameters: one run of the model there. Another mesh or other areas: no run.
    Set(Change),
    /// `fct identify`.
    Fit,
    /// `fct check`: what the records are good for.
    Check,
    /// `fct diagnose`.
    Diagnose,
    /// `fct discover`.
    Discover,
    /// `fct add`, then `fct identify`.
    Add {
        /// Name in the catalogue.
        effect: String,
    },
    /// `fct drop`, then `fct identify`.
    Drop {
        /// Name in the catalogue.
        effect: String,
    },
    /// Back or forth to a step.
    Go {
        /// Its index.
        step: usize,
    },
    /// Ends what runs; its best is kept.
    Stop,
}

impl Action {
    /// In words, while it is done.
    pub fn words(&self) -> String {
        match self {
            Self::Import(_) => "reading the files".into(),
            Self::Set(_) => "computing the model".into(),
            Self::Fit => "fitting".into(),
            Self::Check => "examining the records".into(),
            Self::Diagnose => "asking what is missing".into(),
            Self::Discover => "searching for what is missing".into(),
            Self::Add { effect } => format!("adding {effect} and fitting"),
            Self::Drop { effect } => format!("taking {effect} away and fitting"),
            Self::Go { .. } | Self::Stop => "going".into(),
        }
    }
}

/// What is to be imported, and how.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ImportRequest {
    /// Files, relative to the opened folder, in the order of the tests.
    pub files: Vec<String>,
    /// What was tested, one per file.
    pub kinds: Vec<String>,
    /// Flags of `fct import` without dashes; an empty value is a flag that has none.
    #[serde(default)]
    pub flags: BTreeMap<String, String>,
    /// Dimensions, mm, by `length`, `width`, `thickness`, `cut`.
    #[serde(default)]
    pub geometry: BTreeMap<String, f64>,
    /// Name of the specimen; empty: the header's.
    #[serde(default)]
    pub name: String,
}

/// Flags that a page may set. Those with a value, those without.
const VALUED: [&str; 20] = [
    "time",
    "displacement",
    "force",
    "displacement-x",
    "force-x",
    "grip-displacement",
    "tear-front",
    "width-change",
    "segment",
    "units",
    "decimal",
    "delimiter",
    "encoding",
    "sheet",
    "skip-rows",
    "rate",
    "frequency",
    "drop",
    "restart",
    "points",
];
const PLAIN: [&str; 4] = ["zero", "tare", "flip", "true-measures"];

impl ImportRequest {
    /// The words after `fct import`, without `--out` and `--geometry`.
    ///
    /// # Errors
    /// If a flag is none of `fct import`'s.
    pub fn words(&self) -> Result<Vec<String>, BenchError> {
        let asked = |why: String| BenchError::Asked(why);
        if self.files.is_empty() {
            return Err(asked("no file to import".into()));
        }
        // A path that begins with a dash would be a flag.
        let mut words: Vec<String> = self.files.iter().map(|f| format!("./{f}")).collect();
        if !self.kinds.is_empty() {
            words.push(format!("--kind={}", self.kinds.join(",")));
        }
        for (flag, value) in &self.flags {
            match (VALUED.contains(&flag.as_str()), PLAIN.contains(&flag.as_str())) {
                (true, _) if !value.is_empty() => words.push(format!("--{flag}={value}")),
                (_, true) => words.push(format!("--{flag}")),
                (true, _) => {}
                _ => return Err(asked(format!("--{}: no flag of fct import", input::visible(flag)))),
            }
        }
        Ok(words)
    }

    /// The specimen's dimensions as a TOML file, if any are given.
    ///
    /// # Errors
    /// If one is no length.
    pub fn geometry_toml(&self) -> Result<Option<String>, BenchError> {
        let mut lines = Vec::new();
        for (key, value) in &self.geometry {
            let known = ["length", "width", "thickness", "cut"].contains(&key.as_str());
            let least = if key == "cut" { 0.0 } else { f64::MIN_POSITIVE };
            if !known || !value.is_finite() || *value < least {
                return Err(BenchError::Asked(format!("{} {value} mm: no dimension", input::visible(key))));
            }
            lines.push(format!("{key}_mm = {value:?}"));
        }
        if lines.is_empty() {
            return Ok(None);
        }
        let name = self.name.trim();
        if let Some(why) = input::name_fault(name).filter(|_| !name.is_empty()) {
            let name = input::visible(name);
            return Err(BenchError::Asked(format!("the specimen's name \"{name}\": {why}")));
        }
        // JSON escapes of a string are TOML's too.
        let name =
            if name.is_empty() { String::new() } else { format!("name = {}\n", serde_json::json!(name)) };
        Ok(Some(format!("{name}[geometry]\n{}\n", lines.join("\n"))))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn flags_are_those_of_the_command_and_no_others() {
        let mut request = ImportRequest {
            files: vec!["-a.csv".into()],
            kinds: vec!["tearing".into()],
            flags: [("zero", ""), ("force", "Load [N]"), ("time", "")]
                .map(|(a, b)| (a.into(), b.into()))
                .into(),
            ..ImportRequest::default()
        };
        let words = request.words().unwrap_or_default();
        assert_eq!(words, ["./-a.csv", "--kind=tearing", "--force=Load [N]", "--zero"]);
        request.flags.insert("out".into(), "/etc".into());
        assert!(request.words().is_err());
    }

    #[test]
    fn dimensions_are_lengths() {
        let request = |key: &str, value: f64| ImportRequest {
            geometry: [(key.to_owned(), value)].into(),
            name: " a 'b' & c".into(),
            ..ImportRequest::default()
        };
        let text = request("width", 6.0).geometry_toml().ok().flatten().unwrap_or_default();
        assert_eq!(text, "name = \"a 'b' & c\"\n[geometry]\nwidth_mm = 6.0\n");
        for bad in
            [request("width", 0.0), request("cut", -1.0), request("height", 1.0), request("width", f64::NAN)]
        {
            assert!(bad.geometry_toml().is_err(), "{bad:?}");
        }
        assert!(request("cut", 0.0).geometry_toml().is_ok());
        let named = |name: &str| ImportRequest { name: name.into(), ..request("width", 6.0) };
        assert!(named("a <b>").geometry_toml().is_err_and(|e| e.to_string().contains("a <b>")));
        assert!(named("").geometry_toml().is_ok());
    }
}
