//! The importer.

use crate::errors::Fault;
use pyo3::prelude::*;
use records::{Choices, Geometry};
use std::path::{Path, PathBuf};

/// Tests of a testing machine's file: [(name, kind, canonical CSV)], and how it was read as JSON. `choices`: flags of
/// `fct import` without dashes, with their values.
#[pyfunction]
#[pyo3(signature = (file, choices=Vec::new()))]
pub fn import_record(py: Python<'_>, file: PathBuf, choices: Vec<(String, String)>) -> PyResult<Read> {
    py.detach(|| read(&file, &choices)).map_err(|fault| fault.raised(py))
}

type Read = (Vec<(String, String, String)>, String);

fn read(file: &Path, given: &[(String, String)]) -> Result<Read, Fault> {
    let mut choices = Choices::new();
    for (flag, value) in given {
        choices.answer(flag, value).map_err(|e| Fault::Input(format!("{flag}: {e}")))?;
    }
    let mut geometry = Geometry::default();
    let read = records::import(file, &choices, &mut geometry).map_err(|e| Fault::Input(e.to_string()))?;
    let comments = vec![format!("read from {} by fct {}", file.display(), env!("CARGO_PKG_VERSION"))];
    let tests = read.tests.iter().map(|t| (t.name.clone(), t.kind.clone(), t.csv(&comments))).collect();
    Ok((tests, serde_json::to_string(&read)?))
}
