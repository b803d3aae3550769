//! The paper's inverse analysis: bulk from the uniaxial tests, then the interface with the bulk
//! held (`staged`), or all tests at once from there (`joint`).

mod finish;
mod intervals;
mod mirrored;
mod nearby;
mod poll;
mod rest;
mod search;
mod settings;
mod tear_misfit;
mod work;

pub(crate) use poll::{FAR, poll};
pub(crate) use search::{StagePlan, stages};
pub use work::free_parameters;
pub(crate) use work::{Again, SEARCH_TOLERANCE, TRIAL_BUDGET, Work, fewer_steps, runs_as_long};

use crate::data::{Measured, RecordError};
use crate::held_out::{HeldOut, held_out};
use crate::journal::{Journal, Recent};
use crate::problem::Cancelled;
use crate::start::Start;
use evidence::EvidenceError;
use input::Case;
use inverse::{Fit, FitError, Free, Iterate, Noise, PredictError, Quality, Uncertainty, Whitened};
use model::cost::Purpose;
use model::{BuildError, Catalogue, Discretisation, Model, RunOptions};
use nalgebra::DVector;
use search::{StagedSearch, staged};
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
    /// The models could not be weighed.
    #[error("no probabilities: {0}")]
    Weigh(#[from] EvidenceError),
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
    /// Forces of the model at the record's points, N, per test of the stage, where the search went there; else none.
    pub forces: Vec<(String, Vec<f64>)>,
}

/// Who watches, and who may stop.
pub struct Control<'a> {
    /// Called at every model run.
    pub progress: &'a (dyn Fn(&Progress) + Sync),
    /// Asked between steps.
    pub cancelled: Cancelled<'a>,
    /// Where finished fits are kept.
    pub journal: &'a dyn Journal,
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
    pub free_parameters: Vec<Free>,
    /// Fit over all data at the end (values and jacobian by every free parameter).
    pub fit: Fit,
    /// χ² and its kin.
    pub quality: Quality,
    /// Intervals, in the order of `free`.
    pub uncertainty: Uncertainty,
    /// Parameters whose variance is more the mesh's error than the noise.
    pub mesh_dominated: Vec<String>,
    /// What the model leaves unexplained; `None` where no number could be given.
    pub left: Option<crate::Left>,
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
            &self.free_parameters,
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
    o.stepping.newton.tolerance = case.solver.tolerance;
    // A step that has not converged by then is cut: cheaper than waiting.
    o.stepping.newton.max_iterations = case.solver.max_iterations.min(12);
    o
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
    let case = crate::condensed(&case);
    let models = Models::of(&case, catalogue)?;
    let measured = Measured::of(&models.fine, &models.fine.recorded())?;
    let recent = Recent::new(control.journal);
    let control = &Control { journal: &recent, ..*control };
    let (work, list) = models.search(&case, catalogue, control, Again::default())?;
    let Models { fine, coarse, cheap } = models;
    work.finish(fine, (coarse, cheap), measured, &list, catalogue)
}

/// Where the search of an identification ends.
pub(crate) struct Searched {
    /// All values.
    pub theta: Vec<f64>,
    /// Whether all parameters moved together in the end.
    pub joint: bool,
    /// Where all parameters together ended, if that was tried and did not help enough to be the answer.
    pub beside: Option<Vec<f64>>,
    /// Where it began, if that is where the record of a tear had to tell.
    pub torn: Vec<Arc<Start>>,
    /// Forward runs.
    pub runs: usize,
}

/// The values that [`identify`] answers with, without what it says about them.
pub(crate) fn searched(
    case: &Arc<Case>,
    catalogue: &Catalogue,
    control: &Control,
    again: Again,
) -> Result<Searched, AnalysisError> {
    let models = Models::of(case, catalogue)?;
    let recent = Recent::new(control.journal);
    let control = &Control { journal: &recent, ..*control };
    let (work, list) = models.search(case, catalogue, control, again)?;
    let joint = list.last().is_some_and(|l| l.0 == Stage::Joint);
    Ok(Searched { joint, runs: work.runs, theta: work.theta, beside: work.beside, torn: work.torn })
}

/// One case on the meshes of a search.
struct Models {
    fine: Model,
    coarse: Option<Model>,
    cheap: Option<Model>,
}

impl Models {
    fn of(case: &Arc<Case>, catalogue: &Catalogue) -> Result<Self, AnalysisError> {
        let fine = Model::checked(case.clone(), catalogue, Discretisation::default(), Purpose::Fit)?;
        Ok(Self { fine, coarse: coarse_model(case, catalogue)?, cheap: cheap_model(case, catalogue)? })
    }

    /// The search, and the stages that it went through.
    fn search<'a>(
        &self,
        case: &'a Arc<Case>,
        catalogue: &Catalogue,
        control: &'a Control<'a>,
        again: Again<'a>,
    ) -> Result<(Work<'a>, Vec<StagePlan>), AnalysisError> {
        let options = run_options(case);
        let mut work = Work::new(case, self.fine.theta(), options, control);
        work.again = again;
        if self.cheap.is_some() {
            work.search = fewer_steps(options);
        }
        let mut list = stages(&self.fine, case.identify.mode);
        if list.is_empty() {
            return Err(AnalysisError::Case("no parameter is free".into()));
        }
        let (coarse, cheap) = (self.coarse.as_ref(), self.cheap.as_ref());
        let search = StagedSearch { case, catalogue, fine: &self.fine, coarse: cheap.or(coarse), cheap };
        work.pausing = case.identify.release_bulk && staged(&list);
        search.run(&mut work, &list)?;
        if work.pausing && work.tear_left.unexplained() {
            list.extend(search.release(&mut work, &list)?);
        }
        search.with_all_steps(&mut work, &list)?;
        Ok((work, list))
    }
}

/// A case on a mesh about twice as coarse: half the divisions, where the file gives them; otherwise its sizes are coarsened
/// by the discretisation.
pub(crate) fn coarser(case: &Case) -> (Case, Discretisation) {
    let mut coarse = case.clone();
    if let Some(d) = coarse.mesh.divisions {
        let half = |n: usize| if n > 2 { n.div_ceil(2) } else { n };
        coarse.mesh.divisions = Some([half(d[0]), (half(d[1]) + half(d[1]) % 2).min(d[1]), half(d[2])]);
    }
    let coarsen = if coarse.mesh == case.mesh { 2.0 } else { 1.0 };
    (coarse, Discretisation { coarsen, ..Discretisation::default() })
}

/// How much coarser than the given mesh the one is that the search takes its steps on, where the file gives sizes.
const CHEAP: f64 = 3.0;

/// The same model on the mesh that the search takes its steps on; `None` where the file gives divisions, or the strip is too
/// small.
fn cheap_model(case: &Arc<Case>, catalogue: &Catalogue) -> Result<Option<Model>, AnalysisError> {
    if case.mesh.divisions.is_some() {
        return Ok(None);
    }
    let how = Discretisation { coarsen: CHEAP, ..Discretisation::default() };
    match Model::new(case.clone(), catalogue, how) {
        Ok(m) => Ok(Some(m)),
        Err(BuildError::Mesh { .. }) => Ok(None),
        Err(e) => Err(e.into()),
    }
}

/// The same model on a mesh twice as coarse; `None` where the file gives divisions that cannot be
/// halved.
fn coarse_model(case: &Arc<Case>, catalogue: &Catalogue) -> Result<Option<Model>, AnalysisError> {
    let (coarse, how) = coarser(case);
    if case.mesh.divisions.is_some() && coarse.mesh == case.mesh {
        return Ok(None);
    }
    match Model::new(Arc::new(coarse), catalogue, how) {
        Ok(m) => Ok(Some(m)),
        // A strip too small for coarser elements has no coarse model.
        Err(BuildError::Mesh { .. }) => Ok(None),
        Err(e) => Err(e.into()),
    }
}
