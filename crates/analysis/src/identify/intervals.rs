//! Intervals of a staged fit: each stage on its own rows, the bulk's spread handed on to the
//! interface.

use super::{AnalysisError, Work};
use crate::data::Measured;
use inverse::{
    Data, Fit, Free, Held, Identifiability, Objective, Uncertainty, staged_uncertainty, uncertainty,
};
use model::{Model, Site};
use nalgebra::{DMatrix, DVector};

impl Work<'_> {
    /// Intervals of a staged fit: the bulk from its own stage, the interface with the bulk's
    /// covariance propagated. Joined into one list over all free parameters.
    pub(super) fn staged_intervals(
        &self,
        model: &Model,
        measured: &Measured,
        fit: &Fit,
        free: &[usize],
        rule: &Identifiability,
    ) -> Result<Uncertainty, AnalysisError> {
        let bulk: Vec<usize> = (0..free.len()).filter(|&k| model.site_of(free[k]) == Site::Bulk).collect();
        let rest: Vec<usize> = (0..free.len()).filter(|&k| model.site_of(free[k]) != Site::Bulk).collect();
        let first = part(model, measured, fit, free, &bulk, false);
        let second = part(model, measured, fit, free, &rest, true);
        let first_u = uncertainty(&first.data, &first.free_parameters, &first.fit, rule)?;
        // What the uniaxial test leaves open is not boundless: the literature's spread closes it
        // before it is handed on to the interface.
        let mut bounded = first.free_parameters.clone();
        crate::priors::add(&mut bounded, self.case, self.belief.at_start());
        let handed = uncertainty(&first.data, &bounded, &first.fit, rule)?;
        let held = Held { jacobian: second.jacobian_of(fit, &bulk), covariance: handed.covariance() };
        let second_u = staged_uncertainty(&second.data, &second.free_parameters, &second.fit, &held, rule)?;
        Ok(first_u.join(second_u, &bulk, &rest))
    }
}

/// A stage cut out of the whole fit.
struct Part {
    data: Data,
    free_parameters: Vec<Free>,
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
    tears: bool,
) -> Part {
    let mut rows = Vec::new();
    let mut blocks = Vec::new();
    for (block, slot) in measured.data.blocks.iter().zip(&measured.slots) {
        if model.tests[slot.test].test.kind.tears == tears {
            let start = rows.len();
            rows.extend(block.range.clone());
            blocks.push(inverse::Block { range: start..rows.len(), ..block.clone() });
        }
    }
    let theta: Vec<f64> = columns.iter().map(|&c| whole.theta[c]).collect();
    let free_parameters = columns
        .iter()
        .zip(&theta)
        .map(|(&c, &start)| Free { start, ..Free::of(&model.parameters[free[c]]) })
        .collect();
    let values = DVector::from_iterator(rows.len(), rows.iter().map(|&r| whole.prediction.values[r]));
    let mut part = Part {
        data: Data {
            blocks,
            held_out: rows.iter().map(|&r| !measured.data.is_used(r)).collect(),
            ..Data::default()
        },
        free_parameters,
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
