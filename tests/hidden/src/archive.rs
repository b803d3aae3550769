//! Results of a study in one file, one case a line: a study that takes days goes on from them on another machine, and its page is made
//! from them alone. The records are not in it: they follow from the seed.

use crate::run::Drawn;
use crate::{GenerateError, imitate};
use serde::{Deserialize, Serialize};
use serde_json::{Number, Value};
use std::collections::{BTreeMap, BTreeSet};
use std::io::ErrorKind;
use std::path::Path;

/// What a folder of a case holds besides its records. The answer comes last: where it is, the others are.
const FILES: [&str; 4] = ["truth.json", imitate::FILE, Drawn::LeftOut.file(), ANSWER];
const ANSWER: &str = Drawn::All.file();

/// Significant digits of a number in the archive: more than a page shows.
const DIGITS: usize = 6;

#[derive(Serialize, Deserialize)]
struct Line {
    case: String,
    /// Commit of the program that answered.
    program: Option<String>,
    files: BTreeMap<String, Value>,
}

fn read(path: &Path) -> Result<BTreeMap<String, Line>, GenerateError> {
    let name = path.display().to_string();
    let text = match std::fs::read_to_string(path) {
        Ok(text) => text,
        Err(e) if e.kind() == ErrorKind::NotFound => return Ok(BTreeMap::new()),
        Err(e) => return Err(GenerateError::file(&name, &e)),
    };
    let line = |(i, l): (usize, &str)| {
        let line: Line = serde_json::from_str(l)
            .map_err(|e| GenerateError::file(&format!("{name}, line {}", i + 1), &e))?;
        Ok((line.case.clone(), line))
    };
    text.lines().enumerate().map(line).collect()
}

/// Writes the results of answered cases under `dir` to `path`, beside those that are there; what is new is by `program`.
///
/// # Errors
/// When a file cannot be read or written, or is no JSON.
pub fn pack(dir: &Path, path: &Path, program: Option<&str>) -> Result<usize, GenerateError> {
    let mut lines = read(path)?;
    for folder in crate::run::folders(dir)? {
        if !folder.join(ANSWER).is_file() {
            continue;
        }
        let mut files = BTreeMap::new();
        for file in FILES {
            let from = folder.join(file);
            let fault = |e: &dyn std::fmt::Display| GenerateError::file(&from.display().to_string(), e);
            let text = match std::fs::read_to_string(&from) {
                Err(e) if e.kind() == ErrorKind::NotFound => continue,
                text => text.map_err(|e| fault(&e))?,
            };
            let mut value: Value = serde_json::from_str(&text).map_err(|e| fault(&e))?;
            round(&mut value);
            files.insert(file.to_owned(), value);
        }
        let case = folder.file_name().map_or_else(String::new, |n| n.to_string_lossy().into_owned());
        if lines.get(&case).is_none_or(|there| there.files != files) {
            lines.insert(case.clone(), Line { case, program: program.map(str::to_owned), files });
        }
    }
    let fault = |e: &dyn std::fmt::Display| GenerateError::file(&path.display().to_string(), e);
    let mut text = String::new();
    for line in lines.values() {
        text.push_str(&serde_json::to_string(line).map_err(|e| fault(&e))?);
        text.push('\n');
    }
    if let Some(parent) = path.parent() {
        std::fs::create_dir_all(parent).map_err(|e| fault(&e))?;
    }
    let new = path.with_extension("new");
    std::fs::write(&new, text).and_then(|()| std::fs::rename(&new, path)).map_err(|e| fault(&e))?;
    Ok(lines.len())
}

/// The programs that gave the answers of `path`.
///
/// # Errors
/// As [`pack`].
pub fn programs(path: &Path) -> Result<BTreeSet<String>, GenerateError> {
    Ok(read(path)?.into_values().filter_map(|l| l.program).collect())
}

/// Puts the results of `path` into folders of cases under `dir`, where there are none.
///
/// # Errors
/// As [`pack`].
pub fn unpack(path: &Path, dir: &Path) -> Result<usize, GenerateError> {
    let lines = read(path)?;
    for line in lines.values() {
        let folder = dir.join(&line.case);
        if folder.join(ANSWER).is_file() {
            continue;
        }
        let fault = |e: &dyn std::fmt::Display| GenerateError::file(&folder.display().to_string(), e);
        std::fs::create_dir_all(&folder).map_err(|e| fault(&e))?;
        for file in FILES {
            let Some(value) = line.files.get(file) else { continue };
            let json = serde_json::to_string_pretty(value).map_err(|e| fault(&e))?;
            std::fs::write(folder.join(file), json).map_err(|e| fault(&e))?;
        }
    }
    Ok(lines.len())
}

/// Rounds all numbers that have more digits.
fn round(value: &mut Value) {
    match value {
        Value::Number(n) if n.is_f64() => {
            let short = n.as_f64().and_then(|x| format!("{x:.*e}", DIGITS - 1).parse().ok());
            if let Some(n) = short.and_then(Number::from_f64) {
                *value = Value::Number(n);
            }
        }
        Value::Array(all) => all.iter_mut().for_each(round),
        Value::Object(all) => all.values_mut().for_each(round),
        _ => {}
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    /// Answered cases come back as they were, to six digits; others are not in the archive, and what was in it stays.
    #[test]
    fn results_come_back() {
        let root = tempfile::tempdir().expect("a folder");
        let (from, to, path) =
            (root.path().join("from"), root.path().join("to"), root.path().join("results/1.jsonl"));
        let put = |case: &str, file: &str, value: Value| {
            let folder = from.join(case);
            std::fs::create_dir_all(&folder).expect("a folder");
            std::fs::write(folder.join(file), value.to_string()).expect("a file");
        };
        put("case-001", "truth.json", json!({"seed": 31_000, "gc": [0.123_456_789, 2.0]}));
        put("case-001", "result.json", json!({"verdict": "explained", "none": null}));
        put("case-002", "truth.json", json!({}));
        assert_eq!(pack(&from, &path, Some("one")).expect("packed"), 1);
        assert_eq!(unpack(&path, &to).expect("unpacked"), 1);
        let back = |case: &str, file: &str| -> Option<Value> {
            serde_json::from_str(&std::fs::read_to_string(to.join(case).join(file)).ok()?).ok()
        };
        assert_eq!(back("case-001", "truth.json"), Some(json!({"seed": 31_000, "gc": [0.123_457, 2.0]})));
        assert_eq!(back("case-001", "result.json"), Some(json!({"verdict": "explained", "none": null})));
        assert_eq!(back("case-002", "truth.json"), None);
        put("case-002", "result.json", json!({}));
        std::fs::remove_dir_all(from.join("case-001")).expect("removed");
        assert_eq!(pack(&from, &path, Some("two")).expect("packed"), 2);
        assert_eq!(pack(&to, &path, Some("three")).expect("packed"), 2);
        assert_eq!(programs(&path).expect("programs"), BTreeSet::from(["one".into(), "two".into()]));
        // What a folder found itself stays.
        std::fs::write(to.join("case-001/result.json"), "{}").expect("a file");
        assert_eq!(unpack(&path, &to).expect("unpacked"), 2);
        assert_eq!(back("case-001", "result.json"), Some(json!({})));
        let text = std::fs::read_to_string(&path).expect("an archive");
        std::fs::write(&path, text + "{}\n").expect("a file");
        let said = unpack(&path, &to).expect_err("no line of an archive").to_string();
        assert!(said.contains("1.jsonl, line 3"), "{said}");
    }
}
