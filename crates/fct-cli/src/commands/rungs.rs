//! The rungs of a search as run directories of their own, `rungs/<n>/` in the search's: each model at
//! the values the search found, run once on the file's mesh, so that curves, intervals and energies of
//! every rung can be looked at and continued from.

use crate::session::Session;
use ::report::answer::{IdentifyAnswer, StageEnd};
use ::report::{Published, ReportError, RunDir, store_rung};
use analysis::{Control, DiscoverAnswer, Identified, LadderRow, SimulateControl, SimulatedTest};
use input::{Case, EffectConfig, Location, Mode, Value};
use model::{Catalogue, Discretisation, Model, Options, Scales};
use std::path::Path;
use std::sync::Arc;

/// Where a rung's values come from, on the file's mesh and where that cannot be computed.
const FINE: &str = "Values of the search's ladder, computed once on the file's mesh.";
const COARSE: &str = "Values of the search's ladder, computed once on a mesh twice as coarse as the file's, on which it cannot be computed.";

/// The last rung, for what stands at the top of the search's directory.
pub struct Top {
    /// The model at the found values.
    pub done: Identified,
    /// Its runs with energies.
    pub replayed: Vec<SimulatedTest>,
    /// Its answer.
    pub answer: IdentifyAnswer,
}

/// Stores every rung of the ladder; one that cannot be computed on the file's mesh is left out with a
/// remark. Returns the last rung.
///
/// # Errors
/// If the disk refuses.
pub fn store(
    dir: &RunDir,
    case: &Arc<Case>,
    answer: &DiscoverAnswer,
    session: &Session,
) -> Result<Option<Top>, ReportError> {
    let published = Published::of(case)?;
    let mut last = None;
    for (k, row) in answer.ladder.iter().enumerate() {
        if session.cancelled() {
            return Ok(None);
        }
        let place = dir.place().join("rungs");
        let parent = k.checked_sub(1).map(|b| place.join(b.to_string()));
        let rung = case_of(case, &session.catalogue, &answer.ladder[0], row, parent.as_deref());
        let done = evaluate(&rung, published.as_ref(), FINE, session).or_else(|why| {
            session.say(&format!("rung {k}: {why}; it is computed on the search's coarser mesh instead"));
            evaluate(&coarser(&rung), published.as_ref(), COARSE, session)
        });
        match done {
            Ok(top) => {
                let part = RunDir::begin(&dir.part().join("rungs").join(k.to_string()))?;
                let info = session.info("identify", &rung, true);
                store_rung(&part, &top.done, &rung, &top.replayed, &top.answer, &info)?;
                part.finish()?;
                last = (k + 1 == answer.ladder.len()).then_some(top);
            }
            Err(why) => session.say(&format!("rung {k} is not among the curves: {why}")),
        }
    }
    Ok(last)
}

/// The case of a rung: its effects, and the found values as start.
fn case_of(
    case: &Case,
    catalogue: &Catalogue,
    base: &LadderRow,
    row: &LadderRow,
    parent: Option<&Path>,
) -> Case {
    let mut rung = case.clone();
    if let Some(scales) = scales_of(case, catalogue, base) {
        let new = row.effects.iter().filter(|e| case.effect(e).is_none());
        rung.effects.extend(new.filter_map(|name| config(catalogue, name, &scales)));
    }
    analysis::start_at(&mut rung, row.values.iter().map(|(p, v)| (p.as_str(), *v)));
    rung.identify.mode = Mode::Joint;
    // As the search did it: refitting without them would be another question.
    rung.identify.priors.literature.get_or_insert(true);
    rung.parent = parent.map(|p| p.display().to_string());
    rung
}

/// The sizes that the search took its start values from.
fn scales_of(case: &Case, catalogue: &Catalogue, base: &LadderRow) -> Option<Scales> {
    let mut case = case.clone();
    analysis::start_at(&mut case, base.values.iter().map(|(p, v)| (p.as_str(), *v)));
    let model = Model::new(Arc::new(case), catalogue, Discretisation::default()).ok()?;
    Some(analysis::scales(&model, &model.theta()))
}

fn config(catalogue: &Catalogue, name: &str, scales: &Scales) -> Option<EffectConfig> {
    let effect = catalogue.get(name)?;
    let specs = effect.parameters(&Options::new());
    let start = effect.start(scales);
    Some(EffectConfig {
        name: name.to_owned(),
        parameters: specs.iter().zip(start).map(|(s, v)| (s.name.to_string(), Value::new(v))).collect(),
        options: effect.options().into_iter().filter_map(|o| o.default.map(|d| (o.name, d))).collect(),
        specs,
        location: Location::default(),
    })
}

/// The case with elements twice as large, as the search has them.
fn coarser(case: &Case) -> Case {
    let mut coarse = case.clone();
    let mesh = &mut coarse.mesh;
    (mesh.bulk_size, mesh.path_size) = (2.0 * mesh.bulk_size, 2.0 * mesh.path_size);
    // Half the divisions, those along the load even: the tear path lies between them.
    mesh.divisions =
        mesh.divisions.map(|[x, y, z]| [x.div_ceil(2).max(2), (y.div_ceil(4) * 2).max(2), z.div_ceil(2)]);
    coarse
}

/// One run with derivatives at the values of the case: an identification that takes no step.
fn evaluate(
    case: &Case,
    published: Option<&Published>,
    reason: &str,
    session: &Session,
) -> Result<Top, analysis::AnalysisError> {
    let begun = std::time::Instant::now();
    let mut still = case.clone();
    (still.identify.max_iterations, still.identify.multi_start) = (0, 0);
    still.identify.coarse_first = false;
    let cancelled = || session.cancelled();
    let done = analysis::identify(
        Arc::new(still),
        &session.catalogue,
        &Control { progress: &|_| {}, cancelled: &cancelled },
    )?;
    let replayed = analysis::replay(&done, &SimulateControl { progress: &|_, _| {}, cancelled: &cancelled })?;
    let mut answer = IdentifyAnswer::new(&done, &replayed, published, begun.elapsed().as_secs_f64());
    answer.stages = vec![StageEnd { stage: "search".into(), reason: reason.into(), converged: true }];
    reason.clone_into(&mut answer.stopped_because);
    Ok(Top { done, replayed, answer })
}
