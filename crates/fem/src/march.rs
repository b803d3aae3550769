//! A run through a plan of actuator displacements: steps, cuts, jumps, sensitivities, ledger.

use crate::energy::{self, Ledger};
use crate::equilibrium::{
    Border, Control, NewtonOptions, Step, free_dofs, mean_opening, take_up, train_elongation,
};
use crate::error::FemError;
use crate::path;
use crate::problem::{LocalParams, Problem};
use crate::sensitivity::{Columns, Stage, StepDerivatives};
use crate::state::State;
use crate::system::System;
use crate::warm::{Warm, warm_guess};
use constitutive::Context;
use std::sync::Arc;

/// A point of the plan.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Target {
    /// Actuator displacement, mm.
    pub actuator: f64,
    /// Time since the previous target, s.
    pub dt: f64,
    /// Whether the clock stands still while the time passes (a rest between two tests).
    pub rest: bool,
}

impl Target {
    /// A target reached after `dt` seconds.
    pub const fn new(actuator: f64, dt: f64) -> Self {
        Self { actuator, dt, rest: false }
    }
}

/// How a run is made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MarchOptions {
    /// Newton tolerances.
    pub newton: NewtonOptions,
    /// Smallest step as a share of the planned one; below it a jump is looked for.
    pub min_step_fraction: f64,
    /// Largest unexplained change of force in a step (departure from the rule of the two end
    /// slopes, as a share of the largest force so far) before the step is cut.
    pub continuity: f64,
    /// Whether energies are added up.
    pub ledger: bool,
    /// Whether displacements of every step are kept (fields, warm starts).
    pub keep_states: bool,
    /// Whether their derivatives by the columns are kept too (better warm starts).
    pub keep_gradients: bool,
    /// Arc length of a path step, mm (path control, and the passage of a jump).
    pub arc_step: f64,
    /// Follow the equilibrium path instead of standing at planned displacements.
    pub follow_path: bool,
    /// Newton iterations after which a run is given up (a search need not wait for a hopeless
    /// trial).
    pub budget: usize,
}

/// Share of a planned step below which Newton gets more iterations instead of shorter steps alone.
const STUBBORN: f64 = 0.2;

impl Default for MarchOptions {
    fn default() -> Self {
        Self {
            newton: NewtonOptions::default(),
            min_step_fraction: 1.0 / 256.0,
            continuity: 0.05,
            ledger: false,
            keep_states: false,
            keep_gradients: false,
            arc_step: 0.05,
            follow_path: false,
            budget: usize::MAX,
        }
    }
}

/// Extra outputs of every step: camera channels, fields.
pub trait Observer: Sync {
    /// Values at a converged state.
    fn observe(&self, state: &State) -> Vec<f64>;
    /// Derivatives of the values: `du[dof * count + c]` → `[output][c]`.
    fn derive(&self, state: &State, du: &[f64], count: usize) -> Vec<Vec<f64>>;
}

/// No extra outputs.
pub struct NoObserver;

impl Observer for NoObserver {
    fn observe(&self, _state: &State) -> Vec<f64> {
        Vec::new()
    }
    fn derive(&self, _state: &State, _du: &[f64], _count: usize) -> Vec<Vec<f64>> {
        Vec::new()
    }
}

/// A jump at a standing actuator.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Jump {
    /// Actuator displacement, mm.
    pub displacement: f64,
    /// Clock, s.
    pub time: f64,
    /// Force before, N.
    pub force_before: f64,
    /// Force after, N.
    pub force_after: f64,
    /// Energy set free (area between path and jump), N·mm.
    pub released: f64,
    /// Index of the first step after the jump.
    pub step: usize,
}

/// One converged step.
#[derive(Clone, Debug, PartialEq)]
pub struct StepRecord {
    /// Target it answers, if it stands exactly at one.
    pub target: Option<usize>,
    /// Clock, s.
    pub time: f64,
    /// Actuator displacement, mm.
    pub actuator: f64,
    /// Grip displacement, mm.
    pub grip: f64,
    /// Force, N.
    pub force: f64,
    /// dF/du_actuator, N/mm.
    pub slope: f64,
    /// Newton iterations.
    pub iterations: usize,
    /// Negative pivots of the tangent at standing grip: 0 where stable.
    pub negative_pivots: usize,
    /// Observer's outputs.
    pub extra: Vec<f64>,
    /// Derivatives of all columns, in the order the columns were given.
    pub derivatives: StepDerivatives,
    /// Energies so far.
    pub ledger: Ledger,
    /// Reached after a jump at this same displacement.
    pub after_jump: bool,
    /// Taken over from an earlier visit of the same state.
    pub revisited: bool,
}

/// A whole run; `failure` says why it ended early, if it did.
#[derive(Clone, Debug, Default)]
pub struct Run {
    /// Converged steps in order.
    pub steps: Vec<StepRecord>,
    /// Displacements of each step, where kept.
    pub states: Vec<Arc<Vec<f64>>>,
    /// Histories of each step, where kept: the paths (δ_max) for fields.
    pub path_histories: Vec<Arc<Vec<f64>>>,
    /// du/dθ of each step, where kept: `[dof * columns + c]`. Single precision: a first guess.
    pub gradients: Vec<Arc<Vec<f32>>>,
    /// Jumps.
    pub jumps: Vec<Jump>,
    /// Newton iterations (factorisations while iterating), rejected attempts included.
    pub iterations: usize,
    /// Last converged state.
    pub last: Option<State>,
    /// Why the run ended before its plan did.
    pub failure: Option<FemError>,
}

/// A visited state that an elastic excursion may come back to.
struct Visit {
    step: usize,
    state: State,
}

/// A run in progress.
pub(crate) struct March<'a> {
    pub problem: &'a Problem,
    pub local: LocalParams<f64>,
    pub system: &'a mut System,
    pub free: Vec<usize>,
    pub columns: Vec<&'a mut (dyn Columns + 'static)>,
    pub observer: &'a dyn Observer,
    pub options: MarchOptions,
    pub state: State,
    pub run: Run,
    pub force_floor: f64,
    pub largest_force: f64,
    visits: Vec<Visit>,
    reusable: bool,
    recent: Vec<(f64, Vec<f64>)>,
    /// Cuts have not helped so far: Newton gets more iterations.
    stubborn: bool,
    train_energy: f64,
}

/// Runs a plan.
///
/// The first target should be the start (actuator 0, dt 0): mounting (a turned clamp, prestretch)
/// is solved there. A run that cannot go on returns everything up to that point with the reason.
/// `cancelled` is asked between steps.
#[allow(clippy::too_many_arguments)]
pub fn march(
    problem: &Problem,
    theta: &[f64],
    system: &mut System,
    initial: Option<State>,
    targets: &[Target],
    columns: &mut [&mut (dyn Columns + 'static)],
    observer: &dyn Observer,
    options: MarchOptions,
    warm: Option<&Warm>,
    cancelled: &dyn Fn() -> bool,
) -> Run {
    let reusable = !problem.rate_dependent() && columns.iter().all(|c| c.repeatable());
    let free = free_dofs(system);
    let mut m = March {
        local: problem.local(theta),
        state: initial.unwrap_or_else(|| State::virgin(problem)),
        run: Run::default(),
        force_floor: 0.0,
        largest_force: 0.0,
        visits: Vec::new(),
        recent: Vec::new(),
        stubborn: false,
        train_energy: 0.0,
        problem,
        system,
        free,
        columns: columns.iter_mut().map(|c| &mut **c).collect(),
        observer,
        options,
        reusable,
    };
    let mut differences: Vec<Vec<f64>> = Vec::new();
    for (index, target) in targets.iter().enumerate() {
        if cancelled() {
            m.run.failure = Some(FemError::Setup("stopped by the user".into()));
            break;
        }
        let turned = index >= 2
            && (target.actuator - targets[index - 1].actuator)
                * (targets[index - 1].actuator - targets[index - 2].actuator)
                <= 0.0;
        if turned {
            m.recent.truncate(0);
        }
        if m.revisit(index, target) {
            continue;
        }
        let known = warm.and_then(|w| w.state(index, theta));
        let guess = known.as_ref().map(|u| warm_guess(u, &differences));
        if let Err(e) = m.reach(index, target, guess) {
            m.run.failure = Some(e);
            break;
        }
        match known {
            Some(u) => {
                differences.push(m.state.u.iter().zip(u.iter()).map(|(a, b)| a - b).collect());
                if differences.len() > 2 {
                    differences.remove(0);
                }
            }
            None => differences.clear(),
        }
    }
    m.run.last = Some(m.state);
    m.run
}

impl March<'_> {
    /// Takes a state over from an earlier visit in the same elastic excursion: no history changed
    /// since, no law looks at time, the displacement is the same.
    fn revisit(&mut self, index: usize, target: &Target) -> bool {
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
            self.run.path_histories.push(self.run.path_histories[step].clone());
        }
        if self.options.keep_gradients {
            self.run.gradients.push(self.run.gradients[step].clone());
        }
        self.recent.clear();
        self.run.steps.push(record);
        true
    }

    /// Goes to a target, cutting steps where needed.
    fn reach(&mut self, index: usize, target: &Target, mut guess: Option<Vec<f64>>) -> Result<(), FemError> {
        let (start, start_time) = (self.state.actuator, self.state.time);
        let clock = if target.rest { 0.0 } else { 1.0 };
        let travel = target.actuator - start;
        if self.options.follow_path && travel != 0.0 {
            return path::follow(self, target.actuator, target.dt, index);
        }
        let mut done = 0.0;
        let mut share: f64 = 1.0;
        loop {
            let end = (done + share).min(1.0);
            let last = end > 1.0 - 1e-12;
            let actuator = if last { target.actuator } else { start + end * travel };
            let dt = (end - done) * target.dt;
            self.stubborn = share < STUBBORN;
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
                Err(e) => {
                    share *= 0.5;
                    if share < self.options.min_step_fraction || travel == 0.0 {
                        if self.problem.path.is_none() || travel == 0.0 {
                            return Err(blame(e, self.state.actuator, share * travel.abs()));
                        }
                        path::jump(self, travel.signum(), share * travel.abs(), dt)
                            .map_err(|why| blame(why, self.state.actuator, share * travel.abs()))?;
                        done = if travel == 0.0 {
                            1.0
                        } else {
                            ((self.state.actuator - start) / travel).clamp(0.0, 1.0)
                        };
                        share = (1.0 - done).max(1e-9);
                        if done >= 1.0 - 1e-12 {
                            return Ok(());
                        }
                    }
                }
            }
        }
    }

    /// One Newton solution at a standing actuator, with the checks that a step must pass.
    fn attempt(
        &mut self,
        actuator: f64,
        dt: f64,
        clock: f64,
        guess: Option<Vec<f64>>,
    ) -> Result<(Border, usize, State), FemError> {
        let mut fresh = self.state.clone();
        fresh.actuator = actuator;
        let plain_train = self.problem.train.is_empty();
        let (s, _) = take_up(self.problem, &self.local.takeup, actuator);
        let guessed = guess.is_some();
        if let Some(u) = guess {
            fresh.u = u;
            if plain_train {
                fresh.grip = s;
            }
        } else if let Some(u) = self.extrapolate(actuator) {
            fresh.u = u;
            if plain_train {
                fresh.grip = s;
            }
        }
        let moved = fresh.u != self.state.u;
        let ctx = Context { time: self.state.time + clock * dt, ..self.context(dt) };
        let solved = self.newton(ctx, Control::Actuator(actuator), &mut fresh);
        let converged = match solved {
            Ok(c) => c,
            // A bad guess is no reason to cut the step: once more from the last state.
            Err(_) if moved || guessed => {
                fresh = self.state.clone();
                self.newton(ctx, Control::Actuator(actuator), &mut fresh)?
            }
            Err(e) => return Err(e),
        };
        let border = match converged.border {
            Some(b) => b,
            None => Border::of(self.system, self.problem.multiplicity)?,
        };
        self.check(&fresh, &border)?;
        Ok((border, converged.iterations, fresh))
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
    pub fn actuator_slope(&self, border: &Border, state: &State) -> f64 {
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
        let (_, s_slope) = take_up(self.problem, &self.local.takeup, state.actuator);
        border.stiffness * s_slope / (1.0 + e_slope * border.stiffness)
    }

    pub fn context(&self, dt: f64) -> Context {
        Context { dt, time: self.state.time + dt, path_position: 0.5 }
    }

    pub fn newton(
        &mut self,
        ctx: Context,
        control: Control,
        fresh: &mut State,
    ) -> Result<crate::equilibrium::Converged, FemError> {
        if self.run.iterations > self.options.budget {
            return Err(FemError::Setup(format!("more than {} Newton iterations", self.options.budget)));
        }
        // Leaving the load-free state every fibre decides whether it is taut: an active-set search
        // that smaller steps do not shorten. Nor do they where a few cuts did not help.
        let patience = if self.run.steps.len() < 2 || self.stubborn { 4 } else { 1 };
        let newton = NewtonOptions {
            max_iterations: patience * self.options.newton.max_iterations,
            ..self.options.newton
        };
        let step = Step {
            problem: self.problem,
            local: &self.local,
            free: &self.free,
            ctx,
            old: &self.state,
            control,
            options: newton,
            force_floor: 1e-3 * self.force_floor,
        };
        let result = step.solve(self.system, fresh);
        self.run.iterations += match &result {
            Ok(c) => c.iterations,
            Err(_) => newton.max_iterations,
        };
        result
    }

    /// Quadratic (or linear) extrapolation of the last states of the same branch.
    fn extrapolate(&self, actuator: f64) -> Option<Vec<f64>> {
        let n = self.recent.len();
        let weights: Vec<f64> = match n {
            0 | 1 => return None,
            2 => lagrange(&[self.recent[0].0, self.recent[1].0], actuator),
            _ => lagrange(&[self.recent[n - 3].0, self.recent[n - 2].0, self.recent[n - 1].0], actuator),
        };
        if weights.iter().any(|w| !w.is_finite() || w.abs() > 20.0) {
            return None;
        }
        let used = &self.recent[n - weights.len()..];
        let mut u = vec![0.0; self.state.u.len()];
        for (w, (_, s)) in weights.iter().zip(used) {
            for (a, b) in u.iter_mut().zip(s) {
                *a += w * b;
            }
        }
        Some(u)
    }

    pub fn mean_opening(&self, u: &[f64]) -> f64 {
        mean_opening(self.system, u, &self.free)
    }
}

fn blame(e: FemError, displacement: f64, step: f64) -> FemError {
    match e {
        FemError::NoConvergence { reason, .. } => FemError::NoConvergence { displacement, step, reason },
        FemError::Element(fault) => FemError::NoConvergence { displacement, step, reason: fault.to_string() },
        other => other,
    }
}

fn lagrange(x: &[f64], at: f64) -> Vec<f64> {
    (0..x.len())
        .map(|i| (0..x.len()).filter(|&j| j != i).map(|j| (at - x[j]) / (x[i] - x[j])).product())
        .collect()
}

/// Accepts a converged step: sensitivities, ledger, history, record.
#[allow(clippy::too_many_arguments)]
pub(crate) fn fresh_commit(
    m: &mut March,
    fresh: State,
    time: f64,
    dt: f64,
    target: Option<usize>,
    iterations: usize,
    arc: Option<[f64; 2]>,
    border: &Border,
) -> Result<(), FemError> {
    let ctx = Context { time, ..m.context(dt) };
    let (derivatives, gradient) = differentiate(m, &fresh, ctx, arc, border)?;
    let slope = m.actuator_slope(border, &fresh);
    let ledger = if m.options.ledger { add_up(m, &fresh, ctx, slope) } else { Ledger::default() };
    let moved = m.columns.iter().any(|c| c.moved()) || history_moved(&m.state, &fresh);
    m.force_floor = m.force_floor.max(m.system.force_scale);
    m.largest_force = m.largest_force.max(fresh.force.abs());
    let record = StepRecord {
        target,
        time,
        actuator: fresh.actuator,
        grip: fresh.grip,
        force: fresh.force,
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
        m.run.states.push(Arc::new(m.state.u.clone()));
        m.run.path_histories.push(Arc::new(m.state.history.path.clone()));
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
        m.recent.push((m.state.actuator, m.state.u.clone()));
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
    m: &mut March,
    fresh: &State,
    ctx: Context,
    arc: Option<[f64; 2]>,
    border: &Border,
) -> Result<(StepDerivatives, Vec<f32>), FemError> {
    if m.columns.is_empty() {
        return Ok((StepDerivatives::default(), Vec::new()));
    }
    let n = m.system.unknowns;
    let mut rhs = Vec::new();
    {
        let stage = Stage { system: m.system, state: fresh, ctx, arc };
        for c in m.columns.iter_mut() {
            c.partial(&stage, &mut rhs);
        }
    }
    let count: usize = m.columns.iter().map(|c| c.count()).sum();
    m.system.factor.solve(&mut rhs, count)?;
    let stage = Stage { system: m.system, state: fresh, ctx, arc };
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
        all.force.extend(d.force);
        all.grip.extend(d.grip);
        all.actuator.extend(d.actuator);
        let extra = m.observer.derive(fresh, &du, k);
        if all.extra.is_empty() {
            all.extra = extra;
        } else {
            for (a, e) in all.extra.iter_mut().zip(extra) {
                a.extend(e);
            }
        }
    }
    Ok((all, gradient))
}

/// Ledger after a step: work by the trapezoid with end slopes (fourth order).
fn add_up(m: &mut March, fresh: &State, ctx: Context, slope: f64) -> Ledger {
    let (bulk, path) = energy::internal(m.problem, &m.local, m.system, &ctx, &m.state.history, fresh);
    let (before, mut ledger) = match m.run.steps.last() {
        Some(s) => ((s.actuator, s.force, s.slope, s.grip), s.ledger),
        None => ((fresh.actuator, fresh.force, slope, fresh.grip), Ledger::default()),
    };
    let h = fresh.actuator - before.0;
    ledger.external_work += 0.5 * h * (before.1 + fresh.force) + h * h / 12.0 * (before.2 - slope);
    // The train takes what does not reach the tissue: ∫ F d(u_actuator − u_grip), same rule with
    // the slope of F against the elongation.
    let stretch = (fresh.actuator - fresh.grip) - (before.0 - before.3);
    if stretch != 0.0 {
        let grip_step = fresh.grip - before.3;
        let share = if h.abs() > 0.0 { grip_step / h } else { 0.0 };
        let correction = h * h / 12.0 * (before.2 - slope) * (1.0 - share);
        m.train_energy += 0.5 * stretch * (before.1 + fresh.force) + correction;
    }
    ledger.rig = m.train_energy;
    ledger.stored = bulk.stored;
    ledger.dissipated_bulk = bulk.dissipated;
    ledger.cohesive_recoverable = path.stored;
    ledger.cohesive_dissipated = path.dissipated;
    ledger
}
