//! Where a search along the tear path begins: one strength and one toughness for the whole path,
//! on a coarse mesh, from what the record itself says (work of the test, peak force).
//!
//! A start that is far off tears too early or not at all, costs jumps, and leads to a local
//! optimum (the paper's fourth limitation).

use crate::identify::{AnalysisError, Stage, StagePlan, Work};
use crate::priors::Belief;
use input::Case;
use model::{Catalogue, Discretisation, Model};
use params::{Owner, ParamPath};
use std::sync::Arc;

/// What counts as noise while a start is sought, as a share of the largest force.
pub(crate) const START_NOISE: f64 = 0.03;

/// How much coarser than the given mesh the search for the start is.
const COARSEN: f64 = 3.0;

/// Fits one area on a coarse mesh, then more of them. Returns the finest of these models with its values, then the one-area
/// model with its own, or `None` when the file gives each area its own start, when only the tear tells the bulk, or there is
/// nothing to do.
fn one_area(
    case: &Arc<Case>,
    catalogue: &Catalogue,
    work: &mut Work,
    list: &[StagePlan],
) -> Result<Option<Vec<Start>>, AnalysisError> {
    let interface = &case.interface;
    let tearing = case.tests.iter().any(|t| t.kind.tears && t.record.is_some());
    if !tearing || interface.gc.len() > 1 || interface.sigma_c.len() > 1 || case.mesh.divisions.is_some() {
        return Ok(None);
    }
    let mut simple = (**case).clone();
    simple.interface.areas = 1;
    let how = Discretisation { coarsen: COARSEN, ..Discretisation::default() };
    let Ok(model) = Model::new(Arc::new(simple.clone()), catalogue, how) else { return Ok(None) };
    let file = model.theta();
    let bulk = model.free_on(model::Site::Bulk);
    let bulk_tests = list.first().filter(|s| s.0 == Stage::Bulk).map(|s| s.2.clone());
    if bulk_tests.is_none() && !bulk.is_empty() {
        // Without an intact strip's record the tear's own has to tell the bulk.
        return Ok(None);
    }
    let theta_of_work = std::mem::replace(&mut work.theta, file.clone());
    work.coarse_noise = START_NOISE;
    let (Some(g), Some(s)) = (model.find("interface.area[1].gc"), model.find("interface.area[1].sigma_c"))
    else {
        return Ok(None);
    };
    let tests: Vec<bool> = model.tests.iter().map(|t| t.test.kind.tears && t.test.record.is_some()).collect();
    let free: Vec<usize> = [g, s].into_iter().filter(|&i| model.parameters[i].free).collect();
    let mut best: Option<(f64, Vec<f64>)> = None;
    let found = bulk_starts(&model, &file, &bulk, bulk_tests.as_deref(), work)?;
    let from = from_record(case);
    // Where no bulk optimum lets the tear be computed (a tissue bent by what the model lacks), the
    // file's own bulk does.
    for thetas in [found, vec![file.clone()]] {
        for theta in thetas {
            for share in [1.0, 0.5, 1.5] {
                work.theta.clone_from(&theta);
                for (i, v) in [(g, from.0), (s, share * from.1)] {
                    if model.parameters[i].free {
                        work.theta[i] =
                            v.clamp(model.parameters[i].spec.lower, model.parameters[i].spec.upper);
                    }
                }
                // A start from which the tear cannot be computed is no start.
                match work.stage(&model, Stage::Interface, &free, &tests, true) {
                    Ok(f) => {
                        if best.as_ref().is_none_or(|b| f < b.0) {
                            best = Some((f, work.theta.clone()));
                        }
                        break;
                    }
                    Err(AnalysisError::Fit(inverse::FitError::Start(inverse::PredictError::Interrupted))) => {
                        return Ok(None);
                    }
                    Err(_) => {}
                }
            }
        }
        if best.is_some() {
            break;
        }
    }
    let start = best.map(|(_, theta)| Start { theta, model });
    let start = match start {
        Some(s) => Some(refine(s, &simple, interface.areas, catalogue, work, &tests)?),
        None => None,
    };
    work.theta = theta_of_work;
    work.coarse_noise = 0.0;
    Ok(start)
}

/// Optima of the bulk stage from several tissues, the equally good ones of them: one uniaxial
/// curve is often explained by fibres near the load and by fibres across it alike, and only the
/// tear tells which. Without a bulk stage, the file's values.
fn bulk_starts(
    model: &Model,
    file: &[f64],
    bulk: &[usize],
    tests: Option<&[bool]>,
    work: &mut Work,
) -> Result<Vec<Vec<f64>>, AnalysisError> {
    let Some(tests) = tests else { return Ok(vec![file.to_vec()]) };
    let list = crate::identify::free_parameters(model, file, bulk);
    let mut starts = crate::strip::tissues(model, (work.case, work.belief.at_start()), &list, file);
    let offered = model.starts();
    let given = |i: usize| work.case.bulk.value(&model.parameters[i].spec.name).value.is_some();
    let own = offered.as_ref().is_some_and(|s| given(s.size) || s.apart.is_some_and(|(i, _)| given(i)));
    let apart = offered.and_then(|s| s.apart).map(|(i, _)| i).filter(|i| bulk.contains(i));
    if own || starts.is_empty() {
        starts.insert(0, file.to_vec());
    }
    let mut found: Vec<(f64, Vec<f64>)> = Vec::new();
    for theta in starts {
        work.theta = theta;
        match work.stage(model, Stage::Bulk, bulk, tests, true) {
            Ok(f) => found.push((f, work.theta.clone())),
            Err(AnalysisError::Fit(inverse::FitError::Start(inverse::PredictError::NotComputable(_)))) => {}
            Err(e) => return Err(e),
        }
    }
    let least = found.iter().map(|f| f.0).fold(f64::INFINITY, f64::min);
    found.sort_by(|a, b| a.0.total_cmp(&b.0));
    // Within a tenth they explain the curve alike (χ² at the start's coarse noise); the same optimum
    // twice is one.
    let mut kept: Vec<Vec<f64>> = Vec::new();
    for (f, theta) in found {
        let same = |k: &Vec<f64>| apart.is_some_and(|g| (k[g] - theta[g]).abs() < 0.02);
        if f <= 1.1 * least + 4.0 && !kept.iter().any(same) {
            kept.push(theta);
        }
    }
    Ok(kept)
}

/// Two areas, four, …: each level starts from the one before, so that the strengths find their
/// place along the path before they are many. That place may be an optimum of few areas only: the one area they came
/// of is handed on as a second start, after the last level.
fn refine(
    start: Start,
    case: &Case,
    areas: usize,
    catalogue: &Catalogue,
    work: &mut Work,
    tests: &[bool],
) -> Result<Vec<Start>, AnalysisError> {
    let mut finest: Option<Start> = None;
    let how = Discretisation { coarsen: COARSEN, ..Discretisation::default() };
    let mut m = 2;
    while m < areas {
        let level =
            Case { interface: input::InterfaceConfig { areas: m, ..case.interface.clone() }, ..case.clone() };
        let Ok(model) = Model::new(Arc::new(level), catalogue, how) else { break };
        work.theta = model.theta();
        spread(&model, finest.as_ref().unwrap_or(&start), &mut work.theta);
        let free = model.free_on(model::Site::Interface);
        if work.stage(&model, Stage::Interface, &free, tests, true).is_err() {
            break;
        }
        finest = Some(Start { theta: work.theta.clone(), model });
        m *= 2;
    }
    Ok(finest.into_iter().chain([start]).collect())
}

/// The start of a joint search on a case: the bulk from the uniaxial tests, one area for the tear.
pub(crate) fn for_case(
    case: &Arc<Case>,
    catalogue: &Catalogue,
    options: model::RunOptions,
    control: &crate::Control,
) -> Result<Option<Arc<Start>>, AnalysisError> {
    let fine = Model::new(case.clone(), catalogue, Discretisation::default())?;
    let mut work = Work::new(case, fine.theta(), options, control);
    work.belief = Belief::of(case, Belief::Start);
    let list = crate::identify::stages(&fine, input::Mode::Staged);
    Ok(find(case, catalogue, &mut work, &list)?.and_then(|levels| levels.into_iter().next()))
}

/// Starts for a search, the first first: few areas for the tear; else, where the file's own values do not lead to the end of a record, one
/// that does.
pub(crate) fn find(
    case: &Arc<Case>,
    catalogue: &Catalogue,
    work: &mut Work,
    list: &[StagePlan],
) -> Result<Option<Vec<Arc<Start>>>, AnalysisError> {
    match one_area(case, catalogue, work, list)? {
        Some(levels) => Ok(Some(levels.into_iter().map(Arc::new).collect())),
        None => {
            let found = crate::torn_start::torn_starts(case, catalogue, work)?;
            work.torn = found.iter().flatten().cloned().collect();
            Ok(found)
        }
    }
}

/// A model with fewer areas, with its fitted values.
pub(crate) struct Start {
    pub theta: Vec<f64>,
    pub model: Model,
}

impl Start {
    /// `theta` with what the start says about it.
    pub fn spread_from(&self, fine: &Model, theta: &[f64]) -> Vec<f64> {
        let mut theta = theta.to_vec();
        spread(fine, self, &mut theta);
        theta
    }
}

/// Copies the start into the parameters of the real model: the same path, or the value of the
/// start's area at the same place along the tear.
pub(crate) fn spread(fine: &Model, start: &Start, theta: &mut [f64]) {
    for (i, p) in fine.parameters.iter().enumerate() {
        if !p.free {
            continue;
        }
        let path = match p.path.parse::<ParamPath>() {
            Ok(ParamPath { owner: Owner::Area(here), name }) => {
                let all = fine.areas();
                let middle = (here as f64 - 0.5) / all as f64;
                let from =
                    ((middle * start.model.areas() as f64).floor() as usize + 1).min(start.model.areas());
                ParamPath::area(from, &name).to_string()
            }
            _ => p.path.clone(),
        };
        if let Some(at) = start.model.find(&path) {
            theta[i] = start.theta[at].clamp(p.spec.lower, p.spec.upper);
        }
    }
}

/// (Gc, σc) of the order that the records of tears ask for, by each experiment's own estimate; the largest of all.
pub(crate) fn from_record(case: &Case) -> (f64, f64) {
    let torn = case.tests.iter().filter(|t| t.kind.tears);
    let told = torn.filter_map(|t| t.record.as_ref().map(|r| (t.kind.estimate)(&case.geometry, r)));
    told.fold((0.0f64, 0.0f64), |most, (gc, sigma_c)| (most.0.max(gc), most.1.max(sigma_c)))
}

/// Has a diagnosis stay at identified values: they are an answer, and nothing is searched again.
pub fn stay_at<'a>(case: &mut Case, values: impl Iterator<Item = (&'a str, f64)>) {
    start_at(case, values);
    case.identify.max_iterations = 0;
    case.identify.coarse_first = false;
}

/// Writes identified values into a case as the start of the next search; bounds, freedom and what priors expect stay.
pub fn start_at<'a>(case: &mut Case, values: impl Iterator<Item = (&'a str, f64)>) {
    crate::priors::hold(case);
    let areas = case.interface.areas;
    for (path, value) in values {
        let Ok(path) = path.parse::<ParamPath>() else { continue };
        match path.owner {
            Owner::Area(area) => {
                let list =
                    if path.name == "gc" { &mut case.interface.gc } else { &mut case.interface.sigma_c };
                let common = list.first().copied().unwrap_or_default();
                if list.len() < areas {
                    *list = vec![common; areas];
                }
                if let Some(v) = list.get_mut(area.wrapping_sub(1)) {
                    v.value = Some(value);
                }
            }
            Owner::Bulk => case.bulk.start(&path.name, value),
            Owner::Interface => case.interface.start(&path.name, value),
            Owner::Effect(effect) => {
                if let Some(e) = case.effects.iter_mut().find(|e| e.name == effect) {
                    e.parameters.entry(path.name).or_default().value = Some(value);
                }
            }
        }
    }
}
