//! A search's answer: what the probabilities decide, and the models that show the error fall.

use super::{FeLadder, Fitted};
use crate::averaged::{Averaged, averaged};
use crate::identify::AnalysisError;
use crate::probable::{Probable, explained_by};
use diagnose::{Discovery, FittedModel, Hints, Policy, Verdict};
use evidence::{Decision, ExplainedTo, Posterior, decide};

/// What a search by probabilities found.
pub struct Weighed {
    /// The answer as the contract has it.
    pub discovery: Discovery,
    /// The probabilities behind it.
    pub probable: Probable,
    /// The tissue's values, averaged over what may be missing; of a search alone.
    pub averaged: Option<Averaged>,
}

impl FeLadder<'_> {
    /// Weighs the catalogue by real fits and answers by the table of losses.
    ///
    /// # Errors
    /// [`AnalysisError`].
    pub fn weighed(&mut self) -> Result<Weighed, AnalysisError> {
        let (probable, posterior) = self.weigh_catalogue()?;
        let (decision, steps) = self.decided(&posterior, probable.left.explained_to)?;
        let averaged = match averaged(self, &posterior) {
            Ok(averaged) => Some(averaged),
            // What was found stands without it.
            Err(why) => {
                (self.progress)(&format!("No average over what may be missing ({why})."));
                None
            }
        };
        Ok(Weighed { averaged, ..self.answered(decision, steps, probable) })
    }

    /// What is named, and the models that show it, each fitted: `leading` is to what the leading set explains the records.
    fn decided(
        &mut self,
        posterior: &Posterior,
        leading: ExplainedTo,
    ) -> Result<(Decision, Vec<Vec<String>>), AnalysisError> {
        let decision = decide(posterior, leading);
        let steps = self.steps_to(&decision)?;
        // The records are explained by what is named, not by what leads and is too uncertain to be named.
        let named = explained_by(self, &decision.found)
            .map_err(|e| AnalysisError::Case(format!("no size of what is left: {e}")))?;
        Ok((decide(posterior, named.unwrap_or(leading)), steps))
    }

    /// Weighs the catalogue by its derivatives at the base model alone: nothing else is fitted.
    ///
    /// # Errors
    /// [`AnalysisError`].
    pub fn weighed_by_columns(&mut self) -> Result<Weighed, AnalysisError> {
        let (probable, posterior) = self.weigh_columns()?;
        let decision = decide(&posterior, probable.left.explained_to);
        Ok(self.answered(decision, Vec::new(), probable))
    }

    /// The base model and, where that explains too little, the most probable effects beside it, each fitted on the file's mesh.
    ///
    /// # Errors
    /// [`AnalysisError`].
    pub(crate) fn likely(&mut self, most: usize, policy: &Policy) -> Result<Vec<FittedModel>, AnalysisError> {
        let base: Vec<FittedModel> = self.base_model_fit().into_iter().collect();
        if most == 0 || base.iter().all(|r| r.explained(policy)) {
            return Ok(base);
        }
        let (probable, _) = self.weigh_columns()?;
        let mut effects: Vec<(&String, &f64)> = probable.posterior.effects.iter().collect();
        effects.sort_by(|a, b| b.1.total_cmp(a.1).then(a.0.cmp(b.0)));
        let sets: Vec<Vec<String>> = effects.into_iter().take(most).map(|(e, _)| vec![e.clone()]).collect();
        self.fit_sets(&sets)?;
        self.settle_sets(&sets)?;
        let fitted = sets.iter().filter_map(|s| self.fitted_models.get(s).map(|f| self.fitted_model(s, f)));
        Ok(base.into_iter().chain(fitted).collect())
    }

    /// The effects of a decision one after the other, most probable first, each model at its optimum on the file's mesh.
    fn steps_to(&mut self, decision: &Decision) -> Result<Vec<Vec<String>>, AnalysisError> {
        let steps: Vec<Vec<String>> =
            (1..=decision.found.len()).map(|n| decision.found[..n].to_vec()).collect();
        let keys: Vec<Vec<String>> = steps.iter().map(|s| Self::key(s)).collect();
        for key in &keys {
            if !self.fitted_models.contains_key(key) && !self.interrupted() {
                self.fit_sets(std::slice::from_ref(key))?;
            }
        }
        let open: Vec<Vec<String>> =
            keys.into_iter().filter(|k| self.fitted_models.get(k).is_some_and(|f| !f.settled)).collect();
        if !self.interrupted() {
            self.settle_sets(&open)?;
        }
        Ok(steps.into_iter().filter(|s| self.fitted_models.contains_key(&Self::key(s))).collect())
    }

    fn answered(&self, decision: Decision, steps: Vec<Vec<String>>, probable: Probable) -> Weighed {
        let base = self.base_model_fit();
        let kept = |effects: &Vec<String>| {
            self.fitted_models.get(&Self::key(effects)).map(|f| self.fitted_model(effects, f))
        };
        let ladder: Vec<FittedModel> = base.into_iter().chain(steps.iter().filter_map(kept)).collect();
        let tried = self.fitted_models.iter().map(|(key, f)| self.fitted_model(key, f)).collect();
        let screen_at = |key: &[String]| self.screens.get(key).cloned().unwrap_or_default();
        let top = steps.last().map(|s| Self::key(s)).unwrap_or_default();
        let discovery = Discovery {
            tried,
            failed: self.failed.clone().into_iter().collect(),
            screen: screen_at(&[]),
            last_screen: self.screens.get(&top).cloned().unwrap_or_else(|| screen_at(&[])),
            found: decision.found,
            groups: decision.groups,
            undecided: decision.undecided,
            verdict: match decision.verdict {
                evidence::Verdict::NothingMissing => Verdict::NothingMissing,
                evidence::Verdict::Explained => Verdict::Explained,
                evidence::Verdict::Ambiguous => Verdict::Ambiguous,
                evidence::Verdict::Unexplained => Verdict::Unexplained,
            },
            interrupted: self.interrupted(),
            ladder,
        };
        Weighed { discovery, probable, averaged: None }
    }

    /// The base model as `fct identify` of the same file answers.
    fn base_model_fit(&self) -> Option<FittedModel> {
        self.shown(&[]).map(|f| self.fitted_model(&[], f))
    }

    /// The fit that is shown of a set: of the base model, what `fct identify` finds, whose stages need not end where all
    /// parameters would move to together.
    pub fn shown(&self, key: &[String]) -> Option<&Fitted> {
        let identified = self.identified.as_ref().filter(|_| key.is_empty());
        identified.or_else(|| self.fitted_models.get(key))
    }

    /// What the screen at the nearest model proposes for a set.
    pub(super) fn proposed(&self, set: &[String]) -> Hints {
        let nearest = self.nearest_of(set).and_then(|(key, _)| self.screens.get(key));
        let screen = nearest.or_else(|| self.screens.get(&Vec::new()));
        screen.map_or_else(Hints::new, |s| s.findings.iter().map(|f| (f.effect.clone(), f.clone())).collect())
    }
}

/// The posterior and what is said of it.
pub(super) type Probabilities = (Probable, Posterior);

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ladder::tests::unexplained;
    use evidence::{Judged, SetPrior};

    /// A leading set explains the records by an effect that is too uncertain to be named: without it they are not explained.
    #[test]
    fn the_verdict_goes_by_what_is_named() {
        let catalogue = effects::catalogue();
        let mut ladder = unexplained(&catalogue);
        let sets = [vec![], vec!["drift".to_owned()], vec!["compliance".to_owned(), "drift".to_owned()]];
        let models = [-40.0, 0.0, 4.0].iter().zip(&sets);
        let models: Vec<Judged> = models.map(|(z, s)| Judged::from_numbers(s, *z, -99.0)).collect();
        let posterior = Posterior::of(&models, &SetPrior::of_catalogue(20));
        assert_eq!(posterior.leader().map(|s| s.effects.len()), Some(2));
        assert_eq!(decide(&posterior, ExplainedTo::Practice).verdict, evidence::Verdict::Explained);
        let (decision, steps) = ladder.decided(&posterior, ExplainedTo::Practice).expect("a decision");
        assert_eq!((&decision.found, &steps), (&sets[1], &vec![sets[1].clone()]));
        assert_eq!(decision.verdict, evidence::Verdict::Unexplained);
    }
}
