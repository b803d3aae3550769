//! A second place that a look asks at: the same tear everywhere along the path.

use super::engine::{Linear, coarsest};
use super::mesh_error::predicted;
use crate::problem::Cancelled;
use input::Case;
use inverse::Prediction;
use model::{Catalogue, Model};
use params::{Owner, ParamPath};

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
