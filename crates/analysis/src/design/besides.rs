//! What a look knows of parameters besides its own derivatives: what the file's mesh is wrong by, as an answer's intervals
//! will count it, and derivatives at a second place.

use super::engine::{LOOK, Linear, coarsest, options};
use crate::identify::coarser;
use crate::problem::{Cancelled, FeProblem};
use input::Case;
use inverse::{Prediction, Problem};
use model::cost::Cost;
use model::{Catalogue, Discretisation, Model};
use nalgebra::DVector;
use params::{Owner, ParamPath};
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

/// The look's model with the same tear everywhere along the path, values of the free parameters and derivatives: how well
/// areas are told apart depends on how much they differ, which no look in seconds knows. None where nothing differs.
pub(super) fn with_equal_areas(
    case: &Case,
    catalogue: &Catalogue,
    linear: &Linear,
    cancelled: Cancelled,
) -> Option<(Vec<f64>, Prediction)> {
    let (model, _) = coarsest(case, catalogue).ok()?;
    let tears = case.tests.iter().any(|t| t.kind.tears);
    (tears && model.areas() > 1).then_some(())?;
    predicted(&model, &everywhere_the_same(&model, linear.all()), linear, true, cancelled)
}

/// Values of the free parameters, and what a model says there.
fn predicted(
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

/// θ with the geometric mean of all areas in each of them.
fn everywhere_the_same(model: &Model, theta: &[f64]) -> Vec<f64> {
    let in_area = |k: usize| match model.parameters[k].path.parse::<ParamPath>() {
        Ok(ParamPath { owner: Owner::Area(_), name }) => Some(name),
        _ => None,
    };
    let names: Vec<Option<String>> = (0..theta.len()).map(in_area).collect();
    let mean = |k: usize| {
        let same = (0..theta.len()).filter(|&o| names[o] == names[k]).map(|o| theta[o].ln());
        let (sum, n) = same.fold((0.0, 0.0), |(sum, n), x| (sum + x, n + 1.0));
        (sum / n).exp()
    };
    (0..theta.len()).map(|k| if names[k].is_some() && theta[k] > 0.0 { mean(k) } else { theta[k] }).collect()
}
