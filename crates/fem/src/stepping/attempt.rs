//! One Newton solution from the last state, and what it must pass to be a step.

use super::Stepping;
use crate::equilibrium::{Border, Control, take_up, train_elongation};
use crate::error::FemError;
use crate::newton::{Converged, NewtonOptions, Step};
use crate::problem::{Prescribed, Problem};
use crate::state::{Guess, State};
use constitutive::Context;

/// Out-of-balance force at which a tangent gives the slope for the next guess and the check of a step, where no
/// derivative and no energy hangs on it.
const ROUGHLY: f64 = 1e-3;

impl Stepping<'_> {
    /// One Newton solution at a held actuator, with the checks that a step must pass.
    pub(super) fn attempt(
        &mut self,
        actuator: f64,
        dt: f64,
        clock: f64,
        guess: Option<Guess>,
    ) -> Result<(Border, usize, State), FemError> {
        let mut fresh = self.state.clone();
        fresh.actuator = actuator;
        let guessed = guess.is_some();
        if let Some(guess) = guess.or_else(|| self.extrapolate(actuator, dt)) {
            fresh.grip = self.grip_of(&guess.u, actuator);
            fresh.start_from(guess);
        }
        let moved = fresh.u != self.state.u;
        let ctx = Context { time: self.state.time + clock * dt, ..self.context(dt) };
        let solved = self.newton(ctx, Control::Actuator(actuator), &mut fresh);
        let mut converged = match solved {
            Ok(c) => c,
            // A bad guess is no reason to cut the step: once more from the last state.
            Err(_) if (moved || guessed) && !(self.run.steps.is_empty() && self.mounts_by_waypoints()) => {
                fresh = self.state.clone();
                self.newton(ctx, Control::Actuator(actuator), &mut fresh)?
            }
            Err(e) => return Err(e),
        };
        let border = converged.border(self.system, self.problem.multiplicity)?;
        self.check(&fresh, &border)?;
        Ok((border, converged.iterations, fresh))
    }

    /// Where the grip stands in a guess: with the actuator, or behind a load train where the guess itself has the
    /// clamped faces. Elsewhere the clamps would tear at the elements beside them.
    fn grip_of(&self, u: &[f64], actuator: f64) -> f64 {
        let (old, mut scratch) = (&self.state.history.train, self.state.history.train.clone());
        let rigid = take_up(self.problem, &self.local.takeup, (actuator, None), old, &mut scratch).0;
        if self.problem.train.is_empty() {
            return rigid;
        }
        let pulled = |(s, u): (&Option<Prescribed>, &f64)| {
            s.as_ref().filter(|p| p.grip != 0.0).map(|p| (u - p.mount) / p.grip)
        };
        self.problem.supports.iter().zip(u).find_map(pulled).unwrap_or(rigid)
    }

    /// Stability, and no unexplained change of force.
    fn check(&self, fresh: &State, border: &Border) -> Result<(), FemError> {
        let unstable = |reason: &str| FemError::NoConvergence {
            displacement: fresh.actuator,
            step: 0.0,
            reason: reason.into(),
        };
        if self.problem.path.is_some() && self.system.factor.negative_pivots() > 0 {
            return Err(unstable("the equilibrium found is unstable"));
        }
        // In a hold the force relaxes by itself: no jump.
        let moved = self.run.steps.last().filter(|s| s.actuator != fresh.actuator);
        if let (Some(before), true) = (moved, self.problem.path.is_some()) {
            let slope = self.actuator_slope(border, fresh);
            let step = fresh.actuator - before.actuator;
            let expected = 0.5 * (slope + before.slope) * step;
            let surprise = expected - (fresh.force - before.force);
            // A jump sheds force; a surprise in the toe of the curve is only curvature.
            let sheds = fresh.force < before.force;
            if sheds && surprise.abs() > self.options.continuity * self.largest_force {
                return Err(unstable("the force changes discontinuously"));
            }
        }
        Ok(())
    }

    /// dF/du_actuator at a converged state.
    pub(super) fn actuator_slope(&self, border: &Border, state: &State) -> f64 {
        let mut scratch = self.state.history.train.clone();
        let ctx = self.context(1.0);
        let (_, e_slope) = train_elongation(
            self.problem,
            &self.local.train,
            &ctx,
            state.force,
            &self.state.history.train,
            &mut scratch,
        );
        let old = &self.state.history.train;
        let at = (state.actuator, None);
        let (_, s_slope) = take_up(self.problem, &self.local.takeup, at, old, &mut scratch);
        border.stiffness * s_slope / (1.0 + e_slope * border.stiffness)
    }

    pub(crate) fn context(&self, dt: f64) -> Context {
        Context { dt, time: self.state.time + dt, path_position: 0.5 }
    }

    pub(crate) fn newton(
        &mut self,
        ctx: Context,
        control: Control,
        fresh: &mut State,
    ) -> Result<Converged, FemError> {
        self.newton_of(self.problem, ctx, control, fresh)
    }

    /// The same of a problem that differs from the run's by its supports' displacements.
    pub(super) fn newton_of(
        &mut self,
        problem: &Problem,
        ctx: Context,
        control: Control,
        fresh: &mut State,
    ) -> Result<Converged, FemError> {
        if self.run.iterations > self.options.budget {
            return Err(FemError::Setup(format!("more than {} Newton iterations", self.options.budget)));
        }
        // Leaving the load-free state every fibre decides whether it is taut: an active-set search
        // that smaller steps do not shorten. Nor do they where a few cuts did not help.
        let patience = if self.run.steps.len() < 2 || self.patient { 4 } else { 1 };
        let held = matches!(control, Control::Actuator(_));
        let rough = held && self.columns.is_empty() && !self.options.ledger;
        let newton = NewtonOptions {
            max_iterations: patience * self.options.newton.max_iterations,
            near: if rough { ROUGHLY } else { self.options.newton.near },
            ..self.options.newton
        };
        let step = Step {
            problem,
            local: &self.local,
            free: &self.free,
            ctx,
            old: &self.state,
            control,
            options: newton,
            force_floor: 1e-3 * self.force_floor,
        };
        match step.solve(self.system, fresh) {
            Ok(c) => {
                self.run.iterations += c.iterations;
                Ok(c)
            }
            Err((e, iterations)) => {
                self.run.iterations += iterations;
                Err(e)
            }
        }
    }
}
