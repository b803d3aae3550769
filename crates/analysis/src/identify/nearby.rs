//! What the given mesh says near an answer, without running it there.

use super::finish::Answer;
use super::{SEARCH_TOLERANCE, TRIAL_BUDGET, Work};
use crate::correction::Correction;
use crate::problem::FeProblem;
use inverse::{Fit, PredictError, Prediction, Problem};
use model::{Model, RunOptions};
use nalgebra::DVector;

/// The given mesh near an answer. Where there is a cheap mesh, values and derivatives are its own with the difference at
/// the answer, to first order in the parameters; the numerical error changes as the difference of the two coarser meshes does.
pub(super) struct Nearby<'m> {
    options: RunOptions,
    mapped: Option<Mapped<'m>>,
}

struct Mapped<'m> {
    cheap: &'m Model,
    coarse: &'m Model,
    correction: Correction,
    /// The numerical error is `share` of (coarse − cheap), and `remains`.
    share: f64,
    remains: DVector<f64>,
}

impl<'m> Nearby<'m> {
    /// From the answer's fit and numerical error there.
    pub fn new(
        work: &Work,
        answer: &Answer<'m>,
        (fit, error): (&Fit, &DVector<f64>),
    ) -> Result<Self, PredictError> {
        let mut options = work.search;
        options.stepping.budget = TRIAL_BUDGET;
        options.stepping.newton.tolerance = options.stepping.newton.tolerance.max(SEARCH_TOLERANCE);
        let (Some(cheap), Some(coarse)) = (answer.cheap, answer.coarse) else {
            return Ok(Self { options, mapped: None });
        };
        let both = (
            run(work, answer, cheap, &fit.theta, true, options),
            run(work, answer, coarse, &fit.theta, false, options),
        );
        let (own, coarser) = match both {
            (Ok(own), Ok(coarser)) => (own, coarser),
            (Err(e @ PredictError::Interrupted), _) | (_, Err(e @ PredictError::Interrupted)) => {
                return Err(e);
            }
            _ => return Ok(Self { options, mapped: None }),
        };
        let difference = &coarser.values - &own.values;
        let share = error.dot(&difference) / difference.norm_squared().max(f64::MIN_POSITIVE);
        let correction = Correction::first_order(&answer.free_parameters, &fit.theta, &fit.prediction, &own);
        let remains = error - share * difference;
        Ok(Self { options, mapped: Some(Mapped { cheap, coarse, correction, share, remains }) })
    }

    /// A fit at these values of the free parameters, and the numerical error there where it can be told.
    pub fn at(
        &self,
        work: &Work,
        answer: &Answer,
        values: &[f64],
    ) -> Result<(Fit, Option<DVector<f64>>), PredictError> {
        let Some(m) = &self.mapped else { return work.at(answer, values.to_vec(), self.options) };
        let mut own = run(work, answer, m.cheap, values, true, self.options)?;
        let coarser = run(work, answer, m.coarse, values, false, self.options)?;
        let error = m.share * (coarser.values - &own.values) + &m.remains;
        let theta = full(work, answer, values);
        m.correction.apply(m.cheap, &theta, &answer.free, &mut own.values, own.jacobian.as_mut());
        Ok((work.fit_of(answer, values.to_vec(), own), Some(error)))
    }
}

fn full(work: &Work, answer: &Answer, values: &[f64]) -> Vec<f64> {
    let mut theta = work.theta.clone();
    for (&i, &v) in answer.free.iter().zip(values) {
        theta[i] = v;
    }
    theta
}

fn run(
    work: &Work,
    answer: &Answer,
    model: &Model,
    values: &[f64],
    jacobian: bool,
    options: RunOptions,
) -> Result<Prediction, PredictError> {
    let theta = full(work, answer, values);
    let cancelled = work.control.cancelled;
    FeProblem::new(model, theta, answer.free.clone(), &answer.noisy.slots, options, cancelled)
        .predict(values, jacobian)
}
