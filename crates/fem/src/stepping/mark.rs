//! A point of a run to go back to, when a walk along the path ends nowhere.

use super::Stepping;
use crate::state::State;

/// Where a run stood.
pub(crate) struct Mark {
    state: State,
    steps: usize,
    states: usize,
    gradients: usize,
    train_energy: f64,
    floors: [f64; 2],
}

impl Stepping<'_> {
    /// Remembers this point of the run.
    pub(crate) fn mark(&mut self) -> Mark {
        for c in &mut self.columns {
            c.save();
        }
        Mark {
            state: self.state.clone(),
            steps: self.run.steps.len(),
            states: self.run.states.len(),
            gradients: self.run.gradients.len(),
            train_energy: self.train_energy,
            floors: [self.force_floor, self.largest_force],
        }
    }

    /// Goes back to a point of the run; what it cost stays counted.
    pub(crate) fn back_to(&mut self, mark: Mark) {
        for c in &mut self.columns {
            c.restore();
        }
        self.state = mark.state;
        self.train_energy = mark.train_energy;
        [self.force_floor, self.largest_force] = mark.floors;
        self.run.steps.truncate(mark.steps);
        self.run.states.truncate(mark.states);
        self.run.gradients.truncate(mark.gradients);
        self.forget();
    }

    /// Forgets the states that might have helped the next step.
    pub(crate) fn forget(&mut self) {
        self.visits.clear();
        self.recent.clear();
    }
}
