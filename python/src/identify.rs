//! Check, identify, diagnose, discover, simulate: the analyses of the command on a file.

use crate::errors::Fault;
use crate::task::{Wire, run};
use analysis::{Control, Meter, Metered, NoJournal, SimulateControl};
use input::Case;
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use report::Curve;
use report::answer::{Evaluator, IdentifyAnswer, SimulateAnswer, fitted_case};
use serde_json::json;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Instant;

/// Columns as bytes of doubles.
type Columns = Vec<(String, Py<PyBytes>)>;

/// A curve: test, columns, names of its segments, derivatives of the force by each free parameter.
pub type PyCurve = (String, Columns, Vec<String>, Columns);

/// Derivatives of a test's force by each free parameter: (test, [(path, one value per row)]).
type Slopes = Vec<(String, Vec<(String, Vec<f64>)>)>;

/// An answer as JSON, and its curves.
type Answer = (String, Vec<PyCurve>);

/// Reads a case, its records fit to be fitted.
fn fitted(file: &Path) -> Result<Arc<Case>, Fault> {
    let catalogue = ::effects::catalogue();
    let case = Arc::new(input::read_case(file, &catalogue)?);
    let (faults, _) = analysis::needs(&case, &catalogue);
    let faults: Vec<String> = faults.iter().map(|(place, f)| format!("{place}: error: {f}")).collect();
    if faults.is_empty() { Ok(analysis::condensed(&case)) } else { Err(Fault::Input(faults.join("\n"))) }
}

/// The resolved configuration as TOML, and warnings.
#[pyfunction]
pub fn check(py: Python<'_>, file: PathBuf) -> PyResult<(String, Vec<String>)> {
    let read = py.detach(|| input::read_case(&file, &::effects::catalogue()));
    let case = read.map_err(|d| Fault::from(d).raised(py))?;
    Ok((input::resolved_toml(&case), case.warnings.iter().map(ToString::to_string).collect()))
}

/// Every effect's card as JSON.
#[pyfunction]
pub fn effects() -> String {
    let cards: Vec<_> = ::effects::catalogue()
        .iter()
        .map(|e| {
            let c = e.card();
            json!({ "name": c.name, "site": c.site.word(), "summary": c.summary, "law": c.law,
                "reference": c.reference, "parameters": e.parameters(&model::Options::new()) })
        })
        .collect();
    json!(cards).to_string()
}

/// The answer of `fct identify --json`, and the curves.
#[pyfunction]
#[pyo3(signature = (file, threads=None, progress=None))]
pub fn identify(
    py: Python<'_>,
    file: PathBuf,
    threads: Option<usize>,
    progress: Option<Py<PyAny>>,
) -> PyResult<Answer> {
    let (json, curves) = run(py, threads, progress, move |wire| {
        let case = fitted(&file)?;
        let (answer, curves) = identified(&case, wire)?;
        Ok((serde_json::to_string(&answer)?, curves))
    })?;
    Ok((json, in_python(py, &curves)))
}

fn identified(case: &Arc<Case>, wire: &Wire) -> Result<(IdentifyAnswer, Curves), Fault> {
    let published = report::Published::of(case)?;
    let catalogue = ::effects::catalogue();
    let (begun, meter) = (Instant::now(), Meter::new(true));
    let stops = || wire.stops();
    let metered = Metered::new(&stops, &meter);
    let watch = |p: &analysis::Progress| wire.search(p);
    let control = Control { progress: &watch, cancelled: &metered, journal: &NoJournal };
    let done = analysis::identify(case.clone(), &catalogue, &control)?;
    let still = SimulateControl { progress: &|_, _| {}, cancelled: &metered };
    let replayed = analysis::replay(&done, &still)?;
    let mut answer = IdentifyAnswer::new(&done, &replayed, published.as_ref(), begun.elapsed().as_secs_f64());
    answer.cost = meter.spent();
    Ok((answer, (report::identified_curves(&done, &replayed), slopes(&done))))
}

/// The answer of `fct diagnose --json` at the file's values.
#[pyfunction]
#[pyo3(signature = (file, values=Vec::new(), threads=None, progress=None))]
pub fn diagnose(
    py: Python<'_>,
    file: PathBuf,
    values: Vec<(String, f64)>,
    threads: Option<usize>,
    progress: Option<Py<PyAny>>,
) -> PyResult<String> {
    run(py, threads, progress, move |wire| {
        let mut case = (*fitted(&file)?).clone();
        if !values.is_empty() {
            analysis::stay_at(&mut case, values.iter().map(|(p, v)| (p.as_str(), *v)));
        }
        let (note, stops) = (|s: &str| wire.tell(s), || wire.stops());
        let answer = analysis::diagnose(Arc::new(case), &::effects::catalogue(), &note, &stops, &NoJournal)?;
        Ok(serde_json::to_string(&answer)?)
    })
}

/// The answer of `fct discover --json`, that of `fct identify --json` for the model it chose, and its curves.
#[pyfunction]
#[pyo3(signature = (file, threads=None, progress=None))]
pub fn discover(
    py: Python<'_>,
    file: PathBuf,
    threads: Option<usize>,
    progress: Option<Py<PyAny>>,
) -> PyResult<(String, Option<String>, Vec<PyCurve>)> {
    let (json, last, curves) = run(py, threads, progress, move |wire| {
        let case = fitted(&file)?;
        let catalogue = ::effects::catalogue();
        let (note, stops, meter) = (|s: &str| wire.tell(s), || wire.stops(), Meter::new(true));
        let metered = Metered::new(&stops, &meter);
        let mut found = analysis::discover(case.clone(), &catalogue, &note, &metered, &NoJournal)?;
        let case = found.case.clone();
        let one = analysis::one_strength(&case, &catalogue, &found, &note, &metered, &NoJournal);
        found.one_strength = one.unwrap_or_else(|why| {
            wire.tell(format!("one strength along the path could not be tried: {why}"));
            None
        });
        found.words.extend(found.one_strength.iter().map(|o| o.words.clone()));
        let published = report::Published::of(&case)?;
        let evaluator =
            Evaluator { published: published.as_ref(), catalogue: &catalogue, journal: &NoJournal };
        let last = match found.ladder.last() {
            Some(row) => {
                Some(evaluator.fitted_model(&fitted_case(&case, row, None), &metered, |why| {
                    wire.tell(why.to_string())
                })?)
            }
            None => None,
        };
        found.cost = meter.spent();
        let curves =
            last.as_ref().map(|l| (report::identified_curves(&l.done, &l.replayed), slopes(&l.done)));
        let curves = curves.unwrap_or_default();
        let last = last.map(|l| serde_json::to_string(&l.answer)).transpose()?;
        Ok((serde_json::to_string(&found)?, last, curves))
    })?;
    Ok((json, last, in_python(py, &curves)))
}

/// The answer of `fct simulate --json`.
#[pyfunction]
#[pyo3(signature = (file, threads=None, progress=None))]
pub fn simulate(
    py: Python<'_>,
    file: PathBuf,
    threads: Option<usize>,
    progress: Option<Py<PyAny>>,
) -> PyResult<String> {
    run(py, threads, progress, move |wire| {
        let catalogue = ::effects::catalogue();
        let case = Arc::new(input::read_case(&file, &catalogue)?);
        let begun = Instant::now();
        let steps = |done: usize, total: usize| wire.tell(format!("step {done} of {total}"));
        let stops = || wire.stops();
        let control = SimulateControl { progress: &steps, cancelled: &stops };
        let done = analysis::simulate(case, &catalogue, &control)?;
        Ok(serde_json::to_string(&SimulateAnswer::new(&done, begun.elapsed().as_secs_f64()))?)
    })
}

type Curves = (Vec<Curve>, Slopes);

/// Derivatives of every test's force by the free parameters, in the units of their answers.
fn slopes(done: &analysis::Identified) -> Slopes {
    let Some(jacobian) = done.fit.prediction.jacobian.as_ref() else { return Slopes::new() };
    let shown: Vec<usize> = (0..done.free.len()).filter(|&k| !done.model.is_hidden(done.free[k])).collect();
    let forces = done.measured.data.blocks.iter().zip(&done.measured.slots);
    forces
        .filter(|(_, slot)| slot.channel == model::Channel::Force)
        .map(|(block, slot)| {
            let column = |&k: &usize| {
                let values = block.range.clone().map(|at| jacobian[(at, k)]).collect();
                (done.free_parameters[k].path.clone(), values)
            };
            (done.model.tests[slot.test].test.name.clone(), shown.iter().map(column).collect())
        })
        .collect()
}

/// Curves as bytes that arrays are laid over without a copy.
fn in_python(py: Python<'_>, (curves, slopes): &Curves) -> Vec<PyCurve> {
    let of = |c: &Curve| slopes.iter().find(|s| s.0 == c.test).map_or(&[][..], |s| &s.1);
    curves.iter().map(|c| one(py, c, of(c))).collect()
}

fn one(py: Python<'_>, c: &Curve, slopes: &[(String, Vec<f64>)]) -> PyCurve {
    let bytes = |x: &mut dyn Iterator<Item = f64>| {
        let raw: Vec<u8> = x.flat_map(f64::to_ne_bytes).collect();
        PyBytes::new(py, &raw).unbind()
    };
    let plain = |x: &[f64]| bytes(&mut x.iter().copied());
    let mut columns = vec![
        ("time_s".to_owned(), plain(&c.time)),
        ("displacement_mm".to_owned(), plain(&c.displacement)),
        ("force_measured_N".to_owned(), plain(&c.measured)),
        ("force_model_N".to_owned(), plain(&c.model)),
        ("residual_N".to_owned(), plain(&c.residual())),
    ];
    columns.extend(
        c.columns.iter().map(|(name, x)| (name.clone(), bytes(&mut x.iter().map(|v| v.unwrap_or(f64::NAN))))),
    );
    let slopes = slopes.iter().map(|(path, x)| (path.clone(), plain(x))).collect();
    (c.test.clone(), columns, c.segment.clone(), slopes)
}
