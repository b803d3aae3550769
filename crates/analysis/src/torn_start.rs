//! Where a search of a torn record begins, if the tear alone tells the bulk, or its file gives the mesh by divisions or each
//! area its own values. Where there is no intact strip's record, or the tear cannot be followed with the file's values, the starts are what the record itself
//! tells, each fitted on a coarse mesh: stiffness from its very beginning, with a path that holds; then, of paths whose
//! toughness and strength are told by its work and its peak force, the one that misses it least. The file's own values are one
//! start more.

use crate::data::Measured;
use crate::identify::{AnalysisError, Stage, TRIAL_BUDGET, Work, coarser};
use crate::start::{START_NOISE, Start, from_record};
use input::{Case, Record};
use inverse::{FitError, PredictError, Problem as _};
use model::{Catalogue, Model, Site};
use params::Quantity;
use std::sync::Arc;

/// Parts of the largest displacement that count as the beginning. What a straight beam tells in the first, tissue that stiffens
/// tells in the last.
const BEGINNINGS: [f64; 5] = [0.03, 0.06, 0.12, 0.25, 0.5];

/// χ² per point, at a start's noise, up to which the bulk alone explains a beginning.
const EXPLAINED: f64 = 2.0;

/// Strength, as a multiple of the record's, of a path that holds while the bulk is found: a strip that bends is far stronger
/// than its peak force over its ligament, and a path that is as weak as that leaves no compliance to the bulk.
const HOLDS: f64 = 64.0;

/// Shares of that bulk's stiffness from which a fit begins: what a record's beginning tells is little, and a strip that is too
/// stiff tears through.
const STIFFNESSES: [f64; 3] = [1.0, 0.5, 0.25];

/// Strengths and toughnesses, as multiples of the record's, among which a path is looked for. A weak path tears over a long
/// zone, which every mesh resolves; what the bulk takes of the work leaves less to the path.
const STRENGTHS: [f64; 4] = [1.0, 4.0, 16.0, 64.0];
const TOUGHNESSES: [f64; 2] = [1.0, 0.5];

/// A path that misses the records more than so many times as much as one that holds whatever happens, by sums of squares, does not
/// tear: it is no start as long as what tears was not followed for want of time.
const TEARS: f64 = 0.5;

/// Toughness and strength of a path that holds whatever happens, as multiples of the record's.
const UNBREAKABLE: f64 = 4096.0;

/// Newton iterations that a smooth tear needs.
const SMOOTH_BUDGET: usize = TRIAL_BUDGET / 5;

/// Elements along the pull that a coarse mesh keeps. An arm that bends through one or two is too stiff, and what is fitted with
/// it is no start for the given mesh.
const LAYERS: usize = 8;

/// The file's own values are a start where they miss the records by no more than so many times the sum of squares that the best
/// of the others does.
const AS_GOOD: f64 = 4.0;

/// A start that misses the record no more than this many times as much as the best is tried, too.
const NEAR: f64 = 1.5;

/// Starts for the whole records, the best first, found on a coarse mesh. `None`: the file's values are to be it, or none
/// was found.
pub(crate) fn torn_starts(
    case: &Arc<Case>,
    catalogue: &Catalogue,
    work: &mut Work,
) -> Result<Option<Vec<Arc<Start>>>, AnalysisError> {
    let by_area = case.interface.gc.len() > 1 || case.interface.sigma_c.len() > 1;
    // What a start has to tell is told by one area; where many stand, the fit on all of them finds.
    let mut simple = (**case).clone();
    if !by_area {
        simple.interface.areas = 1;
    }
    let case = &simple;
    let tearing = case.tests.iter().any(|t| t.kind.tears && t.record.is_some());
    let Ok(model) = part_of(case, 1.0, catalogue) else { return Ok(None) };
    if !tearing || model.free_on(Site::Interface).is_empty() {
        return Ok(None);
    }
    let given = model.theta();
    let missed_by_given = missed(&model, &given, work)?;
    // What an intact strip tells of the bulk its own stage finds.
    let intact = case.tests.iter().any(|t| !t.kind.tears && t.record.is_some());
    if (by_area || intact) && missed_by_given.is_some() {
        return Ok(None);
    }
    let theta_of_work = std::mem::replace(&mut work.theta, given.clone());
    (work.coarse_noise, work.by_record) = (START_NOISE, true);
    // What tears in many jumps is no good start, and takes many times as long.
    work.budget = SMOOTH_BUDGET;
    let mut found = fitted_from_known(&model, work);
    for (budget, most) in [(SMOOTH_BUDGET, TEARS), (TRIAL_BUDGET, f64::INFINITY)] {
        work.budget = budget;
        if found.as_ref().is_ok_and(Vec::is_empty) {
            found = candidates(case, catalogue, &model, (missed_by_given, most), work);
        }
    }
    work.budget = TRIAL_BUDGET;
    (work.coarse_noise, work.by_record) = (0.0, false);
    work.theta = theta_of_work;
    let mut found = found?;
    found.sort_by(|a, b| a.0.total_cmp(&b.0));
    let least = found.first().map_or(f64::INFINITY, |f| f.0);
    let near = found.into_iter().filter(|f| f.0 <= NEAR * least).take(2);
    let starts = near.map(|(_, theta)| Ok(Arc::new(Start { theta, model: part_of(case, 1.0, catalogue)? })));
    let starts: Vec<Arc<Start>> = starts.collect::<Result<_, AnalysisError>>()?;
    Ok(Some(starts).filter(|s| !s.is_empty()))
}

/// Bulk and path from where they stood without the effects that this model has more.
fn fitted_from_known(model: &Model, work: &mut Work) -> Result<Vec<Candidate>, AnalysisError> {
    let both: Vec<usize> = [model.free_on(Site::Bulk), model.free_on(Site::Interface)].concat();
    let mut found = Vec::new();
    for start in work.again.starts {
        work.theta = start.spread_from(model, &model.theta());
        found.extend(fitted(model, Stage::Joint, &both, work)?);
    }
    Ok(found)
}

/// Values with what they miss, by the objective at a start's noise.
type Candidate = (f64, Vec<f64>);

/// What the record tells, and what the file says where that misses the records no more. `most`: as [`looked_for`] has it; as long as it
/// is finite, the file is not asked where the record tells nothing.
fn candidates(
    case: &Case,
    catalogue: &Catalogue,
    model: &Model,
    (missed_by_given, most): (Option<f64>, f64),
    work: &mut Work,
) -> Result<Vec<Candidate>, AnalysisError> {
    let path = model.free_on(Site::Interface);
    work.theta = model.theta();
    path_by_record(model, from_record(case), (1.0, HOLDS), &mut work.theta);
    stiffness(case, catalogue, work)?;
    // What the record tells of effects their own fits find.
    let both: Vec<usize> = [model.free_on(Site::Bulk), path.clone()].concat();
    let (bulk, mut found) = (work.theta.clone(), Vec::new());
    for share in STIFFNESSES {
        work.theta.clone_from(&bulk);
        soften(model, share, &mut work.theta);
        if looked_for(model, from_record(case), most, work)? {
            found.extend(fitted(model, Stage::Joint, &both, work)?);
        }
    }
    let Some(by_given) = missed_by_given.filter(|_| !found.is_empty() || most.is_infinite()) else {
        return Ok(found);
    };
    let best = found.iter().min_by(|a, b| a.0.total_cmp(&b.0));
    let by_best = best.map(|(_, theta)| missed(model, theta, work)).transpose()?.flatten();
    if by_best.is_none_or(|m| by_given < AS_GOOD * m) {
        work.theta = model.theta();
        found.extend(fitted(model, Stage::Interface, &path, work)?);
    }
    Ok(found)
}

/// Fitted to the records from the present values, which it moves; `None` where they are no start.
fn fitted(
    model: &Model,
    stage: Stage,
    free: &[usize],
    work: &mut Work,
) -> Result<Option<Candidate>, AnalysisError> {
    match work.stage(model, stage, free, &model.recorded(), true) {
        Ok(f) => Ok(Some((f, work.theta.clone()))),
        Err(AnalysisError::Fit(FitError::Start(PredictError::NotComputable(_)))) => Ok(None),
        Err(e) => Err(e),
    }
}

/// Takes the path that misses the records least; whether one can be followed, and misses no more than so many times what one that
/// holds does. A fit from a path that is far off ends at the first jump of its tear.
fn looked_for(model: &Model, from: (f64, f64), most: f64, work: &mut Work) -> Result<bool, AnalysisError> {
    let with = |times: (f64, f64), work: &Work| {
        let mut theta = work.theta.clone();
        path_by_record(model, from, times, &mut theta);
        Ok::<_, AnalysisError>(missed(model, &theta, work)?.map(|m| (m, theta)))
    };
    let mut best: Option<Candidate> = None;
    for times in TOUGHNESSES.iter().flat_map(|t| STRENGTHS.map(|s| (*t, s))) {
        best = best.into_iter().chain(with(times, work)?).min_by(|a, b| a.0.total_cmp(&b.0));
    }
    let allowed = if most.is_finite() {
        with((UNBREAKABLE, UNBREAKABLE), work)?.map_or(f64::INFINITY, |c| most * c.0)
    } else {
        f64::INFINITY
    };
    let Some((_, theta)) = best.filter(|b| b.0 <= allowed) else { return Ok(false) };
    work.theta = theta;
    Ok(true)
}

/// A bulk of a share of its stiffness.
fn soften(model: &Model, share: f64, theta: &mut [f64]) {
    for i in model.free_on(Site::Bulk) {
        let spec = &model.parameters[i].spec;
        if spec.quantity == Quantity::Stress {
            theta[i] = (share * theta[i]).clamp(spec.lower, spec.upper);
        }
    }
}

/// So many times the toughness and strength along the path that the record tells.
fn path_by_record(
    model: &Model,
    (gc, sigma_c): (f64, f64),
    (tougher, stronger): (f64, f64),
    theta: &mut [f64],
) {
    for (i, p) in model.parameters.iter().enumerate().filter(|(_, p)| p.free) {
        let value = match p.path.rsplit_once('.') {
            Some((_, "sigma_c")) => stronger * sigma_c,
            Some((_, "gc")) => tougher * gc,
            _ => continue,
        };
        theta[i] = value.clamp(p.spec.lower, p.spec.upper);
    }
}

/// The bulk alone from the beginning of the tearing records, as long as the path still holds and the bulk explains what there
/// is: a strip that is several times too stiff would be taken for a soft path.
fn stiffness(case: &Case, catalogue: &Catalogue, work: &mut Work) -> Result<(), AnalysisError> {
    let mut fitted = false;
    for part in BEGINNINGS {
        let Ok(model) = part_of(case, part, catalogue) else { continue };
        let (bulk, tests) = (model.free_on(Site::Bulk), model.recorded());
        if bulk.is_empty() {
            break;
        }
        if missed(&model, &work.theta, work)?.is_none() {
            if fitted {
                break;
            }
            continue;
        }
        let before = work.theta.clone();
        let points = Measured::of(&model, &tests)?.data.points() as f64;
        // Without: the file's stiffness.
        let Ok(f) = work.stage(&model, Stage::Bulk, &bulk, &tests, true) else { break };
        if fitted && f > EXPLAINED * points {
            work.theta = before;
            break;
        }
        fitted = true;
    }
    Ok(())
}

/// The model on a coarse mesh, its tearing records up to this part of their largest displacement.
fn part_of(case: &Case, part: f64, catalogue: &Catalogue) -> Result<Model, AnalysisError> {
    let (mut shorter, how) = coarser(case);
    if let (Some(coarse), Some(given)) = (&mut shorter.mesh.divisions, case.mesh.divisions) {
        coarse[1] = coarse[1].max(given[1].min(LAYERS));
    }
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

/// What the model misses of its records, the sum of squares; `None` where it does not run to their end.
fn missed(model: &Model, theta: &[f64], work: &Work) -> Result<Option<f64>, AnalysisError> {
    let Ok(measured) = Measured::of(model, &model.recorded()) else { return Ok(None) };
    let problem = work.trial(model, theta, &[], &measured.slots, work.search);
    match problem.predict(&[], false) {
        Ok(p) => Ok(Some(measured.data.misfit(&p.values).norm_squared())),
        Err(PredictError::Interrupted) => Err(PredictError::Interrupted.into()),
        Err(_) => Ok(None),
    }
}

#[cfg(test)]
mod tests;
