//! The base of a search: the least-squares optimum on the file's mesh.

use super::settle::{Begun, FineStates, ROUNDS};
use super::{FeLadder, Fitted, LadderSettings};
use crate::columns::transfer;
use crate::cost::Phase;
use crate::identify::{Again, AnalysisError, FAR, Searched, searched};
use input::Case;
use model::{Discretisation, Model};
use std::sync::Arc;
use std::sync::atomic::Ordering;

/// How much coarser than the file's mesh the search's is.
const COARSER: f64 = 3.0;

/// Share of the difference of the two meshes that is left on the file's: of first order at the corners of clamped ends, on a
/// mesh three times as fine.
const LEFT_OF_MESH: f64 = 0.5;

impl<'a> FeLadder<'a> {
    /// The base model at its optimum on the file's mesh; nothing else is fitted.
    ///
    /// # Errors
    /// [`AnalysisError`].
    pub fn weighing(case: Arc<Case>, how: LadderSettings<'a>) -> Result<Self, AnalysisError> {
        let (mut ladder, model) = Self::prepared(case, how)?;
        let found = ladder.identify(&ladder.fine_case, "base model", f64::INFINITY)?;
        let begun = ladder.begun_at(model, &found.theta)?;
        ladder.cancelled.phase(Phase::Base);
        ladder.torn = found.torn;
        let (mut base, mut states) = ladder.settle(begun, None, 0)?.ok_or_else(no_answer)?;
        if !found.joint && ladder.fine_case.identify.max_iterations > 0 {
            if let Some(together) = ladder.together(&base, &states, found.beside.as_deref())? {
                ladder.identified = Some(std::mem::replace(&mut base, together.0));
                states = together.1;
            }
            base.settled = false;
        }
        // What misses the records by far is taken to its end once an answer may hang on it.
        let near = base.quality.reduced_chi2_total <= FAR;
        let mut ladder = ladder.based_on(base, states);
        if near {
            ladder.settle_base()?;
        }
        Ok(ladder)
    }

    /// Takes the base model to where all its parameters move to together, on the file's mesh; whether it was not there yet.
    pub(super) fn settle_base(&mut self) -> Result<bool, AnalysisError> {
        let Some(base) = self.fitted_models.get(&Vec::new()).filter(|f| !f.settled) else { return Ok(false) };
        let begun = self.begun_of(base)?;
        let (settled, states) =
            self.settle(begun, self.fine_states.as_ref(), ROUNDS)?.ok_or_else(no_answer)?;
        self.fine_states = Some(states);
        let before = self.fitted_models.insert(Vec::new(), settled);
        self.identified = self.identified.take().or(before);
        Ok(true)
    }

    /// The same from the file's values alone: no start is sought, all parameters move together.
    pub(crate) fn from_values(case: Arc<Case>, how: LadderSettings<'a>) -> Result<Self, AnalysisError> {
        let (ladder, model) = Self::prepared(case, how)?;
        let fine = Model::new(ladder.fine_case.clone(), ladder.catalogue, Discretisation::default())?;
        let begun = ladder.begun_at(model, &fine.theta())?;
        let (base, states) = ladder.settle(begun, None, ROUNDS)?.ok_or_else(no_answer)?;
        Ok(ladder.based_on(base, states))
    }

    /// A ladder without a model, and the model of its mesh.
    fn prepared(case: Arc<Case>, how: LadderSettings<'a>) -> Result<(Self, Model), AnalysisError> {
        let mut ladder = Self::unfitted(case, how)?;
        if ladder.fine_case.mesh.divisions.is_none() {
            ladder.how.coarsen = COARSER;
        }
        let newton = &mut ladder.options.stepping.newton;
        newton.tolerance = newton.tolerance.max(crate::identify::SEARCH_TOLERANCE);
        let model = Model::new(ladder.case.clone(), ladder.catalogue, ladder.how)?;
        ladder.measured = ladder.measured.as_estimated(&model)?;
        Ok((ladder, model))
    }

    /// With its base, whose difference of the two meshes counts as the file's mesh's own error.
    fn based_on(mut self, base: Fitted, states: FineStates) -> Self {
        let error = LEFT_OF_MESH * &base.correction.shift;
        self.measured = self.measured.clone().with_numerical_error(&error);
        self.fine_states = Some(states);
        self.fitted_models.insert(Vec::new(), base);
        self
    }

    /// The values that `fct identify` of a file finds; where the base began at what the record of a tear tells, that is not
    /// asked again. What does not come below an objective is of no use.
    pub(super) fn identify(
        &self,
        case: &Arc<Case>,
        name: &str,
        below: f64,
    ) -> Result<Searched, AnalysisError> {
        let say = self.progress;
        let shown = |p: &crate::Progress| {
            let objective = p.iterate.f.map_or("no answer".into(), |f| format!("objective {f:.4e}"));
            let mesh = if p.coarse { " on the coarse mesh" } else { "" };
            say(&format!("{name}, {}{mesh}: iteration {}, {objective}", p.stage.word(), p.iterate.iteration));
        };
        let control = crate::Control { progress: &shown, cancelled: self.cancelled, journal: self.journal };
        let found =
            searched(case, self.catalogue, &control, Again { starts: self.known_starts(case), below })?;
        self.runs.fetch_add(found.runs, Ordering::Relaxed);
        Ok(found)
    }

    /// Where all parameters of the base model together ended beside the identification's answer, if that misses the records less.
    fn together(
        &self,
        base: &Fitted,
        states: &FineStates,
        beside: Option<&[f64]>,
    ) -> Result<Option<(Fitted, FineStates)>, AnalysisError> {
        let Some(theta) = beside else { return Ok(None) };
        let model = Model::new(self.case.clone(), self.catalogue, self.how)?;
        let there = self.settle(self.begun_at(model, theta)?, Some(states), 0)?;
        Ok(there.filter(|(f, _)| f.fit.f < base.fit.f))
    }

    /// A model of the search's mesh at values of the file's, as the start of a fit.
    fn begun_at(&self, model: Model, theta: &[f64]) -> Result<Begun, AnalysisError> {
        let fine = Model::new(self.fine_case.clone(), self.catalogue, Discretisation::default())?;
        Ok(self.begun_from(&fine, model, theta))
    }

    /// The same from a model of the file's mesh.
    pub(super) fn begun_from(&self, fine: &Model, model: Model, theta: &[f64]) -> Begun {
        let theta = transfer(fine, theta, &model);
        let free = model.free();
        let free_parameters = self.free_parameters(&model, &theta, &free);
        Begun { model, theta, free, free_parameters, warm: Vec::new() }
    }
}

fn no_answer() -> AnalysisError {
    AnalysisError::Case("the model gives no answer on the file's mesh at the values that fit".into())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ladder::catalogue::Now;
    use crate::ladder::tests::{unheard, unloaded};

    /// An intact strip that stiffens as no tissue does beside a tear that unloads as none does, with this noise.
    fn staged(catalogue: &model::Catalogue, force_sd: f64) -> Arc<Case> {
        let mut case = unloaded(catalogue);
        let mut strip = case.tests[0].clone();
        strip.kind =
            input::TestKind::new(catalogue.experiments().get("uniaxial").expect("an experiment").card());
        strip.name = "strip".into();
        if let Some(r) = &mut strip.record {
            r.force = r.displacement.iter().map(|u| 0.2 * u + 0.1 * u * u).collect();
        }
        case.tests.insert(0, strip);
        case.tests.iter_mut().for_each(|t| t.force_sd = Some(force_sd));
        Arc::new(case)
    }

    /// A base model that misses by far stands, and is shown, where `identify` ends until it is asked for; one that is near moves on.
    #[test]
    fn a_base_that_misses_by_far_is_taken_to_its_end_when_asked_for() {
        let catalogue = effects::catalogue();
        let far = FeLadder::weighing(staged(&catalogue, 0.002), unheard(&catalogue)).expect("a base fit");
        let near = FeLadder::weighing(staged(&catalogue, 0.2), unheard(&catalogue)).expect("a base fit");
        let none = Vec::new();
        assert!(!far.fitted_models[&none].settled && near.fitted_models[&none].settled);
        let mut ladder = far;
        // At the identification's stages, from where all parameters move on.
        let stages = ladder.begun_of(ladder.shown(&none).expect("a fit")).expect("a start");
        let (mut base, _) = ladder.settle(stages, None, 0).expect("a run").expect("an answer");
        base.settled = false;
        ladder.fitted_models.insert(none.clone(), base);
        let at = |f: &Fitted| (f.theta.clone(), f.fit.f);
        let (shown, begun) = (at(ladder.shown(&none).expect("a fit")), ladder.fitted_models[&none].fit.f);
        ladder.columns_at(&none).expect("columns");
        let (found, posterior, models) = ladder.posterior().expect("probabilities");
        let mut now = Now { found, posterior, models, noise: false, leads: vec![vec!["mullins".to_owned()]] };
        assert!(!ladder.settle_leading_base(&now).expect("nothing that leads"));
        now.leads.push(none.clone());
        assert!(ladder.settle_leading_base(&now).expect("a fit"));
        let end = &ladder.fitted_models[&none];
        assert!(end.settled && end.fit.f < 0.9 * begun, "{} {begun} {}", shown.1, end.fit.f);
        assert_eq!(at(ladder.shown(&none).expect("a fit")), shown);
        assert!(!ladder.settle_base().expect("nothing to do"));
    }
}
