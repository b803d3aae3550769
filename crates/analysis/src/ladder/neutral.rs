//! What the file's mesh says more beside a model with further effects.

use super::{FeLadder, Fitted};
use crate::columns::transfer;
use crate::correction::Correction;
use crate::identify::AnalysisError;
use crate::problem::FeProblem;
use inverse::Problem as _;
use model::Model;
use std::sync::atomic::Ordering;

impl FeLadder<'_> {
    /// What the file's mesh says more beside a model with further effects: at their neutral values it is as good as the base, also
    /// where it is followed by other load steps, on which a coarse mesh may jump elsewhere.
    pub(super) fn correction_beside(
        &self,
        base: &Fitted,
        model: &Model,
    ) -> Result<Correction, AnalysisError> {
        let mut correction = base.correction.clone();
        let plan = |m: &Model, t: usize| m.plan(t, &self.options);
        let laws = |m: &Model| (m.case.bulk.law.clone(), m.case.interface.law.clone());
        let same = (0..model.tests.len()).all(|t| plan(model, t) == plan(&base.model, t));
        // Another law has no neutral value.
        if same || laws(model) != laws(&base.model) {
            return Ok(correction);
        }
        let theta = at_neutral(base, model);
        let mut problem = FeProblem::new(
            model,
            theta.clone(),
            Vec::new(),
            &self.measured.slots,
            self.options,
            self.cancelled,
        );
        problem.options.stepping.budget = crate::identify::TRIAL_BUDGET;
        self.runs.fetch_add(1, Ordering::Relaxed);
        match problem.predict(&[], false) {
            Ok(own) => {
                let mut values = own.values;
                correction.apply(model, &theta, &[], &mut values, None);
                if correction.shift.len() == values.len() {
                    correction.shift += &base.fit.prediction.values - values;
                }
                Ok(correction)
            }
            Err(e @ inverse::PredictError::Interrupted) => Err(e.into()),
            Err(_) => Ok(correction),
        }
    }
}

/// The base's values, further effects at neutral.
fn at_neutral(base: &Fitted, model: &Model) -> Vec<f64> {
    let mut theta = transfer(&base.model, &base.theta, model);
    let known = base.model.effects();
    for effect in model.case.effects.iter().filter(|e| !known.contains(&e.name)) {
        for spec in effect.specs.iter() {
            let at = model.find(&format!("effects.{}.{}", effect.name, spec.name));
            if let (Some(neutral), Some(i)) = (spec.neutral, at) {
                theta[i] = neutral;
            }
        }
    }
    theta
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ladder::tests::unexplained;
    use nalgebra::DVector;
    use std::sync::Arc;

    /// An effect that remembers is followed by further load steps; at neutral it predicts what the base does, to the last digits.
    #[test]
    fn at_neutral_an_effect_is_as_good_as_the_base() {
        let catalogue = effects::catalogue();
        let ladder = unexplained(&catalogue);
        let base = &ladder.fitted_models[&Vec::new()];
        let mut case = (*base.model.case).clone();
        let mullins = catalogue.get("mullins").expect("an effect");
        let values = mullins.start(&crate::columns::scales(&base.model, &base.theta));
        case.effects.push(crate::columns::config_of(mullins, &values));
        let model = Model::new(Arc::new(case), &catalogue, ladder.how).expect("a model");
        let theta = at_neutral(base, &model);
        let problem = FeProblem::new(
            &model,
            theta.clone(),
            Vec::new(),
            &ladder.measured.slots,
            ladder.options,
            &|| false,
        );
        let own = problem.predict(&[], false).expect("a run").values;
        let off = |correction: &Correction| {
            let mut values: DVector<f64> = own.clone();
            correction.apply(&model, &theta, &[], &mut values, None);
            (values - &base.fit.prediction.values).amax() / own.amax()
        };
        let (beside, before) = (ladder.correction_beside(base, &model).expect("a run"), &base.correction);
        assert!(off(&beside) < 1e-12, "{}", off(&beside));
        // The base's own difference is of other load steps.
        assert!(off(before) > 1e-9, "{}", off(before));
    }
}
