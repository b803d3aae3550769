//! The catalogue weighed: every effect really fitted, sets grown by their evidence, what matters fitted on the file's mesh.
//!
//! The base is the least-squares optimum on the file's mesh. Fits of effects take the search's mesh, put right at the base
//! to first order in its parameters ([`crate::Correction`]); sets with a share of the posterior are then fitted on the
//! file's mesh themselves, their steps taken on the search's (`inverse::fit_mapped`).

use super::{FeLadder, Fitted, How, named};
use crate::columns::transfer;
use crate::correction::Correction;
use crate::cost::Phase;
use crate::identify::{AnalysisError, fewer_steps, run_options};
use crate::probable::{Probable, probable_with_models};
use crate::problem::FeProblem;
use diagnose::Ladder as _;
use input::Case;
use inverse::{FitOptions, Iterate, MappedOptions, Objective, PredictError, Problem as _, quality};
use model::{Discretisation, Model};
use rayon::prelude::*;
use std::collections::BTreeSet;
use std::ops::ControlFlow;
use std::sync::Arc;
use std::sync::atomic::Ordering;

/// Share of the posterior from which on a set is fitted on the file's mesh.
const MATTERS: f64 = 0.01;
/// Share from which on the catalogue's columns are computed at a set, to see what would be added to it.
const LEADS: f64 = 0.05;
/// Most effects of a set.
const LARGEST: usize = 4;
/// Sets that are fitted in one round, and rounds.
const AT_ONCE: usize = 8;
const ROUNDS: usize = 6;
/// Share of the difference of the two meshes that is left on the file's: of first order at the corners of clamped ends, on a
/// mesh three times as fine.
const LEFT_OF_MESH: f64 = 0.5;
/// A predicted fall of χ² that is not worth a run on the file's mesh.
const SETTLED: f64 = 0.1;

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
        ladder.objective = Objective::Record;
        if ladder.fine_case.mesh.divisions.is_none() {
            ladder.how.coarsen = COARSER;
        }
        ladder.options = fewer_steps(run_options(&ladder.fine_case));
        let newton = &mut ladder.options.march.newton;
        newton.tolerance = newton.tolerance.max(crate::identify::SEARCH_TOLERANCE);
        let model = Model::new(ladder.case.clone(), ladder.catalogue, ladder.how)?;
        ladder.measured = ladder.measured.as_estimated(&model)?;
        let begun = ladder.begun_base(true)?;
        let (base, states) = ladder.settle(begun, None)?;
        let error = LEFT_OF_MESH * &base.correction.shift;
        ladder.measured = ladder.measured.clone().with_numerical_error(&error);
        ladder.fine_states = Some(states);
        ladder.rungs.insert(Vec::new(), base);
        Ok(ladder)
    }

    /// Fits every effect, and every set that matters.
    ///
    /// # Errors
    /// [`AnalysisError`].
    pub fn weigh_catalogue(&mut self) -> Result<Probable, AnalysisError> {
        let mut hints = diagnose::Hints::new();
        self.columns_at(&[], &mut hints)?;
        let present = self.case.effects.iter().map(|e| e.name.clone()).collect::<BTreeSet<_>>();
        let singles: Vec<Vec<String>> = self
            .candidates
            .iter()
            .filter(|c| !present.contains(&c.effect))
            .filter(|c| self.catalogue.get(&c.effect).is_some_and(|e| !e.card().negative_control))
            .map(|c| vec![c.effect.clone()])
            .collect();
        self.fit_sets(&singles, &hints)?;
        for _ in 0..ROUNDS {
            let (found, posterior, models) = self.posterior()?;
            let open: Vec<Vec<String>> = evidence::to_fit(&posterior, &models)
                .into_iter()
                .filter(|s| s.len() <= LARGEST && !self.rungs.contains_key(s))
                .take(AT_ONCE)
                .collect();
            let total = |s: &evidence::SetProbability| s.probability + s.with_something_else;
            let large = |least: f64| -> Vec<Vec<String>> {
                let sets = posterior.sets.iter().filter(|s| total(s) >= least);
                sets.map(|s| s.effects.clone()).filter(|s| self.rungs.contains_key(s)).collect()
            };
            let unsettled: Vec<Vec<String>> =
                large(MATTERS).into_iter().filter(|s| !self.rungs[s].settled).collect();
            let unscreened: Vec<Vec<String>> = large(LEADS)
                .into_iter()
                .filter(|s| s.len() < LARGEST && !self.screened.contains_key(s))
                .collect();
            if open.is_empty() && unsettled.is_empty() && unscreened.is_empty() || self.interrupted() {
                return Ok(found);
            }
            self.settle_sets(&unsettled)?;
            for set in &unscreened {
                self.columns_at(set, &mut hints)?;
            }
            self.fit_sets(&open, &hints)?;
        }
        Ok(self.posterior()?.0)
    }

    fn posterior(&self) -> Result<(Probable, evidence::Posterior, Vec<evidence::Judged>), AnalysisError> {
        probable_with_models(self).map_err(|e| AnalysisError::Case(format!("no probabilities: {e}")))
    }

    /// The catalogue's columns at a fitted set.
    fn columns_at(&mut self, set: &[String], hints: &mut diagnose::Hints) -> Result<(), AnalysisError> {
        let Some(f) = self.rungs.get(set) else { return Ok(()) };
        let rung = self.rung(set, f);
        let screen = self.screen(&rung)?;
        for finding in screen.findings {
            hints.entry(finding.effect.clone()).or_insert(finding);
        }
        Ok(())
    }

    /// Fits sets side by side. One that cannot be fitted is left out, and said to be.
    fn fit_sets(&mut self, sets: &[Vec<String>], hints: &diagnose::Hints) -> Result<(), AnalysisError> {
        self.cancelled.phase(Phase::Candidates);
        let this = &*self;
        let open: Vec<&Vec<String>> =
            sets.iter().filter(|s| this.compatible(s) && !this.rungs.contains_key(*s)).collect();
        let one = |set: &&Vec<String>| this.fit_near_neutral_if_need_be(set, set, hints);
        let fitted: Vec<Result<Fitted, AnalysisError>> = open.par_iter().map(one).collect();
        let names: Vec<Vec<String>> = open.into_iter().cloned().collect();
        for (set, fitted) in names.into_iter().zip(fitted) {
            match fitted {
                Ok(f) => {
                    (self.progress)(&format!("{}: χ² {:.1}", named(&set), f.fit.f));
                    self.rungs.insert(set, f);
                }
                Err(e) if self.cancelled.stops() => return Err(e),
                Err(e) => (self.progress)(&format!("{}: no fit ({e})", named(&set))),
            }
        }
        Ok(())
    }

    /// Fits sets on the file's mesh, side by side.
    fn settle_sets(&mut self, sets: &[Vec<String>]) -> Result<(), AnalysisError> {
        let begun: Vec<(Vec<String>, Fitted)> =
            sets.iter().filter_map(|s| self.rungs.remove_entry(s)).collect();
        let this = &*self;
        let one = |(set, f): (Vec<String>, Fitted)| {
            let states = this.fine_states.as_ref();
            this.settle(f, states).map(|(f, _)| (set, f))
        };
        let done: Vec<Result<(Vec<String>, Fitted), AnalysisError>> =
            begun.into_par_iter().map(one).collect();
        for settled in done {
            let (set, f) = settled?;
            (self.progress)(&format!("{}: on the file's mesh χ² {:.1}", named(&set), f.fit.f));
            self.rungs.insert(set, f);
        }
        Ok(())
    }

    /// A fit taken to the optimum on the file's mesh. Where that mesh gives no answer the fit stays as it is.
    fn settle(&self, f: Fitted, states: Option<&FineStates>) -> Result<(Fitted, FineStates), AnalysisError> {
        let mut case = (*self.fine_case).clone();
        case.effects.clone_from(&f.model.case.effects);
        let fine = Model::new(Arc::new(case), self.catalogue, Discretisation::default())?;
        let theta = transfer(&f.model, &f.theta, &fine);
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
        let cheap =
            FeProblem::new(&f.model, f.theta.clone(), f.free.clone(), slots, self.options, self.cancelled);
        cheap.start_from(f.warm.clone());
        let outer = FitOptions { objective: Objective::Record, max_iterations: 10, ..FitOptions::default() };
        let inner = FitOptions { max_iterations: 8, tolerance: 1e-4, ..outer.clone() };
        let how = MappedOptions { outer, inner, settled: SETTLED };
        let name = named(&f.model.effects());
        let say = self.progress;
        let mut told = |i: &Iterate| {
            say(&format!("{name}, file's mesh: iteration {}, χ² {:?}", i.iteration, i.f));
            ControlFlow::Continue(())
        };
        let mut quiet = |_: &Iterate| ControlFlow::Continue(());
        let frees: Vec<inverse::Free> = (f.frees.iter().zip(&f.fit.theta))
            .map(|(free, &start)| inverse::Free { start, ..free.clone() })
            .collect();
        let end =
            inverse::fit_mapped(&problem, &cheap, &self.measured.data, &frees, &how, &mut told, &mut quiet);
        self.runs.fetch_add(problem.runs() + cheap.runs(), Ordering::Relaxed);
        let end = match end {
            Ok(end) => end,
            Err(inverse::FitError::Start(PredictError::NotComputable(_))) => {
                let warm = problem.warm();
                return Ok((Fitted { settled: true, ..f }, FineStates { model: fine, warm }));
            }
            Err(e) => return Err(e.into()),
        };
        let own = cheap.predict(&end.theta, true)?;
        let correction = Correction::first_order(&frees, &end.theta, &end.prediction, &own);
        let quality = quality(&self.measured.data, &frees, &end);
        let (theta, warm, fine_warm) = (cheap.full(&end.theta), cheap.warm(), problem.warm());
        let settled = Fitted {
            theta,
            frees,
            fit: end,
            quality,
            correction,
            settled: true,
            warm,
            free: f.free,
            model: f.model,
        };
        Ok((settled, FineStates { model: fine, warm: fine_warm }))
    }
}

/// How much coarser than the file's mesh the search's is.
const COARSER: f64 = 3.0;
