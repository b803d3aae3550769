//! What goes into the run directory of each command.

use crate::answer::{IdentifyAnswer, SCHEMA, SimulateAnswer, StageHistory};
use crate::curves::{identified_curves, simulated_curve};
use crate::fields::{snapshots, write_fields};
use crate::figures::{self, Figure};
use crate::runs::{RunInfo, StoredRun};
use crate::synthetic::synthetic_files;
use crate::tables::{history_csv, jacobian_csv};
use crate::{Curve, ReportError, RunDir, html};
use analysis::{Identified, Simulated, SimulatedTest};
use input::Case;
use serde::Serialize;
use serde_json::{Value, json};

/// Fills the directory of a simulation, complete or partial.
///
/// # Errors
/// If the disk refuses.
pub fn store_simulate(
    dir: &RunDir,
    done: &Simulated,
    answer: &SimulateAnswer,
    info: &RunInfo,
) -> Result<(), ReportError> {
    let case = &done.model.case;
    common(dir, case, answer, info)?;
    let curves: Vec<Curve> = answer.tests.iter().map(|(name, t)| simulated_curve(name, t)).collect();
    curve_files(dir, &curves)?;
    figure_files(dir, &figures::of_curves(&curves)?)?;
    write_fields(dir, &snapshots(&done.model, &done.theta, &done.tests, case.output.fields))?;
    if let Some(share) = case.output.noise {
        for (name, content) in synthetic_files(case, answer, share, case.output.seed)? {
            dir.write(name, &content)?;
        }
    }
    page(dir)
}

/// Fills the directory of a search for missing effects; returns the answer as JSON.
///
/// # Errors
/// If the disk refuses.
pub fn store_discover(
    dir: &RunDir,
    case: &Case,
    answer: &analysis::DiscoverAnswer,
    info: &RunInfo,
) -> Result<Value, ReportError> {
    common(dir, case, answer, info)?;
    let json = serde_json::to_value(answer).unwrap_or(Value::Null);
    dir.write("diagnosis.json", format!("{json:#}\n").as_bytes())?;
    Ok(json)
}

/// Fills the directory of a finished identification.
///
/// # Errors
/// If the disk refuses.
pub fn store_identify(
    dir: &RunDir,
    done: &Identified,
    replayed: &[SimulatedTest],
    answer: &IdentifyAnswer,
    info: &RunInfo,
) -> Result<(), ReportError> {
    let case = &done.model.case;
    common(dir, case, answer, info)?;
    let curves = identified_curves(done);
    curve_files(dir, &curves)?;
    figure_files(dir, &figures::of_identify(answer, &curves)?)?;
    dir.write("jacobian.csv", &jacobian_csv(done)?)?;
    dir.write("history.csv", &history_csv(&answer.history)?)?;
    write_fields(dir, &snapshots(&done.model, &done.theta, replayed, case.output.fields))?;
    page(dir)
}

fn curve_files(dir: &RunDir, curves: &[Curve]) -> Result<(), ReportError> {
    curves.iter().try_for_each(|c| dir.write(format!("curves/{}.csv", c.test), &c.csv()?))
}

fn figure_files(dir: &RunDir, figures: &[Figure]) -> Result<(), ReportError> {
    figures.iter().try_for_each(|f| dir.write(format!("figures/{}.svg", f.name), f.svg.as_bytes()))
}

/// `report.html` from what was written so far.
fn page(dir: &RunDir) -> Result<(), ReportError> {
    let run = StoredRun::read(dir.part())?;
    dir.write(
        "report.html",
        html::page(&StoredRun { path: dir.place().to_owned(), ..run.clone() }, &run.curves())?.as_bytes(),
    )
}

/// A search that was interrupted or could not go on.
#[derive(Clone, Debug, Serialize)]
pub struct Partial {
    /// Layout version.
    pub schema: u32,
    /// Name of the specimen.
    pub specimen: String,
    /// Never true here.
    pub complete: bool,
    /// Why it ended.
    pub stopped_because: String,
    /// Best values so far, by path.
    pub parameters: Value,
    /// Runs so far.
    pub history: Vec<StageHistory>,
}

impl Partial {
    /// The state of a search from its runs so far.
    pub fn new(case: &Case, history: Vec<StageHistory>, why: &str) -> Self {
        let mut best = serde_json::Map::new();
        for h in &history {
            if let Some(run) = h.runs.iter().rev().find(|r| r.accepted) {
                for (path, v) in h.paths.iter().zip(&run.theta) {
                    best.insert(path.clone(), json!(v));
                }
            }
        }
        Self {
            schema: SCHEMA,
            specimen: case.name.clone(),
            complete: false,
            stopped_because: why.to_owned(),
            parameters: Value::Object(best),
            history,
        }
    }
}

/// Fills the directory of a search that did not come to its end.
///
/// # Errors
/// If the disk refuses.
pub fn store_partial(
    dir: &RunDir,
    case: &Case,
    partial: &Partial,
    info: &RunInfo,
) -> Result<(), ReportError> {
    common(dir, case, partial, info)?;
    dir.write("history.csv", &history_csv(&partial.history)?)
}

fn common<T: Serialize>(dir: &RunDir, case: &Case, answer: &T, info: &RunInfo) -> Result<(), ReportError> {
    dir.write("run.toml", input::resolved_toml(case).as_bytes())?;
    dir.write("summary.json", &summary(answer, info)?)
}

/// The answer with how it was made.
fn summary<T: Serialize>(answer: &T, info: &RunInfo) -> Result<Vec<u8>, ReportError> {
    let fault =
        |e: serde_json::Error| ReportError::NotARun { path: "summary.json".into(), reason: e.to_string() };
    let mut value = serde_json::to_value(answer).map_err(fault)?;
    if let Some(object) = value.as_object_mut() {
        object.insert("run".into(), serde_json::to_value(info).map_err(fault)?);
    }
    let mut out = serde_json::to_vec_pretty(&value).map_err(fault)?;
    out.push(b'\n');
    Ok(out)
}
