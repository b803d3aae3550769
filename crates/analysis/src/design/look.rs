//! A look at records in seconds: the base fitted roughly on a coarse mesh, and the catalogue's columns there.

use super::engine::{Foresight, LOOK, Linear, coarsest, linear, model_of};
use super::equal_areas::with_equal_areas;
use super::guess::{fitted_roughly, guessed, with_strength};
use super::mesh_error::mesh_error;
use crate::data::Measured;
use crate::identify::AnalysisError;
use crate::problem::Cancelled;
use crate::start::Start;
use diagnose::Policy;
use input::Case;
use inverse::PredictError;
use model::Catalogue;
use std::sync::Arc;

/// Shares of the guessed strength that are tried until a run comes to the end of its records.
const STRENGTHS: [f64; 4] = [1.0, 0.6, 1.6, 0.3];
/// Effects that a first look tells.
const TOLD: usize = 3;
/// Share of χ² that an effect must take away to be told: the coarse mesh and the rough fit leave misfits of their own.
const STANDS_OUT: f64 = 0.2;

/// The base where the records put it roughly, with the catalogue's columns. The rough fit has few areas; what is asked
/// there has all, or the tear would be better known than it is.
fn at_records(case: &Case, catalogue: &Catalogue, cancelled: Cancelled) -> Result<Linear, AnalysisError> {
    let (model, _) = model_of(case, catalogue)?;
    let (whole, how) = coarsest(case, catalogue)?;
    let measured = Measured::conservative(&whole, &whole.recorded())?;
    let guess = guessed(&model);
    let mut few = Start { theta: guess.clone(), model };
    let mut last = None;
    for share in STRENGTHS {
        let theta = with_strength(&few.model, &guess, share);
        few.theta = fitted_roughly(&few.model, &theta, &measured, cancelled);
        let theta = few.spread_from(&whole, &whole.theta());
        match linear(&whole, (how, LOOK), &theta, measured.clone(), catalogue, cancelled) {
            Ok(linear) => return Ok(linear),
            Err(e) if cancelled.stops() => return Err(e),
            Err(e) => last = Some(e),
        }
    }
    Err(last.unwrap_or(AnalysisError::Case("no record".into())))
}

/// What the records of a case can show.
pub(crate) fn foresight_of_records(
    case: &Arc<Case>,
    catalogue: &Catalogue,
    cancelled: Cancelled,
) -> Result<Foresight, AnalysisError> {
    let case = crate::condensed(case);
    let linear = at_records(&case, catalogue, cancelled)?;
    let error = mesh_error(&case, catalogue, &linear, cancelled);
    let equal = with_equal_areas(&case, catalogue, &linear, cancelled);
    if cancelled.stops() {
        return Err(PredictError::Interrupted.into());
    }
    linear.foresight_of_fits((catalogue, &Policy::default()), &case, error.as_ref(), equal)
}

/// Which effects would take most of the misfit away, as a sentence: what a search says first, long before it knows.
///
/// # Errors
/// [`AnalysisError`] where the coarse model gives no answer, or the user stops it.
pub fn first_look(
    case: &Arc<Case>,
    catalogue: &Catalogue,
    cancelled: Cancelled,
) -> Result<String, AnalysisError> {
    let screen = at_records(&crate::condensed(case), catalogue, cancelled)?.screened()?;
    let told = screen.findings.iter().filter(|f| f.significant && f.expected_fall >= STANDS_OUT);
    let mut told: Vec<(f64, &str)> = told.map(|f| (f.expected_fall, f.effect.as_str())).collect();
    told.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(b.1)));
    let one = |(share, effect): &(f64, &str)| format!("{effect} {:.0} %", 100.0 * share);
    let list: Vec<String> = told.iter().take(TOLD).map(one).collect();
    Ok(if list.is_empty() {
        "First look, by a rough fit on a coarse mesh: no effect stands out".into()
    } else {
        format!(
            "First look, by a rough fit on a coarse mesh, no answer yet: of χ² takes away {}",
            list.join(", ")
        )
    })
}
