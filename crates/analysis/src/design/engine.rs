//! What records of some kind would show: the screen's columns and the base jacobian at guessed values, on a coarse mesh.
//!
//! Everything is linear in the effect and in the base parameters, as the screen itself is; the power it promises is that
//! of the screen's test at its own threshold, with the noise of the records.

use super::known::{Known, Sums, less_known};
use crate::columns::Base;
use crate::data::Measured;
use crate::identify::{AnalysisError, coarser, free_parameters};
use crate::priors::Belief;
use crate::problem::Cancelled;
use diagnose::power::{noncentrality, power};
use diagnose::{Candidate, Foreseen, Policy, Shown, foresee};
use input::Case;
use inverse::{Free, Noise, Prediction, Whitened};
use model::{Catalogue, Discretisation, Model, RunOptions};
use nalgebra::{DMatrix, DVector};
use serde::Serialize;
use std::sync::Arc;

/// Areas of the tear path that are told apart: more only blur what is asked here.
const AREAS: usize = 3;
/// How much coarser than the given mesh; less where a strip is too small for that.
const COARSEN: [f64; 3] = [4.0, 2.0, 1.0];
/// What records would show.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Foresight {
    /// The base parameters, no effect present.
    pub parameters: Vec<Known>,
    /// Whether their standard errors count the numerical error of the file's mesh.
    pub counts_mesh: bool,
    /// The catalogue, most visible first.
    pub effects: Vec<Foreseen>,
    /// Effects that would need something else to show: name, and what its card says.
    pub hidden: Vec<(String, String)>,
}

/// A linearised model on records.
#[derive(Clone)]
pub(super) struct Linear {
    pub prediction: Prediction,
    pub candidates: Vec<Candidate>,
    pub measured: Measured,
    free_parameters: Vec<Free>,
    theta: Vec<f64>,
    all: Vec<f64>,
}

/// The case with few areas.
pub(super) fn few_areas(case: &Case) -> Case {
    let mut out = case.clone();
    out.interface.areas = out.interface.areas.min(AREAS);
    for list in [&mut out.interface.gc, &mut out.interface.sigma_c] {
        list.truncate(out.interface.areas);
    }
    out
}

/// The case as it is looked at here, with the meshes to try, the coarsest first.
fn simple(case: &Case) -> (Case, Vec<Discretisation>) {
    let (mut out, how) = coarser(case);
    if out.mesh.divisions.is_none() {
        out.mesh.layers = 1;
    }
    let coarsen = |c| Discretisation { coarsen: c, ..how };
    let list = match case.mesh.divisions {
        Some(_) => vec![how],
        None => COARSEN.map(coarsen).to_vec(),
    };
    (out, list)
}

/// The coarsest model with few areas that the strip allows.
pub(super) fn model_of(case: &Case, catalogue: &Catalogue) -> Result<(Model, Discretisation), AnalysisError> {
    coarsest(&few_areas(case), catalogue)
}

/// The coarsest model that the strip allows.
pub(super) fn coarsest(case: &Case, catalogue: &Catalogue) -> Result<(Model, Discretisation), AnalysisError> {
    let (simple, list) = simple(case);
    let simple = Arc::new(simple);
    let mut last = None;
    for how in list {
        match Model::new(simple.clone(), catalogue, how) {
            Ok(model) => return Ok((model, how)),
            Err(e) => last = Some(e),
        }
    }
    Err(last.map_or_else(|| AnalysisError::Case("no mesh".into()), AnalysisError::from))
}

/// Steps of a tearing and of a uniaxial test.
pub(super) type Steps = (usize, usize);
/// For a linear look: those of the screen.
pub(super) const LOOK: Steps = (30, 14);
/// For the full model: what lies between two steps is interpolated, and an effect that the base nearly imitates is no
/// larger than the error of long ones.
pub(super) const SHORT: Steps = (96, 48);

/// Steps and tolerance of a look: the same steps for all models, with memory or without, or a fit would chase their
/// difference.
pub(super) fn options(case: &Case, steps: Steps) -> RunOptions {
    let mut o = crate::identify::run_options(case);
    (o.tearing_steps, o.uniaxial_steps) = steps;
    o.follow_holds = true;
    o.follow_turns = true;
    o.stepping.newton.tolerance = o.stepping.newton.tolerance.max(crate::identify::SEARCH_TOLERANCE);
    o.stepping.budget = crate::identify::TRIAL_BUDGET;
    o
}

/// One run with the columns of a catalogue.
pub(super) fn linear(
    model: &Model,
    (how, steps): (Discretisation, Steps),
    theta: &[f64],
    measured: Measured,
    catalogue: &Catalogue,
    cancelled: Cancelled,
) -> Result<Linear, AnalysisError> {
    let free = model.free();
    let base = Base {
        model,
        theta,
        free: &free,
        catalogue,
        how,
        options: options(&model.case, steps),
        slots: &measured.slots,
        warm: &[],
        cancelled,
    };
    let screened = base.screen()?;
    let mut list = free_parameters(model, theta, &free);
    crate::priors::add(&mut list, &model.case, Belief::Given);
    let (prediction, candidates) = (screened.prediction, screened.candidates);
    let all = theta.to_vec();
    let theta = free.iter().map(|&i| theta[i]).collect();
    Ok(Linear { prediction, candidates, measured, free_parameters: list, theta, all })
}

impl Linear {
    /// Free base parameters as a fit sees them, with their values.
    pub fn base(&self) -> (&[Free], &[f64]) {
        (&self.free_parameters, &self.theta)
    }

    /// Values of all parameters.
    pub fn all(&self) -> &[f64] {
        &self.all
    }

    /// Whitened with the misfit to what is measured.
    pub fn misfit(&self) -> Whitened {
        Whitened::new(
            &self.measured.data,
            &self.free_parameters,
            &self.theta,
            &self.prediction,
            Noise::Record,
        )
    }

    /// Whitened at the prediction itself: nothing is missed yet. `camera`: camera channels count.
    pub fn white(&self, camera: bool) -> Whitened {
        self.unmissed((&self.free_parameters, &self.theta), &self.prediction, camera)
    }

    /// The same with other priors and values, and a prediction of another mesh.
    fn unmissed(&self, (list, theta): (&[Free], &[f64]), prediction: &Prediction, camera: bool) -> Whitened {
        let mut data = self.measured.data.clone();
        data.held_out = vec![false; data.points()];
        for (block, slot) in data.blocks.iter_mut().zip(&self.measured.slots) {
            let values = prediction.values.rows(block.range.start, block.range.len());
            block.measured = values.iter().copied().collect();
            if slot.channel != model::Channel::Force && !camera {
                data.held_out[block.range.clone()].fill(true);
            }
        }
        Whitened::new(&data, list, theta, prediction, Noise::Record)
    }

    /// Parameters that stand at a bound.
    pub fn at_bound(&self) -> Vec<bool> {
        self.free_parameters.iter().zip(&self.theta).map(|(f, t)| f.at_bound(*t)).collect()
    }

    /// The same model with another record.
    #[cfg(test)]
    pub fn with_record(&self, record: &DVector<f64>) -> Self {
        let mut out = self.clone();
        measure(&mut out.measured, record);
        out
    }

    /// What the screen says of the record.
    pub fn screened(&self) -> Result<diagnose::Screen, AnalysisError> {
        let points = self.measured.data.points();
        diagnose::screen(&self.misfit(), &self.at_bound(), &self.candidates, points, &Policy::default())
            .map_err(|e| AnalysisError::Case(e.to_string()))
    }

    /// What the records would show: parameters as a diagnosis sees them, with what the literature lets one expect.
    pub fn foresight(
        &self,
        catalogue: &Catalogue,
        policy: &Policy,
        camera: bool,
    ) -> Result<Foresight, AnalysisError> {
        let white = self.white(camera);
        let none = vec![false; self.free_parameters.len()];
        let effects = foresee(&white, &none, &self.candidates, self.measured.data.points(), policy)
            .map_err(|e| AnalysisError::Case(e.to_string()))?;
        let hidden = effects
            .iter()
            .filter(|e| e.shown == Shown::Hidden)
            .filter_map(|e| catalogue.get(&e.effect))
            .filter(|e| !e.card().negative_control)
            .map(|e| (e.card().name.to_owned(), e.card().separated_by.to_owned()))
            .collect();
        let parameters = Sums::new(&white, Vec::new())
            .known((&self.free_parameters, &self.theta), &self.beside_which(&effects));
        Ok(Foresight { parameters, counts_mesh: false, effects, hidden })
    }

    /// The same with the parameters as an identification sees them: by the file's priors alone, with the error of its mesh
    /// where that is known, as badly as at the worst of the look's own values and a second place (values and what the model
    /// says there).
    pub fn foresight_of_fits(
        &self,
        (catalogue, policy): (&Catalogue, &Policy),
        case: &Case,
        mesh_error: Option<&DVector<f64>>,
        second: Option<(Vec<f64>, Prediction)>,
    ) -> Result<Foresight, AnalysisError> {
        let plain = |f: &Free| Free { prior: None, ..f.clone() };
        let mut list: Vec<Free> = self.free_parameters.iter().map(plain).collect();
        crate::priors::add(&mut list, case, Belief::Bounds);
        let foresight = self.foresight(catalogue, policy, true)?;
        let beside = self.beside_which(&foresight.effects);
        let at = |theta: &[f64], prediction: &Prediction| {
            let white = self.unmissed((&list, theta), prediction, true);
            let mesh = mesh_error.map_or_else(Vec::new, |e| self.by_block(e, &white));
            Sums::new(&white, mesh).known((&list, theta), &beside)
        };
        let mut parameters = at(&self.theta, &self.prediction);
        if let Some((theta, prediction)) = &second {
            parameters = less_known(parameters, at(theta, prediction));
        }
        Ok(Foresight { parameters, counts_mesh: mesh_error.is_some(), ..foresight })
    }

    /// Candidates that the records show at a plausible size, or may.
    fn beside_which(&self, effects: &[Foreseen]) -> Vec<&Candidate> {
        let shown = effects.iter().filter(|e| e.shown != Shown::Hidden);
        shown.filter_map(|e| self.candidates.iter().find(|c| c.effect == e.effect)).collect()
    }

    /// Whitened columns that are the error in one block and nothing elsewhere: how large it is in one says nothing of the
    /// others.
    fn by_block(&self, error: &DVector<f64>, white: &Whitened) -> Vec<DVector<f64>> {
        let one = |block: &inverse::Block| {
            let mut column = DVector::zeros(error.len());
            let (start, n) = (block.range.start, block.range.len());
            column.rows_mut(start, n).copy_from(&error.rows(start, n));
            white.column(&column)
        };
        self.measured.data.blocks.iter().map(one).collect()
    }

    /// Chance that the wrong one of two effects is told from the right one: the less of either truth, each at its plausible
    /// size, the other in any of its shapes.
    pub fn separation(&self, a: &str, b: &str, policy: &Policy, camera: bool) -> f64 {
        let white = self.white(camera);
        let find = |name: &str| self.candidates.iter().find(|c| c.effect == name);
        let (Some(a), Some(b)) = (find(a), find(b)) else { return 0.0 };
        let (a, b) = (columns(a, &white), columns(b, &white));
        let chance = |truth: &[DVector<f64>], rival: &[DVector<f64>]| {
            let one = |d: &DVector<f64>| {
                let against = rival.iter().map(|r| lambda(&white.jacobian, r, d));
                against.fold(f64::INFINITY, f64::min)
            };
            truth.iter().map(one).filter(|l| l.is_finite()).fold(0.0, f64::max)
        };
        power(chance(&a, &b).min(chance(&b, &a)), policy.separate_chi2)
    }
}

/// Puts a record in the place of what was measured.
pub(super) fn measure(measured: &mut Measured, record: &DVector<f64>) {
    for block in &mut measured.data.blocks {
        block.measured = record.rows(block.range.start, block.range.len()).iter().copied().collect();
    }
}

/// χ² that a rival's column and the base leave of a truth.
fn lambda(base: &DMatrix<f64>, rival: &DVector<f64>, truth: &DVector<f64>) -> f64 {
    let mut new = base.clone().insert_column(base.ncols(), 0.0);
    new.set_column(base.ncols(), rival);
    let known = DMatrix::zeros(1, new.ncols());
    noncentrality(truth, &new, &known)
}

/// Whitened columns of an effect at its plausible size, one per shape.
fn columns(c: &Candidate, white: &Whitened) -> Vec<DVector<f64>> {
    let sized = |s: &diagnose::ShapeColumns| {
        let plausible = c.amplitudes.iter().zip(s.columns.column_iter());
        plausible.fold(DVector::zeros(s.columns.nrows()), |sum, (a, column)| sum + column * a.plausible)
    };
    c.shapes.iter().map(|s| white.column(&sized(s))).collect()
}
