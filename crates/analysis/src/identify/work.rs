//! An identification in progress: one stage's search after the other.

use super::tear_misfit::TearMisfit;
use super::{AnalysisError, Control, HistoryEntry, Progress, Stage};
use crate::data::Measured;
use crate::journal::{Asked, remembered};
use crate::priors::Belief;
use crate::problem::FeProblem;
use crate::start::Start;
use input::Case;
use inverse::{Fit, FitError, Free, Iterate, MappedOptions, MultiStart, StopReason};
use model::{Model, RunOptions};
use std::ops::ControlFlow;
use std::sync::Arc;

/// Half the load steps: the cubic through them carries the curve to 1e-5 of the peak (docs/decisions/load-steps.md).
pub(crate) fn fewer_steps(mut options: RunOptions) -> RunOptions {
    options.tearing_steps = options.tearing_steps / 2 + 1;
    options.uniaxial_steps = options.uniaxial_steps / 2 + 1;
    options
}

/// Exponent by which the time of a run grows with its unknowns.
const GROWTH: f64 = 1.3;

/// Runs of a cheap model that take as long as one of another: as unknowns to the power that a run grows with
/// (docs/performance.md, growth with the mesh), and as their load steps.
pub(crate) fn runs_as_long(of: &Model, by: &RunOptions, cheap: &Model, cheap_by: &RunOptions) -> f64 {
    let work = |m: &Model, o: &RunOptions| -> f64 {
        m.tests.iter().map(|t| (t.unknowns() as f64).powf(GROWTH) * o.steps(t.test.kind) as f64).sum()
    };
    (work(of, by) / work(cheap, cheap_by)).max(1.0)
}

/// Newton tolerance of the search, if the file's is not coarser: it moves χ² by far less than a step
/// does. The last run, which the answer is made from, takes the file's.
pub(crate) const SEARCH_TOLERANCE: f64 = 1e-7;

/// Newton iterations a trial run may take: about five times what a smooth tear needs.
pub(crate) const TRIAL_BUDGET: usize = 2500;

/// What is known where the same records were searched by a model with fewer effects.
#[derive(Clone, Copy)]
pub(crate) struct Again<'a> {
    /// Where that search began.
    pub starts: &'a [Arc<Start>],
    /// Objective that this model came to by another way.
    pub below: f64,
}

impl Default for Again<'_> {
    fn default() -> Self {
        Self { starts: &[], below: f64::INFINITY }
    }
}

pub(crate) struct Work<'a> {
    pub theta: Vec<f64>,
    pub(super) history: Vec<HistoryEntry>,
    pub(super) stopped: Vec<(Stage, String, bool)>,
    pub(super) runs: usize,
    pub(super) iterations: usize,
    pub(super) control: &'a Control<'a>,
    pub case: &'a Case,
    /// How the answer's runs are made.
    pub(super) options: RunOptions,
    /// How the search's runs are made.
    pub search: RunOptions,
    /// Objective that the coarse mesh came to, for the next stage on the given one.
    pub(super) expected: f64,
    /// Whether runs on the given mesh take the answer's steps.
    pub(super) all_steps: bool,
    /// Steps on the given mesh at most, besides the file's limit.
    pub(super) rounds: usize,
    /// Whether the bulk was fitted on the given mesh by a stage of its own.
    pub(super) bulk_held: bool,
    /// What is believed of base parameters.
    pub belief: Belief,
    /// Share of each record's largest value that counts as noise at least: a start need not follow
    /// the record any closer, and keeps a tissue that the literature knows.
    pub coarse_noise: f64,
    /// Whether a start is sought that owes nothing to what the file says: no prior is around that.
    pub by_record: bool,
    /// Newton iterations after which a trial run is given up.
    pub budget: usize,
    /// What an earlier search knows.
    pub again: Again<'a>,
    /// Where this search began, if that is where the record of a tear had to tell.
    pub torn: Vec<Arc<Start>>,
    pub(super) starts: Option<String>,
    /// Whether there is a coarse mesh to begin on.
    pub(super) coarse_level: bool,
    /// What the latest stage left of the tearing records.
    pub(super) tear_left: TearMisfit,
    /// Where all parameters together ended, if that did not help enough.
    pub(super) beside: Option<Vec<f64>>,
    /// Whether a stage pauses where its steps on the given mesh hardly lower what the tear leaves unexplained.
    pub(super) pausing: bool,
    /// Whether the latest stage paused.
    pub(super) paused: bool,
}

/// Free parameters as the optimiser sees them, at θ.
pub fn free_parameters(model: &Model, theta: &[f64], free: &[usize]) -> Vec<Free> {
    free.iter().map(|&i| Free { start: theta[i], ..Free::of(&model.parameters[i]) }).collect()
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
            search: options,
            expected: f64::INFINITY,
            all_steps: false,
            rounds: usize::MAX,
            bulk_held: false,
            belief: Belief::of(case, Belief::Bounds),
            coarse_noise: 0.0,
            by_record: false,
            budget: TRIAL_BUDGET,
            again: Again::default(),
            torn: Vec::new(),
            starts: None,
            coarse_level: false,
            tear_left: TearMisfit::default(),
            beside: None,
            pausing: false,
            paused: false,
        }
    }

    /// A problem for trial runs: given up early where they are hopeless, and no more exact than a step of the search needs.
    pub fn trial<'p>(
        &self,
        model: &'p Model,
        theta: &[f64],
        free: &[usize],
        slots: &'p [crate::data::DataBlock],
        options: RunOptions,
    ) -> FeProblem<'p>
    where
        'a: 'p,
    {
        let cancelled = self.control.cancelled;
        let mut problem = FeProblem::new(model, theta.to_vec(), free.to_vec(), slots, options, cancelled);
        problem.options.stepping.budget = self.budget;
        let newton = &mut problem.options.stepping.newton;
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
        self.stage_beside(model, None, stage, free, tests, coarse)
    }

    /// The same; with a cheap model, which has the same parameters, the search goes on that one, put right by `model` round
    /// by round.
    pub fn stage_beside(
        &mut self,
        model: &Model,
        cheap: Option<&Model>,
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
        let mut list = free_parameters(model, &self.theta, free);
        let belief = match (self.by_record, starting) {
            (true, _) => Belief::Bounds,
            (false, true) => self.belief.at_start(),
            (false, false) => self.belief,
        };
        crate::priors::add(&mut list, self.case, belief);
        let paths: Vec<String> = list.iter().map(|f| f.path.clone()).collect();
        let fit_options = self.fit_options(stage, coarse, &list);
        let options = if self.all_steps { self.options } else { self.search };
        let problem = self.trial(model, &self.theta, free, &measured.slots, options);
        let beside = cheap.map(|m| self.trial(m, &self.theta, free, &measured.slots, self.search));
        let ratio = cheap.map_or(1.0, |m| runs_as_long(model, &options, m, &self.search));
        let mapped = self.mapped_options(&fit_options, ratio);
        let (progress, history) = (self.control.progress, &mut self.history);
        let pausing = self.pausing && !coarse && beside.is_some();
        let mut before: Option<TearMisfit> = None;
        let mut watch = |iterate: &Iterate| {
            progress(&Progress { stage, coarse: true, iterate, paths: &paths, forces: Vec::new() });
            ControlFlow::Continue(())
        };
        let mut observer = |iterate: &Iterate| {
            let forces = if iterate.accepted { problem.forces_at(&iterate.theta) } else { Vec::new() };
            progress(&Progress { stage, coarse, iterate, paths: &paths, forces });
            history.push(HistoryEntry { stage, coarse, iterate: iterate.clone(), paths: paths.clone() });
            let values = (pausing && iterate.accepted).then(|| problem.values_at(&iterate.theta)).flatten();
            let Some(now) = values.map(|v| TearMisfit::of(model, &measured, &v)) else {
                return ControlFlow::Continue(());
            };
            let stalls = before.replace(now).is_some_and(|b| now.stalls(b));
            if stalls { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        };
        let several = self.case.identify.multi_start;
        // On the coarse mesh where there is one: that is where a search may still go astray.
        let starts = if several > 1 && !starting && coarse == self.coarse_level { several } else { 1 };
        let asked = Asked {
            problem: &problem,
            beside: beside.as_ref(),
            data: &measured.data,
            free: &list,
            options: &fit_options,
            how: &format!("{starts} starts, pausing {pausing}"),
            cancelled: self.control.cancelled,
        };
        let done = remembered(self.control.journal, &asked, &mut observer, &mut |observer| {
            asked.search(starts, &mapped, observer, &mut watch)
        })?;
        if let Some(sentence) = done.starts {
            let told = format!("{}: {sentence}", stage.word());
            self.starts = Some(self.starts.take().map_or(told.clone(), |s| format!("{s} {told}")));
        }
        self.runs += done.runs;
        self.theta = problem.full(&done.fit.theta);
        self.tear_left = TearMisfit::of(model, &measured, &done.fit.prediction.values);
        self.paused = pausing && done.fit.stop == StopReason::Stopped && !self.control.cancelled.stops();
        self.end_stage(stage, coarse, &done.fit);
        Ok(done.fit.f)
    }

    /// What is said of how a stage ended, unless it pauses.
    fn end_stage(&mut self, stage: Stage, coarse: bool, fit: &Fit) {
        if !coarse {
            self.iterations = self.iterations.max(fit.iterations);
        }
        if !self.paused {
            self.stopped.push((stage, fit.stop.sentence().to_owned(), fit.stop.converged()));
        }
        if stage == Stage::Bulk && !coarse {
            self.bulk_held = true;
        }
    }
}

impl Asked<'_> {
    /// The fit itself: on the cheap model where there is one, from several starts where they are asked for, which are told.
    fn search(
        &self,
        starts: usize,
        mapped: &MappedOptions,
        observer: &mut dyn FnMut(&Iterate) -> ControlFlow<()>,
        watch: &mut dyn FnMut(&Iterate) -> ControlFlow<()>,
    ) -> Result<(Fit, Option<String>), FitError> {
        let (problem, data, free, options) = (self.problem, self.data, self.free, self.options);
        if let (Some(cheap), 1) = (self.beside, starts) {
            return Ok((inverse::fit_mapped(problem, cheap, data, free, mapped, observer, watch)?, None));
        }
        if starts == 1 {
            return Ok((inverse::fit(problem, data, free, options, observer)?, None));
        }
        let how = MultiStart { starts, ..MultiStart::default() };
        let mut each = |_: usize, iterate: &Iterate| observer(iterate);
        let ends = inverse::multi_start(problem, data, free, options, &how, &mut each)?;
        let told = ends.sentence();
        Ok((ends.best, Some(told)))
    }
}
