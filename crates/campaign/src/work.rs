//! Doing a task: the analyses of `fct identify` and `fct discover`, without a run directory.

use crate::boot::redrawn;
use crate::files::{Folder, Outcome, TaskResult};
use crate::plan::{Plan, Task, VERSION};
use analysis::{AnalysisError, Control, Journal, SimulateControl, Watch};
use input::Case;
use model::Catalogue;
use report::answer::{Evaluator, IdentifyAnswer, fitted_case};
use std::sync::Arc;
use std::time::Instant;

/// What a task is done with.
#[derive(Clone, Copy)]
pub struct Tools<'a> {
    /// Every effect.
    pub catalogue: &'a Catalogue,
    /// Asked between steps; hears of the cost.
    pub watch: &'a dyn Watch,
    /// Hears remarks on what is being done.
    pub note: &'a (dyn Fn(&str) + Sync),
}

/// Does a task of a plan, and returns its result; nothing is stored but what is needed to take it up. `None`: it was
/// stopped.
///
/// # Errors
/// If its input is not any more what was planned. That the task cannot be computed is a result.
pub fn do_task(
    plan: &Plan,
    folder: &Folder,
    task: &Task,
    tools: Tools<'_>,
) -> Result<Option<TaskResult>, String> {
    let begun = Instant::now();
    let case = plan.case(task, tools.catalogue)?;
    let journal = folder.journal(&task.key);
    let doing = Doing { tools, journal: &journal, searches: plan.models[task.model].searches() };
    let outcome = match &task.base {
        None => doing.first(&case),
        Some(base) => match folder.read(base).map(|r| r.outcome) {
            Some(Outcome::Done { identify, .. }) => doing.again(&case, &identify, plan.seed, task.repeat),
            Some(Outcome::Failed { .. }) => Err(AnalysisError::Case("the fit it repeats has failed".into())),
            None => Err(AnalysisError::Case("the fit it repeats is not done".into())),
        },
    };
    if tools.watch.stops() {
        return Ok(None);
    }
    let outcome = outcome.unwrap_or_else(|why| Outcome::Failed { reason: why.to_string() });
    Ok(Some(TaskResult {
        schema: report::answer::SCHEMA,
        key: task.key.clone(),
        version: VERSION.to_owned(),
        specimen: plan.specimens[task.specimen].name.clone(),
        repeat: task.repeat,
        outcome,
        seconds: begun.elapsed().as_secs_f64(),
    }))
}

struct Doing<'a> {
    tools: Tools<'a>,
    journal: &'a dyn Journal,
    searches: bool,
}

type Done = Result<Outcome, AnalysisError>;

impl Doing<'_> {
    fn first(&self, case: &Arc<Case>) -> Done {
        if !self.searches {
            return Ok(done(self.identified(case)?, None));
        }
        let case = &analysis::condensed(case);
        let Tools { catalogue, watch, note } = self.tools;
        let found = analysis::discover(case.clone(), catalogue, note, watch, self.journal)?;
        let last =
            found.ladder.last().ok_or_else(|| AnalysisError::Case("the search has no model".into()))?;
        let evaluated =
            self.evaluator()
                .fitted_model(&fitted_case(&found.case, last, None), watch, |why| note(&why.to_string()))?;
        let json = serde_json::to_value(&found).map_err(|e| AnalysisError::Case(e.to_string()))?;
        Ok(done(evaluated.answer, Some(json)))
    }

    /// The fit of `base` once more, to records whose misfit is drawn anew.
    fn again(&self, case: &Arc<Case>, base: &IdentifyAnswer, seed: u64, repeat: usize) -> Done {
        let mut at = (**case).clone();
        analysis::start_at(&mut at, base.parameters.iter().map(|p| (p.path.as_str(), p.value)));
        let here = self.evaluator().evaluate(&at, "", self.tools.watch)?;
        let drawn = redrawn(&here.done, seed, repeat);
        let mut refit = at;
        refit.tests = drawn;
        Ok(done(self.identified(&Arc::new(refit))?, None))
    }

    fn evaluator(&self) -> Evaluator<'_> {
        Evaluator { published: None, catalogue: self.tools.catalogue, journal: self.journal }
    }

    fn identified(&self, case: &Arc<Case>) -> Result<IdentifyAnswer, AnalysisError> {
        let begun = Instant::now();
        let Tools { catalogue, watch, .. } = self.tools;
        let control = Control { progress: &|_| {}, cancelled: watch, journal: self.journal };
        let found = analysis::identify(case.clone(), catalogue, &control)?;
        let still = SimulateControl { progress: &|_, _| {}, cancelled: watch };
        let replayed = analysis::replay(&found, &still)?;
        Ok(IdentifyAnswer::new(&found, &replayed, None, begun.elapsed().as_secs_f64()))
    }
}

/// An answer as it is stored: the history of its search is of no use to a study.
fn done(mut answer: IdentifyAnswer, discover: Option<serde_json::Value>) -> Outcome {
    answer.history.clear();
    Outcome::Done { identify: Box::new(answer), discover }
}
