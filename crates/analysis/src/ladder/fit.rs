//! Fits of a rung on the search mesh, and their correction by what the file's mesh says more.

use super::{FeLadder, Fitted};
use crate::columns::transfer;
use crate::correction::Correction;
use crate::cost::Phase;
use crate::identify::{AnalysisError, frees, run_options};
use crate::journal::{Asked, remembered};
use crate::problem::FeProblem;
use crate::{priors, start};
use input::EffectConfig;
use inverse::{FitOptions, Iterate, Objective, Problem as _, quality};
use model::{Discretisation, Model};
use nalgebra::DVector;
use std::ops::ControlFlow;
use std::sync::Arc;
use std::sync::atomic::Ordering;

/// Relative fall of χ² that is worth another step of the search. Steps are as long as they are safe: a little fall
/// is a short step more often than the end.
pub(super) const TOLERANCE: f64 = 1e-3;

/// The same while the model is far from the record: what is left then is not for its parameters to explain.
const COARSE_TOLERANCE: f64 = 2e-2;

/// Reduced χ² from which a model counts as far from the record.
const UNEXPLAINED: f64 = 1.5;

/// Trials of one step before the search is content. From the sixth on they must promise what is worth another step:
/// the fits of a search begin where one trial in two is the bent one, so fewer hardly damp them.
const TRIALS: usize = 10;

/// Reduced χ² beyond which a model is far from the record.
pub(super) const FAR: f64 = 3.0;

/// Rounds of fit and correction at most.
const ROUNDS: usize = 2;

/// A correction that moves by less than this (rms, in noise sd) stands.
const SETTLED: f64 = 0.3;

/// A rung is worth its own correction when its χ² is within this factor of the best so far.
const PROMISING: f64 = 1.5;

/// A fit that is still this many times worse than the best model known, after so many steps, and has not halved its
/// misfit in the last of them, is given up: it will not be chosen.
const HOPELESS: f64 = 4.0;
const PATIENCE: usize = 4;
const HALVED: f64 = 0.5;

impl FeLadder<'_> {
    /// The base fit: a start if one is wanted, coarse fit, the finer mesh's correction, fit again.
    pub(super) fn base(&mut self, start: bool) -> Result<(), AnalysisError> {
        let mut fitted = self.begun_base(start)?;
        for _ in 0..ROUNDS {
            let Some(correction) = self.correction_of(&fitted)? else { break };
            let settled = self.change(&correction, &fitted.correction.shift) < SETTLED;
            self.measured = self.measured.clone().with_numerical_error(&correction);
            let correction = Correction::constant(correction);
            fitted = self.fit_model(fitted.model, fitted.theta, TOLERANCE, correction, fitted.warm)?;
            // A model that misses the record by far is not the answer: once is enough.
            if settled || fitted.quality.reduced_chi2_total > FAR {
                break;
            }
        }
        self.rungs.insert(Vec::new(), fitted);
        Ok(())
    }

    /// The base on the search's mesh alone.
    pub(super) fn begun_base(&mut self, start: bool) -> Result<Fitted, AnalysisError> {
        let model = Model::new(self.case.clone(), self.catalogue, self.how)?;
        let mut theta = model.theta();
        let say = self.progress;
        let shown = |p: &crate::Progress| {
            let objective = p.iterate.f.map_or("no answer".into(), |f| format!("objective {f:.4e}"));
            say(&format!("start, {}: iteration {}, {objective}", p.stage.word(), p.iterate.iteration));
        };
        let quiet = crate::Control { progress: &shown, cancelled: self.cancelled, journal: self.journal };
        self.cancelled.phase(Phase::Start);
        if start && let Some(start) = start::for_case(&self.case, self.catalogue, self.options, &quiet)? {
            start::spread(&model, &start, &mut theta);
        }
        self.first.clone_from(&theta);
        self.cancelled.phase(Phase::Base);
        self.fit_model(model, theta, 1e-2, Correction::default(), Vec::new())
    }

    /// What the file's mesh says more than the search mesh, at a fit; `None` where it cannot be
    /// computed.
    fn correction_of(&self, f: &Fitted) -> Result<Option<DVector<f64>>, AnalysisError> {
        let added: Vec<EffectConfig> = f.model.case.effects.clone();
        let mut case = (*self.fine_case).clone();
        case.effects = added;
        let fine = Model::new(Arc::new(case), self.catalogue, Discretisation::default())?;
        let theta = transfer(&f.model, &f.theta, &fine);
        let mut options = run_options(&self.case);
        // A run that struggles on the finer mesh is not worth waiting for.
        options.march.budget = 2 * crate::identify::TRIAL_BUDGET;
        // As in the search: far below what the mesh does.
        options.march.newton.tolerance = self.options.march.newton.tolerance;
        let slots = &self.measured.slots;
        let problem = FeProblem::new(&fine, theta, Vec::new(), slots, options, self.cancelled);
        self.runs.fetch_add(1, Ordering::Relaxed);
        (self.progress)("numerical error: one run on the file's mesh");
        match problem.predict(&[], false) {
            Ok(p) if f.correction.shift.len() == p.values.len() => {
                Ok(Some(&p.values - (&f.fit.prediction.values - &f.correction.shift)))
            }
            Ok(p) => Ok(Some(&p.values - &f.fit.prediction.values)),
            Err(inverse::PredictError::Interrupted) => Err(inverse::PredictError::Interrupted.into()),
            Err(e) => {
                (self.progress)(&format!("the file's mesh gives no answer here: {e}"));
                Ok(None)
            }
        }
    }

    /// Root mean square of the change of a correction, in standard deviations of the noise.
    fn change(&self, a: &DVector<f64>, b: &DVector<f64>) -> f64 {
        let d = if b.len() == a.len() { a - b } else { a.clone() };
        let blocks = &self.measured.data.blocks;
        let sum: f64 = blocks
            .iter()
            .map(|k| d.rows(k.range.start, k.range.len()).norm_squared() / k.noise.sd.powi(2))
            .sum();
        (sum / d.len().max(1) as f64).sqrt()
    }

    /// The states of a fitted rung as first guesses for another model of the same tests.
    pub(super) fn guesses(&self, of: &Fitted, model: &Model) -> Vec<Option<fem::Warm>> {
        let one = |(t, w): (usize, &Option<fem::Warm>)| {
            let (from, to) = (of.model.plan(t, &self.options), model.plan(t, &self.options));
            w.as_ref().map(|w| to.guesses(&from, w))
        };
        of.warm.iter().enumerate().map(one).collect()
    }

    /// Fits a rung; one that promises to be the answer gets its own correction.
    pub(super) fn fit_rung(
        &self,
        model: Model,
        theta: Vec<f64>,
        start: Correction,
        states: Vec<Option<fem::Warm>>,
    ) -> Result<Fitted, AnalysisError> {
        self.corrected(self.fit_model(model, theta, TOLERANCE, start, states)?)
    }

    /// A fit with a correction of its own, where it promises to be the answer.
    pub(super) fn corrected(&self, mut fitted: Fitted) -> Result<Fitted, AnalysisError> {
        // What is weighed has a correction of first order already.
        if self.objective == Objective::Record {
            return Ok(fitted);
        }
        let best = self.rungs.values().map(|f| f.quality.reduced_chi2_total).fold(f64::INFINITY, f64::min);
        for round in 0..ROUNDS {
            let chi2 = fitted.quality.reduced_chi2_total;
            if chi2 > PROMISING * best || round > 0 && chi2 > UNEXPLAINED {
                break;
            }
            let Some(correction) = self.correction_of(&fitted)? else { break };
            let change = self.change(&correction, &fitted.correction.shift);
            let correction = Correction::constant(correction);
            fitted = self.fit_model(fitted.model, fitted.theta, TOLERANCE, correction, fitted.warm)?;
            if change < SETTLED {
                break;
            }
        }
        Ok(fitted)
    }

    /// Fits a model from θ on all data (joint, whitened, with priors).
    pub(super) fn fit_model(
        &self,
        model: Model,
        theta: Vec<f64>,
        tolerance: f64,
        correction: Correction,
        states: Vec<Option<fem::Warm>>,
    ) -> Result<Fitted, AnalysisError> {
        let free = model.free();
        let mut list = frees(&model, &theta, &free);
        let literature = self.case.identify.priors.literature.unwrap_or(true);
        priors::add(&mut list, &self.case, literature);
        let (fit, warm) = {
            let mut problem = FeProblem::new(
                &model,
                theta.clone(),
                free.clone(),
                &self.measured.slots,
                self.options,
                self.cancelled,
            );
            problem.options.march.budget = crate::identify::TRIAL_BUDGET;
            problem.correction = correction.clone();
            problem.start_from(states);
            let options = FitOptions {
                objective: self.objective,
                tolerance,
                max_iterations: 12,
                max_trials: TRIALS,
                initial_damping: 1e-2,
                // A rejected trial needs none, and derivatives cost as much as a run.
                jacobian_with_trial: false,
                max_step: 0.7,
                ..FitOptions::default()
            };
            let progress = self.progress;
            let names = super::named(&model.effects());
            let best = self.rungs.values().map(|f| f.fit.f).fold(f64::INFINITY, f64::min);
            let far = UNEXPLAINED * self.measured.data.points() as f64;
            let mut last = f64::INFINITY;
            let mut watch = |i: &Iterate| {
                if let Some(f) = i.f {
                    progress(&format!(
                        "{names}: iteration {}, χ² {f:.1}{}",
                        i.iteration,
                        if i.accepted { "" } else { " (rejected)" }
                    ));
                }
                // A trial that was rejected says nothing about the fit.
                let taken = i.f.filter(|_| i.accepted);
                let hopeless = i.iteration >= PATIENCE
                    && taken.is_some_and(|f| f > HOPELESS * best && f > HALVED * last);
                let idle = taken.is_some_and(|f| f > far && last - f < COARSE_TOLERANCE * f);
                last = taken.unwrap_or(last);
                if hopeless || idle { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
            };
            let asked = Asked {
                problem: &problem,
                beside: None,
                data: &self.measured.data,
                free: &list,
                options: &options,
                how: &format!("best {best}, far {far}"),
                cancelled: self.cancelled,
            };
            let done = remembered(self.journal, &asked, &mut watch, &mut |observer| {
                Ok((inverse::fit(&problem, &self.measured.data, &list, &options, observer)?, None))
            })?;
            self.runs.fetch_add(done.runs, Ordering::Relaxed);
            (done.fit, done.warm)
        };
        let mut all = theta;
        for (&i, &v) in free.iter().zip(&fit.theta) {
            all[i] = v;
        }
        let quality = quality(&self.measured.data, &list, &fit);
        Ok(Fitted { model, theta: all, free, frees: list, fit, quality, correction, settled: false, warm })
    }
}
