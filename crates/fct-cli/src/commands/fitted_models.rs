//! The rungs of a search as run directories of their own, `rungs/<n>/` in the search's: each model at
//! the values the search found, run once on the file's mesh, so that curves, intervals and energies of
//! every rung can be looked at and continued from.

use crate::session::Session;
use ::report::answer::{Evaluated, Evaluator, fitted_case};
use ::report::{Begin, Published, ReportError, RunDir, store_fitted_model};
use analysis::{DiscoverAnswer, Phase, Watch};
use input::Case;
use std::sync::Arc;

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
) -> Result<Option<Evaluated>, ReportError> {
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
        let fitted_model = fitted_case(case, row, parent.as_deref());
        let evaluator =
            Evaluator { published: published.as_ref(), catalogue: &session.catalogue, journal: &journal };
        let done = evaluator.fitted_model(&fitted_model, watch, |why| {
            session.say(&format!("rung {k}: {why}; it is computed on the search's coarser mesh instead"));
        });
        match done {
            Ok(top) => {
                let part = RunDir::begin(&dir.part().join("rungs").join(k.to_string()), Begin::default())?;
                let info = session.info("identify", &fitted_model, true);
                store_fitted_model(&part, &top.done, &fitted_model, &top.replayed, &top.answer, &info)?;
                part.finish()?;
                last = (k + 1 == answer.ladder.len()).then_some(top);
            }
            Err(_) if session.cancelled() => return Ok(None),
            Err(why) => session.say(&format!("rung {k} is not among the curves: {why}")),
        }
    }
    Ok(last)
}

#[cfg(test)]
mod tests {
    use super::*;
    use analysis::LadderRow;
    use std::path::Path;

    /// A form that the search chose (two branches, say) is not lost on the way to the rung's `run.toml`.
    #[test]
    fn a_fitted_model_has_the_form_that_was_fitted() -> Result<(), Box<dyn std::error::Error>> {
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
            laws: analysis::LawNames::of(&case),
            parameters: 0,
            rms_n: 0.0,
            reduced_chi2: 0.0,
            reduced_chi2_total: 0.0,
            held_out_rms_n: None,
            bic: 0.0,
            values: [("effects.viscoelastic.g2".to_owned(), 0.2)].into(),
            forms: forms.clone(),
            bulk: None,
            interface: None,
        };
        let fitted_model = fitted_case(&case, &row, None);
        assert_eq!(fitted_model.effects[0].options, forms[0].options);
        assert_eq!(fitted_model.effects[0].parameters["g2"].value, Some(0.2));
        // What is believed of a tissue would pull its values away.
        assert_eq!(fitted_model.identify.priors.literature, case.identify.priors.literature);
        Ok(())
    }
}
