//! Staged fits: what the first stage does not know, the second cannot know either.
//!
//! The second stage holds parameters h at estimates with covariance C_h. Its estimate moves with them by
//! G = dφ̂/dh = −(JᵀWJ)⁻¹JᵀW J_h, W the weights of *its* objective, so its covariance grows by G C_h Gᵀ
//! (Murphy & Topel 1985, for stages with independent data).

use crate::covariance::uncertainty_with;
use crate::linalg::damped_solve;
use crate::whiten::Whitened;
use crate::{Data, Fit, FitError, Free, Identifiability, Uncertainty};
use nalgebra::{DMatrix, DVector};

/// What an earlier stage hands on.
#[derive(Clone, Debug)]
pub struct Held {
    /// d(prediction of this stage)/d(held parameters), n × h, physical units, at the optimum.
    pub jacobian: DMatrix<f64>,
    /// Covariance of the held parameters, h × h, physical units ([`Uncertainty::covariance`]).
    pub covariance: DMatrix<f64>,
}

/// Uncertainty of a second stage, the first stage's covariance propagated. Data of the two stages must be
/// independent (a numerical-error column shared by both is treated as two).
///
/// # Errors
/// [`FitError::Contract`] when shapes disagree or the fit carries no jacobian.
pub fn staged_uncertainty(
    data: &Data,
    free: &[Free],
    fit: &Fit,
    held: &Held,
    rule: &Identifiability,
) -> Result<Uncertainty, FitError> {
    let gain = held_gain(data, free, fit, &held.jacobian)?;
    if held.covariance.shape() != (gain.ncols(), gain.ncols()) {
        return Err(FitError::Contract(format!(
            "a covariance of {} by {} for {} held parameters",
            held.covariance.nrows(),
            held.covariance.ncols(),
            gain.ncols()
        )));
    }
    let added = &gain * &held.covariance * gain.transpose();
    uncertainty_with(data, free, fit, rule, Some(&added))
}

/// G = dẑ/dh, p × h: how the free parameters (transformed) answer to the held ones (physical).
/// Rows of parameters at a bound are zero.
///
/// # Errors
/// [`FitError::Contract`] when shapes disagree or the fit carries no jacobian.
pub fn held_gain(
    data: &Data,
    free: &[Free],
    fit: &Fit,
    held_jacobian: &DMatrix<f64>,
) -> Result<DMatrix<f64>, FitError> {
    if held_jacobian.nrows() != data.points() {
        return Err(FitError::Contract(format!(
            "a jacobian of held parameters with {} rows for {} points",
            held_jacobian.nrows(),
            data.points()
        )));
    }
    if fit.prediction.jacobian.is_none() {
        return Err(FitError::Contract("no jacobian at the optimum".into()));
    }
    let white = Whitened::new(data, free, &fit.theta, &fit.prediction, fit.objective.noise());
    let open: Vec<usize> = (0..free.len()).filter(|&k| !fit.at_bound[k]).collect();
    let j = white.without(&fit.at_bound).jacobian;
    let norms: Vec<f64> = j.column_iter().map(|c| c.norm_squared()).collect();
    let ridge = DVector::from_iterator(norms.len(), norms.iter().map(|n| 1e-18 * n.max(1e-300)));
    let mut gain = DMatrix::zeros(free.len(), held_jacobian.ncols());
    for k in 0..held_jacobian.ncols() {
        let column = white.column(&held_jacobian.column(k).into_owned());
        let Some(x) = damped_solve(&j, &column, &ridge) else { continue };
        for (row, &i) in open.iter().enumerate() {
            gain[(i, k)] = -x[row];
        }
    }
    Ok(gain)
}

impl Uncertainty {
    /// Two stages as one list: `here` and `there` are the positions of this stage's and the other's
    /// parameters in the joined list. Correlations between the stages are left out (zero).
    pub fn join(self, other: Uncertainty, here: &[usize], there: &[usize]) -> Uncertainty {
        let n = here.len() + there.len();
        let places: Vec<(usize, bool, usize)> = here
            .iter()
            .enumerate()
            .map(|(k, &at)| (at, false, k))
            .chain(there.iter().enumerate().map(|(k, &at)| (at, true, k)))
            .collect();
        let mut order = vec![(false, 0); n];
        for (at, second, k) in places {
            if at < n {
                order[at] = (second, k);
            }
        }
        let pick = |second: bool| if second { &other } else { &self };
        let block = |m: fn(&Uncertainty) -> &DMatrix<f64>| {
            DMatrix::from_fn(n, n, |i, j| {
                let ((si, ki), (sj, kj)) = (order[i], order[j]);
                if si == sj { m(pick(si))[(ki, kj)] } else { 0.0 }
            })
        };
        let mut spectrum: Vec<(f64, bool, usize)> = self
            .singular_values
            .iter()
            .enumerate()
            .map(|(k, &s)| (s, false, k))
            .chain(other.singular_values.iter().enumerate().map(|(k, &s)| (s, true, k)))
            .collect();
        spectrum.sort_by(|a, b| b.0.total_cmp(&a.0));
        let directions = DMatrix::from_fn(n, spectrum.len(), |i, c| {
            let ((second, k), (_, of_second, column)) = (order[i], spectrum[c]);
            if second == of_second { pick(second).directions[(k, column)] } else { 0.0 }
        });
        Uncertainty {
            estimates: order.iter().map(|&(second, k)| pick(second).estimates[k].clone()).collect(),
            covariance_z: block(|u| &u.covariance_z),
            correlation: block(|u| &u.correlation),
            singular_values: spectrum.iter().map(|s| s.0).collect(),
            directions,
            free: order.iter().map(|&(second, k)| pick(second).free[k].clone()).collect(),
            scales: order.iter().map(|&(second, k)| pick(second).scales[k]).collect(),
            theta: order.iter().map(|&(second, k)| pick(second).theta[k]).collect(),
            rule: self.rule,
            half_width: self.half_width.max(other.half_width),
        }
    }
}
