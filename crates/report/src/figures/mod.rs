//! The figures of a run as SVG: curves with their misfit, convergence, the tear path.

mod convergence;
mod curve;
mod path;
mod style;

pub use style::for_html;

use crate::answer::IdentifyAnswer;
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
