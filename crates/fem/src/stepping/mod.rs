//! A run through a plan of actuator displacements: steps, cuts, jumps, sensitivities, ledger.

mod attempt;
mod commit;
mod mark;
mod mounting;
mod options;
mod record;
mod visits;

pub(crate) use commit::{Along, fresh_commit};
pub use options::{NoObserver, Observer, SteppingOptions, Target};
pub use record::{Jump, Kept, Run, StepRecord};

use crate::equilibrium::{free_dofs, opening};
use crate::error::FemError;
use crate::path::{self, Measure};
use crate::problem::{LocalParams, Problem};
use crate::sensitivity::Columns;
use crate::state::{Guess, State};
use crate::system::System;
use crate::warm::{Warm, warm_guess};
use visits::{Recent, Visit};

/// Share of a planned step below which Newton gets more iterations instead of shorter steps alone.
const SHORT_SHARE: f64 = 0.2;

/// A run in progress.
pub(crate) struct Stepping<'a> {
    pub problem: &'a Problem,
    pub local: LocalParams<f64>,
    pub system: &'a mut System,
    pub free: Vec<usize>,
    pub columns: Vec<&'a mut (dyn Columns + 'static)>,
    pub observer: &'a dyn Observer,
    pub options: SteppingOptions,
    pub state: State,
    pub run: Run,
    pub force_floor: f64,
    pub largest_force: f64,
    visits: Vec<Visit>,
    reusable: bool,
    recent: Vec<Recent>,
    /// Cuts have not helped so far: Newton gets more iterations.
    pub patient: bool,
    train_energy: f64,
    /// What the walks along the path are measured by.
    measure: Measure,
}

/// Runs a plan.
///
/// The first target should be the start (actuator 0, dt 0): mounting (a turned clamp, prestretch)
/// is solved there. A run that cannot go on returns everything up to that point with the reason.
/// `cancelled` is asked between steps.
#[allow(clippy::too_many_arguments)]
pub fn run_steps(
    problem: &Problem,
    theta: &[f64],
    system: &mut System,
    initial: Option<State>,
    targets: &[Target],
    columns: &mut [&mut (dyn Columns + 'static)],
    observer: &dyn Observer,
    options: SteppingOptions,
    warm: Option<&Warm>,
    cancelled: &dyn Fn() -> bool,
) -> Run {
    let reusable = !problem.rate_dependent() && columns.iter().all(|c| c.repeatable());
    let free = free_dofs(system);
    let mut m = Stepping {
        local: problem.local(theta),
        state: initial.unwrap_or_else(|| State::virgin(problem)),
        run: Run::default(),
        force_floor: 0.0,
        largest_force: 0.0,
        visits: Vec::new(),
        recent: Vec::new(),
        patient: false,
        train_energy: 0.0,
        measure: Measure::default(),
        problem,
        system,
        free,
        columns: columns.iter_mut().map(|c| &mut **c).collect(),
        observer,
        options,
        reusable,
    };
    let mut differences: Vec<Guess> = Vec::new();
    for (index, target) in targets.iter().enumerate() {
        if cancelled() {
            m.run.failure = Some(FemError::Setup("stopped by the user".into()));
            break;
        }
        let turned = index >= 2
            && (target.actuator - targets[index - 1].actuator)
                * (targets[index - 1].actuator - targets[index - 2].actuator)
                <= 0.0;
        // A hold begins at the rate at which the ramp ends.
        if turned && target.actuator != targets[index - 1].actuator {
            m.recent.truncate(0);
        }
        if m.revisit(index, target) {
            continue;
        }
        // States of another mesh (half the height, say) are no guess for this one.
        let fits = |g: &Guess| g.u.len() == m.state.u.len();
        let known = warm.and_then(|w| w.state(index, theta)).filter(fits);
        let guess = known.as_ref().and_then(|known| warm_guess(known, &differences));
        if let Err(e) = m.advance_to(index, target, guess) {
            m.run.failure = Some(e);
            break;
        }
        learn(&mut differences, known.as_ref(), &m.state);
    }
    m.run.last = Some(m.state);
    m.run
}

/// Keeps how the last two states differ from what a warm start knew of them.
fn learn(differences: &mut Vec<Guess>, known: Option<&Guess>, state: &State) {
    let Some(known) = known else { return differences.clear() };
    differences.extend(Guess::combined(&[(1.0, &state.guess()), (-1.0, known)]));
    if differences.len() > 2 {
        differences.remove(0);
    }
}

impl Stepping<'_> {
    /// Goes to a target, cutting steps where needed.
    fn advance_to(
        &mut self,
        index: usize,
        target: &Target,
        mut guess: Option<Guess>,
    ) -> Result<(), FemError> {
        let (start, start_time) = (self.state.actuator, self.state.time);
        let clock = if target.rest { 0.0 } else { 1.0 };
        let travel = target.actuator - start;
        if self.options.follow_path && travel != 0.0 {
            return path::follow(self, target.actuator, target.dt, index);
        }
        let mut done = 0.0;
        let mut share: f64 = 1.0;
        let mut lost = false;
        // Where neither travel nor time leads there is only the mounting to cut.
        let mut mounting = travel == 0.0 && target.dt == 0.0;
        if travel == 0.0 && guess.is_none() && self.mounts_by_waypoints() && self.run.steps.is_empty() {
            guess = self.mounted_in_parts();
            mounting = guess.is_none();
        }
        loop {
            let end = (done + share).min(1.0);
            let last = end > 1.0 - 1e-12;
            let actuator = if last { target.actuator } else { start + end * travel };
            let dt = (end - done) * target.dt;
            self.patient = share < SHORT_SHARE;
            match self.attempt(actuator, dt, clock, guess.take()) {
                Ok((border, iterations, fresh)) => {
                    fresh_commit(
                        self,
                        fresh,
                        start_time + clock * end * target.dt,
                        dt,
                        last.then_some(index),
                        iterations,
                        None,
                        &border,
                    )?;
                    if last {
                        return Ok(());
                    }
                    done = end;
                    share *= if iterations <= 5 { 2.0 } else { 1.0 };
                }
                Err(e @ FemError::Setup(_)) => return Err(e),
                Err(e) if std::mem::take(&mut mounting) => {
                    guess =
                        Some(self.mounted_in_parts().ok_or_else(|| with_place(e, self.state.actuator, 0.0))?);
                }
                Err(e) => {
                    share *= 0.5;
                    let at_smallest_step = share < self.options.min_step_fraction;
                    let next = [share * travel, share * target.dt];
                    if self.walked(e, target, next, at_smallest_step, &mut lost)? {
                        done = ((self.state.actuator - start) / travel).clamp(0.0, 1.0);
                        share = (1.0 - done).max(1e-9);
                        if done >= 1.0 - 1e-12 {
                            return Ok(());
                        }
                    }
                }
            }
        }
    }

    /// Before the next step (actuator and time), one having failed: whether the run went on along the path: where it steepens
    /// towards a limit point, and where shorter steps are no way any more (`at_smallest_step`). `lost`: a walk has led nowhere
    /// before.
    fn walked(
        &mut self,
        failed: FemError,
        target: &Target,
        [step, dt]: [f64; 2],
        at_smallest_step: bool,
        lost: &mut bool,
    ) -> Result<bool, FemError> {
        // Where the actuator stands still there is only time to cut.
        let held = step == 0.0;
        if held && (at_smallest_step || target.dt == 0.0) || at_smallest_step && self.problem.path.is_none() {
            return Err(with_place(failed, self.state.actuator, step.abs()));
        }
        if held {
            return Ok(false);
        }
        // Where the mean opening has no say, neither has its tangent on limit points.
        let ahead = self.measure == Measure::Softening || at_smallest_step || path::limit_ahead(self, step);
        if *lost && !at_smallest_step || !ahead {
            return Ok(false);
        }
        // By the softening zone where nothing else has led on before, or does now.
        let measures = match (self.measure, at_smallest_step) {
            (Measure::Arc, false) => vec![Measure::Arc],
            (Measure::Arc, true) => vec![Measure::Arc, Measure::Softening],
            (Measure::Softening, _) => vec![Measure::Softening],
        };
        let mut why = failed;
        for measure in measures {
            match self.jumped(measure, target, step, dt) {
                Ok(()) => return Ok(true),
                // Out of iterations, or stopped: another way would be no better off.
                Err(e @ FemError::Setup(_)) => {
                    why = e;
                    break;
                }
                Err(e) => why = e,
            }
        }
        if at_smallest_step {
            return Err(with_place(why, self.state.actuator, step.abs()));
        }
        // Too early: shorter steps may still find the way.
        *lost = true;
        Ok(false)
    }

    /// Walks by a measure to the end of a jump, or not at all; the measure that led on is kept.
    fn jumped(&mut self, measure: Measure, target: &Target, step: f64, dt: f64) -> Result<(), FemError> {
        let mark = self.mark();
        let walked = path::jump(self, measure, target.actuator, step.abs(), dt);
        path::measure_by_arc(self);
        match &walked {
            Ok(()) => self.measure = measure,
            // What was walked is no answer of the rig.
            Err(_) => self.back_to(mark),
        }
        walked
    }

    pub(crate) fn opening(&self, u: &[f64]) -> f64 {
        opening(self.system, u, &self.free)
    }
}

fn with_place(e: FemError, displacement: f64, step: f64) -> FemError {
    match e {
        FemError::NoConvergence { reason, .. } => FemError::NoConvergence { displacement, step, reason },
        FemError::Element(fault) => FemError::NoConvergence { displacement, step, reason: fault.to_string() },
        other => other,
    }
}
