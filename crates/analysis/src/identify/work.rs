//! An identification in progress: one stage's search after the other, then what all data say.

use super::{AnalysisError, Control, HistoryEntry, Identified, Progress, Stage};
use crate::data::Measured;
use crate::problem::FeProblem;
use input::{Case, TestKind};
use inverse::{
    Fit, FitOptions, Free, Identifiability, Iterate, MultiStart, Objective, PredictError, Problem, quality,
    uncertainty,
};
use model::{Channel, Model, RunOptions};
use nalgebra::DVector;
use std::ops::ControlFlow;

/// The coarse mesh only brings the search near: a fall of half a percent is not worth a run, nor is a
/// fifth trial of a step.
const COARSE_TOLERANCE: f64 = 5e-3;
const COARSE_TRIALS: usize = 4;

/// Three steps in a row that lower χ² by less than this end the search: a quarter of what one
/// parameter is worth by chance, each step half a standard deviation at most in any direction.
const INSIGNIFICANT: f64 = 0.25;

/// Newton tolerance of the search, if the file's is not coarser: it moves χ² by far less than a step
/// does. The last run, which the answer is made from, takes the file's.
const SEARCH_TOLERANCE: f64 = 1e-7;

/// Newton iterations a trial run may take: about five times what a smooth tear needs.
pub(crate) const TRIAL_BUDGET: usize = 2500;

pub(crate) struct Work<'a> {
    pub theta: Vec<f64>,
    history: Vec<HistoryEntry>,
    pub(super) stopped: Vec<(Stage, String, bool)>,
    runs: usize,
    iterations: usize,
    control: &'a Control<'a>,
    pub case: &'a Case,
    options: RunOptions,
    pub(super) held: Option<()>,
    /// Whether the literature's priors count.
    pub literature: bool,
    /// Share of each record's largest value that counts as noise at least: a start need not follow
    /// the record any closer, and keeps a tissue that the literature knows.
    pub coarse_noise: f64,
    pub(super) starts: Option<String>,
    /// Whether there is a coarse mesh to begin on.
    pub(super) coarse_level: bool,
    /// What the latest stage left of the tearing records.
    pub(super) tear_left: TearMisfit,
}

/// Free parameters as the optimiser sees them, at θ.
pub fn frees(model: &Model, theta: &[f64], free: &[usize]) -> Vec<Free> {
    free.iter().map(|&i| Free { start: theta[i], ..Free::of(&model.parameters[i]) }).collect()
}

/// Standard deviations of χ² that are left to chance.
const CHANCE: f64 = 3.0;

/// χ² of the tearing records that a fit left, with their noise as if it were white.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct TearMisfit {
    chi2: f64,
    points: f64,
}

impl TearMisfit {
    fn of(model: &Model, measured: &Measured, fit: &Fit) -> Self {
        let misfit = measured.data.misfit(&fit.prediction.values);
        let mut left = Self::default();
        for (slot, block) in measured.slots.iter().zip(&measured.data.blocks) {
            if model.tests[slot.test].test.kind == TestKind::Tearing && slot.channel == Channel::Force {
                left.chi2 += block.range.clone().map(|i| (misfit[i] / block.noise.sd).powi(2)).sum::<f64>();
                left.points += block.range.len() as f64;
            }
        }
        left
    }

    /// Per point; no record of a tear: not a number.
    pub fn per_point(self) -> f64 {
        self.chi2 / self.points
    }

    /// What noise alone does not leave.
    pub fn excess(self) -> f64 {
        self.chi2 - self.points
    }

    /// Whether noise alone would not leave as much.
    pub fn unexplained(self) -> bool {
        self.excess() > CHANCE * (2.0 * self.points).sqrt()
    }
}

impl<'a> Work<'a> {
    pub fn new(case: &'a Case, theta: Vec<f64>, options: RunOptions, control: &'a Control<'a>) -> Self {
        Self {
            theta,
            history: Vec::new(),
            stopped: Vec::new(),
            runs: 0,
            iterations: 0,
            control,
            case,
            options,
            held: None,
            literature: case.identify.priors.literature.unwrap_or(false),
            coarse_noise: 0.0,
            starts: None,
            coarse_level: false,
            tear_left: TearMisfit::default(),
        }
    }

    /// A problem for trial runs: given up early where they are hopeless, and no more exact than a step of the search needs.
    pub fn trial<'p>(
        &self,
        model: &'p Model,
        theta: &[f64],
        free: &[usize],
        slots: &'p [crate::data::Slot],
    ) -> FeProblem<'p>
    where
        'a: 'p,
    {
        let cancelled = self.control.cancelled;
        let mut problem =
            FeProblem::new(model, theta.to_vec(), free.to_vec(), slots, self.options, cancelled);
        problem.options.march.budget = TRIAL_BUDGET;
        let newton = &mut problem.options.march.newton;
        newton.tolerance = newton.tolerance.max(SEARCH_TOLERANCE);
        problem
    }

    /// One stage from the present values: its parameters on its tests.
    pub fn stage(
        &mut self,
        model: &Model,
        stage: Stage,
        free: &[usize],
        tests: &[bool],
        coarse: bool,
    ) -> Result<f64, AnalysisError> {
        let starting = self.coarse_noise > 0.0;
        let mut measured = Measured::of(model, tests)?;
        if starting {
            measured = measured.with_noise_of_at_least(self.coarse_noise);
        }
        let mut list = frees(model, &self.theta, free);
        crate::priors::add(&mut list, self.case, self.literature || starting);
        let paths: Vec<String> = list.iter().map(|f| f.path.clone()).collect();
        let whitened = stage == Stage::Joint || starting;
        let objective = if whitened { Objective::Record } else { Objective::PaperSum };
        let fit_options = FitOptions {
            objective,
            // The coarse mesh only brings the search near: its own error is larger than the rest.
            insignificant: INSIGNIFICANT,
            tolerance: if coarse { COARSE_TOLERANCE } else { self.case.identify.tolerance },
            max_trials: if coarse { COARSE_TRIALS } else { FitOptions::default().max_trials },
            max_iterations: match (coarse, stage) {
                (false, _) => self.case.identify.max_iterations,
                (true, Stage::Joint) => 30,
                (true, _) => 10,
            },
            // Strengths of neighbouring areas trade against each other: a bold first step makes the
            // tear jump, and a jump tells the search nothing.
            initial_damping: if stage == Stage::Bulk { 1e-3 } else { 3e-2 },
            max_step: if stage == Stage::Bulk { 1.5 } else { 0.5 },
            ..FitOptions::default()
        };
        let problem = self.trial(model, &self.theta, free, &measured.slots);
        let (progress, history) = (self.control.progress, &mut self.history);
        let mut observer = |iterate: &Iterate| {
            progress(&Progress { stage, coarse, iterate, paths: &paths });
            history.push(HistoryEntry { stage, coarse, iterate: iterate.clone(), paths: paths.clone() });
            ControlFlow::Continue(())
        };
        let several = self.case.identify.multi_start;
        // On the coarse mesh where there is one: that is where a search may still go astray.
        let fit = if several > 1 && !starting && coarse == self.coarse_level {
            let how = MultiStart { starts: several, ..MultiStart::default() };
            let mut each = |_: usize, iterate: &Iterate| observer(iterate);
            let ends = inverse::multi_start(&problem, &measured.data, &list, &fit_options, &how, &mut each)?;
            let told = format!("{}: {}", stage.word(), ends.sentence());
            self.starts = Some(self.starts.take().map_or(told.clone(), |s| format!("{s} {told}")));
            ends.best
        } else {
            inverse::fit(&problem, &measured.data, &list, &fit_options, &mut observer)?
        };
        self.runs += problem.runs();
        self.theta = problem.full(&fit.theta);
        if !coarse {
            self.iterations = self.iterations.max(fit.iterations);
        }
        self.tear_left = TearMisfit::of(model, &measured, &fit);
        self.stopped.push((stage, fit.stop.sentence().to_owned(), fit.stop.converged()));
        if stage == Stage::Bulk && !coarse {
            self.held = Some(());
        }
        Ok(fit.f)
    }

    /// All data at the end: quality, numerical error, intervals.
    pub(super) fn finish(
        mut self,
        fine: Model,
        coarse: Option<Model>,
        measured: Measured,
        list: &[(Stage, Vec<usize>, Vec<bool>)],
    ) -> Result<Identified, AnalysisError> {
        let free = fine.free();
        let mut list_free = frees(&fine, &self.theta, &free);
        crate::priors::add(&mut list_free, self.case, self.literature);
        let prediction = {
            let problem = FeProblem::new(
                &fine,
                self.theta.clone(),
                free.clone(),
                &measured.slots,
                self.options,
                self.control.cancelled,
            );
            let values: Vec<f64> = free.iter().map(|&i| self.theta[i]).collect();
            self.runs += 1;
            problem.predict(&values, true)?
        };
        let numerical_error = match &coarse {
            None => DVector::zeros(prediction.values.len()),
            Some(coarse) => {
                let mut options = self.options;
                options.tearing_steps = options.tearing_steps / 2 + 1;
                options.uniaxial_steps = options.uniaxial_steps / 2 + 1;
                let problem = FeProblem::new(
                    coarse,
                    self.theta.clone(),
                    Vec::new(),
                    &measured.slots,
                    options,
                    self.control.cancelled,
                );
                self.runs += 1;
                match problem.predict(&[], false) {
                    Ok(p) => &prediction.values - p.values,
                    Err(PredictError::Interrupted) => return Err(PredictError::Interrupted.into()),
                    Err(_) => DVector::zeros(prediction.values.len()),
                }
            }
        };
        let noisy = measured.clone();
        let measured = measured.with_numerical_error(&numerical_error);
        let last = list.last().map_or(Stage::Joint, |l| l.0);
        let objective = if last == Stage::Joint { Objective::Record } else { Objective::PaperSum };
        let at_bound = list_free.iter().zip(&free).map(|(f, &i)| f.at_bound(self.theta[i])).collect();
        let fit = Fit {
            theta: free.iter().map(|&i| self.theta[i]).collect(),
            f: f64::NAN,
            prediction,
            at_bound,
            objective,
            iterations: self.iterations,
            forward_runs: self.runs,
            stop: inverse::StopReason::Converged,
            history: Vec::new(),
        };
        let quality = quality(&measured.data, &list_free, &fit);
        let rule = Identifiability::default();
        let intervals = |of: &Measured| match (&self.held, last) {
            (Some(_), Stage::Interface) => self.staged_intervals(&fine, of, &fit, &free, &rule),
            _ => Ok(uncertainty(&of.data, &list_free, &fit, &rule)?),
        };
        let uncertainty = intervals(&measured)?;
        let by_noise = intervals(&noisy)?;
        let led = |k: &usize| uncertainty.covariance_z[(*k, *k)] > 2.0 * by_noise.covariance_z[(*k, *k)];
        let led_by_mesh = (0..free.len()).filter(led).map(|k| list_free[k].path.clone()).collect();
        Ok(Identified {
            model: fine,
            measured,
            theta: self.theta,
            free,
            frees: list_free,
            fit,
            quality,
            uncertainty,
            led_by_mesh,
            numerical_error,
            iterations: self.iterations,
            forward_runs: self.runs,
            stopped: self.stopped,
            history: self.history,
            options: self.options,
            starts: self.starts,
        })
    }
}
