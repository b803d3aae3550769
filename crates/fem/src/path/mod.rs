//! Following the equilibrium path through limit points and snap-back.
//!
//! Pseudo-arc length in the plane of actuator displacement and mean opening of the tear path; where that leads
//! nowhere, the opening of the zone that softens ([`Measure`]). As a rig, the actuator stands still while the tear
//! jumps: the path between the two equilibria is followed only to find the second one and the energy set free.

mod follow;
mod measure;
mod walk;

use crate::equilibrium::Control;
use crate::error::FemError;
use crate::opening;
use crate::state::State;
use crate::stepping::{Jump, Stepping, fresh_commit};
pub(crate) use follow::follow;
pub(crate) use measure::Measure;
use walk::{Clock, Walk};

/// A jump is followed for its end, not for its shape: steps this many times longer than those of a traced path.
const BOLD: f64 = 2.0;

/// The measure of everything but walks.
pub(crate) fn measure_by_arc(m: &mut Stepping) {
    m.system.opening = opening::mean(m.problem, &m.system.equation);
}

/// Forward component of the path's tangent below which it is walked rather than stepped: the tear opens nearly
/// twice as fast as the actuator moves.
const STEEP: f64 = 0.5;

/// Whether the path at the last state is about to turn: cutting the step further would only find out slowly.
/// On the way back a step fails for other reasons.
pub(crate) fn limit_ahead(m: &mut Stepping, step: f64) -> bool {
    m.problem.path.is_some()
        && step * m.state.actuator > 0.0
        && Walk::start(m, Measure::Arc, step.signum(), step.abs(), 1.0)
            .is_ok_and(|walk| walk.tangent[0].abs() < STEEP)
}

/// A jump at a limit point: follows the path from the last state until it comes back to the same
/// actuator displacement, drops the steps between, and records what was set free.
///
/// Where the branch goes on without one, it ends on the way to the actuator displacement `to`. The actuator takes `dt` for
/// `length` of its way; while the tear jumps, its clock stands still.
pub(crate) fn jump(
    m: &mut Stepping,
    measure: Measure,
    to: f64,
    length: f64,
    dt: f64,
) -> Result<(), FemError> {
    let before = m.state.clone();
    let direction = (to - before.actuator).signum();
    let enough = (4.0 * length).min(0.4 * (to - before.actuator).abs());
    let first = m.run.steps.len();
    let kept_recent = m.run.states.len();
    let rate = length / dt.max(1e-9);
    let mut walk = Walk::start(m, measure, direction, length.max(1e-6), rate.max(1e-9))?;
    walk.largest = BOLD * m.options.arc_step.max(length);
    walk.clock = Some(Clock { time: before.time, from: before.actuator, direction, pace: dt / length });
    let mut farthest = before.actuator;
    let mut released = 0.0;
    let mut turned = false;
    for _ in 0..m.options.jump_steps {
        let (u0, f0) = (m.state.actuator, m.state.force);
        // Stand exactly at the limit rather than step past it: δ_max would remember the overshoot.
        let forward = walk.tangent[0] * direction;
        let ahead = (farthest - u0) * direction;
        if turned && forward > 0.0 && forward * walk.length >= ahead {
            if stands_at(m, farthest) {
                return land(m, &walk, before, farthest, first, kept_recent, released);
            }
            walk.length = (0.5 * walk.length).max(walk.smallest);
        }
        let advance = forward * walk.length;
        if !turned && forward > 0.0 {
            // A limit point beyond the target is none of this step's: never past it.
            walk.length = walk.length.min(0.5 * (to - u0) * direction / forward);
        }
        walk.step(m, None)?;
        released += 0.5 * (f0 + m.state.force) * (u0 - m.state.actuator);
        if (m.state.actuator - farthest) * direction >= 0.0 && !turned {
            farthest = m.state.actuator;
        } else if (m.state.actuator - farthest) * direction < 0.0 {
            turned = true;
        }
        if turned && m.state.actuator * before.actuator.signum() <= 0.0 {
            return Err(FemError::NoConvergence {
                displacement: before.actuator,
                step: walk.length,
                reason: "the path leads back to the start instead of to a new equilibrium".into(),
            });
        }
        let back = (m.state.actuator - farthest) * direction >= 0.0;
        if turned && back && m.system.factor.negative_pivots() == 0 {
            return land(m, &walk, before, farthest, first, kept_recent, released);
        }
        // The limit point was only a cut-off step away: the branch goes on without a jump.
        let calm = walk.tangent[0] * direction > STEEP || advance > (to - m.state.actuator) * direction;
        if !turned
            && calm
            && (m.state.actuator - before.actuator) * direction > enough
            && m.system.factor.negative_pivots() == 0
        {
            return Ok(());
        }
    }
    Err(FemError::NoConvergence {
        displacement: before.actuator,
        step: walk.length,
        reason: "the tear neither stops nor finds a new equilibrium".into(),
    })
}

/// Whether a stable state is found at this actuator displacement from the last one.
fn stands_at(m: &mut Stepping, actuator: f64) -> bool {
    let mut fresh = m.state.clone();
    let solved = m.newton(m.context(0.0), Control::Actuator(actuator), &mut fresh);
    solved.and_then(|mut c| c.border(m.system, m.problem.multiplicity)).is_ok()
        && m.system.factor.negative_pivots() == 0
}

/// Stands at the limit displacement on the new branch and writes the jump.
fn land(
    m: &mut Stepping,
    walk: &Walk,
    before: State,
    limit: f64,
    first: usize,
    states: usize,
    mut released: f64,
) -> Result<(), FemError> {
    let mut fresh = m.state.clone();
    let mut c = m.newton(m.context(0.0), Control::Actuator(limit), &mut fresh)?;
    let border = c.border(m.system, m.problem.multiplicity)?;
    released += 0.5 * (m.state.force + fresh.force) * (m.state.actuator - fresh.actuator);
    let time = walk.clock.map_or(m.state.time, |c| c.at(limit, before.time));
    fresh_commit(m, fresh, time, 0.0, None, c.iterations, None, &border)?;
    // Between the limit point and the new branch nothing is an answer of the rig.
    let keep = m.run.steps[first..].iter().position(|s| s.negative_pivots > 0).map_or(first, |k| first + k);
    let landed = m.run.steps.len() - 1;
    let work_before = m.run.steps[..keep].last().map_or(0.0, |s| s.ledger.external_work);
    let force_before = m.run.steps[..keep].last().map_or(before.force, |s| s.force);
    let mut record = m.run.steps[landed].clone();
    record.after_jump = true;
    // ∫F du along the path is negative by what was set free: the rig did no work in the jump.
    let along = record.ledger.external_work - work_before;
    if m.options.ledger {
        released = -along;
        record.ledger.external_work = work_before;
        record.ledger.released_in_jumps += released;
    }
    if m.options.keep_states {
        let keep_states = states + (keep - first);
        m.run.states.drain(keep_states..m.run.states.len() - 1);
        if m.options.keep_gradients {
            m.run.gradients.drain(keep_states..m.run.gradients.len() - 1);
        }
    }
    m.run.steps.truncate(keep);
    m.run.jumps.push(Jump {
        displacement: limit,
        time,
        force_before,
        force_after: record.force,
        released,
        step: m.run.steps.len(),
    });
    m.run.steps.push(record);
    // They count in steps that are no more.
    m.forget();
    Ok(())
}
