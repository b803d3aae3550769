//! The catalogue weighed: every effect really fitted, sets grown by their evidence, what matters fitted on the file's mesh.
//!
//! The base is the least-squares optimum on the file's mesh. Fits of effects take the search's mesh, put right at the base
//! to first order in its parameters ([`crate::Correction`]); sets with a share of the posterior are then fitted on the
//! file's mesh themselves, their steps taken on the search's (`inverse::fit_mapped`).

use super::decided::Probabilities;
use super::fit::FAR;
use super::laws::other_laws;
use super::settle::{Begun, FineStates, ROUNDS};
use super::{FeLadder, Fitted, LadderSettings, named};
use crate::columns::transfer;
use crate::cost::Phase;
use crate::identify::{AnalysisError, Searched, searched};
use crate::probable::{Probable, probable_with_models};
use input::Case;
use model::{Discretisation, Model};
use rayon::prelude::*;
use std::collections::BTreeSet;
use std::sync::Arc;
use std::sync::atomic::Ordering;

/// Share of the posterior from which on a set is fitted on the file's mesh, and the catalogue's columns are computed there, to
/// see what would be added to it.
const LEADS: f64 = 0.05;
/// Share of a set, in those of its part that has most, from which on it may say something else than its part does: it was
/// fitted from there, with the file's mesh seen from there.
const OVERTAKES: f64 = 1.0 / 3.0;
/// Most effects of a set.
const LARGEST: usize = 4;
/// Sets that are fitted in one round.
const AT_ONCE: usize = 8;
/// Share of the difference of the two meshes that is left on the file's: of first order at the corners of clamped ends, on a
/// mesh three times as fine.
const LEFT_OF_MESH: f64 = 0.5;

impl<'a> FeLadder<'a> {
    /// The base model at its optimum on the file's mesh; nothing else is fitted.
    ///
    /// # Errors
    /// [`AnalysisError`].
    pub fn weighing(case: Arc<Case>, how: LadderSettings<'a>) -> Result<Self, AnalysisError> {
        let mut ladder = Self::unfitted(case, how)?;
        if ladder.fine_case.mesh.divisions.is_none() {
            ladder.how.coarsen = COARSER;
        }
        let newton = &mut ladder.options.stepping.newton;
        newton.tolerance = newton.tolerance.max(crate::identify::SEARCH_TOLERANCE);
        let model = Model::new(ladder.case.clone(), ladder.catalogue, ladder.how)?;
        ladder.measured = ladder.measured.as_estimated(&model)?;
        let found = ladder.identify()?;
        let begun = ladder.begun_at(model, &found.theta)?;
        ladder.cancelled.phase(Phase::Base);
        let none = || {
            AnalysisError::Case("the model gives no answer on the file's mesh at the values that fit".into())
        };
        let (mut base, mut states) = ladder.settle(begun, None, 0)?.ok_or_else(none)?;
        if !found.joint && ladder.fine_case.identify.max_iterations > 0 {
            let begun = ladder.begun_together(&base, &states, found.beside.as_deref())?;
            let all = ladder.settle(begun, Some(&states), ROUNDS)?.ok_or_else(none)?;
            ladder.identified = Some(std::mem::replace(&mut base, all.0));
            states = all.1;
        }
        let error = LEFT_OF_MESH * &base.correction.shift;
        ladder.measured = ladder.measured.clone().with_numerical_error(&error);
        ladder.fine_states = Some(states);
        ladder.fitted_models.insert(Vec::new(), base);
        Ok(ladder)
    }

    /// The values that `fct identify` of the same file finds.
    fn identify(&self) -> Result<Searched, AnalysisError> {
        let say = self.progress;
        let shown = |p: &crate::Progress| {
            let objective = p.iterate.f.map_or("no answer".into(), |f| format!("objective {f:.4e}"));
            let mesh = if p.coarse { " on the coarse mesh" } else { "" };
            say(&format!(
                "base model, {}{mesh}: iteration {}, {objective}",
                p.stage.word(),
                p.iterate.iteration
            ));
        };
        let control = crate::Control { progress: &shown, cancelled: self.cancelled, journal: self.journal };
        let found = searched(&self.fine_case, self.catalogue, &control)?;
        self.runs.fetch_add(found.runs, Ordering::Relaxed);
        Ok(found)
    }

    /// Where the base model's fit to all records begins: at the identification's answer, or where all its parameters together
    /// ended beside that, if that misses the records less.
    fn begun_together(
        &self,
        base: &Fitted,
        states: &FineStates,
        beside: Option<&[f64]>,
    ) -> Result<Begun, AnalysisError> {
        if let Some(theta) = beside {
            let again = || Model::new(self.case.clone(), self.catalogue, self.how);
            let there = self.settle(self.begun_at(again()?, theta)?, Some(states), 0)?;
            if there.is_some_and(|(f, _)| f.fit.f < base.fit.f) {
                return self.begun_at(again()?, theta);
            }
        }
        self.begun_of(base)
    }

    /// A model of the search's mesh at values of the file's, as the start of a fit.
    fn begun_at(&self, model: Model, theta: &[f64]) -> Result<Begun, AnalysisError> {
        let fine = Model::new(self.fine_case.clone(), self.catalogue, Discretisation::default())?;
        let theta = transfer(&fine, theta, &model);
        let free = model.free();
        let free_parameters = self.free_parameters(&model, &theta, &free);
        Ok(Begun { model, theta, free, free_parameters, warm: Vec::new() })
    }

    /// Fits every effect, and every set that matters: what leads is taken to the file's mesh before anything is added to it,
    /// so that additions are judged at an optimum.
    ///
    /// # Errors
    /// [`AnalysisError`].
    pub(super) fn weigh_catalogue(&mut self) -> Result<Probabilities, AnalysisError> {
        self.columns_at(&[])?;
        let mut first = true;
        let mut twice = BTreeSet::new();
        loop {
            let (found, posterior, models) = self.posterior()?;
            if self.interrupted() {
                return Ok((found, posterior));
            }
            (self.progress)(found.sentence().trim_end_matches('.'));
            if std::mem::take(&mut first) {
                let mut singles = self.singles(&found, &models);
                singles.extend(other_laws(&self.case, self.catalogue).into_iter().map(|law| vec![law]));
                self.fit_sets(&singles)?;
                self.begin_again(&singles)?;
                continue;
            }
            let noise = found.left.explained_to == evidence::ExplainedTo::Noise;
            let leads: Vec<Vec<String>> =
                leading(&posterior).into_iter().filter(|s| self.fitted_models.contains_key(s)).collect();
            let unsettled: Vec<Vec<String>> =
                leads.iter().filter(|s| !self.fitted_models[*s].settled).cloned().collect();
            let once: Vec<Vec<String>> = (unsettled.iter())
                .filter(|s| !noise && !s.is_empty() && !twice.contains(*s))
                .cloned()
                .collect();
            if !once.is_empty() {
                self.begin_as_identified(&once);
                twice.extend(once);
                continue;
            }
            if !unsettled.is_empty() {
                self.settle_sets(&unsettled)?;
                continue;
            }
            let unscreened: Vec<&Vec<String>> =
                (leads.iter()).filter(|s| s.len() < LARGEST && !self.screened.contains_key(*s)).collect();
            for set in &unscreened {
                self.columns_at(set)?;
            }
            if !unscreened.is_empty() {
                continue;
            }
            let beside = if noise { Vec::new() } else { self.with_other_laws(&leads) };
            let open: Vec<Vec<String>> = (evidence::to_fit(&posterior, &models).into_iter())
                .chain(beside)
                .filter(|s| {
                    s.len() <= LARGEST && !self.fitted_models.contains_key(s) && !self.failed.contains_key(s)
                })
                .take(AT_ONCE)
                .collect();
            if open.is_empty() {
                return Ok((found, posterior));
            }
            self.fit_sets(&open)?;
        }
    }

    /// Where no effect explains what the base leaves by far, all are fitted once more from the record's own start.
    fn begin_again(&mut self, sets: &[Vec<String>]) -> Result<(), AnalysisError> {
        let best =
            self.fitted_models.values().map(|f| f.quality.reduced_chi2_total).fold(f64::INFINITY, f64::min);
        if best <= FAR || self.interrupted() {
            return Ok(());
        }
        self.first = self.unbent()?;
        self.cancelled.phase(Phase::Candidates);
        let begun: Vec<(Vec<String>, Fitted)> =
            sets.iter().filter_map(|s| self.fitted_models.remove_entry(s)).collect();
        let this = &*self;
        let again: Vec<(Vec<String>, Fitted)> = (begun.into_par_iter())
            .map(|(set, f)| (set.clone(), this.restart_from_the_record(&set, f)))
            .collect();
        self.fitted_models.extend(again);
        Ok(())
    }

    /// Sets once more from where `fct identify` of the same model would begin; the better of the two fits is kept.
    fn begin_as_identified(&mut self, sets: &[Vec<String>]) {
        self.cancelled.phase(Phase::Candidates);
        let begun: Vec<(Vec<String>, Fitted)> =
            sets.iter().filter_map(|s| self.fitted_models.remove_entry(s)).collect();
        let this = &*self;
        let again: Vec<(Vec<String>, Fitted)> =
            begun.into_par_iter().map(|(set, f)| (set, this.restart_as_identified(f))).collect();
        self.fitted_models.extend(again);
    }

    /// The effects that are fitted first: all of them; where the base leaves noise alone, so that no effect can gain much, those
    /// whose columns gain something, or that have none.
    fn singles(&self, found: &Probable, models: &[evidence::Judged]) -> Vec<Vec<String>> {
        let noise = found.left.explained_to == evidence::ExplainedTo::Noise;
        let present: BTreeSet<&str> = self.case.effects.iter().map(|e| e.name.as_str()).collect();
        let refused = |set: &Vec<String>| {
            let mut judged = models.iter().filter(|m| &m.effects == set);
            noise && judged.next().is_some_and(|m| m.gain <= 0.0)
        };
        self.candidates
            .iter()
            .filter(|c| !present.contains(c.effect.as_str()))
            .filter(|c| self.catalogue.get(&c.effect).is_some_and(|e| !e.card().negative_control))
            .map(|c| vec![c.effect.clone()])
            .filter(|set| !refused(set))
            .collect()
    }

    fn posterior(&self) -> Result<(Probable, evidence::Posterior, Vec<evidence::Judged>), AnalysisError> {
        probable_with_models(self).map_err(|e| AnalysisError::Case(format!("no probabilities: {e}")))
    }

    /// The catalogue by its columns at the base model.
    pub(super) fn weigh_columns(&mut self) -> Result<Probabilities, AnalysisError> {
        self.columns_at(&[])?;
        self.posterior().map(|(found, posterior, _)| (found, posterior))
    }

    /// The catalogue's columns at a fitted set.
    fn columns_at(&mut self, set: &[String]) -> Result<(), AnalysisError> {
        let Some(f) = self.fitted_models.get(set) else { return Ok(()) };
        let fitted_model = self.fitted_model(set, f);
        let screen = self.screen(&fitted_model)?;
        self.screens.insert(set.to_vec(), screen);
        Ok(())
    }

    /// Fits sets side by side. One that cannot be fitted is left out, and said to be.
    ///
    /// # Errors
    /// [`AnalysisError`] when the user stops it.
    pub fn fit_sets(&mut self, sets: &[Vec<String>]) -> Result<(), AnalysisError> {
        self.cancelled.phase(Phase::Candidates);
        let this = &*self;
        let open: Vec<&Vec<String>> =
            sets.iter().filter(|s| this.compatible(s) && !this.fitted_models.contains_key(*s)).collect();
        let one = |set: &&Vec<String>| this.fit_with_restarts(set, set, &this.proposed(set));
        let fitted: Vec<Result<Fitted, AnalysisError>> = open.par_iter().map(one).collect();
        let names: Vec<Vec<String>> = open.into_iter().cloned().collect();
        for (set, fitted) in names.into_iter().zip(fitted) {
            match fitted {
                Ok(f) => {
                    (self.progress)(&format!("{}: χ² {:.1}", named(&set), f.fit.f));
                    self.fitted_models.insert(set, f);
                }
                Err(e) if self.cancelled.stops() => return Err(e),
                Err(e) => {
                    (self.progress)(&format!("{}: no fit ({e})", named(&set)));
                    self.failed.insert(set, e.to_string());
                }
            }
        }
        Ok(())
    }
}

/// How much coarser than the file's mesh the search's is.
const COARSER: f64 = 3.0;

/// The sets that an answer may hang on: those with a share of the posterior, unless a part of theirs has most of it.
fn leading(posterior: &evidence::Posterior) -> Vec<Vec<String>> {
    let share = |s: &evidence::SetProbability| s.probability + s.with_something_else;
    let part = |a: &evidence::SetProbability, of: &evidence::SetProbability| {
        !a.effects.is_empty()
            && a.effects.len() < of.effects.len()
            && a.effects.iter().all(|e| of.effects.contains(e))
    };
    let sets = &posterior.sets;
    let overtaken =
        |s: &evidence::SetProbability| sets.iter().any(|p| part(p, s) && share(s) < OVERTAKES * share(p));
    sets.iter().filter(|s| share(s) >= LEADS && !overtaken(s)).map(|s| s.effects.clone()).collect()
}
