//! What the data fix and what they do not: covariance, intervals, identifiability.
//!
//! Everything is linearised in the transformed coordinates z, where a logarithm makes the χ² valley
//! straighter; intervals are made there and mapped back, so that they respect the bounds.

use crate::half_width::half_width;
use crate::linalg::{columns, spectrum};
use crate::whiten::{Noise, Whitened};
use crate::{Data, Fit, FitError, Free, Objective};
use nalgebra::{DMatrix, DVector};
use params::Transform;
use serde::Serialize;

/// When a parameter counts as fixed by the data. All numbers are in natural scales of the transformed
/// coordinate ([`Free::natural_scale`]): 1 is a factor e for `Log`, half the box for `Identity`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Identifiability {
    /// Largest standard deviation; the default 0.5 lets a 95 % interval span a factor 7.
    pub max_sd: f64,
    /// With a prior, the data must shrink its sd at least to this share; default 0.7 (they halve the variance).
    pub prior_shrink: f64,
    /// Singular values below this share of the largest count as zero.
    pub null: f64,
}

impl Default for Identifiability {
    fn default() -> Self {
        Self { max_sd: 0.5, prior_shrink: 0.7, null: 1e-10 }
    }
}

/// One parameter with its uncertainty; physical units.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Estimate {
    /// Path of the parameter.
    pub path: String,
    /// Identified value.
    pub value: f64,
    /// Standard error; `None` where the data do not fix the parameter at all.
    pub std_error: Option<f64>,
    /// 95 % interval, within the bounds.
    pub interval_95: [f64; 2],
    /// The same if the model were right: noise and the model's numerical error alone. Equal to `interval_95` unless that
    /// allows for more ([`Uncertainty::allowing_for`]).
    pub interval_95_if_right: [f64; 2],
    /// Whether the value stands at a bound. Its interval is one-sided then.
    pub at_bound: bool,
    /// Whether the data fix it, by the rule of [`Identifiability`].
    pub identifiable: bool,
    /// Standard deviation in the transformed coordinate, in natural scales.
    pub scaled_sd: f64,
}

/// Uncertainty of a whole fit.
#[derive(Clone, Debug)]
pub struct Uncertainty {
    /// One estimate per free parameter.
    pub estimates: Vec<Estimate>,
    /// Covariance in the transformed coordinates, p × p; rows and columns of parameters at a bound are zero.
    pub covariance_z: DMatrix<f64>,
    /// Correlations in the transformed coordinates, p × p; 1 on the diagonal.
    pub correlation: DMatrix<f64>,
    /// Singular values of the whitened jacobian scaled by natural scales, largest first: a move of
    /// 1/s natural scales along the direction raises χ² by 1. Parameters at a bound are left out.
    pub singular_values: Vec<f64>,
    /// The directions, one column per singular value, p rows (zero for parameters at a bound).
    pub directions: DMatrix<f64>,
    pub(crate) free: Vec<Free>,
    pub(crate) scales: Vec<f64>,
    pub(crate) theta: Vec<f64>,
    pub(crate) rule: Identifiability,
    /// Half width of a 95 % interval in standard deviations.
    pub(crate) half_width: f64,
}

/// Uncertainty at the optimum of `fit`. A whitened fit has the covariance (JᵀΣ⁻¹J)⁻¹; a fit of the
/// plain sum of squares has the sandwich (JᵀJ)⁻¹JᵀΣJ(JᵀJ)⁻¹, Σ with autocorrelation and numerical error; one that
/// weighed by the record's noise alone the same with J and Σ whitened by that.
///
/// # Errors
/// [`FitError::Contract`] when the fit carries no jacobian.
pub fn uncertainty(
    data: &Data,
    free: &[Free],
    fit: &Fit,
    rule: &Identifiability,
) -> Result<Uncertainty, FitError> {
    uncertainty_with(data, free, fit, rule, None)
}

/// The same with an additional covariance in transformed coordinates (p × p), as a first stage hands on.
pub(crate) fn uncertainty_with(
    data: &Data,
    free: &[Free],
    fit: &Fit,
    rule: &Identifiability,
    added: Option<&DMatrix<f64>>,
) -> Result<Uncertainty, FitError> {
    if fit.prediction.jacobian.is_none() {
        return Err(FitError::Contract("no jacobian at the optimum".into()));
    }
    let p = free.len();
    let theta = &fit.theta;
    let scales: Vec<f64> = free.iter().zip(theta).map(|(f, &x)| f.natural_scale(x)).collect();
    let white = Whitened::new(data, free, theta, &fit.prediction, Noise::Total);
    let open: Vec<usize> = (0..p).filter(|&k| !fit.at_bound[k]).collect();
    let scaled = scaled_columns(&white.jacobian, &open, &scales);
    let (singular_values, v) = spectrum(&scaled);
    let mut directions = DMatrix::zeros(p, open.len());
    for (row, &k) in open.iter().enumerate() {
        directions.row_mut(k).copy_from(&v.row(row));
    }
    let raw = |noise: Noise| Whitened::new(data, free, theta, &fit.prediction, noise);
    let inner = match fit.objective {
        Objective::Whitened => inverse_gram(&singular_values, &v, rule.null),
        Objective::Record => of_record(data, &raw(Noise::Record), &open, &scales, rule.null),
        Objective::PaperSum => of_paper_sum(data, &raw(Noise::None), &open, &scales, rule.null),
    };
    let mut covariance_z = DMatrix::zeros(p, p);
    for (a, &i) in open.iter().enumerate() {
        for (b, &j) in open.iter().enumerate() {
            covariance_z[(i, j)] = inner[(a, b)] * scales[i] * scales[j];
        }
    }
    if let Some(added) = added {
        covariance_z += added;
    }
    let correlation = correlation(&covariance_z);
    let mut out = Uncertainty {
        estimates: Vec::new(),
        covariance_z,
        correlation,
        singular_values,
        directions,
        free: free.to_vec(),
        scales,
        theta: theta.clone(),
        rule: *rule,
        // The least known noise counts: how a parameter shares its spread among the records is not asked.
        half_width: half_width(data.blocks.iter().map(|b| b.noise.freedom).fold(f64::INFINITY, f64::min)),
    };
    out.estimates = (0..p)
        .map(|k| {
            if fit.at_bound[k] {
                out.bound_estimate(data, fit, &white, &open, k)
            } else {
                out.estimate(k, [1.0; 2])
            }
        })
        .collect();
    Ok(out)
}

/// Scaled covariance of the open parameters where the mesh's own error was not in the weights.
fn of_record(data: &Data, raw: &Whitened, open: &[usize], scales: &[f64], null: f64) -> DMatrix<f64> {
    sandwich(raw, open, scales, null, 1.0, |columns| columns.clone() + numerical(data, raw, columns))
}

/// The same where every point weighed alike.
fn of_paper_sum(data: &Data, raw: &Whitened, open: &[usize], scales: &[f64], null: f64) -> DMatrix<f64> {
    sandwich(raw, open, scales, null, data.mean_sd(), |columns| {
        let times = |k| data.covariance_times(&raw.rows, &columns.column(k).into_owned());
        let all: Vec<_> = (0..columns.ncols()).map(times).collect();
        if all.is_empty() { columns.clone() } else { DMatrix::from_columns(&all) }
    })
}

impl Uncertainty {
    /// Covariance in physical units, p × p.
    pub fn covariance(&self) -> DMatrix<f64> {
        let slope: Vec<f64> = self.free.iter().zip(&self.theta).map(|(f, &x)| f.transform.slope(x)).collect();
        DMatrix::from_fn(slope.len(), slope.len(), |i, j| self.covariance_z[(i, j)] * slope[i] * slope[j])
    }

    pub(crate) fn estimate(&self, k: usize, sides: [f64; 2]) -> Estimate {
        let [below, above] = sides.map(|side| self.half_width * side);
        let (f, value) = (&self.free[k], self.theta[k]);
        let sd_z = self.covariance_z[(k, k)].max(0.0).sqrt();
        let scaled_sd = sd_z / self.scales[k];
        let z = f.forward(value);
        let learned = f.prior.is_none_or(|p| sd_z <= self.rule.prior_shrink * p.sd);
        let std_error = f.transform.slope(value).abs() * sd_z;
        let interval_95 = [f.backward(z - below * sd_z), f.backward(z + above * sd_z)];
        Estimate {
            path: f.path.clone(),
            value,
            std_error: (scaled_sd < 1e3).then_some(std_error),
            interval_95,
            interval_95_if_right: interval_95,
            at_bound: false,
            identifiable: scaled_sd <= self.rule.max_sd && learned,
            scaled_sd,
        }
    }

    /// At a bound a transformed coordinate may have no slope: work in physical units, one-sided, with
    /// the other parameters free.
    fn bound_estimate(&self, data: &Data, fit: &Fit, white: &Whitened, open: &[usize], k: usize) -> Estimate {
        let (f, value) = (&self.free[k], self.theta[k]);
        let column = fit
            .prediction
            .jacobian
            .as_ref()
            .map_or_else(|| DVector::zeros(data.points()), |j| j.column(k).into_owned());
        let column = white.column(&column);
        let others = scaled_columns(&white.jacobian, open, &self.scales);
        let left = residual_after(&others, &column);
        let size = match f.transform {
            Transform::Identity => self.scales[k],
            Transform::Log => value.abs().max(f64::MIN_POSITIVE),
            Transform::Logit { lower, upper } => 0.25 * (upper - lower),
        };
        let sd = if left > 1e-9 * column.norm() && left > 0.0 { 1.0 / left } else { f64::MAX.sqrt() };
        let scaled_sd = (sd / size).min(f64::MAX.sqrt());
        let lower_end = value - f.lower <= f.upper - value;
        let interval_95 = if lower_end {
            [value, (value + self.half_width * sd).min(f.upper)]
        } else {
            [(value - self.half_width * sd).max(f.lower), value]
        };
        Estimate {
            path: f.path.clone(),
            value,
            std_error: (scaled_sd < 1e3).then_some(sd),
            interval_95,
            interval_95_if_right: interval_95,
            at_bound: true,
            identifiable: scaled_sd <= self.rule.max_sd,
            scaled_sd,
        }
    }
}

fn scaled_columns(j: &DMatrix<f64>, open: &[usize], scales: &[f64]) -> DMatrix<f64> {
    let mut scaled = columns(j, open);
    for (row, &k) in open.iter().enumerate() {
        scaled.column_mut(row).scale_mut(scales[k]);
    }
    scaled
}

/// Length of what is left of `column` after projection on the columns of `a`.
fn residual_after(a: &DMatrix<f64>, column: &DVector<f64>) -> f64 {
    if a.ncols() == 0 {
        return column.norm();
    }
    let q = crate::orthonormal(a);
    let left = column - &q * q.tr_mul(column);
    left.norm()
}

/// (JᵀJ)⁻¹ = V s⁻² Vᵀ, singular values kept off zero so that the answer is finite.
fn inverse_gram(s: &[f64], v: &DMatrix<f64>, null: f64) -> DMatrix<f64> {
    let floor = s.first().map_or(1e-6, |&s| (null * s).max(1e-6));
    let inverse = DVector::from_iterator(s.len(), s.iter().map(|&s| 1.0 / s.max(floor).powi(2)));
    v * DMatrix::from_diagonal(&inverse) * v.transpose()
}

/// (JᵀJ)⁻¹ JᵀΣJ (JᵀJ)⁻¹ with the jacobian as the fit weighed it, in natural scales of the open parameters.
/// `spread` is Σ times columns, `sd` the size of its unit.
fn sandwich(
    raw: &Whitened,
    open: &[usize],
    scales: &[f64],
    null: f64,
    sd: f64,
    spread: impl Fn(&DMatrix<f64>) -> DMatrix<f64>,
) -> DMatrix<f64> {
    let j = scaled_columns(&raw.jacobian, open, scales);
    let (s, v) = spectrum(&j);
    let floor = s.first().map_or(1e-6 * sd, |&s| (null * s).max(1e-6 * sd));
    let mut g = &j * &v;
    for (k, &s) in s.iter().enumerate() {
        let factor = if s > floor { 1.0 / (s * s) } else { 0.0 };
        g.column_mut(k).scale_mut(factor);
    }
    let m = raw.rows.len();
    let data_part = g.rows(0, m).into_owned();
    let mut meat = data_part.tr_mul(&spread(&data_part));
    let prior_part = g.rows(m, raw.prior_rows).into_owned();
    meat += prior_part.tr_mul(&prior_part) * (sd * sd);
    for (k, &s) in s.iter().enumerate() {
        if s <= floor {
            meat[(k, k)] = (sd / floor).powi(2);
        }
    }
    &v * meat * v.transpose()
}

/// What the model's numerical error adds to Σ times columns, on the whitened rows of the data.
fn numerical(data: &Data, white: &Whitened, columns: &DMatrix<f64>) -> DMatrix<f64> {
    let mut out = DMatrix::zeros(columns.nrows(), columns.ncols());
    for e in data.nuisance_columns() {
        let w = white.whitener.apply(&e);
        out += &w * columns.tr_mul(&w).transpose();
    }
    out
}

fn correlation(c: &DMatrix<f64>) -> DMatrix<f64> {
    DMatrix::from_fn(c.nrows(), c.ncols(), |i, j| {
        if i == j {
            return 1.0;
        }
        let scale = (c[(i, i)] * c[(j, j)]).sqrt();
        if scale > 0.0 { (c[(i, j)] / scale).clamp(-1.0, 1.0) } else { 0.0 }
    })
}
