//! For a start from which a tear cannot be followed to the end of its record (too stiff a strip, too brittle a path):
//! the strip's stiffness comes from the record's very beginning, then the path gets weaker and tougher until it holds to
//! the end, and is fitted to the record from there.

use crate::data::Measured;
use crate::identify::{AnalysisError, Stage, Work, coarser};
use crate::start::{START_NOISE, Start, from_record};
use input::{Case, Record};
use inverse::Problem as _;
use model::{Catalogue, Model, Site};
use std::sync::Arc;

/// Parts of the largest displacement that count as the very beginning: the first that can be followed.
const BEGINNINGS: [f64; 3] = [0.03, 0.06, 0.12];

/// Factors of the strength: a weaker path of the same toughness tears over a longer zone, which every mesh resolves.
const WEAKER: [f64; 6] = [1.0, 0.5, 0.25, 0.12, 0.06, 0.03];

/// A start for the whole record, found on a coarse mesh. `None`: the file's values are one, or none was found.
pub(crate) fn feasible_start(
    case: &Arc<Case>,
    catalogue: &Catalogue,
    work: &mut Work,
) -> Result<Option<Start>, AnalysisError> {
    let tearing = case.tests.iter().any(|t| t.kind.tears && t.record.is_some());
    let Ok(model) = part_of(case, 1.0, catalogue) else { return Ok(None) };
    let path = model.free_on(Site::Interface);
    if !tearing || path.is_empty() || follows(&model, &model.theta(), work)? {
        return Ok(None);
    }
    let theta_of_work = std::mem::replace(&mut work.theta, model.theta());
    work.coarse_noise = START_NOISE;
    stiffness(case, catalogue, work)?;
    let mut start = None;
    if holding(case, &model, work)?
        && work.stage(&model, Stage::Interface, &path, &model.recorded(), true).is_ok()
    {
        start = Some(Start { theta: work.theta.clone(), model });
    }
    work.theta = theta_of_work;
    work.coarse_noise = 0.0;
    Ok(start)
}

/// The bulk alone from the very beginning of the tearing records, where the path still holds: a strip that is several
/// times too stiff would be taken for a soft path.
fn stiffness(case: &Case, catalogue: &Catalogue, work: &mut Work) -> Result<(), AnalysisError> {
    for part in BEGINNINGS {
        let Ok(model) = part_of(case, part, catalogue) else { continue };
        let bulk = model.free_on(Site::Bulk);
        if !bulk.is_empty() && follows(&model, &work.theta, work)? {
            // Without: the file's stiffness.
            let _ = work.stage(&model, Stage::Bulk, &bulk, &model.recorded(), true);
            break;
        }
    }
    Ok(())
}

/// Whether a path was found that holds to the end: the file's toughness or the record's, and weaker and weaker.
fn holding(case: &Case, model: &Model, work: &mut Work) -> Result<bool, AnalysisError> {
    let given = work.theta.clone();
    let tough = from_record(case).0;
    for gc in [None, Some(tough)] {
        for weaker in WEAKER {
            work.theta.clone_from(&given);
            for (i, p) in model.parameters.iter().enumerate().filter(|(_, p)| p.free) {
                let value = match (p.path.rsplit_once('.'), gc) {
                    (Some((_, "sigma_c")), _) => weaker * given[i],
                    (Some((_, "gc")), Some(gc)) => gc,
                    _ => continue,
                };
                work.theta[i] = value.clamp(p.spec.lower, p.spec.upper);
            }
            if follows(model, &work.theta, work)? {
                return Ok(true);
            }
        }
    }
    Ok(false)
}

/// The model on a coarse mesh, its tearing records up to this part of their largest displacement.
fn part_of(case: &Case, part: f64, catalogue: &Catalogue) -> Result<Model, AnalysisError> {
    let (mut shorter, how) = coarser(case);
    for t in shorter.tests.iter_mut().filter(|t| t.kind.tears) {
        let peak = t.record.iter().flat_map(|r| &r.force).fold(0.0f64, |m, f| m.max(f.abs()));
        // A few points do not tell their noise.
        t.force_sd = t.force_sd.or(Some(START_NOISE * peak));
        t.record = t.record.as_ref().map(|r| first(r, part));
    }
    Ok(Model::new(Arc::new(shorter), catalogue, how)?)
}

/// The rows before a record first goes beyond a part of its largest displacement; force only.
fn first(record: &Record, part: f64) -> Record {
    let most = record.displacement.iter().fold(0.0f64, |m, u| m.max(*u));
    let beyond = record.displacement.iter().position(|u| *u > part * most * (1.0 + 1e-12));
    let mut r = record.clone();
    (r.grip_displacement, r.tear_front, r.width_change) = (None, None, None);
    r.truncate(beyond.unwrap_or(record.len()).max(2));
    r
}

/// Whether the model runs to the end of its records.
fn follows(model: &Model, theta: &[f64], work: &Work) -> Result<bool, AnalysisError> {
    let Ok(measured) = Measured::of(model, &model.recorded()) else { return Ok(false) };
    let problem = work.trial(model, theta, &[], &measured.slots, work.search);
    match problem.predict(&[], false) {
        Ok(_) => Ok(true),
        Err(inverse::PredictError::Interrupted) => Err(inverse::PredictError::Interrupted.into()),
        Err(_) => Ok(false),
    }
}
