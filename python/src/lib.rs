//! `fct._fct`: the engine behind the Python package. Answers are the JSON documents of the command, to the last bit of
//! every number; curves are arrays of doubles. Everything that computes lets go of the interpreter.

mod errors;
mod identify;
mod records;
mod study;
mod task;

use pyo3::prelude::*;

/// The module.
#[pymodule]
fn _fct(m: &Bound<'_, PyModule>) -> PyResult<()> {
    m.add("__version__", env!("CARGO_PKG_VERSION"))?;
    errors::add(m)?;
    m.add_function(wrap_pyfunction!(identify::check, m)?)?;
    m.add_function(wrap_pyfunction!(identify::identify, m)?)?;
    m.add_function(wrap_pyfunction!(identify::diagnose, m)?)?;
    m.add_function(wrap_pyfunction!(identify::discover, m)?)?;
    m.add_function(wrap_pyfunction!(identify::simulate, m)?)?;
    m.add_function(wrap_pyfunction!(identify::effects, m)?)?;
    m.add_function(wrap_pyfunction!(records::import_record, m)?)?;
    m.add_function(wrap_pyfunction!(study::campaign_plan, m)?)?;
    m.add_function(wrap_pyfunction!(study::campaign_attempt, m)?)?;
    m.add_function(wrap_pyfunction!(study::campaign_status, m)?)?;
    m.add_function(wrap_pyfunction!(study::campaign_report, m)?)?;
    m.add_function(wrap_pyfunction!(study::campaign_pooled, m)?)?;
    Ok(())
}
