//! Studies: the plan, one task, how it stands, the page.

use crate::errors::Fault;
use crate::task::run;
use campaign::{Observation, Plan, Tools, csv_files, methods, page, pooled, read_or_plan, status, summary};
use pyo3::prelude::*;
use std::path::PathBuf;

/// Plans a study and stores the plan: its folder, the plan as JSON.
#[pyfunction]
pub fn campaign_plan(py: Python<'_>, study: PathBuf) -> PyResult<(PathBuf, String)> {
    let planned = py.detach(|| -> Result<_, Fault> {
        let (plan, folder) = Plan::of(&study, &effects::catalogue())?;
        plan.store(&folder)?;
        Ok((folder.path().to_owned(), serde_json::to_string(&plan)?))
    });
    planned.map_err(|fault| fault.raised(py))
}

/// Tries the task of a key, and says what became of it: `done`, `failed`, `before` (it had a result), `elsewhere`
/// (somebody works on it), `set_aside`, `waits` (for the fit it repeats).
#[pyfunction]
#[pyo3(signature = (folder, key, threads=None))]
pub fn campaign_attempt(
    py: Python<'_>,
    folder: PathBuf,
    key: String,
    threads: Option<usize>,
) -> PyResult<String> {
    run(py, threads, None, move |wire| {
        let catalogue = effects::catalogue();
        let (plan, folder) = read_or_plan(&folder, &catalogue)?;
        let task = plan.tasks.iter().find(|t| t.key == key);
        let task = task.ok_or_else(|| Fault::Input(format!("no task of this study has the key {key}")))?;
        let (note, stops) = (|_: &str| {}, || wire.stops());
        let tools = Tools { catalogue: &catalogue, watch: &stops, note: &note };
        match campaign::attempt(&plan, &folder, task, tools)? {
            campaign::Went::Changed(why) => Err(Fault::Input(why)),
            went => Ok(went.word().to_owned()),
        }
    })
}

/// How a study stands, as JSON.
#[pyfunction]
pub fn campaign_status(py: Python<'_>, study: PathBuf) -> PyResult<String> {
    let told = py.detach(|| -> Result<_, Fault> {
        let (plan, folder) = read_or_plan(&study, &effects::catalogue())?;
        Ok(serde_json::to_string(&status(&plan, &folder))?)
    });
    told.map_err(|fault| fault.raised(py))
}

/// What a study says: the summary as JSON, the page, the methods, its tables.
#[pyfunction]
#[allow(clippy::type_complexity)]
pub fn campaign_report(
    py: Python<'_>,
    study: PathBuf,
) -> PyResult<(String, String, String, Vec<(String, String)>)> {
    let told = py.detach(|| -> Result<_, Fault> {
        let (plan, folder) = read_or_plan(&study, &effects::catalogue())?;
        let all = summary(&plan, &folder);
        let tables = csv_files(&all)?.into_iter();
        let tables =
            tables.map(|(name, bytes)| (name.to_owned(), String::from_utf8_lossy(&bytes).into_owned()));
        Ok((serde_json::to_string(&all)?, page(&all), methods(&all), tables.collect()))
    });
    told.map_err(|fault| fault.raised(py))
}

/// A random-effects model over values with their standard errors, as JSON.
#[pyfunction]
pub fn campaign_pooled(py: Python<'_>, values: Vec<f64>, std_errors: Vec<f64>) -> PyResult<String> {
    let all: Vec<Observation> =
        values.iter().zip(&std_errors).map(|(&value, &std_error)| Observation { value, std_error }).collect();
    let told = match pooled(&all) {
        Some(p) if values.len() == std_errors.len() => serde_json::to_string(&p).map_err(Fault::from),
        _ => Err(Fault::Input(
            "expected as many values as standard errors, at least one, all finite, the errors above 0".into(),
        )),
    };
    told.map_err(|fault| fault.raised(py))
}
