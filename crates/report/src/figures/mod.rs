//! The figures of a run as SVG: curves with their misfit, convergence, the tear path.

mod convergence;
mod curve;
mod export;
mod forest;
mod path;
mod record;
mod staircase;
mod style;

pub(crate) use convergence::shown_parameters;
pub use export::{ending, export, offered};
pub use forest::{ForestGroup, ForestRow, forest};
pub use record::{Channels, of_record};
pub use staircase::figure as staircase;

use crate::answer::IdentifyAnswer;
use crate::html::{FittedModel, View};
use crate::runs::StoredRun;
use crate::{Curve, ReportError};

/// A figure: name without ending, SVG text.
#[derive(Clone, Debug)]
pub struct Figure {
    /// File name without ending.
    pub name: String,
    /// What it shows.
    pub caption: String,
    /// The SVG.
    pub svg: String,
}

/// Figures of an identification: one per test (the paper's Fig. 5), strength along the path,
/// convergence (Fig. 6).
///
/// # Errors
/// If one cannot be drawn.
pub fn of_identify(answer: &IdentifyAnswer, curves: &[Curve]) -> Result<Vec<Figure>, ReportError> {
    let mut out = of_curves(curves)?;
    out.extend(path::figure(answer)?);
    out.extend(convergence::figure(answer)?);
    Ok(out)
}

/// Every figure of a stored run: redrawn from its answer and curves, pictures of the strip as stored. Of
/// a search: the last rung and the ladder.
///
/// # Errors
/// If one cannot be drawn.
pub fn of_run(run: &StoredRun) -> Result<Vec<Figure>, ReportError> {
    let view = View::of(run, &run.path)?;
    let mut out = match view.fitted_models.get(view.shown) {
        Some(fitted_model) => of_identify(&fitted_model.answer, &fitted_model.curves)?,
        None => of_curves(&run.curves()?)?,
    };
    let fitted_models: Vec<(String, f64)> = view.fitted_models.iter().map(|r| (r.name(), r.rms())).collect();
    out.extend(staircase(&fitted_models, view.fitted_models.first().map_or(0.0, FittedModel::noise))?);
    let tests = run.answer.get("tests").and_then(serde_json::Value::as_object);
    let names = view.fitted_models.last().map(|r| r.answer.tests.keys().cloned().collect::<Vec<_>>());
    let names = names.unwrap_or_else(|| tests.into_iter().flat_map(|t| t.keys().cloned()).collect());
    for name in names.iter().map(|n| format!("{n}-S22")) {
        let file = format!("figures/{name}.svg");
        if run.holds(&file) {
            let svg = run.text(&file)?;
            out.push(Figure { name, caption: String::new(), svg });
        }
    }
    Ok(out)
}

/// Figures of curves, one per test.
///
/// # Errors
/// If one cannot be drawn.
pub fn of_curves(curves: &[Curve]) -> Result<Vec<Figure>, ReportError> {
    curves.iter().filter(|c| c.time.len() > 1).map(curve::figure).collect()
}

/// Draws into a string; the plotting library's errors get the figure's name.
fn draw<E: std::fmt::Display>(
    name: &str,
    caption: String,
    size: (u32, u32),
    paint: impl FnOnce(&style::Area) -> Result<(), E>,
) -> Result<Figure, ReportError> {
    use plotters::prelude::{IntoDrawingArea, SVGBackend};
    let fault =
        |e: &dyn std::fmt::Display| ReportError::Figure { name: name.to_owned(), reason: e.to_string() };
    let mut svg = String::new();
    {
        let area = SVGBackend::with_string(&mut svg, size).into_drawing_area();
        area.fill(&style::PAPER).map_err(|e| fault(&e))?;
        paint(&area).map_err(|e| fault(&e))?;
        area.present().map_err(|e| fault(&e))?;
    }
    Ok(Figure { name: name.to_owned(), caption, svg })
}
