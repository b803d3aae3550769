//! The answer of `fct compare`.

use super::{IdentifyAnswer, SCHEMA, TestFit};
use crate::Curve;
use analysis::{AlongTear, DependsOn, Residuals, Where};
use indexmap::IndexMap;
use serde::Serialize;

/// How far an identified model is off, and where.
#[derive(Clone, Debug, Serialize)]
pub struct CompareAnswer {
    /// Layout version.
    pub schema: u32,
    /// Name of the specimen.
    pub specimen: String,
    /// Where the specimen's data come from.
    pub provenance: String,
    /// Effects in the model.
    pub effects: Vec<String>,
    /// Fit of each test's force with its energies, by test, as the run found it.
    pub tests: IndexMap<String, TestFit>,
    /// Fit of the camera channels, by `test.channel`; misfits in mm.
    #[serde(skip_serializing_if = "IndexMap::is_empty")]
    pub channels: IndexMap<String, TestFit>,
    /// χ² per degree of freedom with the record's noise alone.
    pub reduced_chi2: f64,
    /// The same with the model's numerical error.
    pub reduced_chi2_total: f64,
    /// Whether the model explains the records (judged by `reduced_chi2_total`).
    pub explained: bool,
    /// Segments, largest share of χ² first.
    pub r#where: Vec<Where>,
    /// The misfit by the position of the model's tear front, from the cut on.
    pub along_the_tear: Vec<AlongTear>,
    /// What the misfit of each test depends on.
    pub depends_on: Vec<DependsOn>,
    /// The same in words.
    pub words: Vec<String>,
}

impl CompareAnswer {
    /// From an identification and its curves.
    pub fn new(found: &IdentifyAnswer, curves: &[Curve]) -> Self {
        let residuals: Vec<Residuals> = curves.iter().map(Curve::residuals).collect();
        let (depends_on, sentences) = analysis::depends_on(&residuals);
        let mut words = vec![analysis::place_in_words(&residuals)];
        words.extend(sentences);
        Self {
            schema: SCHEMA,
            specimen: found.specimen.clone(),
            provenance: found.provenance.clone(),
            effects: found.effects.clone(),
            tests: found.tests.clone(),
            channels: found.channels.clone(),
            reduced_chi2: found.reduced_chi2,
            reduced_chi2_total: found.reduced_chi2_total,
            explained: found.explained,
            r#where: analysis::places(&residuals),
            along_the_tear: analysis::along_the_tear(&residuals),
            depends_on,
            words,
        }
    }
}
