//! The rest as columns with unknown factors, for estimators that weigh a record by its noise alone.

use crate::model::{Evidence, View};
use crate::record::Record;
use crate::rest::{RestForm, RestPrior, RestSize};
use nalgebra::DVector;

/// What the columns leave out, as a share of the rest's variance.
const LEFT_OUT: f64 = 0.02;

/// Columns of one block at most.
const MOST: usize = 150;

/// Sizes that weigh less are left out.
const NEGLIGIBLE: f64 = 1e-4;

impl Evidence {
    /// Columns e, each of the record's full length and unit, such that Σ e eᵀ is the covariance of the rest, averaged over its
    /// sizes as the records weigh them. `beyond` is the prior probability of a cause outside the catalogue. Empty where
    /// nothing is left.
    pub fn rest_columns(&self, record: &Record, rest: &RestPrior, beyond: f64) -> Vec<DVector<f64>> {
        let weights = self.weights(&View { rest, amplitude: 1.0 }, beyond);
        let mut sizes: Vec<(RestSize, Option<usize>)> = Vec::new();
        for (w, node) in weights.iter().zip(&self.nodes).filter(|(w, _)| **w > NEGLIGIBLE) {
            let size = RestSize {
                tau: w.sqrt() * node.size.tau,
                upsilon: w.sqrt() * node.size.upsilon,
                ..node.size
            };
            let key = |s: &RestSize, only| (s.smooth_length, s.jerk_length, s.form, only);
            match sizes.iter_mut().find(|(s, only)| key(s, *only) == key(&size, node.only)) {
                Some((s, _)) => (s.tau, s.upsilon) = (s.tau.hypot(size.tau), s.upsilon.hypot(size.upsilon)),
                None => sizes.push((size, node.only)),
            }
        }
        let mut out = Vec::new();
        for (block, profile) in record.blocks.iter().zip(&self.profile) {
            let here: Vec<RestSize> = sizes.iter().map(|(z, only)| z.in_test(block.number, *only)).collect();
            let k = |i: usize, j: usize| {
                let product = profile[i] * profile[j];
                let factor = |z: &RestSize| if z.form == RestForm::Proportional { product } else { 1.0 };
                here.iter().map(|z| factor(z) * block.points.rest_covariance(z, i, j)).sum::<f64>()
            };
            for column in pivoted_cholesky(block.rows.len(), k) {
                let mut full = DVector::zeros(record.full);
                for (&row, v) in block.rows.iter().zip(&column) {
                    full[row] = block.peak * v;
                }
                out.push(full);
            }
        }
        out
    }
}

/// Columns of a factor of the n × n covariance `k`, largest diagonal first, until what is left is [`LEFT_OUT`] of its trace.
fn pivoted_cholesky(n: usize, k: impl Fn(usize, usize) -> f64) -> Vec<Vec<f64>> {
    let mut diagonal: Vec<f64> = (0..n).map(|i| k(i, i)).collect();
    let least = LEFT_OUT * diagonal.iter().sum::<f64>();
    let mut columns: Vec<Vec<f64>> = Vec::new();
    while columns.len() < MOST.min(n) && diagonal.iter().sum::<f64>() > least {
        let Some((p, &most)) = diagonal.iter().enumerate().max_by(|a, b| a.1.total_cmp(b.1)) else { break };
        if most <= 0.0 {
            break;
        }
        let root = most.sqrt();
        let column: Vec<f64> =
            (0..n).map(|i| (k(i, p) - columns.iter().map(|c| c[i] * c[p]).sum::<f64>()) / root).collect();
        for (d, c) in diagonal.iter_mut().zip(&column) {
            *d = (*d - c * c).max(0.0);
        }
        columns.push(column);
    }
    columns
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_give_the_covariance_back() {
        let size =
            RestSize { tau: 0.02, upsilon: 0.005, smooth_length: 0.2, jerk_length: 0.1, ..RestSize::NONE };
        let k = |i: usize, j: usize| size.covariance((i as f64 - j as f64).abs() / 60.0);
        let columns = pivoted_cholesky(60, k);
        let (mut wrong, mut all, mut trace) = (0.0f64, 0.0f64, [0.0f64; 2]);
        for i in 0..60 {
            for j in 0..60 {
                let sum: f64 = columns.iter().map(|c| c[i] * c[j]).sum();
                wrong += (sum - k(i, j)).powi(2);
                all += k(i, j).powi(2);
            }
            trace[0] += columns.iter().map(|c| c[i] * c[i]).sum::<f64>();
            trace[1] += k(i, i);
        }
        assert!(wrong.sqrt() < LEFT_OUT * all.sqrt(), "{wrong} of {all}");
        assert!(trace[0] <= trace[1] && trace[0] >= (1.0 - LEFT_OUT) * trace[1], "{trace:?}");
        assert!(columns.len() < 30, "{}", columns.len());
        assert!(pivoted_cholesky(5, |_, _| 0.0).is_empty());
    }
}
