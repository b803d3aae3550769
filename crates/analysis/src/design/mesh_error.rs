//! What the file's mesh is wrong by, as an answer's intervals will count it.

use super::engine::{LOOK, Linear, options};
use crate::identify::coarser;
use crate::problem::{Cancelled, FeProblem};
use input::Case;
use inverse::{Prediction, Problem};
use model::cost::Cost;
use model::{Catalogue, Discretisation, Model};
use nalgebra::DVector;
use std::sync::Arc;

/// Longest foretold run of the file's mesh, s, that a look in seconds can afford: it takes a fraction of the steps.
const AFFORDED: f64 = 120.0;

/// What the file's mesh says more than one twice as coarse ([`crate::Measured::with_numerical_error`]), at the values of a
/// look; none where a run of it takes too long, or there is no answer on either mesh.
pub(super) fn mesh_error(
    case: &Case,
    catalogue: &Catalogue,
    linear: &Linear,
    cancelled: Cancelled,
) -> Option<DVector<f64>> {
    let (given, (coarse, how)) = (Discretisation::default(), coarser(case));
    let fine = Arc::new(case.clone());
    if Cost::of(&fine, catalogue, given).ok()?.simulation.seconds > AFFORDED {
        return None;
    }
    let said = |case: Arc<Case>, how: Discretisation| {
        let model = Model::new(case, catalogue, how).ok()?;
        let (_, p) = predicted(&model, linear.all(), linear, false, cancelled)?;
        Some(p.values)
    };
    let (fine, coarse) = rayon::join(|| said(fine, given), || said(Arc::new(coarse), how));
    Some(fine? - coarse?)
}

/// Values of the free parameters, and what a model says there.
pub(super) fn predicted(
    model: &Model,
    theta: &[f64],
    linear: &Linear,
    derivatives: bool,
    cancelled: Cancelled,
) -> Option<(Vec<f64>, Prediction)> {
    let free = model.free();
    let values: Vec<f64> = free.iter().map(|&i| theta[i]).collect();
    let (options, slots) = (options(&model.case, LOOK), &linear.measured.slots);
    let problem = FeProblem::new(model, theta.to_vec(), free, slots, options, cancelled);
    let prediction = problem.predict(&values, derivatives).ok()?;
    Some((values, prediction))
}
