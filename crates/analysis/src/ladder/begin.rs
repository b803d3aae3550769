//! Where the fit of a rung begins: at the screen's estimate, nearer to the base, off the base's bounds, from where the
//! base's fit began.

use super::{FeLadder, Fitted};
use crate::columns::{case_with, transfer};
use crate::correction::Correction;
use crate::identify::{AnalysisError, FAR};
use crate::problem::FeProblem;
use input::Case;
use inverse::{Noise, Problem as _, Whitener};
use model::Model;
use std::sync::Arc;
use std::sync::atomic::Ordering;

/// Where a rung's fit begins.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Begin {
    /// At the screen's estimate and the base's values.
    Screened,
    /// At that share of the estimate which misses the records least.
    Nearer,
    /// At the estimate, but with the values that the base's fit left at a bound at their own start again: a base that
    /// lacks an effect may have been driven to where no run with the effect comes through (a matrix without
    /// stiffness, say).
    OffBounds,
}

/// Shares of the screen's estimate. It is linear, and may stand far beyond where the effect still fits.
const SHARES: [f64; 5] = [0.5, 0.25, 0.1, 0.05, 0.01];

impl FeLadder<'_> {
    /// Fits a rung from the screen's estimate. At its neutral value an effect leaves the base as good
    /// as it was: a fit that ends worse, or cannot begin, starts once more from a smaller amplitude; one that cannot
    /// begin there either, from values off their bounds.
    pub(super) fn fit_with_restarts(
        &self,
        key: &[String],
        effects: &[String],
        hints: &diagnose::Hints,
    ) -> Result<Fitted, AnalysisError> {
        let mut best: Result<Fitted, AnalysisError> = Err(AnalysisError::Case("no base fit".into()));
        let Some(base) = self.nearest(key) else { return best };
        let correction = self.correction_beside(base, &self.begun(effects, hints, base, 1.0)?.0)?;
        for begin in [Begin::Screened, Begin::Nearer, Begin::OffBounds] {
            // A law has no neutral value to begin nearer to.
            let alone = begin == Begin::Nearer && self.laws_alone(effects);
            if best.is_ok() && (begin == Begin::OffBounds || alone) {
                break;
            }
            let share = match begin {
                Begin::Nearer => self.best_share(effects, hints, base, &correction)?,
                _ => 1.0,
            };
            let (model, mut theta) = self.begun(effects, hints, base, share)?;
            if begin == Begin::OffBounds && !off_bounds(base, &model, &mut theta) {
                break;
            }
            let states = self.guesses(base, &model);
            // Where another start follows, a fit that will not come to what is known is left for it.
            let known = if begin == Begin::Screened && !self.laws_alone(effects) {
                base.fit.f
            } else {
                f64::INFINITY
            };
            match self.fit_model(model, theta, correction.clone(), states, known) {
                Ok(f) if f.fit.f <= base.fit.f => return Ok(f),
                Ok(f) if best.as_ref().is_ok_and(|b| b.fit.f <= f.fit.f) => {}
                Err(e) if self.cancelled.stops() => return Err(e),
                Err(_) if best.is_ok() => {}
                answer => best = answer,
            }
        }
        best
    }

    /// The model with the effects at a share of what the screen proposes, and its values.
    fn begun(
        &self,
        effects: &[String],
        hints: &diagnose::Hints,
        base: &Fitted,
        share: f64,
    ) -> Result<(Model, Vec<f64>), AnalysisError> {
        let laws = self.case_with_laws(effects);
        let case = case_with(&laws, &self.configs(effects, hints, base, share));
        let model = Model::new(Arc::new(case), self.catalogue, self.how)?;
        let mut theta = transfer(&base.model, &base.theta, &model);
        self.start_other_bulk(&base.model, &model, &mut theta)?;
        Ok((model, theta))
    }

    /// The share of the screen's estimate that misses the records least; the smallest where none gives an answer.
    fn best_share(
        &self,
        effects: &[String],
        hints: &diagnose::Hints,
        base: &Fitted,
        correction: &Correction,
    ) -> Result<f64, AnalysisError> {
        // By what the fit minimises.
        let whitener = Whitener::new(&self.measured.data, None, Noise::Record);
        let mut best = (f64::INFINITY, SHARES[SHARES.len() - 1]);
        for share in SHARES {
            let (model, theta) = self.begun(effects, hints, base, share)?;
            let slots = &self.measured.slots;
            let mut problem = FeProblem::new(&model, theta, Vec::new(), slots, self.options, self.cancelled);
            problem.options.stepping.budget = crate::identify::TRIAL_BUDGET;
            problem.correction = correction.clone();
            problem.start_from(self.guesses(base, &model));
            self.runs.fetch_add(1, Ordering::Relaxed);
            match problem.predict(&[], false) {
                Ok(p) => {
                    let f = whitener.apply(&self.measured.data.misfit(&p.values)).norm_squared();
                    if f < best.0 {
                        best = (f, share);
                    }
                }
                Err(e @ inverse::PredictError::Interrupted) => return Err(e.into()),
                Err(_) => {}
            }
        }
        (self.progress)(&format!(
            "{}: once more from {} of the screen's estimate",
            super::named(effects),
            best.1
        ));
        Ok(best.1)
    }

    /// Once more from the values that a search from the record alone begins with, and the effect's own: the lack of it may
    /// have bent the base beyond recognition. The better of the two fits.
    pub(super) fn restart_from_the_record(&self, effects: &[String], first: Fitted) -> Fitted {
        let key = Self::key(effects);
        let (Some(base), Some(bare)) = (self.nearest(&key), self.fitted_models.get(&Vec::new())) else {
            return first;
        };
        let Ok((model, _)) = self.begun(effects, &diagnose::Hints::new(), base, 1.0) else {
            return first;
        };
        if model.case.bulk.law != bare.model.case.bulk.law {
            return first;
        }
        let theta = transfer(&bare.model, &self.first, &model);
        (self.progress)(&format!(
            "{}: once more from where the record's own start is",
            super::named(effects)
        ));
        let Ok(correction) = self.correction_beside(base, &model) else { return first };
        match self.fit_model(model, theta, correction, Vec::new(), first.fit.f) {
            Ok(f) if f.fit.f < first.fit.f => f,
            _ => first,
        }
    }

    /// Once more from where `fct identify` begins with this model in the file, its effects as the first fit has them: the
    /// base's optimum, from which that was fitted, may be bent to where no step leads out. The better of the two fits.
    pub(super) fn restart_as_identified(&self, first: Fitted) -> Fitted {
        (self.progress)(&format!(
            "{}: once more from the record",
            super::named(&self.parts_of(&first.model))
        ));
        match self.fitted_from_the_record(&first) {
            Ok(f) if f.fit.f < first.fit.f => f,
            _ => first,
        }
    }

    /// A fit that misses the records by far, taken to where `identify` of its model ends on the file's mesh, if that misses them less.
    pub(super) fn end_as_identified(&self, first: Fitted) -> Fitted {
        if first.quality.reduced_chi2_total <= FAR || self.cancelled.stops() {
            return first;
        }
        match self.settle_as_identified(&first) {
            Ok(Some((f, _))) if f.fit.f < first.fit.f => f,
            _ => first,
        }
    }

    fn fitted_from_the_record(&self, first: &Fitted) -> Result<Fitted, AnalysisError> {
        let case = Arc::new(with_effects_at(first));
        let model = Model::new(case.clone(), self.catalogue, self.how)?;
        let theta = self.start_by_record(&case, &model)?;
        let correction = Correction::constant(first.correction.shift.clone());
        self.fit_model(model, theta, correction, Vec::new(), first.fit.f)
    }
}

/// A fit's case, its effects at the fitted values.
pub(super) fn with_effects_at(f: &Fitted) -> Case {
    let mut case = (*f.model.case).clone();
    for effect in &mut case.effects {
        for spec in &effect.specs {
            let path = format!("effects.{}.{}", effect.name, spec.name);
            if let (Some(i), Some(v)) = (f.model.find(&path), effect.parameters.get_mut(spec.name.as_ref())) {
                v.value = Some(f.theta[i]);
            }
        }
    }
    case
}

/// Gives the parameters that a fit left at a bound their own start; whether there are any.
fn off_bounds(of: &Fitted, model: &Model, theta: &mut [f64]) -> bool {
    let start = model.theta();
    let mut any = false;
    for (&i, _) in of.free.iter().zip(&of.fit.at_bound).filter(|(_, at)| **at) {
        if let Some(j) = model.find(&of.model.parameters[i].path) {
            theta[j] = start[j];
            any = true;
        }
    }
    any
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ladder::catalogue::{Done, Now};
    use crate::ladder::tests::unexplained;

    /// What misses the records by far, wherever it stood, goes to where `identify` of its model ends on the file's mesh.
    #[test]
    fn what_misses_by_far_is_taken_to_where_identify_ends() {
        let catalogue = effects::catalogue();
        let mut ladder = unexplained(&catalogue);
        let identified = ladder.shown(&[]).expect("a base model").fit.f;
        let mut astray = ladder.fitted_models.remove(&Vec::new()).expect("a base fit");
        astray.fit.f = f64::INFINITY;
        // What the file's mesh would say is so wrong that no fit on the search's mesh comes near.
        astray.correction.shift.add_scalar_mut(1.0);
        let found = ladder.end_as_identified(ladder.restart_as_identified(astray));
        println!(
            "χ² {} ({} a point), identify {}",
            found.fit.f, found.quality.reduced_chi2_total, identified
        );
        assert!(found.quality.reduced_chi2_total > FAR && found.settled);
        assert!(found.fit.f <= 1.001 * identified, "{} for {}", found.fit.f, identified);
    }

    /// Where noise is left, what leads begins once more, unless the base does; elsewhere all that is near, and what leads ends where
    /// `identify` of it does; each once.
    #[test]
    fn what_leads_is_taken_to_where_identify_ends_and_its_rivals_are_not() {
        let catalogue = effects::catalogue();
        let mut ladder = unexplained(&catalogue);
        let sets = ["compliance", "slack"].map(|e| vec![e.to_owned()]);
        ladder.columns_at(&[]).expect("columns");
        ladder.fit_sets(&sets).expect("fits");
        let (found, posterior, models) = ladder.posterior().expect("probabilities");
        let mut now = Now { found, posterior, models, noise: true, leads: vec![sets[0].clone(), Vec::new()] };
        let mut done = Done::default();
        assert!(
            !ladder.begin_rivals_again(&mut done, &now) && !ladder.end_leaders_as_identified(&mut done, &now)
        );
        // A base that does not lead is bent.
        now.leads.pop();
        assert!(
            ladder.begin_rivals_again(&mut done, &now) && !ladder.end_leaders_as_identified(&mut done, &now)
        );
        assert_eq!(done.twice, sets[..1].iter().cloned().collect());
        now.noise = false;
        assert!(
            ladder.begin_rivals_again(&mut done, &now) && ladder.end_leaders_as_identified(&mut done, &now)
        );
        assert_eq!(done.twice, sets.iter().cloned().collect());
        assert_eq!(done.ended, sets[..1].iter().cloned().collect());
        assert!(
            !ladder.begin_rivals_again(&mut done, &now) && !ladder.end_leaders_as_identified(&mut done, &now)
        );
    }

    /// Of the fits that ended worse than the base, those that did so clearly begin once more, where the base leaves more than noise.
    #[test]
    fn what_ended_clearly_worse_than_the_base_begins_once_more() {
        let catalogue = effects::catalogue();
        let mut ladder = unexplained(&catalogue);
        let sets = ["compliance", "drift"].map(|e| vec![e.to_owned()]);
        ladder.columns_at(&[]).expect("columns");
        ladder.fit_sets(&sets).expect("fits");
        // As if what is left were near the noise: no reason to begin all again.
        let base = ladder.fitted_models.get_mut(&Vec::new()).expect("a base fit");
        base.quality.reduced_chi2_total = 1.0;
        let lost = [1.05, 10.0].map(|times| times * base.fit.f);
        for (set, f) in sets.iter().zip(lost) {
            ladder.fitted_models.get_mut(set).expect("a fit").fit.f = f;
        }
        let (found, posterior, models) = ladder.posterior().expect("probabilities");
        let mut now = Now { found, posterior, models, noise: true, leads: Vec::new() };
        let ends = |ladder: &FeLadder| sets.clone().map(|s| ladder.fitted_models[&s].fit.f);
        ladder.begin_again(&sets, &now).expect("fits");
        assert_eq!(ends(&ladder), lost);
        now.noise = false;
        ladder.begin_again(&sets, &now).expect("fits");
        let [little, much] = ends(&ladder);
        assert!(little == lost[0] && much < 0.5 * lost[1], "{little} {much} of {lost:?}");
    }
}
