//! The catalogue weighed: every effect really fitted, sets grown by their evidence, what matters fitted on the file's mesh.
//!
//! The base is the least-squares optimum on the file's mesh. Fits of effects take the search's mesh, put right at the base
//! to first order in its parameters ([`crate::Correction`]); sets with a share of the posterior are then fitted on the
//! file's mesh themselves, their steps taken on the search's (`inverse::fit_mapped`).

use super::decided::Probabilities;
use super::fit::FAR;
use super::{FeLadder, Fitted, How, named};
use crate::columns::transfer;
use crate::correction::Correction;
use crate::cost::Phase;
use crate::identify::{AnalysisError, Searched, fewer_steps, run_options, searched};
use crate::journal::{Asked, remembered};
use crate::probable::{Probable, probable_with_models};
use crate::problem::FeProblem;
use input::Case;
use inverse::{FitOptions, Iterate, MappedOptions, Objective, PredictError, Problem as _, quality};
use model::{Discretisation, Model};
use rayon::prelude::*;
use std::collections::BTreeSet;
use std::ops::ControlFlow;
use std::sync::Arc;
use std::sync::atomic::Ordering;

/// Share of the posterior from which on a set is fitted on the file's mesh, and the catalogue's columns are computed there, to
/// see what would be added to it.
const LEADS: f64 = 0.05;
/// Most effects of a set.
const LARGEST: usize = 4;
/// Sets that are fitted in one round.
const AT_ONCE: usize = 8;
/// Runs on the file's mesh that a fit may move by.
const ROUNDS: usize = 5;
/// Share of the difference of the two meshes that is left on the file's: of first order at the corners of clamped ends, on a
/// mesh three times as fine.
const LEFT_OF_MESH: f64 = 0.5;
/// A predicted fall of χ² that is not worth a run on the file's mesh: as in `identify`.
const SETTLED: f64 = 0.25;

/// States on the file's mesh, with the model they are of.
pub(super) struct FineStates {
    model: Model,
    warm: Vec<Option<fem::Warm>>,
}

impl<'a> FeLadder<'a> {
    /// The base model at its optimum on the file's mesh; nothing else is fitted.
    ///
    /// # Errors
    /// [`AnalysisError`].
    pub fn weighing(case: Arc<Case>, how: How<'a>) -> Result<Self, AnalysisError> {
        let mut ladder = Self::unfitted(case, how)?;
        if ladder.fine_case.mesh.divisions.is_none() {
            ladder.how.coarsen = COARSER;
        }
        let newton = &mut ladder.options.march.newton;
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
            let all = ladder.settle(ladder.begun_of(&base)?, Some(&states), ROUNDS)?.ok_or_else(none)?;
            ladder.identified = Some(std::mem::replace(&mut base, all.0));
            states = all.1;
        }
        let error = LEFT_OF_MESH * &base.correction.shift;
        ladder.measured = ladder.measured.clone().with_numerical_error(&error);
        ladder.fine_states = Some(states);
        ladder.rungs.insert(Vec::new(), base);
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

    /// A model of the search's mesh at values of the file's, as the start of a fit.
    fn begun_at(&self, model: Model, theta: &[f64]) -> Result<Begun, AnalysisError> {
        let fine = Model::new(self.fine_case.clone(), self.catalogue, Discretisation::default())?;
        let theta = transfer(&fine, theta, &model);
        let free = model.free();
        let frees = self.frees(&model, &theta, &free);
        Ok(Begun { model, theta, free, frees, warm: Vec::new() })
    }

    /// The same at a fit.
    fn begun_of(&self, f: &Fitted) -> Result<Begun, AnalysisError> {
        let start = |(free, &start): (&inverse::Free, &f64)| inverse::Free { start, ..free.clone() };
        Ok(Begun {
            model: Model::new(f.model.case.clone(), self.catalogue, self.how)?,
            theta: f.theta.clone(),
            free: f.free.clone(),
            frees: f.frees.iter().zip(&f.fit.theta).map(start).collect(),
            warm: f.warm.clone(),
        })
    }

    /// Fits every effect, and every set that matters: what leads is taken to the file's mesh before anything is added to it,
    /// so that additions are judged at an optimum.
    ///
    /// # Errors
    /// [`AnalysisError`].
    pub(super) fn weigh_catalogue(&mut self) -> Result<Probabilities, AnalysisError> {
        self.columns_at(&[])?;
        let mut first = true;
        loop {
            let (found, posterior, models) = self.posterior()?;
            if self.interrupted() {
                return Ok((found, posterior));
            }
            (self.progress)(found.sentence().trim_end_matches('.'));
            if std::mem::take(&mut first) {
                let singles = self.singles(&found, &models);
                self.fit_sets(&singles)?;
                self.begin_again(&singles)?;
                continue;
            }
            let leading: Vec<Vec<String>> = (posterior.sets.iter())
                .filter(|s| s.probability + s.with_something_else >= LEADS)
                .map(|s| s.effects.clone())
                .filter(|s| self.rungs.contains_key(s))
                .collect();
            let unsettled: Vec<Vec<String>> =
                leading.iter().filter(|s| !self.rungs[*s].settled).cloned().collect();
            if !unsettled.is_empty() {
                self.settle_sets(&unsettled)?;
                continue;
            }
            let unscreened: Vec<Vec<String>> = (leading.into_iter())
                .filter(|s| s.len() < LARGEST && !self.screened.contains_key(s))
                .collect();
            for set in &unscreened {
                self.columns_at(set)?;
            }
            if !unscreened.is_empty() {
                continue;
            }
            let open: Vec<Vec<String>> = (evidence::to_fit(&posterior, &models).into_iter())
                .filter(|s| s.len() <= LARGEST && !self.rungs.contains_key(s) && !self.failed.contains_key(s))
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
        let best = self.rungs.values().map(|f| f.quality.reduced_chi2_total).fold(f64::INFINITY, f64::min);
        if best <= FAR || self.interrupted() {
            return Ok(());
        }
        self.first = self.unbent()?;
        self.cancelled.phase(Phase::Candidates);
        let begun: Vec<(Vec<String>, Fitted)> =
            sets.iter().filter_map(|s| self.rungs.remove_entry(s)).collect();
        let this = &*self;
        let again: Vec<(Vec<String>, Fitted)> = (begun.into_par_iter())
            .map(|(set, f)| (set.clone(), this.again_from_the_beginning(&set, f)))
            .collect();
        self.rungs.extend(again);
        Ok(())
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
        let Some(f) = self.rungs.get(set) else { return Ok(()) };
        let rung = self.rung(set, f);
        let screen = self.screen(&rung)?;
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
            sets.iter().filter(|s| this.compatible(s) && !this.rungs.contains_key(*s)).collect();
        let one = |set: &&Vec<String>| this.fit_near_neutral_if_need_be(set, set, &this.proposed(set));
        let fitted: Vec<Result<Fitted, AnalysisError>> = open.par_iter().map(one).collect();
        let names: Vec<Vec<String>> = open.into_iter().cloned().collect();
        for (set, fitted) in names.into_iter().zip(fitted) {
            match fitted {
                Ok(f) => {
                    (self.progress)(&format!("{}: χ² {:.1}", named(&set), f.fit.f));
                    self.rungs.insert(set, f);
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

    /// Fits sets on the file's mesh, side by side. Where that mesh gives no answer a fit stays as it is.
    pub(super) fn settle_sets(&mut self, sets: &[Vec<String>]) -> Result<(), AnalysisError> {
        let this = &*self;
        let one = |set: &Vec<String>| match this.rungs.get(set) {
            Some(f) => {
                let better = this.best_form(f)?;
                let begun = this.begun_of(better.as_ref().unwrap_or(f))?;
                this.settle(begun, this.fine_states.as_ref(), ROUNDS)
            }
            None => Ok(None),
        };
        let done: Vec<Result<Option<(Fitted, FineStates)>, AnalysisError>> =
            sets.par_iter().map(one).collect();
        for (set, settled) in sets.iter().zip(done) {
            match (settled?, self.rungs.get_mut(set)) {
                (Some((f, _)), _) => {
                    (self.progress)(&format!("{}: on the file's mesh χ² {:.1}", named(set), f.fit.f));
                    self.rungs.insert(set.clone(), f);
                }
                (None, Some(f)) => f.settled = true,
                (None, None) => {}
            }
        }
        Ok(())
    }

    /// A fit taken to the optimum on the file's mesh; `None` where that mesh gives no answer.
    fn settle(
        &self,
        begun: Begun,
        states: Option<&FineStates>,
        rounds: usize,
    ) -> Result<Option<(Fitted, FineStates)>, AnalysisError> {
        let mut case = (*self.fine_case).clone();
        case.effects.clone_from(&begun.model.case.effects);
        let fine = Model::new(Arc::new(case), self.catalogue, Discretisation::default())?;
        let theta = transfer(&begun.model, &begun.theta, &fine);
        let slots = &self.measured.slots;
        let mut options = fewer_steps(run_options(&self.fine_case));
        options.march.budget = 2 * crate::identify::TRIAL_BUDGET;
        options.march.newton.tolerance = self.options.march.newton.tolerance;
        let free = fine.free();
        let problem = FeProblem::new(&fine, theta, free, slots, options, self.cancelled);
        if let Some(s) = states {
            let one = |(t, w): (usize, &Option<fem::Warm>)| {
                let (from, to) = (s.model.plan(t, &options), fine.plan(t, &options));
                w.as_ref().map(|w| to.guesses(&from, w))
            };
            problem.start_from(s.warm.iter().enumerate().map(one).collect());
        }
        let Begun { model, theta, free, frees, warm } = begun;
        let cheap = FeProblem::new(&model, theta, free.clone(), slots, self.options, self.cancelled);
        cheap.start_from(warm.clone());
        let outer =
            FitOptions { objective: Objective::Record, max_iterations: rounds, ..FitOptions::default() };
        let inner = FitOptions { max_iterations: 16, tolerance: 1e-4, ..outer.clone() };
        let how = MappedOptions { outer, inner, settled: SETTLED };
        let name = named(&model.effects());
        let say = self.progress;
        let mut told = |i: &Iterate| {
            say(&format!("{name}, file's mesh: iteration {}, χ² {:?}", i.iteration, i.f));
            ControlFlow::Continue(())
        };
        let mut quiet = |_: &Iterate| ControlFlow::Continue(());
        let data = &self.measured.data;
        let asked = Asked {
            problem: &problem,
            beside: Some(&cheap),
            data,
            free: &frees,
            options: &how.outer,
            how: &format!("{how:?}"),
            cancelled: self.cancelled,
        };
        let done = remembered(self.journal, &asked, &mut told, &mut |told| {
            Ok((inverse::fit_mapped(&problem, &cheap, data, &frees, &how, told, &mut quiet)?, None))
        });
        let done = match done {
            Ok(done) => done,
            Err(AnalysisError::Fit(inverse::FitError::Start(PredictError::NotComputable(_)))) => {
                return Ok(None);
            }
            Err(e) => return Err(e),
        };
        self.runs.fetch_add(done.runs, Ordering::Relaxed);
        let end = done.fit;
        // From the same states whether the fit was done or remembered: the same bits.
        cheap.start_from(warm);
        let own = cheap.predict(&end.theta, true)?;
        let correction = Correction::first_order(&frees, &end.theta, &end.prediction, &own);
        let quality = quality(data, &frees, &end);
        let (theta, warm, fine_warm) = (cheap.full(&end.theta), cheap.warm(), done.warm);
        drop((problem, cheap));
        let settled =
            Fitted { theta, frees, fit: end, quality, correction, settled: true, warm, free, model };
        Ok(Some((settled, FineStates { model: fine, warm: fine_warm })))
    }
}

/// Where a fit on the file's mesh begins, by the search's mesh.
struct Begun {
    model: Model,
    theta: Vec<f64>,
    free: Vec<usize>,
    frees: Vec<inverse::Free>,
    warm: Vec<Option<fem::Warm>>,
}

/// How much coarser than the file's mesh the search's is.
const COARSER: f64 = 3.0;
