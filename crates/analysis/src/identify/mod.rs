//! The paper's inverse analysis: bulk from the uniaxial tests, then the interface with the bulk
//! held (`staged`), or all tests at once from there (`joint`).

mod intervals;
mod work;

pub use work::frees;
pub(crate) use work::{TRIAL_BUDGET, Work};

use crate::data::{Measured, RecordError};
use crate::held_out::{HeldOut, held_out};
use crate::problem::Cancelled;
use input::{Case, Mode, TestKind};
use inverse::{Fit, FitError, Free, Iterate, Noise, PredictError, Quality, Uncertainty, Whitened};
use model::{BuildError, Catalogue, Discretisation, Model, RunOptions, Site};
use nalgebra::DVector;
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

impl Identified {
    /// What whole segments say that the fit did not see; `None` where there are too few.
    pub fn held_out(&self) -> Option<HeldOut> {
        let white = Whitened::new(
            &self.measured.data,
            &self.frees,
            &self.fit.theta,
            &self.fit.prediction,
            Noise::Total,
        );
        held_out(&self.model.case, &self.measured, &white, &self.fit.at_bound)
    }
}

/// Run options that a case asks for.
pub fn run_options(case: &Case) -> RunOptions {
    let mut o = RunOptions::default();
    o.march.newton.tolerance = case.solver.tolerance;
    // A step that has not converged by then is cut: cheaper than waiting.
    o.march.newton.max_iterations = case.solver.max_iterations.min(12);
    o
}

/// A stage, its parameters, its tests.
pub(crate) type StagePlan = (Stage, Vec<usize>, Vec<bool>);

/// A larger reduced χ² of the tear is not explained by the stages.
const UNEXPLAINED: f64 = 2.0;
/// Everything at once helps where it leaves this share of that, at most.
const HELPED: f64 = 0.5;

/// The stages of a case: which parameters on which tests.
pub(crate) fn stages(model: &Model, mode: Mode) -> Vec<StagePlan> {
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
    work.coarse_level = coarse.is_some() && case.identify.coarse_first;
    search(&case, catalogue, &fine, coarse.as_ref(), &mut work, &list)?;
    let joint = list.iter().any(|s| s.0 == Stage::Joint);
    let mut list = list;
    if !joint && case.identify.release_bulk && work.left > UNEXPLAINED {
        list.extend(release(&case, catalogue, &fine, coarse.as_ref(), &mut work)?);
    }
    work.finish(fine, coarse, measured, &list)
}

/// A start, the stages on a coarse mesh, the stages on the given one.
fn search(
    case: &Arc<Case>,
    catalogue: &Catalogue,
    fine: &Model,
    coarse: Option<&Model>,
    work: &mut Work,
    list: &[StagePlan],
) -> Result<(), AnalysisError> {
    // What is said of the end of a search is said of its last stages.
    let before = work.stopped.len();
    if case.identify.coarse_first
        && let Some(start) = crate::start::one_area(case, catalogue, work, list)?
    {
        crate::start::spread(fine, &start, &mut work.theta);
    }
    if let Some(coarse) = coarse.filter(|_| case.identify.coarse_first) {
        for (stage, free, tests) in list {
            work.stage(coarse, *stage, free, tests, true)?;
        }
    }
    work.stopped.truncate(before);
    work.held = None;
    // A joint search that was brought near on the coarse mesh needs no stages on the fine one.
    let near = work.coarse_level;
    let joint = list.iter().any(|s| s.0 == Stage::Joint);
    for (stage, free, tests) in list.iter().filter(|s| !(near && joint) || s.0 == Stage::Joint) {
        work.stage(fine, *stage, free, tests, false)?;
    }
    Ok(())
}

/// A bulk that the intact strip alone leaves open, along the valley of its sloppy combinations, may end where the tear
/// cannot be explained: all parameters are then fitted to all records, from the beginning, since strengths that made up
/// for a wrong bulk are a bad start. The stages stand where that does not help.
fn release(
    case: &Arc<Case>,
    catalogue: &Catalogue,
    fine: &Model,
    coarse: Option<&Model>,
    work: &mut Work,
) -> Result<Option<StagePlan>, AnalysisError> {
    let before = work.left;
    let (theta, stopped, held) = (work.theta.clone(), work.stopped.len(), work.held);
    work.theta = fine.theta();
    let list = stages(fine, Mode::Joint);
    search(case, catalogue, fine, coarse, work, &list)?;
    if work.left > HELPED * before {
        (work.theta, work.held) = (theta, held);
        work.stopped.truncate(stopped);
        return Ok(None);
    }
    if let Some(last) = work.stopped.last_mut() {
        last.1 = format!(
            "The intact strip's bulk left the tear at reduced χ² {before:.1}: everything was fitted to all records. {}",
            last.1
        );
    }
    Ok(list.into_iter().find(|s| s.0 == Stage::Joint))
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
