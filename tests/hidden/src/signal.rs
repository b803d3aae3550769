//! What a record can see of an effect: the change of force that no base parameter imitates, in units of the noise.

use crate::GenerateError;
use crate::forward::{never, slots};
use analysis::{FeProblem, free_parameters, run_options};
use input::Case;
use inverse::{Data, Noise, NoiseModel, Problem, Whitened, orthonormal};
use model::{Catalogue, Channel, Discretisation, Model};
use nalgebra::{DMatrix, DVector};
use std::sync::Arc;

/// Directions of the whitened force records in which base parameters can move them, at the truth, on the mesh of the
/// identification; no priors.
pub struct Visible {
    white: Whitened,
    basis: DMatrix<f64>,
    /// Forces of the base model on the mesh of the identification, tests one after the other.
    pub coarse: Vec<f64>,
}

impl Visible {
    /// Linearises the base model at its true values. `noise` is the true noise of each test: (sd, ar1).
    ///
    /// # Errors
    /// When the model cannot be built or run.
    pub fn new(case: &Case, catalogue: &Catalogue, noise: &[(f64, f64)]) -> Result<Self, GenerateError> {
        let model = Model::new(Arc::new(case.clone()), catalogue, Discretisation::default())?;
        let (theta, free, slots) = (model.theta(), model.free(), slots(case, Channel::Force));
        let problem = FeProblem::new(&model, theta.clone(), free.clone(), &slots, run_options(case), &never);
        let values: Vec<f64> = free.iter().map(|&i| theta[i]).collect();
        let prediction = problem.predict(&values, true)?;
        let parts = slots.iter().zip(noise).map(|(s, &(sd, ar1))| {
            (format!("test {}", s.test), vec![0.0; s.rows.len()], NoiseModel::ar1(sd, ar1))
        });
        let data = Data::from_parts(parts).map_err(|e| GenerateError::Model(e.to_string()))?;
        let list = free_parameters(&model, &theta, &free);
        let white = Whitened::new(&data, &list, &values, &prediction, Noise::Record);
        let rows = white.rows.len();
        let basis = orthonormal(&white.jacobian.rows(0, rows).into_owned());
        Ok(Self { white, basis, coarse: prediction.values.as_slice().to_vec() })
    }

    /// Norm over all points of what is left of a change of force (tests one after the other) when the base
    /// parameters have taken what they can.
    pub fn beyond_base(&self, change: &[f64]) -> f64 {
        let s = self.white.whitener.apply(&DVector::from_column_slice(change));
        (&s - &self.basis * self.basis.tr_mul(&s)).norm()
    }
}
