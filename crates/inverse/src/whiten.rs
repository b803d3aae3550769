//! Whitening: the linear map that turns correlated noise into independent numbers of variance 1.
//!
//! With block noise D R D (sd, AR(1)) and numerical-error columns E the covariance is
//! Σ = L Lᵀ + E Eᵀ. AR(1) is whitened exactly, point by point; the columns follow by
//! (I + E₁E₁ᵀ)^(−½) = I + U diag(1/√(1 + s²) − 1) Uᵀ with E₁ = L⁻¹E = U s Vᵀ (Woodbury), so that
//! a whitened vector keeps one row per point and its square is rᵀΣ⁻¹r.

use crate::linalg::columns;
use crate::{Data, Free, Prediction};
use nalgebra::{DMatrix, DVector};

/// Which part of the noise is whitened.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Noise {
    /// The record's noise and the model's numerical error.
    Total,
    /// The record's noise alone.
    Record,
    /// Nothing: the misfit as it is (the paper's plain sum of squares).
    None,
}

/// The whitening map of a set of points. Built once, applied to misfits, jacobians and effect columns.
#[derive(Clone, Debug)]
pub struct Whitener {
    rows: Vec<usize>,
    weight: Vec<f64>,
    carry: Vec<f64>,
    basis: DMatrix<f64>,
    shrink: DVector<f64>,
}

impl Whitener {
    /// The map for all points that are used (not held out) and, if a mask is given, valid.
    /// A missing point inside a block is bridged exactly: the correlation across k steps is ar1ᵏ.
    pub fn new(data: &Data, valid: Option<&[bool]>, noise: Noise) -> Self {
        let keep = |i: usize| data.is_used(i) && valid.is_none_or(|v| v.get(i).copied().unwrap_or(true));
        Self::with_points(data, keep, noise)
    }

    /// The map for the points that `keep` selects.
    pub fn with_points(data: &Data, keep: impl Fn(usize) -> bool, noise: Noise) -> Self {
        let (mut rows, mut weight, mut carry) = (Vec::new(), Vec::new(), Vec::new());
        for block in &data.blocks {
            let (start, model) = (block.range.start, &block.noise);
            let mut last: Option<usize> = None;
            for i in block.range.clone().filter(|&i| keep(i)) {
                let phi = match (last, noise) {
                    (_, Noise::None) | (None, _) => 0.0,
                    (Some(j), _) => model.correlation(j - start, i - start),
                };
                rows.push(i);
                // What of the point before stands in this one: in its own sd.
                carry.push(match (last, model.spread.is_empty()) {
                    (Some(j), false) => phi * model.sd_of(i - start) / model.sd_of(j - start),
                    _ => phi,
                });
                weight.push(match noise {
                    Noise::None => model.root_weight(i - start),
                    _ => 1.0 / (model.sd_of(i - start) * (1.0 - phi * phi).sqrt()),
                });
                last = Some(i);
            }
        }
        let mut map = Self { rows, weight, carry, basis: DMatrix::zeros(0, 0), shrink: DVector::zeros(0) };
        if noise == Noise::Total {
            map.add_nuisance(&data.nuisance_columns());
        }
        map
    }

    fn add_nuisance(&mut self, columns: &[DVector<f64>]) {
        let live: Vec<DVector<f64>> =
            columns.iter().map(|e| self.apply(e)).filter(|e| e.norm() > 0.0).collect();
        if live.is_empty() {
            return;
        }
        let svd = DMatrix::from_columns(&live).svd(true, false);
        if let Some(u) = svd.u {
            self.shrink = svd.singular_values.map(|s| 1.0 / (1.0 + s * s).sqrt() - 1.0);
            self.basis = u;
        }
    }

    /// Index in the prediction vector of each whitened row.
    pub fn rows(&self) -> &[usize] {
        &self.rows
    }

    /// Whitens a vector of full length n; the answer has one number per selected point.
    pub fn apply(&self, v: &DVector<f64>) -> DVector<f64> {
        let mut w = DVector::zeros(self.rows.len());
        for k in 0..self.rows.len() {
            let before = if k > 0 { self.carry[k] * v[self.rows[k - 1]] } else { 0.0 };
            w[k] = self.weight[k] * (v[self.rows[k]] - before);
        }
        if !self.shrink.is_empty() {
            let inner = self.basis.tr_mul(&w).component_mul(&self.shrink);
            w += &self.basis * inner;
        }
        w
    }

    /// Whitens every column of an n × p matrix.
    pub fn apply_matrix(&self, a: &DMatrix<f64>) -> DMatrix<f64> {
        let mut out = DMatrix::zeros(self.rows.len(), a.ncols());
        for k in 0..a.ncols() {
            out.set_column(k, &self.apply(&a.column(k).into_owned()));
        }
        out
    }
}

/// A whitened, linearised problem at one set of parameters: min |r − J dz|².
///
/// The first rows belong to points of the record, the last `prior_rows` to priors. The columns are
/// derivatives in the transformed coordinates z of the free parameters.
#[derive(Clone, Debug)]
pub struct Whitened {
    /// Whitened misfit (measurement − model), then (mean − z)/sd of each prior.
    pub r: DVector<f64>,
    /// Whitened jacobian in transformed coordinates, then 1/sd rows of the priors.
    pub jacobian: DMatrix<f64>,
    /// Index in the prediction vector of each data row.
    pub rows: Vec<usize>,
    /// How many rows at the end are priors.
    pub prior_rows: usize,
    /// The map that made it.
    pub whitener: Whitener,
}

impl Whitened {
    /// Whitens a prediction with its jacobian at `theta` (physical units). Points marked not valid
    /// and held-out points have no row. A prediction without a jacobian gives zero columns.
    pub fn new(data: &Data, free: &[Free], theta: &[f64], prediction: &Prediction, noise: Noise) -> Self {
        let whitener = Whitener::new(data, prediction.valid.as_deref(), noise);
        let (m, p) = (whitener.rows.len(), free.len());
        let priors: Vec<usize> = (0..p).filter(|&k| free[k].prior.is_some()).collect();
        let weight = if noise == Noise::None { data.mean_sd() } else { 1.0 };
        let mut r = DVector::zeros(m + priors.len());
        let mut jacobian = DMatrix::zeros(m + priors.len(), p);
        r.rows_mut(0, m).copy_from(&whitener.apply(&data.misfit(&prediction.values)));
        if let Some(raw) = &prediction.jacobian {
            let mut j = whitener.apply_matrix(raw);
            for (k, f) in free.iter().enumerate() {
                j.column_mut(k).scale_mut(f.transform.slope(theta[k]));
            }
            jacobian.rows_mut(0, m).copy_from(&j);
        }
        for (row, &k) in priors.iter().enumerate() {
            if let Some(prior) = free[k].prior {
                r[m + row] = weight * (prior.mean - free[k].forward(theta[k])) / prior.sd;
                jacobian[(m + row, k)] = weight / prior.sd;
            }
        }
        Self { r, jacobian, rows: whitener.rows.clone(), prior_rows: priors.len(), whitener }
    }

    /// Whitens one more column of full length n (an effect's d(prediction)/da); prior rows are zero.
    pub fn column(&self, s: &DVector<f64>) -> DVector<f64> {
        let w = self.whitener.apply(s);
        let mut out = DVector::zeros(self.r.len());
        out.rows_mut(0, w.len()).copy_from(&w);
        out
    }

    /// The same without the columns where `leave_out` is true (parameters at a bound).
    pub fn without(&self, leave_out: &[bool]) -> Self {
        let keep: Vec<usize> =
            (0..self.jacobian.ncols()).filter(|&k| !leave_out.get(k).copied().unwrap_or(false)).collect();
        Self { jacobian: columns(&self.jacobian, &keep), ..self.clone() }
    }
}

impl Data {
    /// Root mean square noise sd over the used points: the weight of priors in the plain sum of squares.
    pub(crate) fn mean_sd(&self) -> f64 {
        let (mut sum, mut n) = (0.0, 0.0);
        for b in &self.blocks {
            let used = b.range.clone().filter(|&i| self.is_used(i)).count() as f64;
            sum += used * b.noise.sd.powi(2);
            n += used;
        }
        if n > 0.0 { (sum / n).sqrt() } else { 1.0 }
    }

    /// W^½ Σ W^½ v over the given points, Σ the total covariance (record noise and numerical error), W the weights of a
    /// plain sum of squares.
    pub(crate) fn covariance_times(&self, rows: &[usize], v: &DVector<f64>) -> DVector<f64> {
        let mut out = DVector::zeros(rows.len());
        let mut root = DVector::from_element(rows.len(), 1.0);
        for block in &self.blocks {
            let at: Vec<usize> = (0..rows.len()).filter(|&k| block.range.contains(&rows[k])).collect();
            let (sd2, start) = (block.noise.sd.powi(2), block.range.start);
            at.iter().for_each(|&k| root[k] = block.noise.root_weight(rows[k] - start));
            let gap = |a: usize, b: usize| block.noise.correlation(rows[a] - start, rows[b] - start);
            let spread = |k: usize| block.noise.spread.get(rows[k] - start).copied().unwrap_or(1.0);
            let share = |k: usize| root[k] * spread(k);
            let mut forward = 0.0;
            for (n, &k) in at.iter().enumerate() {
                forward = match n {
                    0 => 0.0,
                    _ => gap(at[n - 1], k) * (forward + share(at[n - 1]) * v[at[n - 1]]),
                };
                out[k] += sd2 * share(k) * (share(k) * v[k] + forward);
            }
            let mut backward = 0.0;
            for (n, &k) in at.iter().enumerate().rev() {
                backward = match at.get(n + 1) {
                    None => 0.0,
                    Some(&next) => gap(k, next) * (backward + share(next) * v[next]),
                };
                out[k] += sd2 * share(k) * backward;
            }
        }
        for e in self.nuisance_columns() {
            let part = DVector::from_iterator(rows.len(), rows.iter().zip(&root).map(|(&i, w)| w * e[i]));
            let factor = part.dot(v);
            out.axpy(factor, &part, 1.0);
        }
        out
    }
}
