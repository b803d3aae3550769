//! The finite-element model as a ladder: fits with any set of effects, and screens at each rung.
//!
//! Fits run on a mesh coarser than the file's, corrected by what the file's mesh says more at the
//! fit (defect correction, repeated until it stands); the same difference tells the numerical error
//! that every χ², test and interval carries.

use crate::columns::{Base, case_with, config_of, scales, transfer};
use crate::data::Measured;
use crate::identify::{AnalysisError, coarse_case, frees, run_options};
use crate::problem::{Cancelled, FeProblem};
use crate::{priors, start};
use diagnose::{Candidate, Finding, Policy, Rung, Screen};
use input::{Case, EffectConfig};
use inverse::{Data, Fit, FitOptions, Free, Noise, Problem, Quality, Whitened, quality};
use model::{Catalogue, Channel, Discretisation, Model, RunOptions};
use nalgebra::{DMatrix, DVector};
use std::collections::BTreeMap;
use std::ops::ControlFlow;
use std::sync::Arc;

/// How much coarser than the file's mesh the search works.
const COARSEN: f64 = 2.0;

/// Relative fall of χ² that is worth another step of the search.
const TOLERANCE: f64 = 3e-3;

/// Trials of one step before the search is content.
const TRIALS: usize = 5;

/// Reduced χ² beyond which a model is far from the record.
const FAR: f64 = 3.0;

/// A fit that is still this many times worse than the best model known, after so many steps, is
/// given up: it will not be chosen.
const HOPELESS: f64 = 4.0;
const PATIENCE: usize = 4;

/// Rounds of fit and correction at most.
const ROUNDS: usize = 2;

/// A correction that moves by less than this (rms, in noise sd) stands.
const SETTLED: f64 = 0.3;

/// A rung is worth its own correction when its χ² is within this factor of the best so far.
const PROMISING: f64 = 1.5;

/// Steps and tolerance of the search: the numerical error that every test carries includes them.
fn search_options(case: &Case) -> RunOptions {
    let mut o = run_options(case);
    (o.tearing_steps, o.uniaxial_steps) = (30, 14);
    o.march.newton.tolerance = o.march.newton.tolerance.max(1e-7);
    o
}

/// A fitted rung with everything a screen or a report needs.
pub struct Fitted {
    /// The model (coarse).
    pub model: Model,
    /// Its values.
    pub theta: Vec<f64>,
    /// Free parameters.
    pub free: Vec<usize>,
    /// As the optimiser saw them.
    pub frees: Vec<Free>,
    /// Fit with jacobian.
    pub fit: Fit,
    /// χ² and kin.
    pub quality: Quality,
    /// What the file's mesh says more than the search mesh, at this fit.
    pub correction: DVector<f64>,
    /// States of the last run: first guesses.
    pub warm: Vec<Option<fem::Warm>>,
}

/// The ladder of one case.
pub struct FeLadder<'a> {
    case: Arc<Case>,
    fine_case: Arc<Case>,
    catalogue: &'a Catalogue,
    how: Discretisation,
    options: RunOptions,
    cancelled: Cancelled<'a>,
    /// Data with noise and numerical error.
    pub measured: Measured,
    /// Every rung that was fitted, by its sorted effects.
    pub rungs: BTreeMap<Vec<String>, Fitted>,
    /// Candidates of the latest screen, with raw columns.
    pub candidates: Vec<Candidate>,
    /// Forward runs so far.
    pub runs: usize,
    policy: Policy,
    progress: &'a (dyn Fn(&str) + Sync),
}

impl<'a> FeLadder<'a> {
    /// Fits the case's own model and finds the numerical error.
    ///
    /// # Errors
    /// [`AnalysisError`].
    pub fn new(
        case: Arc<Case>,
        catalogue: &'a Catalogue,
        policy: Policy,
        progress: &'a (dyn Fn(&str) + Sync),
        cancelled: Cancelled<'a>,
    ) -> Result<Self, AnalysisError> {
        let coarse = coarse_case(&case);
        let how = if coarse.mesh == case.mesh {
            Discretisation { coarsen: COARSEN, ..Discretisation::default() }
        } else {
            Discretisation::default()
        };
        let fine = Model::new(case.clone(), catalogue, Discretisation::default())?;
        let wanted: Vec<bool> = fine.tests.iter().map(|t| t.test.record.is_some()).collect();
        let measured = Measured::cautious(&fine, &wanted)?;
        let mut ladder = Self {
            case: Arc::new(coarse),
            fine_case: case.clone(),
            catalogue,
            how,
            options: search_options(&case),
            cancelled,
            measured,
            rungs: BTreeMap::new(),
            candidates: Vec::new(),
            runs: 0,
            policy,
            progress,
        };
        ladder.base()?;
        Ok(ladder)
    }

    /// The base fit: start, coarse fit, the finer mesh's correction, fit again.
    fn base(&mut self) -> Result<(), AnalysisError> {
        let model = Model::new(self.case.clone(), self.catalogue, self.how)?;
        let mut theta = model.theta();
        let say = self.progress;
        let shown = |p: &crate::Progress| {
            say(&format!(
                "start: {} step {} f {:?} {:.4?}",
                p.stage.word(),
                p.iterate.iteration,
                p.iterate.f,
                p.iterate.theta
            ))
        };
        let quiet = crate::Control { progress: &shown, cancelled: self.cancelled };
        if let Some(start) = start::for_case(&self.case, self.catalogue, self.options, &quiet)? {
            start::spread(&model, &start, &mut theta);
        }
        let none = DVector::zeros(self.measured.data.points());
        let mut fitted = self.fit_model(model, theta, 1e-2, none, Vec::new())?;
        for _ in 0..ROUNDS {
            let Some(correction) = self.correction_of(&fitted)? else { break };
            let settled = self.change(&correction, &fitted.correction) < SETTLED;
            self.measured = self.measured.clone().with_numerical_error(&correction);
            fitted = self.fit_model(fitted.model, fitted.theta, TOLERANCE, correction, fitted.warm)?;
            // A model that misses the record by far is not the answer: once is enough.
            if settled || fitted.quality.reduced_chi2_total > FAR {
                break;
            }
        }
        self.rungs.insert(Vec::new(), fitted);
        Ok(())
    }

    /// What the file's mesh says more than the search mesh, at a fit; `None` where it cannot be
    /// computed.
    fn correction_of(&mut self, f: &Fitted) -> Result<Option<DVector<f64>>, AnalysisError> {
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
        self.runs += 1;
        (self.progress)("numerical error: one run on the file's mesh");
        match problem.predict(&[], false) {
            Ok(p) => Ok(Some(&p.values - (&f.fit.prediction.values - &f.correction))),
            Err(inverse::PredictError::Interrupted) => Err(inverse::PredictError::Interrupted.into()),
            Err(e) => {
                (self.progress)(&format!("the file's mesh gives no answer here: {e}"));
                Ok(None)
            }
        }
    }

    /// Root mean square of the change of a correction, in standard deviations of the noise.
    fn change(&self, a: &DVector<f64>, b: &DVector<f64>) -> f64 {
        let d = a - b;
        let blocks = &self.measured.data.blocks;
        let sum: f64 = blocks
            .iter()
            .map(|k| d.rows(k.range.start, k.range.len()).norm_squared() / k.noise.sd.powi(2))
            .sum();
        (sum / d.len().max(1) as f64).sqrt()
    }

    /// Fits a rung; one that promises to be the answer gets its own correction.
    fn fit_rung(
        &mut self,
        model: Model,
        theta: Vec<f64>,
        start: DVector<f64>,
    ) -> Result<Fitted, AnalysisError> {
        let mut fitted = self.fit_model(model, theta, TOLERANCE, start, Vec::new())?;
        let best = self.rungs.values().map(|f| f.quality.reduced_chi2_total).fold(f64::INFINITY, f64::min);
        for _ in 0..ROUNDS {
            if fitted.quality.reduced_chi2_total > PROMISING * best {
                break;
            }
            let Some(correction) = self.correction_of(&fitted)? else { break };
            let change = self.change(&correction, &fitted.correction);
            fitted = self.fit_model(fitted.model, fitted.theta, TOLERANCE, correction, fitted.warm)?;
            if change < SETTLED {
                break;
            }
        }
        Ok(fitted)
    }

    /// Fits a model from θ on all data (joint, whitened, with priors).
    fn fit_model(
        &mut self,
        model: Model,
        theta: Vec<f64>,
        tolerance: f64,
        correction: DVector<f64>,
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
                tolerance,
                max_iterations: 12,
                max_trials: TRIALS,
                initial_damping: 1e-2,
                max_step: 0.7,
                ..FitOptions::default()
            };
            let progress = self.progress;
            let names = model.effects().join(" + ");
            let best = self.rungs.values().map(|f| f.fit.f).fold(f64::INFINITY, f64::min);
            let fit = inverse::fit(&problem, &self.measured.data, &list, &options, &mut |i| {
                if let Some(f) = i.f {
                    progress(&format!(
                        "fit [{names}] step {} χ² {f:.1}{}",
                        i.iteration,
                        if i.accepted { "" } else { " (rejected)" }
                    ));
                }
                let hopeless = i.iteration >= PATIENCE && i.f.is_some_and(|f| f > HOPELESS * best);
                if hopeless { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
            })?;
            self.runs += problem.runs();
            (fit, problem.warm())
        };
        let mut all = theta;
        for (&i, &v) in free.iter().zip(&fit.theta) {
            all[i] = v;
        }
        let quality = quality(&self.measured.data, &list, &fit);
        Ok(Fitted { model, theta: all, free, frees: list, fit, quality, correction, warm })
    }

    /// The same effects with one of them in another form, where the fit helps but leaves structure,
    /// as long as a form pays for its parameters.
    fn enrich(&mut self, mut f: Fitted) -> Result<Fitted, AnalysisError> {
        let best = self.rungs.values().map(|r| r.quality.reduced_chi2_total).fold(f64::INFINITY, f64::min);
        if f.quality.reduced_chi2_total > best {
            return Ok(f);
        }
        for at in 0..f.model.case.effects.len() {
            while let Some(better) = self.better_form(&f, at)? {
                f = better;
            }
        }
        Ok(f)
    }

    /// The first other form of one effect that pays, if the record is not explained yet.
    fn better_form(&mut self, f: &Fitted, at: usize) -> Result<Option<Fitted>, AnalysisError> {
        if f.quality.reduced_chi2_total <= self.policy.explained_chi2 {
            return Ok(None);
        }
        let config = &f.model.case.effects[at];
        let Some(effect) = self.catalogue.get(&config.name) else { return Ok(None) };
        let path = |s: &params::ParamSpec| format!("effects.{}.{}", config.name, s.name);
        let values: Vec<f64> =
            config.specs.iter().filter_map(|s| f.model.find(&path(s)).map(|i| f.theta[i])).collect();
        for (settings, values) in effect.richer(&config.options, &values) {
            let mut case = (*f.model.case).clone();
            case.effects[at] = crate::columns::config_with(effect, &settings, &values);
            let model = Model::new(Arc::new(case), self.catalogue, self.how)?;
            let mut theta = transfer(&f.model, &f.theta, &model);
            for (spec, v) in effect.parameters(&settings).iter().zip(&values) {
                if let Some(i) = model.find(&path(spec)) {
                    theta[i] = *v;
                }
            }
            (self.progress)(&format!("{} in another form: {}", config.name, in_words(&settings)));
            let fitted = self.fit_rung(model, theta, f.correction.clone())?;
            if fitted.quality.bic + self.policy.add_bic < f.quality.bic {
                return Ok(Some(fitted));
            }
        }
        Ok(None)
    }

    /// A rung's key: effects in sorted order.
    pub fn key(effects: &[String]) -> Vec<String> {
        let mut k = effects.to_vec();
        k.sort();
        k
    }

    /// The rung of a fit.
    pub fn rung(&self, effects: &[String], f: &Fitted) -> Rung {
        let misfit = self.measured.data.misfit(&f.fit.prediction.values);
        let mut force = Vec::new();
        for (slot, block) in self.measured.slots.iter().zip(&self.measured.data.blocks) {
            if slot.channel == Channel::Force {
                force.extend(block.range.clone().map(|i| misfit[i]));
            }
        }
        let white =
            Whitened::new(&self.measured.data, &f.frees, &f.fit.theta, &f.fit.prediction, Noise::Total);
        let rows = white.rows.len();
        let structure = diagnose::atlas::structure_p(white.r.rows(0, rows).into_owned().as_slice());
        let rung = Rung::new(effects, &f.quality, inverse::rms(force), structure);
        match self.held_out(f, &white) {
            Some((chi2, points, rms)) => rung.held_out(chi2, points, rms),
            None => rung,
        }
    }

    /// Whole segments left out in turn, their prediction corrected to first order for not having
    /// been fitted: reduced χ² and rms of what the fit did not see.
    fn held_out(&self, f: &Fitted, white: &Whitened) -> Option<(f64, usize, f64)> {
        let mask = self.hold_out_mask();
        let rows = white.rows.len();
        let out: Vec<usize> = (0..rows).filter(|&r| mask[white.rows[r]]).collect();
        if out.len() < 10 {
            return None;
        }
        let open: Vec<usize> = (0..f.free.len()).filter(|&k| !f.fit.at_bound[k]).collect();
        let j = DMatrix::from_fn(white.jacobian.nrows(), open.len(), |r, c| white.jacobian[(r, open[c])]);
        let kept: Vec<usize> = (0..j.nrows()).filter(|r| *r >= rows || !mask[white.rows[*r]]).collect();
        let jt = DMatrix::from_fn(kept.len(), open.len(), |r, c| j[(kept[r], c)]);
        let rt = DVector::from_iterator(kept.len(), kept.iter().map(|&r| white.r[r]));
        let normal = jt.tr_mul(&jt);
        let ridge = 1e-9 * normal.diagonal().max();
        let step =
            (normal + DMatrix::identity(open.len(), open.len()) * ridge).cholesky()?.solve(&jt.tr_mul(&rt));
        let (mut chi2, mut square) = (0.0, 0.0);
        for &r in &out {
            let left = white.r[r] - j.row(r).dot(&step.transpose());
            chi2 += left * left;
            let sd = self.sd_at(white.rows[r]);
            square += (left * sd).powi(2);
        }
        let n = out.len() as f64;
        Some((chi2 / n, out.len(), (square / n).sqrt()))
    }

    fn sd_at(&self, point: usize) -> f64 {
        self.measured.data.blocks.iter().find(|b| b.range.contains(&point)).map_or(1.0, |b| b.noise.sd)
    }

    fn hold_out_mask(&self) -> Vec<bool> {
        let mut mask = vec![false; self.measured.data.points()];
        for (slot, block) in self.measured.slots.iter().zip(&self.measured.data.blocks) {
            let test = &self.case.tests[slot.test];
            let (Some(r), Channel::Force) = (&test.record, slot.channel) else { continue };
            let segments = crate::compare::segments(test, r);
            let split = diagnose::holdout::split(&segments, r.len(), 0.25);
            for (k, i) in block.range.clone().enumerate() {
                mask[i] = split.mask.get(slot.rows[k]).copied().unwrap_or(false);
            }
        }
        mask
    }

    /// Configurations of effects, started from the screen's findings.
    fn configs(
        &self,
        effects: &[String],
        hints: &BTreeMap<String, Finding>,
        base: &Fitted,
    ) -> Vec<EffectConfig> {
        let scales = scales(&base.model, &base.theta);
        effects
            .iter()
            .filter(|e| !self.case.effects.iter().any(|c| &&c.name == e))
            .filter_map(|name| {
                if let Some(known) = base.model.case.effects.iter().find(|c| &c.name == name) {
                    return Some(known.clone());
                }
                let effect = self.catalogue.get(name)?;
                let specs = effect.parameters(&model::Options::new());
                let mut values = effect.start(&scales);
                if let Some(h) = hints.get(name) {
                    start_from(h, &specs, &mut values);
                }
                Some(config_of(effect, &values))
            })
            .collect()
    }
}

/// Settings as a file would give them.
fn in_words(settings: &model::Options) -> String {
    let one = |(name, value): (&String, &input::OptionValue)| format!("{name} = {value}");
    settings.iter().map(one).collect::<Vec<_>>().join(", ")
}

/// Start values from a finding: its shape, and its amplitude held inside the plausible.
fn start_from(h: &Finding, specs: &[params::ParamSpec], values: &mut [f64]) {
    for (spec, v) in specs.iter().zip(values.iter_mut()).skip(1) {
        if let Some((_, s)) = h.shape.iter().find(|(n, _)| *n == spec.key()) {
            *v = *s;
        }
    }
    let neutral = specs[0].neutral.unwrap_or(0.0);
    let plausible = (values[0] - neutral).abs();
    if let Some((_, a)) = h.amplitudes.first() {
        // A linear estimate may overshoot: never start beyond three plausible amplitudes, nor at
        // nothing.
        let size = a.abs().clamp(0.05 * plausible, 3.0 * plausible);
        values[0] =
            (neutral + size.copysign(if *a == 0.0 { 1.0 } else { *a })).clamp(specs[0].lower, specs[0].upper);
    }
}

impl diagnose::Ladder for FeLadder<'_> {
    type Error = AnalysisError;

    fn fit(&mut self, effects: &[String], hints: &diagnose::Hints) -> Result<Rung, AnalysisError> {
        let key = Self::key(effects);
        if !self.rungs.contains_key(&key) {
            let Some(base) = self.nearest(&key) else {
                return Err(AnalysisError::Case("no base fit".into()));
            };
            let configs = self.configs(effects, hints, base);
            let case = case_with(&self.case, &configs);
            let model = Model::new(Arc::new(case), self.catalogue, self.how)?;
            let theta = transfer(&base.model, &base.theta, &model);
            let start = base.correction.clone();
            let fitted = self.fit_rung(model, theta, start)?;
            let fitted = self.enrich(fitted)?;
            self.rungs.insert(key.clone(), fitted);
        }
        let fitted = &self.rungs[&key];
        let rung = self.rung(effects, fitted);
        (self.progress)(&format!(
            "[{}] reduced χ² {:.2} (with numerical error {:.2}), BIC {:.1}",
            effects.join(" + "),
            rung.reduced_chi2,
            rung.reduced_chi2_total(),
            rung.bic
        ));
        Ok(rung)
    }

    fn screen(&mut self, rung: &Rung) -> Result<Screen, AnalysisError> {
        let key = Self::key(&rung.effects);
        let Some(f) = self.rungs.get(&key) else {
            return Err(AnalysisError::Case("screen before fit".into()));
        };
        let base = Base {
            model: &f.model,
            theta: &f.theta,
            free: &f.free,
            catalogue: self.catalogue,
            how: self.how,
            options: self.options,
            slots: &self.measured.slots,
            warm: &f.warm,
            cancelled: self.cancelled,
        };
        (self.progress)(&format!("screen at [{}]", rung.effects.join(" + ")));
        let screened = base.screen()?;
        self.runs += 1 + screened.secant_runs;
        let mut prediction = screened.prediction;
        prediction.values += &f.correction;
        let white = Whitened::new(&self.measured.data, &f.frees, &f.fit.theta, &prediction, Noise::Total);
        self.candidates = screened.candidates;
        diagnose::screen(&white, &f.fit.at_bound, &self.candidates, self.measured.data.points(), &self.policy)
            .map_err(|e| AnalysisError::Case(e.to_string()))
    }

    fn compatible(&self, effects: &[String]) -> bool {
        effects.iter().all(|a| {
            self.catalogue
                .get(a)
                .is_some_and(|e| !effects.iter().any(|b| e.card().excludes.contains(&b.as_str())))
        })
    }

    fn interrupted(&self) -> bool {
        (self.cancelled)()
    }
}

impl FeLadder<'_> {
    /// The fitted rung with the most of these effects: the start of a new fit.
    fn nearest(&self, key: &[String]) -> Option<&Fitted> {
        self.rungs
            .iter()
            .filter(|(k, _)| k.iter().all(|e| key.contains(e)))
            .max_by_key(|(k, _)| k.len())
            .map(|(_, f)| f)
    }

    /// The case on its search mesh.
    pub fn case(&self) -> &Case {
        &self.case
    }

    /// Data of the ladder.
    pub fn data(&self) -> &Data {
        &self.measured.data
    }
}
