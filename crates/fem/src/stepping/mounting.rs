//! Mounting in parts: a turned clamp may bend the strip farther than Newton's method finds in one step.

use super::Stepping;
use crate::equilibrium::Control;
use crate::problem::Problem;
use crate::state::Guess;

/// Smallest part of the mounting that is tried, as a share of the whole.
const SMALLEST: f64 = 1.0 / 64.0;

impl Stepping<'_> {
    /// Displacements of nearly the whole mounting, found through smaller ones, each the guess for the next: the history
    /// sees none of them. `None` where there is nothing to divide, or no part has an equilibrium.
    pub(super) fn mounted_in_parts(&mut self) -> Option<Guess> {
        if !self.problem.supports.iter().flatten().any(|s| s.mount != 0.0) {
            return None;
        }
        let mut found: Option<Guess> = None;
        let (mut done, mut part) = (0.0, 0.5);
        while part >= SMALLEST && done + part < 1.0 {
            let partly = mounted_by(self.problem, done + part);
            let mut fresh = self.state.clone();
            if let Some(guess) = found.clone() {
                fresh.start_from(guess);
            }
            let control = Control::Actuator(self.state.actuator);
            if self.newton_of(&partly, self.context(0.0), control, &mut fresh).is_ok() {
                done += part;
                found = Some(fresh.guess());
                // Halfway on to the whole: the attempt at the rest is the caller's.
                part = part.min(0.5 * (1.0 - done));
            } else {
                part *= 0.5;
            }
        }
        found
    }
}

/// The problem with a share of its mounting displacements.
fn mounted_by(problem: &Problem, share: f64) -> Problem {
    let mut partly = problem.clone();
    let mut supports = (*problem.supports).clone();
    for s in supports.iter_mut().flatten() {
        s.mount *= share;
    }
    partly.supports = supports.into();
    partly
}
