//! `control = "path"`: the whole equilibrium path, through every limit point, to the end of a leg.
//!
//! A strip under a monotone program goes back for one reason only: the tear grows, and the strip unloads into it. So the
//! sense of the path is no matter of angles: a step back on which the tear dissipates nothing is the way just come,
//! by elastic unloading, and is refused ([`Walk::following`]). Where the plane of actuator and mean opening has no
//! step left, the opening of the zone that softens takes over, and the other way round ([`Measure`]).

use super::{Measure, Walk};
use crate::equilibrium::Control;
use crate::error::FemError;
use crate::stepping::{Stepping, fresh_commit};

/// Steps before a path is given up.
const MOST_STEPS: usize = 20_000;

/// Largest change of the ledger's gap in a step, as a share of the largest work so far: more means that the step went past
/// a turn of the path.
const CLOSES: f64 = 3e-5;

/// Follows the path until the actuator first reaches `to`, every step reported, then stands exactly there.
pub(crate) fn follow(m: &mut Stepping, to: f64, dt: f64, target: usize) -> Result<(), FemError> {
    let start = m.state.actuator;
    let direction = (to - start).signum();
    let rate = (to - start).abs() / dt.max(1e-12);
    if m.problem.path.is_none() {
        return Err(FemError::Setup("path control needs a tear path".into()));
    }
    let step = m.options.arc_step;
    let mut walk = Walk::start(m, Measure::Arc, direction, step, rate)?.following(direction, step);
    for _ in 0..MOST_STEPS {
        if arrived(m, &mut walk, to, direction, rate, target)? {
            super::measure_by_arc(m);
            return Ok(());
        }
        match closing_step(m, &mut walk) {
            Ok(()) => {}
            Err(e @ FemError::Setup(_)) => return Err(e),
            Err(e) => walk = changed(m, &walk, direction, rate).map_err(|_| e)?,
        }
    }
    Err(FemError::NoConvergence {
        displacement: m.state.actuator,
        step: walk.length,
        reason: format!("the path did not reach {to} mm in {MOST_STEPS} steps"),
    })
}

/// Stands exactly at `to` where the next step would pass it; else nothing.
fn arrived(
    m: &mut Stepping,
    walk: &mut Walk,
    to: f64,
    direction: f64,
    rate: f64,
    target: usize,
) -> Result<bool, FemError> {
    let ahead = (to - m.state.actuator) * direction;
    let forward = walk.tangent[0] * direction;
    if forward <= 0.0 || forward * walk.length < ahead {
        return Ok(false);
    }
    let mut fresh = m.state.clone();
    let dt = ahead.abs() / rate;
    match m.newton(m.context(dt), Control::Actuator(to), &mut fresh) {
        Ok(mut c) => {
            let border = c.border(m.system, m.problem.multiplicity)?;
            let time = m.state.time + dt;
            fresh_commit(m, fresh, time, dt, Some(target), c.iterations, None, &border)?;
            Ok(true)
        }
        Err(_) => {
            walk.length *= 0.5;
            Ok(false)
        }
    }
}

/// A step over which the work is what became of it, where energies are added up: a longer one is taken back and halved.
fn closing_step(m: &mut Stepping, walk: &mut Walk) -> Result<(), FemError> {
    loop {
        let (mark, before, opening) = (m.mark(), walk.clone(), m.system.opening.clone());
        walk.step(m, None)?;
        let taken = walk.taken();
        if closes(m) || taken <= before.smallest {
            return Ok(());
        }
        m.back_to(mark);
        m.system.opening = opening;
        *walk = before;
        walk.length = 0.5 * taken;
    }
}

/// Whether the ledger closes over the last step as well as before it.
fn closes(m: &Stepping) -> bool {
    let [.., before, last] = m.run.steps.as_slice() else { return true };
    let most = m.run.steps.iter().fold(0.0f64, |most, s| most.max(s.ledger.external_work.abs()));
    (last.ledger.gap() - before.ledger.gap()).abs() <= CLOSES * most
}

/// The walk from the last state by the other measure, one step on.
fn changed(m: &mut Stepping, walk: &Walk, direction: f64, rate: f64) -> Result<Walk, FemError> {
    let step = m.options.arc_step;
    let other = match walk.measure {
        Measure::Arc => Measure::Softening,
        Measure::Softening => Measure::Arc,
    };
    super::measure_by_arc(m);
    let sense = if other == Measure::Arc { walk.tangent[0] } else { direction };
    let mut next = Walk::start(m, other, sense, step, rate)?.following(direction, step);
    closing_step(m, &mut next)?;
    Ok(next)
}
