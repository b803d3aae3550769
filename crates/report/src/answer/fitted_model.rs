//! A rung of a search as an answer of its own: its model at the values that the search found, computed once.

use super::{IdentifyAnswer, StageEnd};
use crate::Published;
use analysis::{
    AnalysisError, Control, Identified, Journal, LadderRow, SimulateControl, SimulatedTest, Watch, Within,
};
use input::{Case, Mode};
use model::Catalogue;
use std::path::Path;
use std::sync::Arc;

/// Where a rung's values come from, on the file's mesh and where that cannot be computed.
const FINE: &str = "Values of the search's ladder, computed once on the file's mesh.";
const COARSE: &str = "Values of the search's ladder, computed once on a mesh twice as coarse as the file's, on which it cannot be computed.";

/// A model at given values.
pub struct Evaluated {
    /// The model.
    pub done: Identified,
    /// Its runs with energies.
    pub replayed: Vec<SimulatedTest>,
    /// Its answer.
    pub answer: IdentifyAnswer,
}

/// What it takes to compute a case without a search.
pub struct Evaluator<'a> {
    /// Published values of the specimen, where there are some.
    pub published: Option<&'a Published>,
    /// Every effect.
    pub catalogue: &'a Catalogue,
    /// Where finished fits are kept.
    pub journal: &'a dyn Journal,
}

impl Evaluator<'_> {
    /// A rung of a ladder; one that cannot be computed on the file's mesh is computed on the search's coarser one, after
    /// `told` has heard why.
    ///
    /// # Errors
    /// If it cannot be computed on either, or `watch` stops it.
    pub fn fitted_model(
        &self,
        fitted_model: &Case,
        watch: &dyn Watch,
        told: impl FnOnce(&AnalysisError),
    ) -> Result<Evaluated, AnalysisError> {
        self.evaluate(fitted_model, FINE, watch).or_else(|why| {
            if watch.stops() {
                return Err(why);
            }
            told(&why);
            self.evaluate(&coarser(fitted_model), COARSE, watch)
        })
    }

    /// One run with derivatives at the values of the case: an identification that takes no step.
    ///
    /// # Errors
    /// If it cannot be computed, or `watch` stops it.
    pub fn evaluate(&self, case: &Case, reason: &str, watch: &dyn Watch) -> Result<Evaluated, AnalysisError> {
        let begun = std::time::Instant::now();
        let mut still = case.clone();
        (still.identify.max_iterations, still.identify.multi_start) = (0, 0);
        still.identify.coarse_first = false;
        let watch = &Within(watch);
        let done = analysis::identify(
            Arc::new(still),
            self.catalogue,
            &Control { progress: &|_| {}, cancelled: watch, journal: self.journal },
        )?;
        let replayed = analysis::replay(&done, &SimulateControl { progress: &|_, _| {}, cancelled: watch })?;
        let mut answer = IdentifyAnswer::new(&done, &replayed, self.published, begun.elapsed().as_secs_f64());
        answer.stages = vec![StageEnd { stage: "search".into(), reason: reason.into(), converged: true }];
        reason.clone_into(&mut answer.stopped_because);
        Ok(Evaluated { done, replayed, answer })
    }
}

/// The case of a rung: its effects, and the found values as start.
pub fn fitted_case(case: &Case, row: &LadderRow, parent: Option<&Path>) -> Case {
    let mut fitted_model = case.clone();
    fitted_model.effects.clone_from(&row.forms);
    if let Some(bulk) = &row.bulk {
        fitted_model.bulk.clone_from(bulk);
    }
    if let Some(interface) = &row.interface {
        fitted_model.interface.clone_from(interface);
    }
    analysis::start_at(&mut fitted_model, row.values.iter().map(|(p, v)| (p.as_str(), *v)));
    // Its run.toml gives these values: starts, that bound nothing.
    fitted_model.identify.priors.around.clear();
    fitted_model.identify.mode = Mode::Joint;
    fitted_model.parent = parent.map(|p| p.display().to_string());
    fitted_model
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
