//! The rungs of a ladder of models, and what makes one better than another.

use crate::ratio::ratio;
use crate::{Finding, Policy};
use inverse::Quality;
use serde::Serialize;
use std::collections::BTreeMap;

/// A fitted model: the base with a set of effects.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FittedModel {
    /// Effects, in the order of the search.
    pub effects: Vec<String>,
    /// Free parameters.
    pub parameters: usize,
    /// Points that were fitted.
    pub points: usize,
    /// Root mean square misfit over all force points.
    pub rms: f64,
    /// Reduced χ² with the record's noise alone.
    pub reduced_chi2: f64,
    /// χ², numerical error included.
    pub chi2_total: f64,
    /// Degrees of freedom left for `chi2_total`.
    pub freedom: f64,
    /// Bayesian information criterion on `chi2_total`.
    pub bic: f64,
    /// Akaike's, corrected.
    pub aicc: f64,
    /// Reduced χ² of points that the fit behind it did not see.
    pub held_out_chi2: Option<f64>,
    /// Number of those points.
    pub held_out_points: usize,
    /// Root mean square misfit there.
    pub held_out_rms: Option<f64>,
    /// p-value of left-over structure ([`crate::atlas::structure_p`] of the whitened misfit); 1 if not computed.
    pub structure_p: f64,
}

/// A larger reduced χ² with the record's noise alone leans on the model's numerical error to be explained.
pub const MESH_ERROR_ONLY: f64 = 2.0;

impl FittedModel {
    /// A rung from a fit's quality. `rms` is over all force points; `structure_p` as
    /// [`crate::atlas::structure_p`] gives it. Nothing is held out yet.
    pub fn new(effects: &[String], quality: &Quality, rms: f64, structure_p: f64) -> Self {
        Self {
            effects: effects.to_vec(),
            parameters: quality.parameters,
            points: quality.points,
            rms,
            reduced_chi2: quality.reduced_chi2,
            chi2_total: quality.chi2_total,
            freedom: quality.freedom,
            bic: quality.bic,
            aicc: quality.aicc,
            held_out_chi2: None,
            held_out_points: 0,
            held_out_rms: None,
            structure_p,
        }
    }

    /// The same with what the fit behind it did not see: reduced χ², number of points and rms there.
    pub fn held_out(mut self, chi2: f64, points: usize, rms: f64) -> Self {
        (self.held_out_chi2, self.held_out_points, self.held_out_rms) = (Some(chi2), points, Some(rms));
        self
    }

    /// Reduced χ², numerical error included.
    pub fn reduced_chi2_total(&self) -> f64 {
        self.chi2_total / self.freedom.max(1.0)
    }

    /// Whether the misfit is at the noise floor.
    pub fn explained(&self, policy: &Policy) -> bool {
        self.reduced_chi2_total() <= self.largest_explained(policy) && self.structure_p >= policy.structure_p
    }

    /// Largest reduced χ² that noise and its uncertain level explain.
    fn largest_explained(&self, policy: &Policy) -> f64 {
        let spread = policy.explained_sigmas * (2.0 / self.freedom.max(1.0)).sqrt();
        policy.explained_chi2.max(1.0 + spread)
    }
}

/// Start values for effects, from the screen that proposed them.
pub type Hints = BTreeMap<String, Finding>;

/// Weights of models from an information criterion (Burnham & Anderson 2002): exp(−Δ/2), summing to 1.
pub fn weights(criterion: &[f64]) -> Vec<f64> {
    let best = criterion.iter().copied().fold(f64::INFINITY, f64::min);
    let raw: Vec<f64> = criterion.iter().map(|c| (-0.5 * (c - best)).exp()).collect();
    let sum: f64 = raw.iter().sum();
    raw.iter().map(|w| ratio(*w, sum)).collect()
}
