//! What was computed of models on one record. A search asks for its probabilities after every round, in which few models change.

use super::Gain;
use crate::probable::Left;
use diagnose::Candidate;
use evidence::{Judged, Linear, Record};
use nalgebra::DMatrix;
use std::collections::BTreeMap;

/// Models by their effects, on one record.
#[derive(Default)]
pub(crate) struct Known {
    record: Option<Record>,
    models: BTreeMap<Vec<String>, KnownModel>,
}

/// What was computed of one model, where it was linearised.
pub(crate) struct KnownModel {
    /// The model at its fit.
    pub linear: Linear,
    /// The model at the mode of its posterior, where that is known to be elsewhere, and what its evidence claims too much.
    pub mode: Option<(Linear, f64)>,
    /// ln Z on a few sizes of the rest.
    pub quick: f64,
    /// Mean square that it leaves beyond noise.
    pub excess: f64,
    /// With the integral over the rest; none for what was far behind.
    pub judged: Option<Judged>,
    /// How far the mode is from where that was computed, standard deviations.
    pub moved: f64,
    /// What it leaves, where that was asked.
    pub left: Option<Left>,
    /// What candidates gain: the columns of their shapes, and the gain.
    gains: BTreeMap<String, (Vec<DMatrix<f64>>, Option<Gain>)>,
}

impl KnownModel {
    /// A model of which nothing but its quick value and what it leaves is known.
    pub fn new(quick: f64, excess: f64, linear: Linear) -> Self {
        Self {
            linear,
            mode: None,
            quick,
            excess,
            judged: None,
            moved: 0.0,
            left: None,
            gains: BTreeMap::new(),
        }
    }

    /// Where its evidence is computed.
    pub fn best(&self) -> &Linear {
        self.mode.as_ref().map_or(&self.linear, |m| &m.0)
    }

    /// The gain of a candidate, if it was asked with the same columns.
    pub fn gain(&self, candidate: &Candidate) -> Option<Option<Gain>> {
        let (columns, gain) = self.gains.get(&candidate.effect)?;
        let same = columns.len() == candidate.shapes.len()
            && columns.iter().zip(&candidate.shapes).all(|(a, b)| *a == b.columns);
        same.then_some(*gain)
    }

    /// Notes the gain of a candidate.
    pub fn note_gain(&mut self, candidate: &Candidate, gain: Option<Gain>) {
        let columns = candidate.shapes.iter().map(|s| s.columns.clone()).collect();
        self.gains.insert(candidate.effect.clone(), (columns, gain));
    }
}

impl Known {
    /// Forgets everything if the record is another one: models are compared on the same points only.
    pub fn on(&mut self, record: &Record) {
        if self.record.as_ref() != Some(record) {
            *self = Self { record: Some(record.clone()), models: BTreeMap::new() };
        }
    }

    /// Whether a model is known that was linearised at the same point.
    pub fn holds(&self, effects: &[String], linear: &Linear) -> bool {
        self.models.get(effects).is_some_and(|m| m.linear == *linear)
    }

    /// Notes where a model has its mode: its evidence is that there.
    pub fn at_mode(&mut self, effects: &[String], mode: Option<(Linear, f64)>) {
        self.change(effects, |m| {
            if m.mode != mode {
                (m.mode, m.judged, m.left) = (mode, None, None);
            }
        });
    }

    /// What is known of a model that was weighed.
    pub fn weighed(&self, effects: &[String]) -> Option<&KnownModel> {
        self.models.get(effects)
    }

    /// Adds to what is known of a model.
    pub fn change(&mut self, effects: &[String], by: impl FnOnce(&mut KnownModel)) {
        if let Some(model) = self.models.get_mut(effects) {
            by(model);
        }
    }

    /// Notes a model, in place of what was known of it.
    pub fn note(&mut self, effects: &[String], model: KnownModel) {
        self.models.insert(effects.to_vec(), model);
    }
}
