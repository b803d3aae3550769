//! States of the run that help the next step: one visited before is taken over, the last ones of
//! a branch are extrapolated.

use super::{Stepping, Target};
use crate::state::{Guess, State};

/// A visited state that an elastic excursion may come back to.
pub(super) struct Visit {
    pub(super) step: usize,
    pub(super) state: State,
}

/// A state of the present branch.
pub(super) struct Recent {
    pub(super) actuator: f64,
    pub(super) time: f64,
    pub(super) guess: Guess,
}

impl Stepping<'_> {
    /// Takes a state over from an earlier visit in the same elastic excursion: no history changed
    /// since, no law looks at time, the displacement is the same.
    pub(super) fn revisit(&mut self, index: usize, target: &Target) -> bool {
        if !self.reusable || self.options.follow_path {
            return false;
        }
        let same =
            |v: &Visit| (v.state.actuator - target.actuator).abs() <= 1e-12 * target.actuator.abs().max(1.0);
        let Some(at) = self.visits.iter().rposition(same) else { return false };
        let (step, state) = (self.visits[at].step, self.visits[at].state.clone());
        self.train_energy = self.run.steps[step].ledger.rig;
        let before = self.run.steps.last().cloned();
        let time = self.state.time + if target.rest { 0.0 } else { target.dt };
        self.state = state;
        self.state.time = time;
        let mut record = self.run.steps[step].clone();
        record.target = Some(index);
        record.time = time;
        record.iterations = 0;
        record.revisited = true;
        record.after_jump = false;
        if let Some(before) = before {
            // Elastic: the work is the difference of the two states' work.
            record.ledger.released_in_jumps = before.ledger.released_in_jumps;
        }
        if self.options.keep_states {
            self.run.states.push(self.run.states[step].clone());
        }
        if self.options.keep_gradients {
            self.run.gradients.push(self.run.gradients[step].clone());
        }
        self.recent.clear();
        self.run.steps.push(record);
        true
    }

    /// Quadratic (or linear) extrapolation of the last states of the same branch.
    pub(super) fn extrapolate(&self, actuator: f64, dt: f64) -> Option<Guess> {
        if actuator == self.state.actuator {
            return self.creep(dt);
        }
        let n = self.recent.len();
        let weights: Vec<f64> = match n {
            0 | 1 => return None,
            2 => lagrange(&[self.recent[0].actuator, self.recent[1].actuator], actuator),
            _ => lagrange(&[0, 1, 2].map(|i| self.recent[n - 3 + i].actuator), actuator),
        };
        if weights.iter().any(|w| !w.is_finite() || w.abs() > 20.0) {
            return None;
        }
        let used = self.recent[n - weights.len()..].iter().map(|r| &r.guess);
        Guess::combined(&weights.into_iter().zip(used).collect::<Vec<_>>())
    }

    /// What moves on at a held actuator, as fast as in the last step: a tear that stopped at once would lose all the
    /// strength it has by its rate.
    fn creep(&self, dt: f64) -> Option<Guess> {
        let [.., before, last] = &self.recent[..] else { return None };
        let share = (dt / (last.time - before.time)).min(1.0);
        let by_rate = self.problem.path.as_ref().is_some_and(|p| p.law.rate_dependent());
        if !by_rate || !share.is_finite() {
            return None;
        }
        Guess::combined(&[(1.0 + share, &last.guess), (-share, &before.guess)])
    }
}

fn lagrange(x: &[f64], at: f64) -> Vec<f64> {
    (0..x.len())
        .map(|i| (0..x.len()).filter(|&j| j != i).map(|j| (at - x[j]) / (x[i] - x[j])).product())
        .collect()
}
