//! The finite-element model as an inverse problem: free parameters in, record points out.

use crate::correction::Correction;
use crate::cost::Watch;
use crate::data::DataBlock;
use fem::Warm;
use inverse::{PredictError, Prediction, Problem};
use model::{Channel, Model, Request, RunOptions, TestRun};
use nalgebra::{DMatrix, DVector};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Asked between steps: whether the user wants to stop; told what is done.
pub type Cancelled<'a> = &'a dyn Watch;

/// Runs kept per test as first guesses: an accepted point with its derivatives, and a trial.
const KEPT: usize = 2;

/// How long a run may take beside those before it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Patience {
    /// So many times the Newton iterations of the longest of them,
    pub times: usize,
    /// each with these for a jump that it did not have.
    pub jump: usize,
}

impl Patience {
    /// Of a fit with its trials.
    pub const FIT: Self = Self { times: 3, jump: 200 };

    /// Newton iterations of a run after those.
    pub const fn limit(self, longest: usize) -> usize {
        self.times * (longest + self.jump)
    }
}

/// A finished run, as a first guess.
#[derive(Clone)]
struct Kept {
    warm: Warm,
    /// Newton iterations; `None` where it was made elsewhere.
    iterations: Option<usize>,
}

/// A model with some free parameters, compared with some blocks.
pub struct FeProblem<'a> {
    /// The model.
    pub model: &'a Model,
    /// All parameter values; the free ones are replaced.
    pub theta: Vec<f64>,
    /// Indices of the free ones.
    pub free: Vec<usize>,
    /// Blocks of the prediction vector.
    pub slots: &'a [DataBlock],
    /// Run options.
    pub options: RunOptions,
    /// Added to the prediction: what a finer mesh says more.
    pub correction: Correction,
    cancelled: Cancelled<'a>,
    /// Where a run is given up that takes far longer than those before it. Not for runs made side by side: they would hang on
    /// each other.
    pub(crate) patience: Option<Patience>,
    /// The latest runs per test, newest last: an accepted point and a trial, say.
    warm: Mutex<Vec<Vec<Kept>>>,
    /// What was predicted last, and where: for whoever watches.
    last: Mutex<Option<(Vec<f64>, DVector<f64>)>>,
    runs: AtomicUsize,
}

impl<'a> FeProblem<'a> {
    /// A problem without first guesses.
    pub fn new(
        model: &'a Model,
        theta: Vec<f64>,
        free: Vec<usize>,
        slots: &'a [DataBlock],
        options: RunOptions,
        cancelled: Cancelled<'a>,
    ) -> Self {
        let tests = model.tests.len();
        Self {
            model,
            theta,
            free,
            slots,
            options,
            correction: Correction::default(),
            patience: None,
            cancelled,
            warm: Mutex::new(vec![Vec::new(); tests]),
            last: Mutex::new(None),
            runs: AtomicUsize::new(0),
        }
    }

    /// States of the latest runs, per test.
    pub fn warm(&self) -> Vec<Option<Warm>> {
        self.kept().iter().map(|runs| runs.last().map(|k| k.warm.plain())).collect()
    }

    /// Starts from states kept elsewhere.
    pub fn start_from(&self, states: Vec<Option<Warm>>) {
        let mut kept = self.kept();
        if states.len() == kept.len() {
            let elsewhere = |warm| Kept { warm, iterations: None };
            *kept = states.into_iter().map(|w| w.into_iter().map(elsewhere).collect()).collect();
        }
    }

    fn kept(&self) -> std::sync::MutexGuard<'_, Vec<Vec<Kept>>> {
        self.warm.lock().unwrap_or_else(std::sync::PoisonError::into_inner)
    }

    /// The kept run nearest to θ, per test; without derivatives the newest.
    fn nearest(&self, theta: &[f64]) -> Vec<Option<Warm>> {
        let near = |runs: &Vec<Kept>| {
            let warm = runs.iter().rev().map(|k| &k.warm);
            warm.min_by(|a, b| a.distance(theta).total_cmp(&b.distance(theta))).cloned()
        };
        self.kept().iter().map(near).collect()
    }

    /// Newton iterations after which a run is given up.
    fn budget(&self) -> usize {
        let budget = self.options.stepping.budget;
        let longest = self.kept().iter().flatten().filter_map(|k| k.iterations).max();
        self.patience.zip(longest).map_or(budget, |(patience, n)| budget.min(patience.limit(n)))
    }

    /// Keeps the states of finished runs.
    fn keep(&self, runs: &[Option<TestRun>], theta: &[f64], seeds: &[usize]) {
        for (slot, run) in self.kept().iter_mut().zip(runs) {
            if let Some(r) = run.as_ref().filter(|r| r.run.failure.is_none()) {
                let warm = Warm::first_order(&r.run, r.plan.targets.len(), theta, seeds);
                slot.push(Kept { warm, iterations: Some(r.run.iterations) });
                if slot.len() > KEPT {
                    let only = slot.iter().filter(|k| k.warm.has_derivatives()).count() == 1;
                    slot.remove(usize::from(only && slot[0].warm.has_derivatives()));
                }
            }
        }
    }

    /// Forces at the record's points, N, per test, where the latest prediction was made at these free parameters.
    pub fn forces_at(&self, free: &[f64]) -> Vec<(String, Vec<f64>)> {
        let last = self.last.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        let Some((_, values)) = last.as_ref().filter(|l| l.0 == free) else { return Vec::new() };
        let mut at = 0;
        let mut out = Vec::new();
        for slot in self.slots {
            let n = slot.rows.len();
            if slot.channel == Channel::Force {
                let name = self.model.tests[slot.test].test.name.clone();
                out.push((name, values.rows(at, n).iter().copied().collect()));
            }
            at += n;
        }
        out
    }

    /// Predictions at these free values, if the latest run was there.
    pub(crate) fn values_at(&self, free: &[f64]) -> Option<DVector<f64>> {
        let last = self.last.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        last.as_ref().filter(|l| l.0 == free).map(|l| l.1.clone())
    }

    /// Forward runs so far.
    pub fn runs(&self) -> usize {
        self.runs.load(Ordering::Relaxed)
    }

    /// θ with the free parameters replaced.
    pub fn full(&self, free: &[f64]) -> Vec<f64> {
        let mut theta = self.theta.clone();
        for (&i, &v) in self.free.iter().zip(free) {
            theta[i] = v;
        }
        theta
    }

    /// Runs the tests at θ with derivatives by `seeds`, keeping states as first guesses.
    ///
    /// # Errors
    /// [`PredictError`] when a solver cannot be set up.
    pub fn run(&self, theta: &[f64], seeds: &[usize]) -> Result<Vec<Option<TestRun>>, PredictError> {
        let mut wanted = vec![false; self.model.tests.len()];
        for s in self.slots {
            wanted[s.test] = true;
        }
        let mut options = self.options;
        options.stepping.keep_states = true;
        options.stepping.keep_gradients = !seeds.is_empty();
        options.stepping.budget = self.budget();
        let warm = self.nearest(theta);
        self.runs.fetch_add(1, Ordering::Relaxed);
        let stops = || self.cancelled.stops();
        let request = Request { theta, seeds, options, wanted: &wanted, warm: &warm, cancelled: &stops };
        let runs = self.model.run(&request).map_err(|e| PredictError::NotComputable(e.to_string()))?;
        self.cancelled.ran(&runs);
        if self.cancelled.stops() {
            return Err(PredictError::Interrupted);
        }
        self.keep(&runs, theta, seeds);
        Ok(runs)
    }

    /// Prediction vector (and jacobian) from finished runs.
    ///
    /// # Errors
    /// Why a run stopped before the last record point.
    pub fn gather(
        &self,
        runs: &[Option<TestRun>],
        theta: &[f64],
        jacobian: bool,
    ) -> Result<Prediction, PredictError> {
        let n: usize = self.slots.iter().map(|s| s.rows.len()).sum();
        let k = if jacobian { runs.iter().flatten().next().map_or(0, |r| r.columns.len()) } else { 0 };
        let mut values = DVector::zeros(n);
        let mut matrix = DMatrix::zeros(n, k);
        let mut valid = vec![true; n];
        let mut at = 0;
        for slot in self.slots {
            let not = |why: String| PredictError::NotComputable(why);
            let run = runs[slot.test].as_ref().ok_or_else(|| not("a test was not run".into()))?;
            let name = &self.model.tests[slot.test].test.name;
            let series =
                self.model.series(run, theta, slot.channel).map_err(|e| not(format!("test {name}: {e}")))?;
            for (row, value) in series.values.iter().enumerate() {
                values[at + row] = *value;
                valid[at + row] = series.smooth[row];
                for c in 0..k {
                    matrix[(at + row, c)] = series.derivatives[row * k + c];
                }
            }
            at += slot.rows.len();
        }
        if values.iter().any(|v| !v.is_finite()) || matrix.iter().any(|v| !v.is_finite()) {
            return Err(PredictError::NotComputable("the prediction is not finite".into()));
        }
        let by = if k == self.free.len() { self.free.as_slice() } else { &[] };
        self.correction.apply(self.model, theta, by, &mut values, jacobian.then_some(&mut matrix));
        Ok(Prediction { values, jacobian: jacobian.then_some(matrix), valid: Some(valid) })
    }
}

impl Problem for FeProblem<'_> {
    fn predict(&self, free: &[f64], jacobian: bool) -> Result<Prediction, PredictError> {
        let theta = self.full(free);
        let seeds: &[usize] = if jacobian { &self.free } else { &[] };
        let runs = self.run(&theta, seeds)?;
        let prediction = self.gather(&runs, &theta, jacobian)?;
        let mut last = self.last.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        *last = Some((free.to_vec(), prediction.values.clone()));
        Ok(prediction)
    }
}
