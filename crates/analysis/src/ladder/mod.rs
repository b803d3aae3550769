//! The finite-element model as a ladder: fits with any set of effects, and screens at each rung.
//!
//! Fits run on a mesh coarser than the file's, corrected by what the file's mesh says more at the
//! fit (defect correction, repeated until it stands); the same difference tells the numerical error
//! that every χ², test and interval carries.

mod adds;
mod begin;
mod fit;
mod forms;
pub(crate) mod next_test;
mod rung;
mod search;
mod weighing;

pub use adds::Adds;
pub use next_test::{NextTest, Tried};
use weighing::FineStates;

use crate::columns::Base;
use crate::correction::Correction;
use crate::cost::Phase;
use crate::data::Measured;
use crate::identify::{AnalysisError, coarser, run_options};
use crate::journal::Journal;
use crate::problem::Cancelled;
use diagnose::{Candidate, Policy, Rung, Screen};
use input::Case;
use inverse::{Data, Fit, Free, Noise, Objective, Quality, Whitened};
use model::cost::Purpose;
use model::{Catalogue, Discretisation, Model, RunOptions};
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

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
    /// What the file's mesh says more than the search mesh, around this fit.
    pub correction: Correction,
    /// Whether this is the optimum on the file's mesh.
    pub settled: bool,
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
    /// Candidates of every screen, by the rung's sorted effects.
    pub screened: BTreeMap<Vec<String>, Vec<Candidate>>,
    /// Values that the base's fit began with.
    first: Vec<f64>,
    runs: AtomicUsize,
    policy: Policy,
    /// What fits minimise.
    objective: Objective,
    /// States on the file's mesh at the base's optimum: first guesses there.
    fine_states: Option<FineStates>,
    progress: &'a (dyn Fn(&str) + Sync),
    journal: &'a dyn Journal,
}

impl<'a> FeLadder<'a> {
    /// Fits the case's own model and finds the numerical error.
    ///
    /// # Errors
    /// [`AnalysisError`].
    pub fn new(case: Arc<Case>, how: How<'a>) -> Result<Self, AnalysisError> {
        let mut ladder = Self::unfitted(case, how)?;
        ladder.base(true)?;
        Ok(ladder)
    }

    /// The same, with the values of the case as the start of its fit.
    ///
    /// # Errors
    /// [`AnalysisError`].
    pub fn from_values(case: Arc<Case>, how: How<'a>) -> Result<Self, AnalysisError> {
        let mut ladder = Self::unfitted(case, how)?;
        ladder.base(false)?;
        Ok(ladder)
    }

    fn unfitted(case: Arc<Case>, how: How<'a>) -> Result<Self, AnalysisError> {
        let How { catalogue, policy, progress, cancelled, journal } = how;
        let case = crate::condensed(&case);
        // The search works on a coarser mesh than the file's.
        let (coarse, mesh) = coarser(&case);
        let fine = Model::checked(case.clone(), catalogue, Discretisation::default(), Purpose::Fit)?;
        let wanted = fine.recorded();
        let measured = Measured::cautious(&fine, &wanted)?;
        Ok(Self {
            case: Arc::new(coarse),
            fine_case: case.clone(),
            catalogue,
            how: mesh,
            options: search_options(&case),
            cancelled,
            measured,
            rungs: BTreeMap::new(),
            candidates: Vec::new(),
            screened: BTreeMap::new(),
            first: Vec::new(),
            runs: AtomicUsize::new(0),
            policy,
            objective: Objective::Whitened,
            fine_states: None,
            progress,
            journal,
        })
    }
}

/// How a search is made.
#[derive(Clone)]
pub struct How<'a> {
    /// The effects it draws on.
    pub catalogue: &'a Catalogue,
    /// What it judges by.
    pub policy: Policy,
    /// Whom it tells.
    pub progress: &'a (dyn Fn(&str) + Sync),
    /// Who stops it.
    pub cancelled: Cancelled<'a>,
    /// Where finished fits are kept.
    pub journal: &'a dyn Journal,
}

/// A model by its effects.
fn named(effects: &[String]) -> String {
    if effects.is_empty() { "base model".into() } else { format!("with {}", effects.join(" + ")) }
}

impl diagnose::Ladder for FeLadder<'_> {
    type Error = AnalysisError;

    fn fit(&mut self, effects: &[String], hints: &diagnose::Hints) -> Result<Rung, AnalysisError> {
        self.fit_all(&[effects.to_vec()], hints).swap_remove(0)
    }

    /// Side by side: every fit sees the rungs that were there before the call, so that the answer does not
    /// depend on which ends first.
    fn fit_all(&mut self, sets: &[Vec<String>], hints: &diagnose::Hints) -> Vec<Result<Rung, AnalysisError>> {
        self.cancelled.phase(Phase::Candidates);
        let this = &*self;
        let one = |effects: &Vec<String>| {
            let key = Self::key(effects);
            if this.rungs.contains_key(&key) {
                return Ok(None);
            }
            let fitted = this.fit_near_neutral_if_need_be(&key, effects, hints)?;
            this.enrich(fitted).map(Some)
        };
        let mut fitted: Vec<Result<Option<Fitted>, AnalysisError>> = sets.par_iter().map(one).collect();
        let all_far = |f: &Result<Option<Fitted>, AnalysisError>| !matches!(f, Ok(Some(f)) if f.quality.reduced_chi2_total <= fit::FAR);
        if fitted.iter().all(all_far) {
            let again = |(effects, first): (&Vec<String>, Result<Option<Fitted>, AnalysisError>)| {
                Ok(first?.map(|f| this.again_from_the_beginning(effects, f)))
            };
            fitted = sets.par_iter().zip(fitted).map(again).collect();
        }
        let keep = |(effects, fitted): (&Vec<String>, Result<Option<Fitted>, AnalysisError>)| {
            let key = Self::key(effects);
            if let Some(f) = fitted? {
                self.rungs.insert(key.clone(), f);
            }
            let rung = self.rung(effects, &self.rungs[&key]);
            let held_out = rung.held_out_chi2.map_or(String::new(), |h| format!(", held out {h:.2}"));
            (self.progress)(&format!(
                "{}: reduced χ² {:.2} (with numerical error {:.2}), BIC {:.1}{held_out}",
                named(effects),
                rung.reduced_chi2,
                rung.reduced_chi2_total(),
                rung.bic
            ));
            Ok(rung)
        };
        sets.iter().zip(fitted).map(keep).collect()
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
        self.cancelled.phase(Phase::Screen);
        (self.progress)(&format!("{}: screen of the catalogue", named(&rung.effects)));
        let screened = base.screen()?;
        self.runs.fetch_add(1 + screened.secant_runs, Ordering::Relaxed);
        let mut prediction = screened.prediction;
        let by = f.free.as_slice();
        f.correction.apply(&f.model, &f.theta, by, &mut prediction.values, prediction.jacobian.as_mut());
        self.candidates = screened.candidates;
        self.screened.insert(key.clone(), self.candidates.clone());
        let judged = |data: &Data| {
            let white = Whitened::new(data, &f.frees, &f.fit.theta, &prediction, Noise::Total);
            diagnose::screen(&white, &f.fit.at_bound, &self.candidates, data.points(), &self.policy)
                .map_err(|e| AnalysisError::Case(e.to_string()))
        };
        let mut screen = judged(&self.measured.data)?;
        screen.beside(&judged(&self.measured.as_estimated(&f.model)?.data)?);
        Ok(screen)
    }

    fn compatible(&self, effects: &[String]) -> bool {
        effects.iter().all(|a| {
            self.catalogue
                .get(a)
                .is_some_and(|e| !effects.iter().any(|b| e.card().excludes.contains(&b.as_str())))
        })
    }

    fn untold(&self, effect: &str) -> Vec<String> {
        crate::needs::untold(&self.case, self.catalogue, effect)
    }

    fn interrupted(&self) -> bool {
        self.cancelled.stops()
    }
}

impl<'a> FeLadder<'a> {
    /// Forward runs so far.
    pub fn runs(&self) -> usize {
        self.runs.load(Ordering::Relaxed)
    }

    /// The fitted rung with the most of these effects: the start of a new fit.
    fn nearest(&self, key: &[String]) -> Option<&Fitted> {
        self.rungs
            .iter()
            .filter(|(k, _)| k.iter().all(|e| key.contains(e)))
            .max_by_key(|(k, _)| k.len())
            .map(|(_, f)| f)
    }

    /// The effects that are searched.
    pub const fn catalogue(&self) -> &'a Catalogue {
        self.catalogue
    }

    /// A rung's key: effects in sorted order.
    pub fn key(effects: &[String]) -> Vec<String> {
        let mut k = effects.to_vec();
        k.sort();
        k
    }

    /// How probable each set of effects is by what was fitted and screened so far, and how much is left.
    ///
    /// # Errors
    /// [`evidence::EvidenceError`] when a number cannot be used or nothing was fitted.
    pub fn probable(&self) -> Result<crate::Probable, evidence::EvidenceError> {
        crate::probable::probable(self)
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
