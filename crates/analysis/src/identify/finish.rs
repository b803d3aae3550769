//! The end of an identification: what all data say at the values that were found.

use super::nearby::Nearby;
use super::search::StagePlan;
use super::work::fewer_steps;
use super::{AnalysisError, Identified, Stage, Work, free_parameters};
use crate::cost::Phase;
use crate::data::Measured;
use crate::problem::FeProblem;
use inverse::{
    Fit, Free, Identifiability, Objective, PredictError, Prediction, Problem, StopReason, Uncertainty,
    quality, uncertainty,
};
use model::{Catalogue, Model, RunOptions};
use nalgebra::DVector;
use rayon::prelude::*;

/// Combinations of parameters along which intervals ask their standard errors again: the least known two. Each costs two
/// runs with derivatives.
const ASKED: usize = 2;

/// The models and data that an answer is made from.
pub(super) struct Answer<'m> {
    pub(super) fine: &'m Model,
    pub(super) coarse: Option<&'m Model>,
    /// What the search took its steps on.
    pub(super) cheap: Option<&'m Model>,
    /// Data with the record's noise alone.
    pub(super) noisy: &'m Measured,
    /// Indices of the free parameters.
    pub(super) free: Vec<usize>,
    pub(super) free_parameters: Vec<Free>,
    last: Stage,
}

impl Work<'_> {
    /// All data at the end: quality, numerical error, intervals.
    pub(super) fn finish(
        mut self,
        fine: Model,
        (coarse, cheap): (Option<Model>, Option<Model>),
        noisy: Measured,
        list: &[StagePlan],
        catalogue: &Catalogue,
    ) -> Result<Identified, AnalysisError> {
        self.control.cancelled.phase(Phase::Intervals);
        let free = fine.free();
        let mut list_free = free_parameters(&fine, &self.theta, &free);
        crate::priors::add(&mut list_free, self.case, self.belief);
        let last = list.last().map_or(Stage::Joint, |l| l.0);
        let answer = Answer {
            fine: &fine,
            coarse: coarse.as_ref(),
            cheap: cheap.as_ref(),
            noisy: &noisy,
            free,
            free_parameters: list_free,
            last,
        };
        let values: Vec<f64> = answer.free.iter().map(|&i| self.theta[i]).collect();
        let (fit, error) = self.at(&answer, values, self.options)?;
        let numerical_error = error.unwrap_or_else(|| DVector::zeros(noisy.data.points()));
        let measured = noisy.clone().with_numerical_error(&numerical_error);
        let by_noise = self.intervals(&answer, &noisy, &fit)?;
        let straight = self.intervals(&answer, &measured, &fit)?;
        let dominated = |k: &usize| straight.covariance_z[(*k, *k)] > 2.0 * by_noise.covariance_z[(*k, *k)];
        let mesh_dominated = (0..answer.free.len())
            .filter(dominated)
            .map(|k| answer.free_parameters[k].path.clone())
            .collect();
        // Where no step was asked for, the values are no optimum: further runs would say how wrong a linear look is there.
        let mut uncertainty = match self.case.identify.max_iterations {
            0 => straight,
            _ => self.asymmetric(&answer, (&fit, &numerical_error), straight)?,
        };
        // Numbers that cannot be used leave intervals as they are: noise and mesh alone.
        let rest = self.unexplained(&answer, &fit, &measured, catalogue).ok();
        if let Some(rest) = &rest {
            uncertainty = self.allowing_for((&answer, &fit), rest, uncertainty)?;
        }
        self.runs += 1 + usize::from(coarse.is_some());
        let Answer { free, free_parameters, .. } = answer;
        Ok(Identified {
            quality: quality(&measured.data, &free_parameters, &fit),
            measured,
            theta: self.theta,
            free,
            free_parameters,
            fit: Fit { forward_runs: self.runs, ..fit },
            uncertainty,
            mesh_dominated,
            left: rest.map(|r| r.left),
            numerical_error,
            iterations: self.iterations,
            forward_runs: self.runs,
            stopped: self.stopped,
            history: self.history,
            options: self.options,
            starts: self.starts,
            model: fine,
        })
    }

    /// What the model says at these values of the free parameters, and how much less the coarse mesh does: nothing without
    /// one, `None` where it gives no answer.
    pub(super) fn at(
        &self,
        answer: &Answer,
        values: Vec<f64>,
        mut options: RunOptions,
    ) -> Result<(Fit, Option<DVector<f64>>), PredictError> {
        let mut theta = self.theta.clone();
        for (&i, &v) in answer.free.iter().zip(&values) {
            theta[i] = v;
        }
        let (slots, cancelled) = (&answer.noisy.slots, self.control.cancelled);
        let free = answer.free.clone();
        let prediction = FeProblem::new(answer.fine, theta.clone(), free, slots, options, cancelled)
            .predict(&values, true)?;
        options = fewer_steps(options);
        let coarse = answer.coarse.map(|coarse| {
            FeProblem::new(coarse, theta, Vec::new(), slots, options, cancelled).predict(&[], false)
        });
        let error = match coarse {
            Some(Ok(p)) => Some(&prediction.values - p.values),
            Some(Err(PredictError::Interrupted)) => return Err(PredictError::Interrupted),
            Some(Err(_)) => None,
            None => Some(DVector::zeros(prediction.values.len())),
        };
        Ok((self.fit_of(answer, values, prediction), error))
    }

    pub(super) fn fit_of(&self, answer: &Answer, theta: Vec<f64>, prediction: Prediction) -> Fit {
        let objective = if answer.last == Stage::Joint { Objective::Record } else { Objective::PaperSum };
        Fit {
            at_bound: answer.free_parameters.iter().zip(&theta).map(|(f, &v)| f.at_bound(v)).collect(),
            theta,
            f: f64::NAN,
            prediction,
            objective,
            iterations: self.iterations,
            forward_runs: self.runs,
            stop: StopReason::Converged,
            history: Vec::new(),
        }
    }

    pub(super) fn intervals(
        &self,
        answer: &Answer,
        measured: &Measured,
        fit: &Fit,
    ) -> Result<Uncertainty, AnalysisError> {
        let rule = Identifiability::default();
        if self.bulk_held && answer.last == Stage::Interface {
            return self.staged_intervals(answer.fine, measured, fit, &answer.free, &rule);
        }
        Ok(uncertainty(&measured.data, &answer.free_parameters, fit, &rule)?)
    }

    /// Asymmetric intervals, from how the standard errors change along the least known combinations: derivatives and
    /// numerical error at the ends of these are others than at the answer.
    fn asymmetric(
        &mut self,
        answer: &Answer,
        at_end: (&Fit, &DVector<f64>),
        straight: Uncertainty,
    ) -> Result<Uncertainty, AnalysisError> {
        let probes = straight.probes(ASKED);
        let nearby = Nearby::new(self, answer, at_end)?;
        let this = &*self;
        let asked = |probe: &inverse::Probe| -> Result<Option<Uncertainty>, AnalysisError> {
            match nearby.at(this, answer, &probe.theta) {
                Ok((fit, Some(error))) => {
                    let measured = answer.noisy.clone().with_numerical_error(&error);
                    this.intervals(answer, &measured, &fit).map(Some)
                }
                Err(e @ PredictError::Interrupted) => Err(e.into()),
                // A place that a mesh gives no answer at says nothing.
                Ok((_, None)) | Err(_) => Ok(None),
            }
        };
        let there: Vec<Option<Uncertainty>> = probes.par_iter().map(asked).collect::<Result<_, _>>()?;
        self.runs += probes.len() * (1 + usize::from(answer.coarse.is_some()));
        Ok(straight.with_asymmetric_intervals(&probes, &there))
    }
}
