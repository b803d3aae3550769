//! Small cases, and running the binary on them.
#![allow(dead_code)]

use serde_json::Value;
use std::fs;
use std::path::Path;
use std::process::{Command, Output};
use tempfile::TempDir;

pub type Tested = Result<(), Box<dyn std::error::Error>>;

/// A strip of few elements, pulled and torn; `more` goes to the end of the file.
pub fn strip(more: &str) -> String {
    format!(
        r#"name = "strip"
[geometry]
length_mm = 8.0
width_mm = 6.0
thickness_mm = 0.8
cut_mm = 1.5
[[tests]]
kind = "uniaxial"
protocol = [{{ to_mm = 2.0, rate_mm_per_s = 0.05 }}]
[[tests]]
kind = "tearing"
protocol = [{{ to_mm = 2.0, rate_mm_per_s = 0.05 }}, {{ to_mm = 1.0, rate_mm_per_s = 0.05 }}, {{ to_mm = 5.0, rate_mm_per_s = 0.05 }}]
[mesh]
divisions = [8, 8, 1]
[bulk]
mu_kPa = 6.0
k1_kPa = 700.0
k2 = 15.0
gamma_deg = 42.0
kappa = 0.22
[interface]
gc_N_per_mm = 0.15
sigma_c_MPa = 0.08
{more}"#
    )
}

/// A config that fits a synthetic specimen from other start values.
pub const FIT: &str = r#"specimen = "runs/strip/specimen.toml"
[mesh]
divisions = [8, 8, 1]
[bulk]
mu_kPa = { start = 6.0, fixed = true }
k1_kPa = 500.0
k2 = 12.0
gamma_deg = { start = 42.0, fixed = true }
kappa = { start = 0.22, fixed = true }
[interface]
gc_N_per_mm = 0.12
sigma_c_MPa = 0.06
"#;

/// A folder with the strip in `strip.toml`.
pub fn folder(text: &str) -> Result<TempDir, Box<dyn std::error::Error>> {
    let folder = tempfile::tempdir()?;
    fs::write(folder.path().join("strip.toml"), text)?;
    Ok(folder)
}

/// A folder with a synthetic specimen in `runs/strip` and the config `fit.toml`.
pub fn synthetic() -> Result<TempDir, Box<dyn std::error::Error>> {
    let folder =
        folder(&strip("[solver]\nstep_mm = 0.2\n[output]\nnoise = 0.005\nseed = 3\nfields = false\n"))?;
    let out = fct(folder.path(), &["simulate", "strip.toml", "--quiet"])?;
    assert!(out.status.success(), "{}", String::from_utf8_lossy(&out.stderr));
    fs::write(folder.path().join("fit.toml"), FIT)?;
    Ok(folder)
}

/// Runs `fct` in a folder.
pub fn fct(folder: &Path, arguments: &[&str]) -> Result<Output, Box<dyn std::error::Error>> {
    Ok(Command::new(env!("CARGO_BIN_EXE_fct")).args(arguments).current_dir(folder).output()?)
}

/// Runs `fct … --json`: exit code, the one document on stdout, stderr.
pub fn json(folder: &Path, arguments: &[&str]) -> Result<(i32, Value, String), Box<dyn std::error::Error>> {
    let out = fct(folder, &[arguments, &["--json"]].concat())?;
    let stderr = String::from_utf8_lossy(&out.stderr).into_owned();
    let value = serde_json::from_slice(&out.stdout)
        .map_err(|e| format!("{e}\nstdout: {}\nstderr: {stderr}", String::from_utf8_lossy(&out.stdout)))?;
    Ok((out.status.code().unwrap_or(-1), value, stderr))
}

/// The document without what may differ from run to run.
pub fn timeless(mut value: Value) -> Value {
    fn strip(v: &mut Value) {
        match v {
            Value::Object(o) => {
                o.remove("seconds");
                o.remove("cost");
                o.values_mut().for_each(strip);
            }
            Value::Array(a) => a.iter_mut().for_each(strip),
            _ => {}
        }
    }
    strip(&mut value);
    value
}

/// Sources of the book.
pub const BOOK: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/book/src");

/// Fenced blocks of a page: what stands after the fence, and the lines.
pub fn blocks(text: &str) -> Vec<(String, Vec<String>)> {
    let mut out: Vec<(String, Vec<String>)> = Vec::new();
    let mut open = false;
    for line in text.lines() {
        match (line.strip_prefix("```"), open) {
            (Some(head), false) => {
                out.push((head.to_owned(), Vec::new()));
                open = true;
            }
            (Some(_), true) => open = false,
            (None, true) => out.last_mut().into_iter().for_each(|b| b.1.push(line.to_owned())),
            (None, false) => {}
        }
    }
    out
}
