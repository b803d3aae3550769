//! Exceptions with the text of the command's messages.

use analysis::AnalysisError;
use campaign::CampaignError;
use input::Diagnostics;
use pyo3::create_exception;
use pyo3::exceptions::{PyException, PyKeyboardInterrupt};
use pyo3::prelude::*;
use pyo3::types::PyTuple;

create_exception!(fct, FctError, PyException, "Why fct gave no answer.");
create_exception!(
    fct,
    InputError,
    FctError,
    "Bad input. `faults` lists each fault with file, line, column, key, message and help."
);
create_exception!(fct, ComputeError, FctError, "The input is good, but could not be computed.");
create_exception!(
    fct,
    Interrupted,
    PyKeyboardInterrupt,
    "Stopped by Ctrl-C. `best` holds the values of the search's best run so far by parameter path (mm, N, s, MPa, rad)."
);

/// Adds them to the module.
pub fn add(m: &Bound<'_, PyModule>) -> PyResult<()> {
    m.add("FctError", m.py().get_type::<FctError>())?;
    // What is raised in Python itself has no faults of files.
    m.py().get_type::<InputError>().setattr("faults", PyTuple::empty(m.py()))?;
    m.add("InputError", m.py().get_type::<InputError>())?;
    m.add("ComputeError", m.py().get_type::<ComputeError>())?;
    m.add("Interrupted", m.py().get_type::<Interrupted>())
}

/// What went wrong where no interpreter is held.
pub enum Fault {
    /// Files, with every fault.
    Files(Diagnostics),
    /// Bad input.
    Input(String),
    /// Not computable.
    Compute(String),
}

impl From<Diagnostics> for Fault {
    fn from(d: Diagnostics) -> Self {
        Self::Files(d)
    }
}

impl From<AnalysisError> for Fault {
    fn from(e: AnalysisError) -> Self {
        match e {
            AnalysisError::Build(_) | AnalysisError::Record(_) | AnalysisError::Case(_) => {
                Self::Input(e.to_string())
            }
            _ => Self::Compute(e.to_string()),
        }
    }
}

impl From<CampaignError> for Fault {
    fn from(e: CampaignError) -> Self {
        match e {
            CampaignError::Study(d) => Self::Files(d),
            CampaignError::Files(e) => Self::Compute(e.to_string()),
            other => Self::Input(other.to_string()),
        }
    }
}

impl From<report::ReportError> for Fault {
    fn from(e: report::ReportError) -> Self {
        Self::Compute(e.to_string())
    }
}

impl From<serde_json::Error> for Fault {
    fn from(e: serde_json::Error) -> Self {
        Self::Compute(e.to_string())
    }
}

impl Fault {
    /// The exception.
    pub fn raised(self, py: Python<'_>) -> PyErr {
        match self {
            Self::Compute(text) => ComputeError::new_err(text),
            Self::Input(text) => with_faults(py, InputError::new_err(text), "[]"),
            Self::Files(d) => {
                let faults = serde_json::to_string(&d).unwrap_or_else(|_| "[]".into());
                with_faults(py, InputError::new_err(d.to_string()), &faults)
            }
        }
    }
}

/// The exception with its faults as a list of dictionaries.
fn with_faults(py: Python<'_>, error: PyErr, json: &str) -> PyErr {
    let faults = py.import("json").and_then(|m| m.call_method1("loads", (json,)));
    let set = faults.and_then(|f| error.value(py).setattr("faults", f));
    set.map_or_else(|e| e, |()| error)
}
