//! The finite-element model as a ladder: fits with any set of effects, and screens at each rung.
//!
//! Fits run on a mesh coarser than the file's, put right to first order by what the file's mesh says more; the models that
//! matter are fitted on the file's mesh itself.

mod adds;
mod base;
mod begin;
mod catalogue;
mod decided;
mod fit;
mod fitted_model;
mod forms;
pub(crate) mod laws;
mod leading;
mod modes;
mod neutral;
pub(crate) mod next_test;
mod pace;
mod rivals;
mod settle;
mod smaller;
#[cfg(test)]
pub(crate) mod tests;
mod torn_end;

pub use adds::Adds;
pub use decided::Weighed;
use modes::Seed;
pub use next_test::{NextTest, Tried};
use settle::FineStates;
pub use torn_end::{LeftOut, SearchOutcome};

use crate::columns::Base;
use crate::correction::Correction;
use crate::cost::Phase;
use crate::data::Measured;
use crate::identify::{AnalysisError, coarser, fewer_steps, run_options};
use crate::journal::Journal;
use crate::problem::Cancelled;
use crate::start::Start;
use crate::weigh::{Known, Mode};
use diagnose::{Candidate, FittedModel, Policy, Screen};
use input::Case;
use inverse::{Data, Fit, Free, Noise, Quality, Whitened};
use model::cost::Purpose;
use model::{Catalogue, Discretisation, Model, RunOptions};
use std::collections::BTreeMap;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex};

/// A fitted rung with everything a screen or a report needs.
pub struct Fitted {
    /// The model (coarse).
    pub model: Model,
    /// Its values.
    pub theta: Vec<f64>,
    /// Free parameters.
    pub free: Vec<usize>,
    /// As the optimiser saw them.
    pub free_parameters: Vec<Free>,
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
    /// Where its posterior has its mode, once that was looked for.
    pub(crate) mode: Option<Mode>,
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
    pub fitted_models: BTreeMap<Vec<String>, Fitted>,
    /// Candidates of the latest screen, with raw columns.
    pub candidates: Vec<Candidate>,
    /// Candidates of every screen, by the rung's sorted effects.
    pub screened: BTreeMap<Vec<String>, Vec<Candidate>>,
    /// Sets that could not be fitted, and why.
    pub failed: BTreeMap<Vec<String>, String>,
    /// Screen at each set where there was one.
    pub(crate) screens: BTreeMap<Vec<String>, Screen>,
    /// The base model as `fct identify` finds it, where all parameters together end elsewhere.
    identified: Option<Fitted>,
    /// Values that the base's fit began with.
    first: Vec<f64>,
    /// Where the base's search began, if that is where the record of a tear had to tell.
    torn: Vec<Arc<Start>>,
    /// The objective of a model that leaves noise alone: fits that cannot come near it are dropped.
    leader: Option<f64>,
    /// Where the sets' posteriors were found to have their modes: paths and values of the free parameters.
    modes: BTreeMap<Vec<String>, Seed>,
    /// What the models say of the records, as far as it was asked.
    pub(crate) known: Mutex<Known>,
    /// Whether the search ends where no effect alone comes near the records: there is something else to try first.
    brief: bool,
    runs: AtomicUsize,
    policy: Policy,
    /// States on the file's mesh at the base's optimum: first guesses there.
    fine_states: Option<FineStates>,
    progress: &'a (dyn Fn(&str) + Sync),
    journal: &'a dyn Journal,
}

impl<'a> FeLadder<'a> {
    fn unfitted(case: Arc<Case>, how: LadderSettings<'a>) -> Result<Self, AnalysisError> {
        let LadderSettings { catalogue, policy, progress, cancelled, journal } = how;
        let case = crate::condensed(&case);
        // The search works on a coarser mesh than the file's.
        let (coarse, mesh) = coarser(&case);
        let fine = Model::checked(case.clone(), catalogue, Discretisation::default(), Purpose::Fit)?;
        let wanted = fine.recorded();
        let measured = Measured::conservative(&fine, &wanted)?;
        Ok(Self {
            case: Arc::new(coarse),
            fine_case: case.clone(),
            catalogue,
            how: mesh,
            options: fewer_steps(run_options(&case)),
            cancelled,
            measured,
            fitted_models: BTreeMap::new(),
            candidates: Vec::new(),
            screened: BTreeMap::new(),
            failed: BTreeMap::new(),
            screens: BTreeMap::new(),
            identified: None,
            first: Vec::new(),
            torn: Vec::new(),
            leader: None,
            modes: BTreeMap::new(),
            known: Mutex::default(),
            brief: false,
            runs: AtomicUsize::new(0),
            policy,
            fine_states: None,
            progress,
            journal,
        })
    }
}

/// How a search is made.
#[derive(Clone)]
pub struct LadderSettings<'a> {
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

impl FeLadder<'_> {
    /// The catalogue's score tests at a fitted rung, from its derivatives there.
    ///
    /// # Errors
    /// [`AnalysisError`].
    pub fn screen(&mut self, fitted_model: &FittedModel) -> Result<Screen, AnalysisError> {
        let key = Self::key(&fitted_model.effects);
        let Some(f) = self.fitted_models.get(&key) else {
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
        (self.progress)(&format!("{}: screen of the catalogue", named(&fitted_model.effects)));
        let screened = base.screen()?;
        self.runs.fetch_add(1 + screened.secant_runs, Ordering::Relaxed);
        let mut prediction = screened.prediction;
        let by = f.free.as_slice();
        f.correction.apply(&f.model, &f.theta, by, &mut prediction.values, prediction.jacobian.as_mut());
        self.candidates = screened.candidates;
        self.screened.insert(key.clone(), self.candidates.clone());
        let judged = |data: &Data| {
            let white = Whitened::new(data, &f.free_parameters, &f.fit.theta, &prediction, Noise::Total);
            diagnose::screen(&white, &f.fit.at_bound, &self.candidates, data.points(), &self.policy)
                .map_err(|e| AnalysisError::Case(e.to_string()))
        };
        let mut screen = judged(&self.measured.data)?;
        screen.beside(&judged(&self.measured.as_estimated(&f.model)?.data)?);
        Ok(screen)
    }

    /// Whether these effects may stand together.
    pub(crate) fn compatible(&self, effects: &[String]) -> bool {
        let site = |name: &String| self.catalogue.site_of_law(name);
        effects.iter().all(|a| match self.catalogue.get(a) {
            Some(e) => !effects.iter().any(|b| e.card().excludes.contains(&b.as_str())),
            None => site(a).is_some_and(|own| effects.iter().filter(|b| site(b) == Some(own)).count() == 1),
        })
    }

    /// Whether the user asked to stop; a search then ends with what it has.
    pub fn interrupted(&self) -> bool {
        self.cancelled.stops()
    }
}

impl<'a> FeLadder<'a> {
    /// Forward runs so far.
    pub fn runs(&self) -> usize {
        self.runs.load(Ordering::Relaxed)
    }

    /// The fitted rung with the most of these effects, of several that which misses the records least: the start of a new
    /// fit.
    fn nearest(&self, key: &[String]) -> Option<&Fitted> {
        self.nearest_of(key).map(|(_, f)| f)
    }

    fn nearest_of(&self, key: &[String]) -> Option<(&Vec<String>, &Fitted)> {
        self.nearest_where(key, |_| true)
    }

    /// The same among rungs of some kind.
    fn nearest_where(
        &self,
        key: &[String],
        counts: impl Fn(&[String]) -> bool,
    ) -> Option<(&Vec<String>, &Fitted)> {
        self.fitted_models
            .iter()
            .filter(|(k, _)| counts(k) && k.iter().all(|e| key.contains(e)))
            .max_by(|a, b| a.0.len().cmp(&b.0.len()).then(b.1.fit.f.total_cmp(&a.1.fit.f)))
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
