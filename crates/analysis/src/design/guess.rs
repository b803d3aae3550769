//! What a design takes for the tissue and the tear: the file's values, else what its records suggest.

use super::engine::model_of;
use crate::identify::{AnalysisError, free_parameters};
use input::Case;
use model::{Catalogue, Model};

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
        if let Some(tissue) = crate::strip::tissues(model, case, &list, &theta).into_iter().next() {
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
