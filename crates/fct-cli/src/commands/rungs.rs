//! The rungs of a search as run directories of their own, `rungs/<n>/` in the search's: each model at
//! the values the search found, run once on the file's mesh, so that curves, intervals and energies of
//! every rung can be looked at and continued from.

use crate::session::Session;
use ::report::answer::{IdentifyAnswer, StageEnd};
use ::report::{Begin, Published, ReportError, RunDir, RunJournal, store_rung};
use analysis::{
    Control, DiscoverAnswer, Identified, LadderRow, Phase, SimulateControl, SimulatedTest, Watch, Within,
};
use input::{Case, Mode};
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
    watch: &dyn Watch,
) -> Result<Option<Top>, ReportError> {
    watch.phase(Phase::Replay);
    let published = Published::of(case)?;
    let journal = dir.journal();
    let mut last = None;
    for (k, row) in answer.ladder.iter().enumerate() {
        if session.cancelled() {
            return Ok(None);
        }
        let place = dir.place().join("rungs");
        let parent = k.checked_sub(1).map(|b| place.join(b.to_string()));
        let rung = case_of(case, row, parent.as_deref());
        let done = evaluate(&rung, published.as_ref(), FINE, &journal, session, watch).or_else(|why| {
            if session.cancelled() {
                return Err(why);
            }
            session.say(&format!("rung {k}: {why}; it is computed on the search's coarser mesh instead"));
            evaluate(&coarser(&rung), published.as_ref(), COARSE, &journal, session, watch)
        });
        match done {
            Ok(top) => {
                let part = RunDir::begin(&dir.part().join("rungs").join(k.to_string()), Begin::default())?;
                let info = session.info("identify", &rung, true);
                store_rung(&part, &top.done, &rung, &top.replayed, &top.answer, &info)?;
                part.finish()?;
                last = (k + 1 == answer.ladder.len()).then_some(top);
            }
            Err(_) if session.cancelled() => return Ok(None),
            Err(why) => session.say(&format!("rung {k} is not among the curves: {why}")),
        }
    }
    Ok(last)
}

/// The case of a rung: its effects, and the found values as start.
fn case_of(case: &Case, row: &LadderRow, parent: Option<&Path>) -> Case {
    let mut rung = case.clone();
    rung.effects.clone_from(&row.forms);
    analysis::start_at(&mut rung, row.values.iter().map(|(p, v)| (p.as_str(), *v)));
    // Its run.toml gives these values, and what is expected stands around them.
    rung.identify.priors.around.clear();
    rung.identify.mode = Mode::Joint;
    // As the search did it: refitting without them would be another question.
    rung.identify.priors.literature.get_or_insert(true);
    rung.parent = parent.map(|p| p.display().to_string());
    rung
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
    journal: &RunJournal,
    session: &Session,
    watch: &dyn Watch,
) -> Result<Top, analysis::AnalysisError> {
    let begun = std::time::Instant::now();
    let mut still = case.clone();
    (still.identify.max_iterations, still.identify.multi_start) = (0, 0);
    still.identify.coarse_first = false;
    let watch = &Within(watch);
    let done = analysis::identify(
        Arc::new(still),
        &session.catalogue,
        &Control { progress: &|_| {}, cancelled: watch, journal },
    )?;
    let replayed = analysis::replay(&done, &SimulateControl { progress: &|_, _| {}, cancelled: watch })?;
    let mut answer = IdentifyAnswer::new(&done, &replayed, published, begun.elapsed().as_secs_f64());
    answer.stages = vec![StageEnd { stage: "search".into(), reason: reason.into(), converged: true }];
    reason.clone_into(&mut answer.stopped_because);
    Ok(Top { done, replayed, answer })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A form that the search chose (two branches, say) is not lost on the way to the rung's `run.toml`.
    #[test]
    fn a_rung_has_the_form_that_was_fitted() -> Result<(), Box<dyn std::error::Error>> {
        let catalogue = effects::catalogue();
        let folder = tempfile::tempdir()?;
        let (base, formed) = (folder.path().join("base.toml"), folder.path().join("formed.toml"));
        let text = "[geometry]\nlength_mm = 8.0\nwidth_mm = 6.0\nthickness_mm = 0.8\n[[tests]]\nkind = \"uniaxial\"\n\
                    protocol = [{ to_mm = 1.0, rate_mm_per_s = 0.1 }]\n";
        std::fs::write(&base, text)?;
        std::fs::write(
            &formed,
            format!("{text}[effects.viscoelastic]\nbranches = 2\nrelaxing = \"fibres\"\ng = 0.1\n"),
        )?;
        let read = |path: &Path| input::read_case(path, &catalogue);
        let (case, forms) = (read(&base)?, read(&formed)?.effects);
        let row = LadderRow {
            effects: vec!["viscoelastic".into()],
            parameters: 0,
            rms_n: 0.0,
            reduced_chi2: 0.0,
            reduced_chi2_total: 0.0,
            held_out_rms_n: None,
            bic: 0.0,
            values: [("effects.viscoelastic.g2".to_owned(), 0.2)].into(),
            forms: forms.clone(),
        };
        let rung = case_of(&case, &row, None);
        assert_eq!(rung.effects[0].options, forms[0].options);
        assert_eq!(rung.effects[0].parameters["g2"].value, Some(0.2));
        Ok(())
    }
}
