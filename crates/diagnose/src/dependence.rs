//! What the misfit depends on, catalogue or not: an additive model of explanatory variables, each as a small
//! spline (or one level per value when it takes few), and what each explains beyond the others.

use crate::atlas::autocorrelation;
use crate::ratio::ratio;
use crate::tails::f_sf;
use inverse::orthonormal;
use nalgebra::{DMatrix, DVector};
use serde::Serialize;

/// Interior knots of a variable's spline.
const KNOTS: usize = 4;

/// An explanatory variable, one value per point of the record.
#[derive(Clone, Debug, PartialEq)]
pub struct Variable {
    /// Name in answers: `time since the last turn`.
    pub name: String,
    /// Values.
    pub values: Vec<f64>,
}

impl Variable {
    /// A named variable.
    pub fn new(name: &str, values: Vec<f64>) -> Self {
        Self { name: name.to_owned(), values }
    }
}

/// What one variable explains of the misfit.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Dependence {
    /// Name of the variable.
    pub variable: String,
    /// Share of the misfit's sum of squares that it explains by itself.
    pub share_alone: f64,
    /// Share that it explains beyond all the others.
    pub share_beyond: f64,
    /// p-value of the latter (F test with the number of independent points that the autocorrelation of what
    /// is left allows).
    pub p_value: f64,
}

/// Variables made from a protocol: displacement, rate, time since the last turn, clock time, largest displacement
/// so far, cycle number, force. `turns` are the indices where a new stretch begins.
pub fn protocol_variables(t: &[f64], u: &[f64], force: &[f64], turns: &[usize]) -> Vec<Variable> {
    let n = t.len().min(u.len()).min(force.len());
    let mut largest = Vec::with_capacity(n);
    let mut since = Vec::with_capacity(n);
    let mut cycle = Vec::with_capacity(n);
    let mut rate = Vec::with_capacity(n);
    let (mut top, mut last, mut count, mut falling) = (f64::MIN, 0.0, 0.0, false);
    for i in 0..n {
        top = top.max(u[i]);
        if i == 0 || turns.contains(&i) {
            last = t[i.saturating_sub(1)];
        }
        let (a, b) = (i.saturating_sub(2), (i + 2).min(n - 1));
        let v = ratio(u[b] - u[a], t[b] - t[a]);
        let step = turns.contains(&i);
        if step && v < 0.0 && !falling {
            falling = true;
        } else if step && v > 0.0 && falling {
            falling = false;
            count += 1.0;
        }
        largest.push(top);
        since.push(t[i] - last);
        cycle.push(count);
        rate.push(v);
    }
    vec![
        Variable::new("displacement", u[..n].to_vec()),
        Variable::new("rate", rate),
        Variable::new("time since the last turn", since),
        Variable::new("clock time", t[..n].to_vec()),
        Variable::new("largest displacement so far", largest),
        Variable::new("cycle number", cycle),
        Variable::new("force", force[..n].to_vec()),
    ]
}

/// What each variable explains of `misfit`, most first. Variables of another length, or without variation, or
/// with numbers that are not finite, explain nothing.
pub fn dependence(misfit: &[f64], variables: &[Variable]) -> Vec<Dependence> {
    let n = misfit.len();
    let r = DVector::from_column_slice(misfit);
    let total = r.norm_squared();
    if n == 0 || total <= 0.0 {
        return variables.iter().map(|v| nothing(&v.name)).collect();
    }
    let usable = |v: &Variable| v.values.len() == n && v.values.iter().all(|x| x.is_finite());
    let blocks: Vec<DMatrix<f64>> =
        variables.iter().map(|v| if usable(v) { basis(&v.values) } else { DMatrix::zeros(n, 0) }).collect();
    let constant = DMatrix::from_element(n, 1, 1.0);
    let fitted = |skip: Option<usize>, only: Option<usize>| -> (f64, usize, DVector<f64>) {
        let mut columns: Vec<DVector<f64>> = constant.column_iter().map(|c| c.into_owned()).collect();
        for (k, b) in blocks.iter().enumerate() {
            if skip != Some(k) && only.is_none_or(|o| o == k) {
                columns.extend(b.column_iter().map(|c| c.into_owned()));
            }
        }
        let q = orthonormal(&DMatrix::from_columns(&columns));
        let left = &r - &q * q.tr_mul(&r);
        (left.norm_squared(), q.ncols(), left)
    };
    let (full, rank, left) = fitted(None, None);
    let rho = autocorrelation(left.as_slice()).clamp(0.0, 0.95);
    let effective = n as f64 * (1.0 - rho) / (1.0 + rho);
    let mut out: Vec<Dependence> = (0..variables.len())
        .map(|k| {
            if blocks[k].ncols() == 0 {
                return nothing(&variables[k].name);
            }
            let (without, less, _) = fitted(Some(k), None);
            let (alone, _, _) = fitted(None, Some(k));
            let (a, b) = ((rank - less) as f64, effective - rank as f64);
            let gain = (without - full).max(0.0);
            let p_value =
                if a > 0.0 && b > 1.0 { f_sf((gain / a) / (full / b).max(1e-300), a, b) } else { 1.0 };
            Dependence {
                variable: variables[k].name.clone(),
                share_alone: ((total - alone) / total).clamp(0.0, 1.0),
                share_beyond: (gain / total).clamp(0.0, 1.0),
                p_value,
            }
        })
        .collect();
    out.sort_by(|x, y| y.share_beyond.total_cmp(&x.share_beyond).then(x.variable.cmp(&y.variable)));
    out
}

fn nothing(name: &str) -> Dependence {
    Dependence { variable: name.to_owned(), share_alone: 0.0, share_beyond: 0.0, p_value: 1.0 }
}

/// One column per level for few values; else a linear spline with knots at quantiles.
fn basis(x: &[f64]) -> DMatrix<f64> {
    let mut levels = x.to_vec();
    levels.sort_by(f64::total_cmp);
    levels.dedup_by(|a, b| (*a - *b).abs() <= 1e-9 * b.abs().max(1e-300));
    if levels.len() < 2 {
        return DMatrix::zeros(x.len(), 0);
    }
    if levels.len() <= KNOTS + 2 {
        return DMatrix::from_fn(x.len(), levels.len(), |i, k| {
            f64::from(u8::from((x[i] - levels[k]).abs() <= 1e-9 * levels[k].abs().max(1e-300)))
        });
    }
    let (low, high) = (levels[0], levels[levels.len() - 1]);
    let scaled: Vec<f64> = x.iter().map(|v| (v - low) / (high - low)).collect();
    let mut sorted = scaled.clone();
    sorted.sort_by(f64::total_cmp);
    let knot = |k: usize| sorted[k * (sorted.len() - 1) / (KNOTS + 1)];
    DMatrix::from_fn(
        x.len(),
        KNOTS + 1,
        |i, k| if k == 0 { scaled[i] } else { (scaled[i] - knot(k)).max(0.0) },
    )
}
