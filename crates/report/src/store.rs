//! What goes into the run directory of each command.

use crate::answer::{IdentifyAnswer, SCHEMA, SimulateAnswer, StageHistory};
use crate::curves::{identified_curves, simulated_curve};
use crate::fields::{Snapshot, pictures, snapshots, write_fields};
use crate::figures::{self, Figure, ending, export};
use crate::runs::{RunInfo, StoredRun};
use crate::synthetic::synthetic_files;
use crate::tables::{history_csv, jacobian_csv};
use crate::{Curve, ReportError, RunDir, html};
use analysis::{Identified, LadderRow, Simulated, SimulatedTest};
use input::{Case, Figure as Format};
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
    fields(dir, case, &snapshots(&done.model, &done.theta, &done.tests, case.output.fields))?;
    figure_files(dir, &figures::of_curves(&curves)?, &case.output.figures)?;
    if let Some(share) = case.output.noise {
        for (name, content) in synthetic_files(case, answer, share, case.output.seed)? {
            dir.write(name, &content)?;
        }
    }
    page(dir)
}

/// Fills the directory of a search for missing effects; returns the answer as JSON. `top`: the last
/// rung, whose curves, fields and figures stand at the top.
///
/// # Errors
/// If the disk refuses.
pub fn store_discover(
    dir: &RunDir,
    case: &Case,
    answer: &analysis::DiscoverAnswer,
    top: Option<(&Identified, &[SimulatedTest], &IdentifyAnswer)>,
    info: &RunInfo,
) -> Result<Value, ReportError> {
    common(dir, case, answer, info)?;
    let json = serde_json::to_value(answer).unwrap_or(Value::Null);
    dir.write("diagnosis.json", format!("{json:#}\n").as_bytes())?;
    if let Some((done, replayed, found)) = top {
        let curves = identified_curves(done, replayed);
        curve_files(dir, &curves)?;
        fields(dir, case, &snapshots(&done.model, &done.theta, replayed, case.output.fields))?;
        let mut all = figures::of_identify(found, &curves)?;
        let fitted_models: Vec<(String, f64)> =
            answer.ladder.iter().map(|r| (fitted_name(r, &answer.ladder), r.rms_n)).collect();
        all.extend(figures::staircase(&fitted_models, noise(found))?);
        figure_files(dir, &all, &case.output.figures)?;
    }
    page(dir)?;
    Ok(json)
}

/// A rung in words: what it has beside the first.
fn fitted_name(row: &LadderRow, ladder: &[LadderRow]) -> String {
    let parts = row.laws.parts(&ladder.first().unwrap_or(row).laws, &row.effects);
    if parts.is_empty() { "base".into() } else { parts.join(" + ") }
}

/// Noise over all force points, N.
fn noise(a: &IdentifyAnswer) -> f64 {
    let points: f64 = a.tests.values().map(|t| t.points as f64).sum();
    let squares: f64 = a.tests.values().map(|t| t.noise_N.powi(2) * t.points as f64).sum();
    (squares / points.max(1.0)).sqrt()
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
    let curves = fitted_model(dir, done, case, replayed, answer, info)?;
    fields(dir, case, &snapshots(&done.model, &done.theta, replayed, case.output.fields))?;
    figure_files(dir, &figures::of_identify(answer, &curves)?, &case.output.figures)?;
    page(dir)
}

/// Fills the directory of a rung of a search: what a ladder needs, pictures of the strip, no VTU files.
///
/// # Errors
/// If the disk refuses.
pub fn store_fitted_model(
    dir: &RunDir,
    done: &Identified,
    case: &Case,
    replayed: &[SimulatedTest],
    answer: &IdentifyAnswer,
    info: &RunInfo,
) -> Result<(), ReportError> {
    fitted_model(dir, done, case, replayed, answer, info)?;
    let strips = pictures(&snapshots(&done.model, &done.theta, replayed, case.output.fields));
    strips.iter().try_for_each(|(name, svg)| dir.write(format!("figures/{name}.svg"), svg.as_bytes()))
}

fn fitted_model(
    dir: &RunDir,
    done: &Identified,
    case: &Case,
    replayed: &[SimulatedTest],
    answer: &IdentifyAnswer,
    info: &RunInfo,
) -> Result<Vec<Curve>, ReportError> {
    common(dir, case, answer, info)?;
    let curves = identified_curves(done, replayed);
    curve_files(dir, &curves)?;
    dir.write("jacobian.csv", &jacobian_csv(done)?)?;
    dir.write("history.csv", &history_csv(&answer.history)?)?;
    Ok(curves)
}

fn curve_files(dir: &RunDir, curves: &[Curve]) -> Result<(), ReportError> {
    curves.iter().try_for_each(|c| dir.write(format!("curves/{}.csv", c.test), &c.csv()?))
}

/// VTU files and the pictures made of the same fields. A picture is always there as SVG: the page shows it.
fn fields(dir: &RunDir, case: &Case, all: &[(String, Vec<Snapshot>)]) -> Result<(), ReportError> {
    write_fields(dir, all)?;
    for (name, svg) in pictures(all) {
        dir.write(format!("figures/{name}.svg"), svg.as_bytes())?;
        let figure = Figure { name, caption: String::new(), svg };
        figure_files(dir, &[figure], &case.output.figures)?;
    }
    Ok(())
}

fn figure_files(dir: &RunDir, figures: &[Figure], formats: &[Format]) -> Result<(), ReportError> {
    exported(figures, formats)?.iter().try_for_each(|(name, content)| dir.write(name, content))
}

/// Each figure alone, in each of the formats: its path in a run directory, and the file.
///
/// # Errors
/// If a figure cannot be converted.
pub fn exported(figures: &[Figure], formats: &[Format]) -> Result<Vec<(String, Vec<u8>)>, ReportError> {
    let one = |figure: &Figure, format| {
        Ok((format!("figures/{}.{}", figure.name, ending(format)), export(figure, format)?))
    };
    figures.iter().flat_map(|figure| formats.iter().map(move |&format| one(figure, format))).collect()
}

/// `report.html` from what was written so far.
fn page(dir: &RunDir) -> Result<(), ReportError> {
    let run = StoredRun::read_part(dir.part())?;
    let run = run.in_folder(dir.place());
    dir.write("report.html", html::page(&run, dir.part())?.as_bytes())
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
    store_unfinished(dir, case, partial, info)?;
    dir.write("history.csv", &history_csv(&partial.history)?)
}

/// The same for a search of which there is no history: its input, what is known so far, and the page.
///
/// # Errors
/// If the disk refuses.
pub fn store_unfinished<T: Serialize>(
    dir: &RunDir,
    case: &Case,
    partial: &T,
    info: &RunInfo,
) -> Result<(), ReportError> {
    common(dir, case, partial, info)?;
    page(dir)
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
