//! What a design takes for the tissue and the tear: the file's values, else what its records suggest.

use super::engine::{LOOK, model_of, options};
use crate::data::Measured;
use crate::identify::{AnalysisError, free_parameters};
use crate::priors::Belief;
use crate::problem::{Cancelled, FeProblem};
use crate::start::START_NOISE;
use input::Case;
use inverse::{FitOptions, Iterate, Objective};
use model::{Catalogue, Model};
use std::ops::ControlFlow;

/// What counts as the record being followed, where only the order of the tissue and of the tear is asked for: a step that
/// changes the misfit by less of it ends the fit.
const ROUGHLY: f64 = 0.02;
/// Most steps of such a fit.
const STEPS: usize = 12;

/// θ with the strengths of the tear path multiplied.
pub(super) fn with_strength(model: &Model, theta: &[f64], share: f64) -> Vec<f64> {
    let mut theta = theta.to_vec();
    for (p, v) in model.parameters.iter().zip(&mut theta) {
        if p.free && p.path.ends_with("].sigma_c") {
            *v = (share * *v).clamp(p.spec.lower, p.spec.upper);
        }
    }
    theta
}

/// The case with what its records suggest of the tissue and the tear as start values, where the file gives none.
pub(super) fn with_guess(case: &Case, catalogue: &Catalogue) -> Result<Case, AnalysisError> {
    let mut out = case.clone();
    if case.tests.iter().any(|t| t.record.is_some()) {
        let (model, _) = model_of(case, catalogue)?;
        let theta = guessed(&model);
        out.interface.areas = model.areas();
        let values = model.free().into_iter().map(|i| (model.parameters[i].path.as_str(), theta[i]));
        crate::start::start_at(&mut out, values);
    }
    Ok(out)
}

/// The file's values; where it gives none, a tissue that explains the intact strip roughly and a tear of the order of the
/// record's work and peak.
pub(super) fn guessed(model: &Model) -> Vec<f64> {
    let case = &model.case;
    let mut theta = model.theta();
    let set = |theta: &mut Vec<f64>, path: &str, value: f64| {
        if let Some(i) = model.find(path).filter(|&i| model.parameters[i].free) {
            let spec = &model.parameters[i].spec;
            theta[i] = value.clamp(spec.lower, spec.upper);
        }
    };
    let given = |i: usize| case.bulk.value(&model.parameters[i].spec.name).value.is_some();
    if let Some(offered) = model.starts().filter(|s| !given(s.size)) {
        let list = free_parameters(model, &theta, &model.free());
        if let Some(tissue) =
            crate::strip::tissues(model, (case, Belief::Given), &list, &theta).into_iter().next()
        {
            offered.axes.iter().for_each(|&(i, _)| set(&mut theta, &model.parameters[i].path, tissue[i]));
        }
    }
    let torn = case.tests.iter().any(|t| t.kind.tears && t.record.is_some());
    if torn && case.interface.gc_of(0).value.is_none() {
        let (gc, sigma_c) = crate::start::from_record(case);
        for area in 1..=model.areas() {
            set(&mut theta, &format!("interface.area[{area}].gc"), gc);
            set(&mut theta, &format!("interface.area[{area}].sigma_c"), sigma_c);
        }
    }
    theta
}

/// θ with the base fitted roughly to the records, from a first guess: the strip's homogeneous tissue and a path of
/// the order of the work may tear far earlier or later than the record does, and what shows depends on how far it tears.
/// The start itself where the fit fails.
pub(super) fn fitted_roughly(
    model: &Model,
    theta: &[f64],
    measured: &Measured,
    cancelled: Cancelled,
) -> Vec<f64> {
    let free = model.free();
    let mut list = free_parameters(model, theta, &free);
    crate::priors::add(&mut list, &model.case, Belief::Given);
    let measured = measured.clone().with_noise_of_at_least(START_NOISE);
    let options = options(&model.case, LOOK);
    let problem = FeProblem::new(model, theta.to_vec(), free, &measured.slots, options, cancelled);
    let how_far = FitOptions {
        objective: Objective::Record,
        tolerance: ROUGHLY,
        max_iterations: STEPS,
        ..FitOptions::default()
    };
    let mut watch = |_: &Iterate| ControlFlow::Continue(());
    inverse::fit(&problem, &measured.data, &list, &how_far, &mut watch)
        .map_or_else(|_| theta.to_vec(), |fit| problem.full(&fit.theta))
}
