//! The parts of an identification's answer.

use super::EnergyAnswer;
use serde::{Deserialize, Serialize};

/// One free parameter.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct ParameterAnswer {
    /// `bulk.mu`.
    pub path: String,
    /// Identified value.
    pub value: f64,
    /// Unit; empty for a pure number.
    pub unit: String,
    /// Standard error; null where the records do not fix the parameter at all.
    pub std_error: Option<f64>,
    /// 95 % interval, allowing for what the model leaves unexplained.
    pub interval_95: [Option<f64>; 2],
    /// The same if the model were right: noise and mesh alone.
    #[serde(default)]
    pub interval_95_if_right: [Option<f64>; 2],
    /// Whether it stands at a bound.
    pub at_bound: bool,
    /// Whether the records fix it.
    pub identifiable: bool,
    /// Published value, where there is one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub published: Option<f64>,
    /// Whether `published` is a mean over the area's part of the path, where others had another number of areas: shown,
    /// not compared.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub published_averaged: bool,
    /// Whether the published value lies in the interval.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub published_in_interval: Option<bool>,
}

/// How well one block is reproduced.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct TestFit {
    /// Root mean square misfit, N (mm for a camera channel).
    pub rms_N: f64,
    /// Noise sd, the same unit.
    pub noise_N: f64,
    /// χ² per degree of freedom with the record's noise.
    pub reduced_chi2: f64,
    /// The same with the model's numerical error.
    pub reduced_chi2_total: f64,
    /// The paper's f, sum of squared misfits.
    pub objective: f64,
    /// Points.
    pub points: usize,
    /// Rms of the model's numerical error as estimated on a coarser mesh.
    pub numerical_error_N: f64,
    /// Largest measured value.
    pub peak_N: f64,
    /// Energies of the fitted model at the end of the test.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub energy: Option<EnergyAnswer>,
    /// Toughness by the energy that the record alone shows: a cross-check.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub gc_by_energy: Option<ByEnergy>,
}

/// A toughness without finite elements.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ByEnergy {
    /// Toughness, N/mm.
    pub gc_N_per_mm: f64,
    /// By what balance.
    pub how: String,
}

/// The end of a stage.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct StageEnd {
    /// Stage.
    pub stage: String,
    /// Why it ended.
    pub reason: String,
    /// Whether at an optimum.
    pub converged: bool,
}

/// Runs of one stage on one mesh.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct StageHistory {
    /// Stage.
    pub stage: String,
    /// On the coarse mesh.
    pub coarse: bool,
    /// Parameters of the stage.
    pub paths: Vec<String>,
    /// Its runs.
    pub runs: Vec<Trial>,
}

/// One model run of the search.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Trial {
    /// Step that was tried.
    pub iteration: usize,
    /// Objective; null where the model could not be computed.
    pub f: Option<f64>,
    /// Whether the search went there.
    pub accepted: bool,
    /// Parameters.
    pub theta: Vec<f64>,
}

/// Where published values come from and how they compare.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct PublishedSummary {
    /// Source.
    pub source: String,
    /// Remarks on the printed numbers.
    pub notes: Vec<String>,
    /// Identifiable parameters with a published value.
    pub compared: usize,
    /// Of these, how many have it in their 95 % interval.
    pub inside: usize,
    /// Parameters that are shown a mean over their part of the path, since others had another number of areas.
    #[serde(default)]
    pub averaged: usize,
}

impl PublishedSummary {
    /// How the identified values compare, in sentences.
    pub(crate) fn words(&self) -> String {
        let mut words = Vec::new();
        if self.compared > 0 {
            words.push(format!(
                "{} of {} identifiable parameters have the published value in their 95 % interval.",
                self.inside, self.compared
            ));
        }
        if self.averaged > 0 {
            words.push(
                "The published values are of another number of areas: each area here is shown their mean over its part of the \
                 path (≈), which is not compared with its interval."
                    .to_owned(),
            );
        }
        words.join(" ")
    }
}
