//! A model near its fit: misfit, jacobian, beliefs; mode and curvature of its parameters (their integral: `spectrum.rs`).

use crate::record::{EvidenceError, Record, length};
use crate::truncated::Belief;
use inverse::{Free, Prediction};
use nalgebra::{DMatrix, DVector};

/// One parameter of a linearised model.
#[derive(Clone, Debug, PartialEq)]
pub struct Parameter {
    /// Path in answers.
    pub path: String,
    /// Where the linearisation stands, in the coordinate of the parameter's transform.
    pub at: f64,
    /// What is believed of it, in the same coordinate.
    pub belief: Belief,
    /// Whether it is the amplitude of an effect: sensitivity doubles and halves the spread of these.
    pub amplitude: bool,
}

/// A model linearised at a fit: y ≈ f(at) + H (z − at), misfit r = y − f(at).
#[derive(Clone, Debug, PartialEq)]
pub struct Linear {
    /// Misfit r of every point, full length n, units of the record.
    pub misfit: DVector<f64>,
    /// H, n × p, by the transformed coordinates.
    pub jacobian: DMatrix<f64>,
    /// The parameters in the order of the columns.
    pub parameters: Vec<Parameter>,
    /// Where the model jumps, by how much, units of the record; 0 elsewhere, empty where it nowhere does. At which of these points
    /// it jumps is not known, and by derivatives it is not asked.
    pub jumps: Vec<f64>,
}

impl Linear {
    /// A fit: `theta` in physical units, the prediction with its jacobian there, one belief per free parameter,
    /// and which of them are amplitudes of effects.
    ///
    /// # Errors
    /// [`EvidenceError::Length`] when the parts disagree or the prediction has no jacobian.
    pub fn at_fit(
        measured: &DVector<f64>,
        free: &[Free],
        theta: &[f64],
        prediction: &Prediction,
        beliefs: &[(Belief, bool)],
    ) -> Result<Self, EvidenceError> {
        let p = free.len();
        length("values of parameters", theta.len(), p)?;
        length("beliefs", beliefs.len(), p)?;
        length("prediction", prediction.values.len(), measured.len())?;
        let raw = prediction.jacobian.as_ref();
        length("columns of the jacobian", raw.map_or(0, DMatrix::ncols), p)?;
        let mut jacobian = raw.cloned().unwrap_or_else(|| DMatrix::zeros(measured.len(), p));
        let mut parameters = Vec::new();
        for (k, f) in free.iter().enumerate() {
            jacobian.column_mut(k).scale_mut(f.transform.slope(theta[k]));
            let (belief, amplitude) = beliefs[k];
            parameters.push(Parameter { path: f.path.clone(), at: f.forward(theta[k]), belief, amplitude });
        }
        let jumps = jumps(prediction);
        for (i, _) in jumps.iter().enumerate().filter(|j| *j.1 > 0.0) {
            jacobian.row_mut(i).fill(0.0);
        }
        Ok(Self { misfit: measured - &prediction.values, jacobian, parameters, jumps })
    }

    /// The same with further parameters whose columns stand at the same point: a superset without a fit of its own.
    ///
    /// # Errors
    /// [`EvidenceError::Length`] when the columns do not fit.
    pub fn with(&self, parameters: &[Parameter], columns: &DMatrix<f64>) -> Result<Self, EvidenceError> {
        length("rows of further columns", columns.nrows(), self.jacobian.nrows())?;
        length("further columns", columns.ncols(), parameters.len())?;
        let p = self.jacobian.ncols();
        let mut out = self.clone();
        out.jacobian = out.jacobian.insert_columns(p, columns.ncols(), 0.0);
        out.jacobian.columns_mut(p, columns.ncols()).copy_from(columns);
        out.parameters.extend_from_slice(parameters);
        Ok(out)
    }

    /// Checks shapes and numbers against a record.
    pub(crate) fn check(&self, record: &Record) -> Result<(), EvidenceError> {
        length("misfit", self.misfit.len(), record.full)?;
        length("rows of the jacobian", self.jacobian.nrows(), record.full)?;
        length("columns of the jacobian", self.jacobian.ncols(), self.parameters.len())?;
        if !self.jumps.is_empty() {
            length("jumps", self.jumps.len(), record.full)?;
        }
        let finite = self.misfit.iter().chain(self.jacobian.iter()).chain(&self.jumps).all(|x| x.is_finite());
        let bad = |what: &str, value| EvidenceError::Value {
            what: what.into(),
            value,
            expected: "a finite number",
        };
        if !finite {
            return Err(bad("a number of the misfit, jacobian or jumps", f64::NAN));
        }
        for p in &self.parameters {
            let b = &p.belief;
            if !(b.sd > 0.0
                && b.sd.is_finite()
                && b.mean.is_finite()
                && b.lower < b.upper
                && p.at.is_finite())
            {
                return Err(EvidenceError::Value {
                    what: format!("belief of {}", p.path),
                    value: b.sd,
                    expected: "a finite mean, a positive sd, bounds in order",
                });
            }
        }
        Ok(())
    }
}

/// By how much a prediction changes over each stretch of points that are not smooth, the points beside it among them.
fn jumps(prediction: &Prediction) -> Vec<f64> {
    let Some(valid) = prediction.valid.as_ref().filter(|v| v.contains(&false)) else { return Vec::new() };
    let mut out = vec![0.0; valid.len()];
    let mut from = 0;
    for stretch in valid.chunk_by(|a, b| a == b) {
        let to = from + stretch.len();
        if !stretch[0] {
            let around = prediction.values.rows_range(from.saturating_sub(1)..(to + 1).min(valid.len()));
            out[from..to].fill(around.max() - around.min());
        }
        from = to;
    }
    out
}

/// A model as one covariance weighs it: |L⁻¹(r − H x − E a)|² = (x, a, −1)ᵀ S (x, a, −1).
#[derive(Clone, Debug)]
pub(crate) struct Reduced {
    /// S = XᵀC⁻¹X with X = [H | E | r]: q + 1 rows and columns.
    pub square: DMatrix<f64>,
    pub ln_det: f64,
    pub points: f64,
}

/// Mode and curvature of all parameters at one covariance.
#[derive(Clone, Debug)]
pub(crate) struct Solved {
    /// From the point of linearisation to the mode, bounds left out of account.
    pub step: DVector<f64>,
    /// Upper triangle T with TᵀT = A.
    pub root: DMatrix<f64>,
}

/// ln 2π.
pub(crate) const LN_TAU: f64 = 1.837_877_066_409_345_3;

impl Reduced {
    /// Mode and curvature; noise and beliefs as they are, mesh factors a ~ N(0, `mesh`²). In shares of the peak.
    pub fn solve(&self, parameters: &[Parameter], mesh: f64) -> Solved {
        let q = self.square.ncols() - 1;
        let mut a = DMatrix::zeros(2 * q, q + 1);
        a.rows_mut(0, q).copy_from(&self.factor());
        for k in 0..q {
            let (mean, sd) = parameters.get(k).map_or((0.0, mesh), |x| (x.belief.mean - x.at, x.belief.sd));
            a[(q + k, k)] = 1.0 / sd;
            a[(q + k, q)] = mean / sd;
        }
        let t = a.qr().r();
        let root = t.view((0, 0), (q, q)).into_owned();
        let rhs: DVector<f64> = t.view((0, q), (q, 1)).column(0).into_owned();
        let step = root.solve_upper_triangular(&rhs).unwrap_or_else(|| DVector::zeros(q));
        Solved { step, root }
    }

    /// F of q rows and q + 1 columns with FᵀF = S but for what no parameter takes from r². Directions in which rounding is all that S
    /// knows are left out.
    fn factor(&self) -> DMatrix<f64> {
        let q = self.square.ncols() - 1;
        let size = DVector::from_fn(q, |k, _| self.square[(k, k)].max(f64::MIN_POSITIVE).sqrt());
        let even = DMatrix::from_fn(q, q, |i, j| self.square[(i, j)] / (size[i] * size[j]));
        let (squares, axes) = told_apart(even);
        let pull = DVector::from_fn(q, |k, _| self.square[(k, q)] / size[k]);
        let mut out = DMatrix::zeros(q, q + 1);
        for (i, s) in squares.iter().enumerate().filter(|s| *s.1 > 0.0) {
            for k in 0..q {
                out[(i, k)] = s.sqrt() * axes[(k, i)] * size[k];
            }
            out[(i, q)] = axes.column(i).dot(&pull) / s.sqrt();
        }
        out
    }
}

/// Eigenvalues and eigenvectors of a symmetric matrix; 0 for those in which rounding is all that it knows.
pub(crate) fn told_apart(a: DMatrix<f64>) -> (DVector<f64>, DMatrix<f64>) {
    if a.is_empty() {
        return (DVector::zeros(0), DMatrix::zeros(0, 0));
    }
    let rounding = 4.0 * a.nrows() as f64 * f64::EPSILON;
    let parts = a.symmetric_eigen();
    let least = rounding * parts.eigenvalues.max();
    (parts.eigenvalues.map(|s| if s > least { s } else { 0.0 }), parts.eigenvectors)
}

impl Solved {
    /// (TᵀT)⁻¹.
    pub fn covariance(&self) -> DMatrix<f64> {
        let q = self.root.ncols();
        let inverse = self.root.solve_upper_triangular(&DMatrix::identity(q, q));
        inverse.map_or_else(|| DMatrix::zeros(q, q), |i| &i * i.transpose())
    }

    /// The step to the mode within the bounds: what violates its bound most is put on it, until nothing does.
    pub fn bounded_step(&self, parameters: &[Parameter]) -> DVector<f64> {
        let covariance = self.covariance();
        let mut step = self.step.clone();
        let mut fixed: Vec<usize> = Vec::new();
        for _ in 0..parameters.len() {
            let over = |k: usize| {
                let p = &parameters[k];
                let x = p.at + step[k];
                (p.belief.lower - x).max(x - p.belief.upper) / covariance[(k, k)].sqrt().max(1e-300)
            };
            let free = (0..parameters.len()).filter(|k| !fixed.contains(k));
            let worst = free.max_by(|&i, &j| over(i).total_cmp(&over(j)));
            match worst.filter(|&k| over(k) > 1e-9) {
                Some(k) => fixed.push(k),
                None => break,
            }
            // Conditional mean of the others with these on their bounds.
            let c = DMatrix::from_fn(fixed.len(), fixed.len(), |i, j| covariance[(fixed[i], fixed[j])]);
            let d = DVector::from_fn(fixed.len(), |i, _| {
                let (p, x) = (&parameters[fixed[i]], self.step[fixed[i]]);
                (p.at + x).clamp(p.belief.lower, p.belief.upper) - p.at - x
            });
            let Some(weights) = c.cholesky().map(|c| c.solve(&d)) else { break };
            step = self.step.clone();
            for (i, &k) in fixed.iter().enumerate() {
                step += covariance.column(k) * weights[i];
            }
        }
        step
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_jump_is_as_large_as_what_changes_across_it() {
        let jumps_of = |values: &[f64], valid: &[bool]| {
            let values = DVector::from_row_slice(values);
            jumps(&Prediction { values, jacobian: None, valid: Some(valid.to_vec()) })
        };
        let values = [5.0, 4.0, 3.0, 1.0, 0.5, 0.25];
        assert_eq!(
            jumps_of(&values, &[true, true, false, false, true, true]),
            [0.0, 0.0, 3.5, 3.5, 0.0, 0.0]
        );
        // At either end there is a point on one side alone.
        assert_eq!(
            jumps_of(&values, &[false, true, true, true, true, false]),
            [1.0, 0.0, 0.0, 0.0, 0.0, 0.25]
        );
        assert!(jumps_of(&values, &[true; 6]).is_empty());
    }
}
