//! The rungs of a ladder of models, and what makes one better than another.

use crate::ratio::ratio;
use crate::{Finding, Policy, Screen};
use inverse::Quality;
use serde::Serialize;
use std::collections::BTreeMap;
use std::fmt::Display;

/// A fitted model: the base with a set of effects.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Rung {
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
pub const LEANS: f64 = 2.0;

impl Rung {
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

    /// Whether only the model's numerical error, not the record's noise, makes the misfit small.
    pub fn leans_on_the_mesh(&self) -> bool {
        self.reduced_chi2 > LEANS
    }

    /// Least fall of χ² that makes an effect worth adding: more than BIC asks for where χ² is small already.
    pub fn least_fall(&self, policy: &Policy) -> f64 {
        match (self.reduced_chi2_total() <= self.largest_explained(policy), self.leans_on_the_mesh()) {
            (false, _) => 0.0,
            (true, false) => policy.min_fall_explained,
            (true, true) => policy.min_fall_leaning,
        }
    }

    /// χ² above what noise alone would leave.
    pub fn excess(&self) -> f64 {
        (self.chi2_total - self.freedom).max(0.0)
    }

    /// Whether `after` takes this share of what noise alone would not leave; of the record's noise, or with the
    /// model's numerical error, which a misfit of its shape may hide behind.
    pub(crate) fn loses(&self, after: &Self, share: f64) -> bool {
        let raw = |r: &Self| r.reduced_chi2 * r.freedom;
        self.chi2_total - after.chi2_total >= share * self.excess()
            || raw(self) - raw(after) >= share * (raw(self) - self.freedom).max(0.0)
    }
}

/// Whether `after`, which has more effects than `before`, pays for them: BIC falls by `add_bic`, a fair share of
/// the excess goes, and the held-out points are not predicted worse than their sampling spread allows. Where only the
/// mesh's error explains `before`, an effect must not lean on it more: the misfit to the record itself does not rise.
pub fn pays(before: &Rung, after: &Rung, policy: &Policy) -> bool {
    let gain = before.chi2_total - after.chi2_total;
    before.bic - after.bic >= policy.add_bic
        && gain >= policy.min_share * before.excess()
        && gain >= before.least_fall(policy)
        && !(before.explained(policy)
            && before.leans_on_the_mesh()
            && after.reduced_chi2 > before.reduced_chi2)
        && !held_out_worse(before, after, policy)
}

fn held_out_worse(before: &Rung, after: &Rung, policy: &Policy) -> bool {
    let (Some(x), Some(y)) = (before.held_out_chi2, after.held_out_chi2) else { return false };
    let points = after.held_out_points.max(1) as f64;
    y > x * (1.0 - policy.held_out_fall) + 2.0 * (2.0 / points).sqrt()
}

/// Start values for effects, from the screen that proposed them.
pub type Hints = BTreeMap<String, Finding>;

/// A model that can be fitted with any set of effects, and screened. Plugged in by the caller; this crate knows
/// no mechanics.
pub trait Ladder {
    /// Why a fit or screen failed.
    type Error: Display;

    /// Fits the base model with `effects`. `hints` holds the latest finding of each effect as start values.
    ///
    /// # Errors
    /// When the model cannot be fitted; the search then goes on without this set.
    fn fit(&mut self, effects: &[String], hints: &Hints) -> Result<Rung, Self::Error>;

    /// Fits several sets, none of which is a start for another; side by side where the model can. The answers
    /// stand in the order of `sets`.
    fn fit_all(&mut self, sets: &[Vec<String>], hints: &Hints) -> Vec<Result<Rung, Self::Error>> {
        sets.iter().map(|effects| self.fit(effects, hints)).collect()
    }

    /// Screens the catalogue at a fitted model; effects already in it are ignored.
    ///
    /// # Errors
    /// When the screen cannot be computed; the search then ends there.
    fn screen(&mut self, rung: &Rung) -> Result<Screen, Self::Error>;

    /// Whether these effects may stand together.
    fn compatible(&self, _effects: &[String]) -> bool {
        true
    }

    /// Effects that only something which the records do not hold would tell from `effect` (a pause or a second rate, for
    /// effects of time): a better fit says no more than that one law's form is nearer than the other's.
    fn untold(&self, _effect: &str) -> Vec<String> {
        Vec::new()
    }

    /// Whether the user asked to stop; the search then ends with what it has.
    fn interrupted(&self) -> bool {
        false
    }
}

/// Weights of models from an information criterion (Burnham & Anderson 2002): exp(−Δ/2), summing to 1.
pub fn weights(criterion: &[f64]) -> Vec<f64> {
    let best = criterion.iter().copied().fold(f64::INFINITY, f64::min);
    let raw: Vec<f64> = criterion.iter().map(|c| (-0.5 * (c - best)).exp()).collect();
    let sum: f64 = raw.iter().sum();
    raw.iter().map(|w| ratio(*w, sum)).collect()
}
