//! Accepting a step: derivatives, energies, history, the record of it.

use super::visits::{Recent, Visit};
use super::{Kept, StepRecord, Stepping};
use crate::energy::{self, Ledger};
use crate::equilibrium::Border;
use crate::error::FemError;
use crate::sensitivity::{Stage, StepDerivatives};
use crate::state::State;
use constitutive::Context;
use std::sync::Arc;

/// What a step along the path kept, and how it began and ended.
#[derive(Clone, Copy)]
pub(crate) struct Along {
    /// Tangent of the control that held it ([`Stage::arc`]).
    pub held: [f64; 2],
    /// Change of the actuator displacement at its start and at its end, mm over the whole step.
    pub rates: [f64; 2],
}

/// Accepts a converged step: sensitivities, ledger, history, record.
#[allow(clippy::too_many_arguments)]
pub(crate) fn fresh_commit(
    m: &mut Stepping,
    fresh: State,
    time: f64,
    dt: f64,
    target: Option<usize>,
    iterations: usize,
    along: Option<Along>,
    border: &Border,
) -> Result<(), FemError> {
    let arc = along.map(|a| a.held);
    // Before the derivatives: they leave the elements as they are.
    let whole = m.problem.multiplicity;
    let reactions = m.system.reactions(m.problem).into_iter().map(|r| whole * r).collect();
    let ctx = Context { time, ..m.context(dt) };
    let (derivatives, gradient) = differentiate(m, &fresh, ctx, arc, border)?;
    let slope = m.actuator_slope(border, &fresh);
    let ledger = if m.options.ledger { add_up(m, &fresh, ctx, slope, along) } else { Ledger::default() };
    let moved = m.columns.iter().any(|c| c.moved()) || history_moved(&m.state, &fresh);
    m.force_floor = m.force_floor.max(m.system.force_scale);
    m.largest_force = m.largest_force.max(fresh.force.abs());
    let record = StepRecord {
        target,
        time,
        actuator: fresh.actuator,
        grip: fresh.grip,
        force: fresh.force,
        reactions,
        slope,
        iterations,
        negative_pivots: m.system.factor.negative_pivots(),
        extra: m.observer.observe(&fresh),
        derivatives,
        ledger,
        after_jump: false,
        revisited: false,
    };
    m.state = fresh;
    m.state.time = time;
    if m.options.keep_states {
        let kept = Kept { guess: m.state.guess(), path: m.state.history.path.clone() };
        m.run.states.push(Arc::new(kept));
    }
    if m.options.keep_gradients {
        m.run.gradients.push(Arc::new(gradient));
    }
    if m.reusable {
        if moved {
            m.visits.clear();
        }
        m.visits.push(Visit { step: m.run.steps.len(), state: m.state.clone() });
    }
    if arc.is_some() {
        m.recent.clear();
    } else {
        m.recent.push(Recent { actuator: m.state.actuator, time, guess: m.state.guess() });
        if m.recent.len() > 3 {
            m.recent.remove(0);
        }
    }
    m.run.steps.push(record);
    Ok(())
}

fn history_moved(a: &State, b: &State) -> bool {
    let differs = |x: &[f64], y: &[f64]| x.iter().zip(y).any(|(p, q)| p.to_bits() != q.to_bits());
    differs(&a.history.bulk, &b.history.bulk)
        || differs(&a.history.path, &b.history.path)
        || differs(&a.history.train, &b.history.train)
}

fn differentiate(
    m: &mut Stepping,
    fresh: &State,
    ctx: Context,
    arc: Option<[f64; 2]>,
    border: &Border,
) -> Result<(StepDerivatives, Vec<f32>), FemError> {
    if m.columns.is_empty() {
        return Ok((StepDerivatives::default(), Vec::new()));
    }
    let (n, from) = (m.system.unknowns, m.state.actuator);
    let mut rhs = Vec::new();
    {
        let stage = Stage { system: m.system, state: fresh, ctx, arc, from };
        for c in m.columns.iter_mut() {
            c.partial(&stage, &mut rhs);
        }
    }
    let count: usize = m.columns.iter().map(|c| c.count()).sum();
    m.system.factor.solve(&mut rhs, count)?;
    let stage = Stage { system: m.system, state: fresh, ctx, arc, from };
    let mut all = StepDerivatives::default();
    let mut gradient = vec![0.0_f32; if m.options.keep_gradients { count * fresh.u.len() } else { 0 }];
    let mut at = 0;
    for c in m.columns.iter_mut() {
        let k = c.count();
        let (du, d) = c.total(&stage, border, &rhs[at * n..(at + k) * n]);
        for (row, from) in gradient.chunks_exact_mut(count).zip(du.chunks_exact(k)) {
            for (g, d) in row[at..at + k].iter_mut().zip(from) {
                *g = *d as f32;
            }
        }
        at += k;
        let extra = m.observer.derive(fresh, &du, k);
        all.append(StepDerivatives { extra, ..d });
    }
    Ok((all, gradient))
}

/// Work of a force over a step, ∫F du, with both as cubics of the arc (Hermite): values, and rates of the
/// displacement over the step with the slopes dF/du at its start and end. At an even rate this is the trapezoid with end
/// slopes; a step may also turn back in u.
fn work(force: [f64; 2], u: [f64; 2], rate: [f64; 2], slope: [f64; 2]) -> f64 {
    let [f0, f1] = force;
    let h = u[1] - u[0];
    let [a, b] = [slope[0] * rate[0], slope[1] * rate[1]];
    let curved = ((f0 - f1) * (rate[0] - rate[1]) + (a - b) * h) / 10.0 + (b * rate[0] - a * rate[1]) / 60.0;
    0.5 * h * (f0 + f1) + if curved.is_finite() { curved } else { 0.0 }
}

/// Ledger after a step.
fn add_up(m: &mut Stepping, fresh: &State, ctx: Context, slope: f64, along: Option<Along>) -> Ledger {
    let (bulk, path) = energy::internal(m.problem, &m.local, m.system, &ctx, &m.state.history, fresh);
    let (before, mut ledger) = match m.run.steps.last() {
        Some(s) => ((s.actuator, s.force, s.slope, s.grip), s.ledger),
        None => ((fresh.actuator, fresh.force, slope, fresh.grip), Ledger::default()),
    };
    let h = fresh.actuator - before.0;
    let rates = along.map_or([h, h], |a| a.rates);
    let forces = [before.1, fresh.force];
    let added = work(forces, [before.0, fresh.actuator], rates, [before.2, slope]);
    ledger.external_work += added;
    // The train takes what does not reach the tissue: ∫ F d(u_actuator − u_grip), same rule with
    // its share of the curvature.
    let stretch = (fresh.actuator - fresh.grip) - (before.0 - before.3);
    if stretch != 0.0 {
        let grip_step = fresh.grip - before.3;
        let share = if h.abs() > 0.0 { grip_step / h } else { 0.0 };
        let correction = (added - 0.5 * h * (before.1 + fresh.force)) * (1.0 - share);
        m.train_energy += 0.5 * stretch * (before.1 + fresh.force) + correction;
    }
    ledger.rig = m.train_energy;
    ledger.stored = bulk.stored;
    ledger.dissipated_bulk = bulk.dissipated;
    ledger.cohesive_recoverable = path.stored;
    ledger.cohesive_dissipated = path.dissipated;
    ledger
}
