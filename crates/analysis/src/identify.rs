//! The paper's inverse analysis: bulk from the uniaxial tests, then the interface with the bulk
//! held (`staged`), or all tests at once from there (`joint`).

use crate::data::{Measured, RecordError};
use crate::problem::{Cancelled, FeProblem};
use input::{Case, Mode, TestKind};
use inverse::{
    Data, Fit, FitError, FitOptions, Free, Held, Identifiability, Iterate, Objective, PredictError, Problem,
    Quality, Uncertainty, quality, staged_uncertainty, uncertainty,
};
use model::{BuildError, Catalogue, Discretisation, Model, RunOptions, Site};
use nalgebra::{DMatrix, DVector};
use std::ops::ControlFlow;
use std::sync::Arc;
use thiserror::Error;

/// Why an identification could not be done.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum AnalysisError {
    /// The model could not be built.
    #[error(transparent)]
    Build(#[from] BuildError),
    /// The records cannot be used.
    #[error(transparent)]
    Record(#[from] RecordError),
    /// The fit could not begin.
    #[error(transparent)]
    Fit(#[from] FitError),
    /// The model could not be run.
    #[error(transparent)]
    Predict(#[from] PredictError),
    /// Nothing is free, or nothing is there to fit.
    #[error("{0}")]
    Case(String),
}

/// A stage of the search, for progress lines.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// Bulk parameters on the uniaxial tests.
    Bulk,
    /// Interface parameters on the tearing tests.
    Interface,
    /// Everything on every test.
    Joint,
}

impl Stage {
    /// The word shown.
    pub const fn word(self) -> &'static str {
        match self {
            Self::Bulk => "bulk",
            Self::Interface => "interface",
            Self::Joint => "joint",
        }
    }
}

/// One model run of the search, with its place.
#[derive(Clone, Debug)]
pub struct Progress<'a> {
    /// Stage.
    pub stage: Stage,
    /// On the coarse mesh.
    pub coarse: bool,
    /// The run.
    pub iterate: &'a Iterate,
    /// Paths of the free parameters of this stage.
    pub paths: &'a [String],
}

/// Who watches, and who may stop.
pub struct Control<'a> {
    /// Called at every model run.
    pub progress: &'a (dyn Fn(&Progress) + Sync),
    /// Asked between steps.
    pub cancelled: Cancelled<'a>,
}

/// One run of the search, kept for the convergence plot.
#[derive(Clone, Debug, PartialEq)]
pub struct HistoryEntry {
    /// Stage.
    pub stage: Stage,
    /// On the coarse mesh.
    pub coarse: bool,
    /// The run.
    pub iterate: Iterate,
    /// Paths of the parameters in `iterate.theta`.
    pub paths: Vec<String>,
}

/// A finished identification.
pub struct Identified {
    /// The model.
    pub model: Model,
    /// Measured data with noise and numerical error.
    pub measured: Measured,
    /// All parameter values at the end.
    pub theta: Vec<f64>,
    /// Indices of the free parameters.
    pub free: Vec<usize>,
    /// Free parameters as the optimiser saw them.
    pub frees: Vec<Free>,
    /// Fit over all data at the end (values and jacobian by every free parameter).
    pub fit: Fit,
    /// χ² and its kin.
    pub quality: Quality,
    /// Intervals, in the order of `free`.
    pub uncertainty: Uncertainty,
    /// What a mesh twice as coarse predicts less, per point.
    pub numerical_error: DVector<f64>,
    /// Accepted steps on the given mesh, per stage the largest.
    pub iterations: usize,
    /// Forward runs, coarse ones included.
    pub forward_runs: usize,
    /// Why each stage stopped.
    pub stopped: Vec<(Stage, String, bool)>,
    /// Every run.
    pub history: Vec<HistoryEntry>,
    /// How runs are made.
    pub options: RunOptions,
    /// Sentence on agreement of several starts, if there were.
    pub starts: Option<String>,
}

/// Run options that a case asks for.
pub fn run_options(case: &Case) -> RunOptions {
    let mut o = RunOptions::default();
    o.march.newton.tolerance = case.solver.tolerance;
    // A step that has not converged by then is cut: cheaper than waiting.
    o.march.newton.max_iterations = case.solver.max_iterations.min(12);
    o
}

/// The stages of a case: which parameters on which tests.
pub(crate) fn stages(model: &Model, mode: Mode) -> Vec<(Stage, Vec<usize>, Vec<bool>)> {
    let has = |k: TestKind| model.tests.iter().any(|t| t.test.kind == k && t.test.record.is_some());
    let (uniaxial, tearing) = (has(TestKind::Uniaxial), has(TestKind::Tearing));
    let all: Vec<bool> = model.tests.iter().map(|t| t.test.record.is_some()).collect();
    let only = |k: TestKind| -> Vec<bool> {
        model.tests.iter().map(|t| t.test.kind == k && t.test.record.is_some()).collect()
    };
    let free = model.free();
    if !(uniaxial && tearing) {
        return vec![(Stage::Joint, free, all)];
    }
    let site = |i: usize| model.site_of(i);
    let bulk: Vec<usize> = free.iter().copied().filter(|&i| site(i) == Site::Bulk).collect();
    let rest: Vec<usize> = free.iter().copied().filter(|&i| site(i) == Site::Interface).collect();
    let other = free.len() > bulk.len() + rest.len();
    let mut out = vec![
        (Stage::Bulk, bulk, only(TestKind::Uniaxial)),
        (Stage::Interface, rest, only(TestKind::Tearing)),
    ];
    // Rig, specimen and sensor effects act on every test: they have no stage of their own.
    if mode == Mode::Joint || other {
        out.push((Stage::Joint, free, all));
    }
    out.retain(|s| !s.1.is_empty());
    out
}

/// Identifies the parameters of a case.
///
/// # Errors
/// [`AnalysisError`]; a search that stops early is no error, its reason is in the answer.
pub fn identify(
    case: Arc<Case>,
    catalogue: &Catalogue,
    control: &Control,
) -> Result<Identified, AnalysisError> {
    let fine = Model::new(case.clone(), catalogue, Discretisation::default())?;
    let coarse = coarse_model(&case, catalogue)?;
    let options = run_options(&case);
    let wanted: Vec<bool> = fine.tests.iter().map(|t| t.test.record.is_some()).collect();
    let measured = Measured::of(&fine, &wanted)?;
    let mut work = Work::new(&case, fine.theta(), options, control);
    let list = stages(&fine, case.identify.mode);
    if list.is_empty() {
        return Err(AnalysisError::Case("no parameter is free".into()));
    }
    if case.identify.coarse_first
        && let Some(start) = crate::start::one_area(&case, catalogue, &mut work, &list)?
    {
        crate::start::spread(&fine, &start, &mut work.theta);
    }
    if let Some(coarse) = coarse.as_ref().filter(|_| case.identify.coarse_first) {
        for (stage, free, tests) in &list {
            work.stage(coarse, *stage, free, tests, true)?;
        }
        work.stopped.clear();
    }
    work.held = None;
    // A joint search that was brought near on the coarse mesh needs no stages on the fine one.
    let near = coarse.is_some() && case.identify.coarse_first;
    let joint = list.iter().any(|s| s.0 == Stage::Joint);
    for (stage, free, tests) in list.iter().filter(|s| !(near && joint) || s.0 == Stage::Joint) {
        work.stage(&fine, *stage, free, tests, false)?;
    }
    work.finish(fine, coarse, measured, &list)
}

/// The case with a mesh of about half the divisions, where the file gives divisions; otherwise the
/// same case (its sizes are coarsened by [`Discretisation`]).
pub(crate) fn coarse_case(case: &Case) -> Case {
    let mut coarser = case.clone();
    if let Some(d) = coarser.mesh.divisions {
        let half = |n: usize| if n > 2 { n.div_ceil(2) } else { n };
        coarser.mesh.divisions = Some([half(d[0]), (half(d[1]) + half(d[1]) % 2).min(d[1]), half(d[2])]);
    }
    coarser
}

/// The same model on a mesh twice as coarse; `None` where the file gives divisions that cannot be
/// halved.
fn coarse_model(case: &Arc<Case>, catalogue: &Catalogue) -> Result<Option<Model>, AnalysisError> {
    let how = Discretisation { coarsen: 2.0, ..Discretisation::default() };
    let coarser = coarse_case(case);
    if case.mesh.divisions.is_some() && coarser.mesh == case.mesh {
        return Ok(None);
    }
    match Model::new(Arc::new(coarser), catalogue, how) {
        Ok(m) => Ok(Some(m)),
        // A strip too small for coarser elements has no coarse model.
        Err(BuildError::Mesh { .. }) => Ok(None),
        Err(e) => Err(e.into()),
    }
}

/// The coarse mesh only brings the search near: a fall of half a percent is not worth a run, nor is a
/// fifth trial of a step.
const COARSE_TOLERANCE: f64 = 5e-3;
const COARSE_TRIALS: usize = 4;

/// Three steps in a row that lower χ² by less than this end the search: a tenth of what one
/// parameter is worth by chance.
const INSIGNIFICANT: f64 = 0.1;

/// Newton iterations a trial run may take: about five times what a smooth tear needs.
pub(crate) const TRIAL_BUDGET: usize = 2500;

pub(crate) struct Work<'a> {
    pub theta: Vec<f64>,
    history: Vec<HistoryEntry>,
    stopped: Vec<(Stage, String, bool)>,
    runs: usize,
    iterations: usize,
    control: &'a Control<'a>,
    pub case: &'a Case,
    options: RunOptions,
    held: Option<()>,
    /// Whether the literature's priors count.
    pub literature: bool,
    /// Share of each record's largest value that counts as noise at least: a start need not follow
    /// the record any closer, and keeps a tissue that the literature knows.
    pub coarse_noise: f64,
    starts: Option<String>,
}

/// Free parameters as the optimiser sees them, at θ.
pub fn frees(model: &Model, theta: &[f64], free: &[usize]) -> Vec<Free> {
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
            held: None,
            literature: case.identify.priors.literature.unwrap_or(false),
            coarse_noise: 0.0,
            starts: None,
        }
    }

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
        let problem = FeProblem::new(
            model,
            self.theta.clone(),
            free.to_vec(),
            &measured.slots,
            self.options,
            self.control.cancelled,
        );
        let whitened = stage == Stage::Joint || starting;
        let objective = if whitened { Objective::Whitened } else { Objective::PaperSum };
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
        let mut problem = problem;
        problem.options.march.budget = TRIAL_BUDGET;
        let (progress, history) = (self.control.progress, &mut self.history);
        let mut observer = |iterate: &Iterate| {
            progress(&Progress { stage, coarse, iterate, paths: &paths });
            history.push(HistoryEntry { stage, coarse, iterate: iterate.clone(), paths: paths.clone() });
            ControlFlow::Continue(())
        };
        let fit = inverse::fit(&problem, &measured.data, &list, &fit_options, &mut observer)?;
        self.runs += problem.runs();
        self.theta = problem.full(&fit.theta);
        if !coarse {
            self.iterations = self.iterations.max(fit.iterations);
        }
        self.stopped.push((stage, fit.stop.sentence().to_owned(), fit.stop.converged()));
        if stage == Stage::Bulk && !coarse {
            self.held = Some(());
        }
        Ok(fit.f)
    }

    /// All data at the end: quality, numerical error, intervals.
    fn finish(
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
        let measured = measured.with_numerical_error(&numerical_error);
        let last = list.last().map_or(Stage::Joint, |l| l.0);
        let objective = if last == Stage::Joint { Objective::Whitened } else { Objective::PaperSum };
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
        let uncertainty = match (&self.held, last) {
            (Some(_), Stage::Interface) => self.staged_intervals(&fine, &measured, &fit, &free, &rule)?,
            _ => uncertainty(&measured.data, &list_free, &fit, &rule)?,
        };
        Ok(Identified {
            model: fine,
            measured,
            theta: self.theta,
            free,
            frees: list_free,
            fit,
            quality,
            uncertainty,
            numerical_error,
            iterations: self.iterations,
            forward_runs: self.runs,
            stopped: self.stopped,
            history: self.history,
            options: self.options,
            starts: self.starts,
        })
    }

    /// Intervals of a staged fit: the bulk from its own stage, the interface with the bulk's
    /// covariance propagated. Joined into one list over all free parameters.
    fn staged_intervals(
        &self,
        model: &Model,
        measured: &Measured,
        fit: &Fit,
        free: &[usize],
        rule: &Identifiability,
    ) -> Result<Uncertainty, AnalysisError> {
        let bulk: Vec<usize> = (0..free.len()).filter(|&k| model.site_of(free[k]) == Site::Bulk).collect();
        let rest: Vec<usize> = (0..free.len()).filter(|&k| model.site_of(free[k]) != Site::Bulk).collect();
        let first = part(model, measured, fit, free, &bulk, TestKind::Uniaxial);
        let second = part(model, measured, fit, free, &rest, TestKind::Tearing);
        let first_u = uncertainty(&first.data, &first.frees, &first.fit, rule)?;
        // What the uniaxial test leaves open is not boundless: the literature's spread closes it
        // before it is handed on to the interface.
        let mut bounded = first.frees.clone();
        crate::priors::add(&mut bounded, self.case, true);
        let handed = uncertainty(&first.data, &bounded, &first.fit, rule)?;
        let held = Held { jacobian: second.jacobian_of(fit, &bulk), covariance: handed.covariance() };
        let second_u = staged_uncertainty(&second.data, &second.frees, &second.fit, &held, rule)?;
        Ok(first_u.join(second_u, &bulk, &rest))
    }
}

/// A stage cut out of the whole fit.
struct Part {
    data: Data,
    frees: Vec<Free>,
    fit: Fit,
    rows: Vec<usize>,
}

impl Part {
    /// The jacobian of other parameters on this part's rows.
    fn jacobian_of(&self, whole: &Fit, columns: &[usize]) -> DMatrix<f64> {
        let rows = &self.rows;
        match &whole.prediction.jacobian {
            Some(j) => DMatrix::from_fn(rows.len(), columns.len(), |r, c| j[(rows[r], columns[c])]),
            None => DMatrix::zeros(rows.len(), columns.len()),
        }
    }
}

fn part(
    model: &Model,
    measured: &Measured,
    whole: &Fit,
    free: &[usize],
    columns: &[usize],
    kind: TestKind,
) -> Part {
    let mut rows = Vec::new();
    let mut blocks = Vec::new();
    for (block, slot) in measured.data.blocks.iter().zip(&measured.slots) {
        if model.tests[slot.test].test.kind == kind {
            let start = rows.len();
            rows.extend(block.range.clone());
            blocks.push(inverse::Block { range: start..rows.len(), ..block.clone() });
        }
    }
    let theta: Vec<f64> = columns.iter().map(|&c| whole.theta[c]).collect();
    let frees = columns
        .iter()
        .zip(&theta)
        .map(|(&c, &start)| Free { start, ..Free::of(&model.parameters[free[c]]) })
        .collect();
    let values = DVector::from_iterator(rows.len(), rows.iter().map(|&r| whole.prediction.values[r]));
    let mut part = Part {
        data: Data { blocks, ..Data::default() },
        frees,
        fit: Fit {
            theta,
            prediction: inverse::Prediction::new(values, None),
            at_bound: columns.iter().map(|&c| whole.at_bound[c]).collect(),
            objective: Objective::PaperSum,
            ..whole.clone()
        },
        rows,
    };
    part.fit.prediction.jacobian = Some(part.jacobian_of(whole, columns));
    part.fit.prediction.valid =
        whole.prediction.valid.as_ref().map(|v| part.rows.iter().map(|&r| v[r]).collect());
    part
}
