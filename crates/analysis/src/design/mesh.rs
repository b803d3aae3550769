//! The numerical error that a search will carry: what the file's mesh says more than one twice as coarse, at the guess.

use super::engine::fewer_areas;
use crate::columns::transfer;
use crate::data::Slot;
use crate::identify::{TRIAL_BUDGET, coarser, run_options};
use crate::ladder::search_options;
use crate::problem::{Cancelled, FeProblem};
use input::Case;
use inverse::Problem as _;
use model::cost::Cost;
use model::{Catalogue, Discretisation, Model, RunOptions};
use nalgebra::DVector;
use std::sync::Arc;

/// A run on the file's mesh that takes longer on one core is not made for a look, s.
const PATIENCE_S: f64 = 60.0;

/// The difference at every point; `None` where the run would be long, or a mesh gives no answer at the guess.
pub(super) fn error(
    case: &Arc<Case>,
    catalogue: &Catalogue,
    (guessed, theta): (&Model, &[f64]),
    slots: &[Slot],
    cancelled: Cancelled,
) -> Option<DVector<f64>> {
    let case = Arc::new(fewer_areas(case));
    let cost = Cost::of(&case, catalogue, Discretisation::default()).ok()?;
    if cost.fit.seconds > PATIENCE_S {
        return None;
    }
    let (coarse, how) = coarser(&case);
    let tolerance = search_options(&case).march.newton.tolerance;
    let said = |case: Arc<Case>, how: Discretisation, mut options: RunOptions| {
        let model = Model::new(case, catalogue, how).ok()?;
        options.march.budget = 2 * TRIAL_BUDGET;
        options.march.newton.tolerance = tolerance;
        let theta = transfer(guessed, theta, &model);
        let problem = FeProblem::new(&model, theta, Vec::new(), slots, options, cancelled);
        problem.predict(&[], false).ok().map(|p| p.values)
    };
    let (fine, search) = rayon::join(
        || said(case.clone(), Discretisation::default(), run_options(&case)),
        || said(Arc::new(coarse), how, search_options(&case)),
    );
    Some(fine? - search?)
}
