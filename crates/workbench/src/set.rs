//! Values of the user's choice, as the words of `fct set`.

use crate::BenchError;
use serde::Deserialize;
use std::collections::BTreeMap;

/// What is changed of a model; paths as in answers, values in internal units (mm, N, s, MPa, rad).
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Change {
    /// Start values.
    pub values: BTreeMap<String, f64>,
    /// Whether parameters are held.
    pub fixed: BTreeMap<String, bool>,
    /// Stretches of records that count less, more or not at all.
    pub weigh: Vec<Weigh>,
    /// Tests whose points count alike again.
    pub unweigh: Vec<String>,
    /// Elements along x, y, z.
    pub divisions: Option<[usize; 3]>,
    /// Number of areas along the path.
    pub areas: Option<usize>,
}

/// How much a stretch of a record counts.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Weigh {
    /// Name of the test.
    pub test: String,
    /// First instant, s.
    pub from: f64,
    /// Last instant, s.
    pub to: f64,
    /// Factor of its part in χ²; 0: left out.
    pub weight: f64,
}

impl Change {
    /// Whether the model is another one: it is not run before somebody asks.
    pub fn is_of_the_mesh(&self) -> bool {
        self.divisions.is_some() || self.areas.is_some()
    }

    /// Whether it says what of the records counts.
    pub fn weighs(&self) -> bool {
        !self.weigh.is_empty() || !self.unweigh.is_empty()
    }

    /// The words behind `fct set FILE`.
    ///
    /// # Errors
    /// If a path or a number is none.
    pub fn words(&self) -> Result<Vec<String>, BenchError> {
        let paths = self.values.keys().chain(self.fixed.keys());
        if let Some(bad) = paths.into_iter().find(|p| !is_path(p)) {
            return Err(BenchError::Asked(format!("{}: no parameter of this model", input::visible(bad))));
        }
        // The shortest digits that are the same number.
        let mut out: Vec<String> = self.values.iter().map(|(p, v)| format!("{p}={v:?}")).collect();
        for (flag, wanted) in [("hold", true), ("free", false)] {
            let all: Vec<&str> = self.fixed.iter().filter(|f| *f.1 == wanted).map(|f| f.0.as_str()).collect();
            if !all.is_empty() {
                out.push(format!("--{flag}={}", all.join(",")));
            }
        }
        out.extend(self.unweigh.iter().map(|t| format!("--unweigh={t}")));
        let stretch = |w: &Weigh| format!("--weigh={},{:?},{:?},{:?}", w.test, w.from, w.to, w.weight);
        out.extend(self.weigh.iter().map(stretch));
        if let Some([x, y, z]) = self.divisions {
            out.push(format!("--divisions={x},{y},{z}"));
        }
        out.extend(self.areas.map(|n| format!("--areas={n}")));
        Ok(out)
    }
}

/// Whether this is written as a path: never a flag.
fn is_path(path: &str) -> bool {
    let rest = |c: char| c.is_ascii_alphanumeric() || "._[]".contains(c);
    path.starts_with(|c: char| c.is_ascii_alphabetic()) && path.chars().all(rest)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_change_is_the_words_of_a_command() -> Result<(), Box<dyn std::error::Error>> {
        let change: Change = serde_json::from_str(
            r#"{ "values": { "bulk.mu": 0.1, "interface.area[2].gc": 3e-17 }, "fixed": { "bulk.k1": true, "bulk.k2": false },
                 "divisions": [8, 20, 2], "areas": 3 }"#,
        )?;
        let words = change.words()?.join(" ");
        let right = "bulk.mu=0.1 interface.area[2].gc=3e-17 --hold=bulk.k1 --free=bulk.k2 --divisions=8,20,2 --areas=3";
        assert_eq!(words, right);
        let left_out: Change = serde_json::from_str(
            r#"{ "unweigh": ["tearing"], "weigh": [{ "test": "a b", "from": 1, "to": 2.5, "weight": 0 }] }"#,
        )?;
        assert_eq!(left_out.words()?, ["--unweigh=tearing", "--weigh=a b,1.0,2.5,0.0"]);
        for bad in [
            r#"{ "values": { "--out": 1.0 } }"#,
            r#"{ "fixed": { "a,--x": true } }"#,
            r#"{ "fixed": { "": true } }"#,
        ] {
            assert!(serde_json::from_str::<Change>(bad)?.words().is_err(), "{bad}");
        }
        Ok(())
    }
}
