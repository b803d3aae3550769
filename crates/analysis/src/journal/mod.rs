//! Finished fits of a search, kept so that a run which was stopped goes on where it was.
//!
//! A fit is known by a hash of everything it depends on: the case and its mesh, the values it starts from, the data and
//! their noise, the search's settings, the states it starts from, the version of the program. The same fit is therefore
//! found by the same search, and its numbers are stored to the last bit: a search that is taken up ends as if it had never
//! stopped.

use crate::identify::AnalysisError;
use crate::problem::FeProblem;
use fem::{Guess, Kept, Warm};
use inverse::{Data, Fit, FitError, FitOptions, Free, Iterate, PredictError, Prediction};
use nalgebra::{DMatrix, DVector};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::ops::ControlFlow;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Where finished fits are kept, by key.
pub trait Journal: Sync {
    /// What was kept under a key.
    fn get(&self, key: &str) -> Option<Vec<u8>>;
    /// Keeps something.
    fn put(&self, key: &str, content: &[u8]);
    /// Whether something is kept under a key.
    fn has(&self, key: &str) -> bool {
        self.get(key).is_some()
    }
}

/// Keeps nothing.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoJournal;

impl Journal for NoJournal {
    fn get(&self, _: &str) -> Option<Vec<u8>> {
        None
    }

    fn put(&self, _: &str, _: &[u8]) {}
}

/// Keeps the fits of one analysis, in memory where they are kept nowhere else: what a search does twice is done once.
pub(crate) struct Recent<'a> {
    kept: Mutex<BTreeMap<String, Vec<u8>>>,
    beside: &'a dyn Journal,
}

impl<'a> Recent<'a> {
    pub fn new(beside: &'a dyn Journal) -> Self {
        Self { kept: Mutex::default(), beside }
    }

    fn kept(&self) -> MutexGuard<'_, BTreeMap<String, Vec<u8>>> {
        self.kept.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Journal for Recent<'_> {
    fn get(&self, key: &str) -> Option<Vec<u8>> {
        let known = self.kept().get(key).cloned();
        known.or_else(|| self.beside.get(key))
    }

    fn put(&self, key: &str, content: &[u8]) {
        self.beside.put(key, content);
        if !self.beside.has(key) {
            self.kept().insert(key.to_owned(), content.to_vec());
        }
    }
}

/// The end of a fit as it is kept.
#[derive(Serialize, Deserialize)]
enum Stored {
    Found(Box<StoredFit>),
    /// The model could not be computed where the fit was to begin.
    NoStart(String),
}

#[derive(Serialize, Deserialize)]
struct StoredFit {
    theta: Vec<f64>,
    f: f64,
    values: Vec<f64>,
    jacobian: Option<Vec<f64>>,
    valid: Option<Vec<bool>>,
    at_bound: Vec<bool>,
    iterations: usize,
    forward_runs: usize,
    stop: inverse::StopReason,
    /// Runs of the problem, which several starts share.
    runs: usize,
    history: Vec<Iterate>,
    /// Every run in the order in which it was told.
    told: Vec<Iterate>,
    starts: Option<String>,
    states: Vec<Option<Vec<Option<StoredState>>>>,
}

#[derive(Serialize, Deserialize)]
struct StoredState {
    u: Vec<f64>,
    pressure: Vec<f64>,
    path: Vec<f64>,
}

/// A fit with what went on around it.
pub(crate) struct Done {
    /// The fit.
    pub fit: Fit,
    /// Forward runs.
    pub runs: usize,
    /// States of its last run.
    pub warm: Vec<Option<Warm>>,
    /// How several starts agreed, where there were several.
    pub starts: Option<String>,
}

/// What is asked of a search: a problem, data, free parameters, settings.
pub(crate) struct Asked<'a> {
    /// The model.
    pub problem: &'a FeProblem<'a>,
    /// A cheap model that the search takes its steps on.
    pub beside: Option<&'a FeProblem<'a>>,
    /// Measured data.
    pub data: &'a Data,
    /// Free parameters.
    pub free: &'a [Free],
    /// Settings of the fit.
    pub options: &'a FitOptions,
    /// What else decides how the search goes.
    pub how: &'a str,
    /// Whether the user asked to stop: a fit that was cut off is not kept.
    pub cancelled: crate::Cancelled<'a>,
}

/// Who hears of every run of a fit.
type Observer<'a> = &'a mut dyn FnMut(&Iterate) -> ControlFlow<()>;

/// A fit, with a sentence on its starts where there were several.
type Found = Result<(Fit, Option<String>), FitError>;

/// Does a fit, or takes the one that was kept. `search` does it; `observer` hears of every run either way.
pub(crate) fn remembered(
    journal: &dyn Journal,
    asked: &Asked,
    observer: Observer,
    search: &mut dyn FnMut(Observer) -> Found,
) -> Result<Done, AnalysisError> {
    let key = asked.key();
    let points = asked.data.points();
    if let Some(stored) = journal.get(&key).and_then(|b| postcard::from_bytes::<Stored>(&b).ok()) {
        match stored {
            Stored::NoStart(why) => return Err(FitError::Start(PredictError::NotComputable(why)).into()),
            Stored::Found(stored) => {
                for iterate in &stored.told {
                    // Where this search stopped, the kept one did.
                    let _ = observer(iterate);
                }
                if let Some(done) = stored.done(points, asked.free.len(), asked.options) {
                    return Ok(done);
                }
            }
        }
    }
    let mut told = Vec::new();
    let result = search(&mut |iterate| {
        told.push(iterate.clone());
        observer(iterate)
    });
    let stored = match &result {
        Ok((fit, starts)) => Some(Stored::Found(Box::new(StoredFit::of(fit, starts.clone(), asked, told)))),
        Err(FitError::Start(PredictError::NotComputable(why))) => Some(Stored::NoStart(why.clone())),
        Err(_) => None,
    };
    if let Some(stored) = stored.filter(|_| !asked.cancelled.stops())
        && let Ok(bytes) = postcard::to_allocvec(&stored)
    {
        journal.put(&key, &bytes);
    }
    let (fit, starts) = result?;
    Ok(Done { runs: asked.runs(), warm: asked.problem.warm(), fit, starts })
}

impl Asked<'_> {
    /// Runs of its models so far.
    fn runs(&self) -> usize {
        self.problem.runs() + self.beside.map_or(0, FeProblem::runs)
    }

    /// A hash of everything the fit depends on.
    fn key(&self) -> String {
        let p = self.problem;
        let mut text = String::new();
        let mesh: Vec<usize> = p.model.tests.iter().map(model::TestModel::unknowns).collect();
        // Writing to a string does not fail.
        let _ = write!(
            text,
            "{}|{:?}|{mesh:?}|{:?}|{:?}|{:?}|{:?}|{:?}|{:?}|{}",
            env!("CARGO_PKG_VERSION"),
            CaseKey(&p.model.case),
            p.theta,
            p.free,
            p.options,
            p.correction,
            self.free,
            self.options,
            self.how,
        );
        let _ = write!(text, "|{:?}", self.data);
        if let Some(cheap) = self.beside {
            let mesh: Vec<usize> = cheap.model.tests.iter().map(model::TestModel::unknowns).collect();
            let _ = write!(text, "|{mesh:?}|{:?}", cheap.options);
        }
        for state in p.warm().iter().flatten().flat_map(|w| w.at_target.iter().flatten()) {
            let _ = write!(text, "|{:?}|{:?}|{:?}", state.guess.u, state.guess.pressure, state.path);
        }
        input::sha256(text.as_bytes())
    }
}

/// A case without where it was read from.
struct CaseKey<'a>(&'a input::Case);

impl std::fmt::Debug for CaseKey<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let mut case = self.0.clone();
        (case.specimen_file, case.config_file, case.parent) = (None, None, None);
        case.inputs.iter_mut().for_each(|i| i.file.clear());
        for record in case.tests.iter_mut().filter_map(|t| t.record.as_mut()) {
            record.path.clear();
        }
        case.fmt(f)
    }
}

impl StoredFit {
    fn of(fit: &Fit, starts: Option<String>, asked: &Asked, told: Vec<Iterate>) -> Self {
        let states = |w: &Warm| w.at_target.iter().map(|k| k.as_deref().map(StoredState::of)).collect();
        Self {
            theta: fit.theta.clone(),
            f: fit.f,
            values: fit.prediction.values.as_slice().to_vec(),
            jacobian: fit.prediction.jacobian.as_ref().map(|j| j.as_slice().to_vec()),
            valid: fit.prediction.valid.clone(),
            at_bound: fit.at_bound.clone(),
            iterations: fit.iterations,
            forward_runs: fit.forward_runs,
            stop: fit.stop,
            runs: asked.runs(),
            history: fit.history.clone(),
            told,
            starts,
            states: asked.problem.warm().iter().map(|w| w.as_ref().map(states)).collect(),
        }
    }

    /// `None` if it does not fit the data it was kept for, which a damaged journal may make of it.
    fn done(self, points: usize, free: usize, options: &FitOptions) -> Option<Done> {
        let jacobian = match self.jacobian {
            Some(j) if j.len() == points * free => Some(DMatrix::from_vec(points, free, j)),
            Some(_) => return None,
            None => None,
        };
        let fits = self.values.len() == points && self.theta.len() == free && self.at_bound.len() == free;
        let fit = Fit {
            theta: self.theta,
            f: self.f,
            prediction: Prediction { values: DVector::from_vec(self.values), jacobian, valid: self.valid },
            at_bound: self.at_bound,
            objective: options.objective,
            iterations: self.iterations,
            forward_runs: self.forward_runs,
            stop: self.stop,
            history: self.history,
        };
        let warm = |states: Vec<Option<StoredState>>| {
            Warm::at(states.into_iter().map(|s| s.map(|s| Arc::new(s.kept()))).collect())
        };
        let warm = self.states.into_iter().map(|w| w.map(warm)).collect();
        fits.then_some(Done { fit, runs: self.runs, warm, starts: self.starts })
    }
}

impl StoredState {
    fn of(k: &Kept) -> Self {
        Self { u: k.guess.u.clone(), pressure: k.guess.pressure.clone(), path: k.path.clone() }
    }

    fn kept(self) -> Kept {
        Kept { guess: Guess { u: self.u, pressure: self.pressure }, path: self.path }
    }
}

#[cfg(test)]
mod tests;
