//! Mounting in parts: a turned clamp, or an arm that is folded back, may bend the piece farther than Newton's method
//! finds in one step.

use super::Stepping;
use crate::equilibrium::Control;
use crate::problem::Problem;
use crate::state::Guess;

/// Smallest part of the way to the next waypoint that is tried.
const SMALLEST: f64 = 1.0 / 64.0;

impl Stepping<'_> {
    /// Whether a piece is to be mounted by its waypoints: from where it lies, Newton's method must not look for the clamps.
    pub(super) fn mounts_by_waypoints(&self) -> bool {
        !self.problem.waypoints.is_empty()
    }

    /// Displacements of nearly the whole mounting, found through smaller parts of it, each the guess for the next: the
    /// history sees none of them. `None` where there is nothing to divide, or no part has an equilibrium.
    pub(super) fn mounted_in_parts(&mut self) -> Option<Guess> {
        let waypoints = self.problem.waypoints.len();
        if waypoints == 0 && !self.problem.supports.iter().flatten().any(|s| s.mount != 0.0) {
            return None;
        }
        let whole = (waypoints + 1) as f64;
        let mut found: Option<Guess> = None;
        let (mut done, mut part) = (0.0, if waypoints == 0 { 0.5 } else { 1.0 });
        while part >= SMALLEST && done + part < whole {
            let partly = mounted_by(self.problem, done + part);
            let mut fresh = self.state.clone();
            if let Some(guess) = found.clone() {
                fresh.start_from(guess);
            }
            let control = Control::Actuator(self.state.actuator);
            if self.newton_of(&partly, self.context(0.0), control, &mut fresh).is_ok() {
                done += part;
                found = Some(fresh.guess());
                // A whole leg again, but halfway on to the end: the attempt at the rest is the caller's.
                part = if waypoints == 0 { part } else { (2.0 * part).min(1.0) };
                part = part.min(if whole - done > 1.0 { 1.0 } else { 0.5 * (whole - done) });
            } else {
                part *= 0.5;
            }
        }
        found
    }
}

/// The problem at a place on the way of the mounting: whole numbers are its waypoints, 0 the piece as it lies, and the end
/// the supports.
fn mounted_by(problem: &Problem, way: f64) -> Problem {
    let (leg, share) = (way.floor() as usize, way.fract());
    let mut supports = (*problem.supports).clone();
    let end = |leg: usize, dof: usize, last: f64| match (leg, problem.waypoints.get(leg.wrapping_sub(1))) {
        (0, _) => 0.0,
        (_, Some(point)) => point.iter().find(|p| p.0 == dof).map_or(0.0, |p| p.1),
        (_, None) => last,
    };
    for (dof, s) in supports.iter_mut().enumerate() {
        if let Some(s) = s {
            s.mount = (1.0 - share) * end(leg, dof, s.mount) + share * end(leg + 1, dof, s.mount);
        }
    }
    Problem { supports: supports.into(), ..problem.clone() }
}
