//! What the file's mesh says more than a coarser one, to first order in the parameters.

use inverse::{Free, Prediction};
use model::Model;
use nalgebra::{DMatrix, DVector};
use params::Transform;

/// Difference of two meshes at an anchor: the values, and the derivatives by the transformed coordinates. A fit on the
/// coarser mesh with it has the finer one's gradient at the anchor (manifold mapping: [`inverse::Mapped`]).
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Correction {
    /// Finer less coarser at the anchor, per point; of zero length: nothing.
    pub shift: DVector<f64>,
    slopes: Vec<Slope>,
}

#[derive(Clone, Debug, PartialEq)]
struct Slope {
    path: String,
    transform: Transform,
    /// Coordinate of the anchor.
    at: f64,
    column: DVector<f64>,
}

impl Correction {
    /// The same difference everywhere.
    pub fn constant(shift: DVector<f64>) -> Self {
        Self { shift, slopes: Vec::new() }
    }

    /// From the predictions of both meshes at θ with their jacobians. Points at which one of them jumps get no slope.
    pub fn first_order(free: &[Free], theta: &[f64], finer: &Prediction, coarser: &Prediction) -> Self {
        let smooth = |i: usize| {
            let of = |p: &Prediction| p.valid.as_ref().is_none_or(|v| v.get(i).copied().unwrap_or(true));
            of(finer) && of(coarser)
        };
        let shift = &finer.values - &coarser.values;
        let (Some(f), Some(c)) = (&finer.jacobian, &coarser.jacobian) else { return Self::constant(shift) };
        let one = |(k, p): (usize, &Free)| {
            let by_z = p.transform.slope(theta[k]);
            let entry = |i: usize, _| if smooth(i) { (f[(i, k)] - c[(i, k)]) * by_z } else { 0.0 };
            Slope {
                path: p.path.clone(),
                transform: p.transform,
                at: p.forward(theta[k]),
                column: DVector::from_fn(shift.len(), entry),
            }
        };
        let slopes = free.iter().enumerate().map(one).collect();
        Self { shift, slopes }
    }

    /// Adds the difference to what the coarser mesh predicts at `theta` (all values of `model`); `columns` are the
    /// parameters of the jacobian.
    pub fn apply(
        &self,
        model: &Model,
        theta: &[f64],
        columns: &[usize],
        values: &mut DVector<f64>,
        jacobian: Option<&mut DMatrix<f64>>,
    ) {
        if self.shift.len() != values.len() {
            return;
        }
        *values += &self.shift;
        let mut jacobian = jacobian;
        for s in &self.slopes {
            let Some(i) = model.find(&s.path) else { continue };
            values.axpy(s.transform.forward(theta[i]) - s.at, &s.column, 1.0);
            let by_z = s.transform.slope(theta[i]);
            if let (Some(j), Some(k)) = (jacobian.as_deref_mut(), columns.iter().position(|&c| c == i))
                && by_z != 0.0
            {
                j.column_mut(k).axpy(1.0 / by_z, &s.column, 1.0);
            }
        }
    }
}
