//! How far off a fit is: χ² and rms per block, degrees of freedom, information criteria.

use crate::whiten::{Noise, Whitened, Whitener};
use crate::{Data, Fit, Free};
use nalgebra::{DMatrix, DVector};
use serde::Serialize;

/// How well one block is reproduced.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct BlockQuality {
    /// Name of the block.
    pub name: String,
    /// Points that took part.
    pub points: usize,
    /// Share of the fitted parameters that this block determines (trace of its part of the hat matrix).
    pub degrees_of_freedom: f64,
    /// Root mean square misfit, unit of the block.
    pub rms: f64,
    /// Noise sd of the block, its unit.
    pub noise: f64,
    /// Plain sum of squared misfits.
    pub objective: f64,
    /// χ² with the record's noise alone.
    pub chi2: f64,
    /// χ² with the record's noise and the model's numerical error.
    pub chi2_total: f64,
    /// `chi2` per degree of freedom left.
    pub reduced_chi2: f64,
    /// `chi2_total` per degree of freedom left.
    pub reduced_chi2_total: f64,
}

/// How well a whole fit reproduces its data.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Quality {
    /// One entry per block.
    pub blocks: Vec<BlockQuality>,
    /// Points that took part.
    pub points: usize,
    /// Free parameters, not counting those at a bound.
    pub parameters: usize,
    /// Points minus the parameters' share of them (trace of the hat matrix).
    pub freedom: f64,
    /// χ² with the record's noise alone.
    pub chi2: f64,
    /// χ² with numerical error.
    pub chi2_total: f64,
    /// `chi2` per degree of freedom left.
    pub reduced_chi2: f64,
    /// `chi2_total` per degree of freedom left.
    pub reduced_chi2_total: f64,
    /// Bayesian information criterion, χ²_total + k ln n (noise known).
    pub bic: f64,
    /// Akaike's, corrected for small n: χ²_total + 2k + 2k(k + 1)/(n − k − 1).
    pub aicc: f64,
}

/// Quality of a fit on the points it used. A point that leaves the linearisation still counts.
pub fn quality(data: &Data, free: &[Free], fit: &Fit) -> Quality {
    let misfit = data.misfit(&fit.prediction.values);
    let leverage = leverage(data, free, fit);
    let mut blocks = Vec::new();
    for (b, block) in data.blocks.iter().enumerate() {
        let inside = |i: usize| data.is_used(i) && block.range.contains(&i);
        let square = |noise| Whitener::with_points(data, inside, noise).apply(&misfit).norm_squared();
        let points = block.range.clone().filter(|&i| data.is_used(i)).count();
        let weight = |i: usize| block.noise.readings.get(i - block.range.start).copied().unwrap_or(1.0);
        let readings: f64 = block.range.clone().filter(|&i| data.is_used(i)).map(weight).sum();
        let dof = leverage[b];
        let left = (points as f64 - dof).max(1.0);
        let (objective, chi2, chi2_total) =
            (square(Noise::None), square(Noise::Record), square(Noise::Total));
        blocks.push(BlockQuality {
            name: block.name.clone(),
            points,
            degrees_of_freedom: dof,
            rms: (objective / readings.max(1.0)).sqrt(),
            noise: block.noise.sd,
            objective,
            chi2,
            chi2_total,
            reduced_chi2: chi2 / left,
            reduced_chi2_total: chi2_total / left,
        });
    }
    let points = data.used_points();
    let parameters = fit.at_bound.iter().filter(|&&b| !b).count();
    let chi2 = Whitener::new(data, None, Noise::Record).apply(&misfit).norm_squared();
    let chi2_total = Whitener::new(data, None, Noise::Total).apply(&misfit).norm_squared();
    let left = (points as f64 - leverage.iter().sum::<f64>()).max(1.0);
    Quality {
        blocks,
        points,
        parameters,
        freedom: left,
        chi2,
        chi2_total,
        reduced_chi2: chi2 / left,
        reduced_chi2_total: chi2_total / left,
        bic: bic(chi2_total, parameters, points),
        aicc: aicc(chi2_total, parameters, points),
    }
}

/// Bayesian information criterion with known noise: χ² + k ln n.
pub fn bic(chi2: f64, parameters: usize, points: usize) -> f64 {
    chi2 + parameters as f64 * (points.max(1) as f64).ln()
}

/// Akaike's information criterion with known noise, corrected for small n: χ² + 2k + 2k(k + 1)/(n − k − 1);
/// infinite when n ≤ k + 1.
pub fn aicc(chi2: f64, parameters: usize, points: usize) -> f64 {
    let (k, n) = (parameters as f64, points as f64);
    if n <= k + 1.0 { f64::INFINITY } else { chi2 + 2.0 * k + 2.0 * k * (k + 1.0) / (n - k - 1.0) }
}

/// Root mean square of misfits; 0 for none.
pub fn rms(misfit: impl IntoIterator<Item = f64>) -> f64 {
    let (sum, n) = misfit.into_iter().fold((0.0, 0.0), |(s, n), r| (s + r * r, n + 1.0));
    if n > 0.0 { f64::sqrt(sum / n) } else { 0.0 }
}

/// Trace of the hat matrix over each block: J(JᵀJ)⁻¹Jᵀ of the whitened jacobian, priors as rows.
fn leverage(data: &Data, free: &[Free], fit: &Fit) -> Vec<f64> {
    let mut per_block = vec![0.0; data.blocks.len()];
    if fit.prediction.jacobian.is_none() {
        return per_block;
    }
    let white = Whitened::new(data, free, &fit.theta, &fit.prediction, Noise::Total).without(&fit.at_bound);
    let basis = orthonormal(&white.jacobian);
    for (row, &i) in white.rows.iter().enumerate() {
        if let Some(b) = data.blocks.iter().position(|b| b.range.contains(&i)) {
            per_block[b] += basis.row(row).norm_squared();
        }
    }
    per_block
}

/// An orthonormal basis of the columns of `a` (m × rank), by pivoted Gram–Schmidt with re-orthogonalisation.
/// Columns are scaled to length 1 first, so that units do not decide what counts as zero; a column of which
/// less than 1e-9 is left counts as a combination of the others.
pub fn orthonormal(a: &DMatrix<f64>) -> DMatrix<f64> {
    let mut left: Vec<DVector<f64>> =
        a.column_iter().filter(|c| c.norm() > 0.0 && c.norm().is_finite()).map(|c| c.normalize()).collect();
    let mut basis: Vec<DVector<f64>> = Vec::new();
    while basis.len() < a.nrows() {
        let longest =
            (0..left.len()).max_by(|&i, &j| left[i].norm().total_cmp(&left[j].norm()).then(j.cmp(&i)));
        let Some(longest) = longest else { break };
        let mut q = left.swap_remove(longest);
        if q.norm() < 1e-9 {
            break;
        }
        for b in &basis {
            q.axpy(-b.dot(&q), b, 1.0);
        }
        q.normalize_mut();
        for c in &mut left {
            c.axpy(-q.dot(c), &q, 1.0);
        }
        basis.push(q);
    }
    if basis.is_empty() { DMatrix::zeros(a.nrows(), 0) } else { DMatrix::from_columns(&basis) }
}
