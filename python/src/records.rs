//! The importer.

use crate::errors::Fault;
use input::ExperimentRegistry;
use pyo3::prelude::*;
use records::{Choices, Geometry};
use std::path::{Path, PathBuf};

/// Tests of a testing machine's file: [(name, kind, canonical CSV)], and how it was read as JSON. `choices`: flags of
/// `fct import` without dashes, with their values. `kind`: the experiment, if it is known; it decides whether there is a
/// second axis.
#[pyfunction]
#[pyo3(signature = (file, choices=Vec::new(), kind=""))]
pub fn import_record(
    py: Python<'_>,
    file: PathBuf,
    choices: Vec<(String, String)>,
    kind: &str,
) -> PyResult<Read> {
    py.detach(|| read(&file, &choices, kind)).map_err(|fault| fault.raised(py))
}

type Read = (Vec<(String, String, String)>, String);

fn read(file: &Path, given: &[(String, String)], kind: &str) -> Result<Read, Fault> {
    let two_axes = effects::catalogue().kind(kind).is_some_and(|k| k.two_axes);
    let mut choices = Choices { two_axes, ..Choices::new() };
    for (flag, value) in given {
        choices.answer(flag, value).map_err(|e| Fault::Input(format!("{flag}: {e}")))?;
    }
    let mut geometry = Geometry::default();
    let read = records::import(file, &choices, &mut geometry).map_err(|e| Fault::Input(e.to_string()))?;
    let comments = vec![format!("read from {} by fct {}", file.display(), env!("CARGO_PKG_VERSION"))];
    let tests = read.tests.iter().map(|t| (t.name.clone(), t.kind.clone(), t.csv(&comments))).collect();
    Ok((tests, serde_json::to_string(&read)?))
}
