//! The search, and the question whether its base model was where it could be.

use super::fit::TOLERANCE;
use super::{FeLadder, Fitted};
use crate::columns::transfer;
use crate::identify::AnalysisError;
use diagnose::Discovery;
use model::Model;

/// The share of an answer's fall that the base model must get alone for it to have been stuck.
const STUCK: f64 = 0.5;

impl FeLadder<'_> {
    /// Adds effects until the record is explained, or honestly not. Where the base model, begun at the values of the
    /// answer, falls more than half as far without the effects, it had stuck in a local minimum: then the search is
    /// made once more, from there.
    ///
    /// # Errors
    /// [`AnalysisError`].
    pub fn search(&mut self) -> Result<Discovery, AnalysisError> {
        let (say, policy) = (self.progress, self.policy.clone());
        let found = diagnose::discover(self, &policy, &mut |s| say(s))?;
        let Some(base) = self.unstuck(&found) else { return Ok(found) };
        say(
            "the base model had stuck: most of the fall is its own; the search begins again from these values",
        );
        self.rungs.clear();
        self.rungs.insert(Vec::new(), base);
        diagnose::discover(self, &policy, &mut |s| say(s))
    }

    /// The base model fitted from an answer's values, if that shows that it had stuck.
    fn unstuck(&self, found: &Discovery) -> Option<Fitted> {
        if found.interrupted || found.found.is_empty() {
            return None;
        }
        let base = self.rungs.get(&Vec::new())?;
        let answer = self.rungs.get(&Self::key(&found.found))?;
        let model = Model::new(self.case.clone(), self.catalogue, self.how).ok()?;
        let theta = transfer(&answer.model, &answer.theta, &model);
        let states = self.guesses(answer, &model);
        (self.progress)("the base model once more, from the values of this answer");
        let again = self.fit_model(model, theta, TOLERANCE, base.correction.clone(), states).ok()?;
        let fall = base.fit.f - answer.fit.f;
        let stuck = fall > 0.0 && base.fit.f - again.fit.f > STUCK * fall;
        if stuck { self.corrected(again).ok() } else { None }
    }
}
