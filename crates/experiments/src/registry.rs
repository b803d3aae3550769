//! The list of all experiments: one line each.

use crate::{Biaxial, Experiment, Peel180, PureShear, TPeel, Tearing, Uniaxial};
use input::{ExperimentRegistry, TestKind};
use std::sync::Arc;

/// Every experiment this project knows, in the order of the handbook.
pub fn registry() -> Experiments {
    Experiments::default()
        .with(Arc::new(Uniaxial))
        .with(Arc::new(Tearing))
        .with(Arc::new(TPeel))
        .with(Arc::new(Peel180))
        .with(Arc::new(Biaxial))
        .with(Arc::new(PureShear))
}

/// Experiments that can be asked by name.
#[derive(Clone, Default)]
pub struct Experiments(Vec<Arc<dyn Experiment>>);

impl Experiments {
    /// The same with one more.
    pub fn with(mut self, experiment: Arc<dyn Experiment>) -> Self {
        self.0.push(experiment);
        self
    }

    /// The experiment of this name.
    pub fn get(&self, name: &str) -> Option<&Arc<dyn Experiment>> {
        self.0.iter().find(|e| e.card().name == name)
    }

    /// Every experiment.
    pub fn iter(&self) -> impl Iterator<Item = &Arc<dyn Experiment>> {
        self.0.iter()
    }
}

impl ExperimentRegistry for Experiments {
    fn kinds(&self) -> Vec<TestKind> {
        self.0.iter().map(|e| TestKind::new(e.card())).collect()
    }
}
