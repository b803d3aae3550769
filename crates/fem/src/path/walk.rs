//! Steps along the equilibrium path, one after the other.

use super::measure::Measure;
use crate::energy;
use crate::equilibrium::{Border, Control, take_up, train_elongation};
use crate::error::FemError;
use crate::opening::Weights;
use crate::state::{Guess, State};
use crate::stepping::{Along, Stepping, fresh_commit};

/// Changes (actuator, opening) per unit of grip displacement at a converged state.
fn rates(m: &Stepping, border: &Border, state: &State) -> [f64; 2] {
    let mut scratch = m.state.history.train.clone();
    let (_, e_slope) = train_elongation(
        m.problem,
        &m.local.train,
        &m.context(1.0),
        state.force,
        &m.state.history.train,
        &mut scratch,
    );
    let old = &m.state.history.train;
    let at = (state.actuator, Some(m.state.actuator));
    let (_, s_slope) = take_up(m.problem, &m.local.takeup, at, old, &mut scratch);
    let du_a = (1.0 + e_slope * border.stiffness) / s_slope;
    let dw: f64 = m.system.opening.iter().map(|&(eq, w)| w * border.response[eq]).sum();
    [du_a, dw]
}

/// Share of the work that a step back must leave in the tear, or it is elastic unloading.
const GROWS: f64 = 1e-6;

/// How many times further than the longest step the actuator may go in one.
const TOO_FAR: f64 = 1.5;

/// Cuts of a followed path's step after which Newton gets more iterations instead of shorter steps alone.
const PATIENT: usize = 3;

/// A path followed for its own sake.
#[derive(Clone, Copy)]
struct Following {
    /// Sense in which the actuator was told to go.
    direction: f64,
    /// Longest step in actuator displacement, mm.
    step: f64,
}

/// The time that a rig's actuator says, which goes on at its pace whatever the tear does in between.
#[derive(Clone, Copy)]
pub(super) struct Clock {
    /// Time and displacement at the start.
    pub(super) time: f64,
    pub(super) from: f64,
    /// Sense in which the actuator goes.
    pub(super) direction: f64,
    /// Seconds for a mm.
    pub(super) pace: f64,
}

impl Clock {
    /// Time at an actuator displacement, not before `last`: on the way back of a jump it stands still.
    pub(super) fn at(self, actuator: f64, last: f64) -> f64 {
        (self.time + self.pace * (actuator - self.from) * self.direction).max(last)
    }
}

/// A path in progress.
#[derive(Clone)]
pub(super) struct Walk {
    pub(super) measure: Measure,
    pub(super) tangent: [f64; 2],
    pub(super) length: f64,
    pub(super) smallest: f64,
    pub(super) largest: f64,
    rate: f64,
    /// Whose time the steps get; without one their arc is their time.
    pub(super) clock: Option<Clock>,
    /// Previous state, its grip and actuator, and the arc between it and the present one.
    before: Option<(Guess, f64, f64, f64)>,
    following: Option<Following>,
}

impl Walk {
    pub(super) fn start(
        m: &mut Stepping,
        measure: Measure,
        direction: f64,
        length: f64,
        rate: f64,
    ) -> Result<Self, FemError> {
        // The tangent at the present state: assemble and factorise there.
        let mut here = m.state.clone();
        let ctx = m.context(0.0);
        let at = m.state.actuator;
        let mut relaxed = m.options.newton;
        relaxed.tolerance = relaxed.tolerance.max(1e-6);
        let kept = std::mem::replace(&mut m.options.newton, relaxed);
        let solved = m.newton(ctx, Control::Actuator(at), &mut here);
        m.options.newton = kept;
        let border = solved?.border(m.system, m.problem.multiplicity)?;
        m.system.opening = measure.opening(m, &here);
        let mut t = measure.tangent(rates(m, &border, &here));
        let mut length = length;
        match measure {
            Measure::Arc if t[0] * direction < 0.0 => t = [-t[0], -t[1]],
            Measure::Arc => {}
            // As far as the actuator was to move.
            Measure::Softening => length /= t[0].abs().max(1.0),
        }
        // Where the grip moves no softening point, its opening measures nothing.
        if length <= 0.0 || !t[0].is_finite() {
            return Err(FemError::Singular);
        }
        let (smallest, largest) = (length * 1e-4, length);
        Ok(Self {
            measure,
            tangent: t,
            length,
            smallest,
            largest,
            rate,
            clock: None,
            before: None,
            following: None,
        })
    }

    /// Every step is an answer: none longer than `step` mm of actuator displacement, none back along the way come.
    pub(super) fn following(mut self, direction: f64, step: f64) -> Self {
        self.following = Some(Following { direction, step });
        (self.smallest, self.largest) = (1e-4 * step.min(self.length), step);
        self
    }

    /// Arc of the last step.
    pub(super) fn taken(&self) -> f64 {
        self.before.as_ref().map_or(self.length, |b| b.3)
    }

    /// Refuses a step that goes back although nothing tears (the way just come), or further than asked for (onto another
    /// branch).
    fn refuse_return(&self, m: &Stepping, fresh: &State, dt: f64) -> Result<(), FemError> {
        let Some(Following { direction, step }) = self.following else { return Ok(()) };
        let moved = fresh.actuator - m.state.actuator;
        let refused = |reason: &str| FemError::NoConvergence {
            displacement: m.state.actuator,
            step: self.length,
            reason: reason.into(),
        };
        if moved.abs() > TOO_FAR * step && self.length > self.smallest {
            return Err(refused("a step along the path went too far"));
        }
        if moved * direction >= 0.0 {
            return Ok(());
        }
        let lost = |s: &State| energy::of_path(m.problem, &m.local, &m.context(dt), &m.state.history, s);
        let work = 0.5 * (m.state.force + fresh.force) * moved;
        if lost(fresh).dissipated - lost(&m.state).dissipated > GROWS * work.abs() {
            return Ok(());
        }
        Err(refused("the path leads back the way it came"))
    }

    /// The opening measured from a state on, and the tangent by it; `next` is that by the present one.
    fn upcoming(&self, m: &mut Stepping, at: &State, border: &Border, next: [f64; 2]) -> (Weights, [f64; 2]) {
        let present = m.system.opening.clone();
        if self.measure == Measure::Arc {
            return (present, next);
        }
        m.system.opening = self.measure.opening(m, at);
        let tangent = self.measure.tangent(rates(m, border, at));
        (std::mem::replace(&mut m.system.opening, present), tangent)
    }

    /// One accepted step along the path.
    pub(super) fn step(&mut self, m: &mut Stepping, target: Option<usize>) -> Result<(), FemError> {
        let mut cuts = 0;
        loop {
            let w = m.opening(&m.state.u);
            let held = self.measure.held(self.tangent);
            let control = Control::Arc { from: [m.state.actuator, w], tangent: held, length: self.length };
            let mut fresh = m.state.clone();
            if let Some((before, grip, actuator, arc)) = &self.before {
                let r = self.length / arc;
                if let Some(g) = Guess::combined(&[(1.0 + r, &fresh.guess()), (-r, before)]) {
                    fresh.start_from(g);
                }
                fresh.grip += r * (fresh.grip - grip);
                fresh.actuator += r * (fresh.actuator - actuator);
            }
            let dt = self.length / self.rate;
            let attempt = m.newton(m.context(dt), control, &mut fresh).and_then(|mut c| {
                self.refuse_return(m, &fresh, dt)?;
                let border = c.border(m.system, m.problem.multiplicity)?;
                let next = self.measure.tangent(rates(m, &border, &fresh));
                let next = self.measure.onward(next, self.tangent, self.length <= self.smallest)?;
                Ok((c, border, next))
            });
            match attempt {
                Ok((c, border, next)) => {
                    let kept = (m.state.guess(), m.state.grip, m.state.actuator, self.length);
                    let last = m.state.time;
                    let time = self.clock.map_or(last + dt, |c| c.at(fresh.actuator, last));
                    // The step keeps the measure that held it; the next one has its own.
                    let upcoming = self.upcoming(m, &fresh, &border, next);
                    let along = Along { held, rates: [self.tangent[0], next[0]].map(|t| self.length * t) };
                    fresh_commit(m, fresh, time, dt, target, c.iterations, Some(along), &border)?;
                    (m.system.opening, self.tangent) = upcoming;
                    self.before = Some(kept);
                    if c.iterations <= 4 {
                        self.length = (1.5 * self.length).min(self.largest);
                    }
                    self.keep_short();
                    self.patience(m, 0);
                    return Ok(());
                }
                Err(e @ FemError::Setup(_)) => return Err(e),
                Err(e) => {
                    self.length *= 0.5;
                    self.before = None;
                    if self.length < self.smallest {
                        self.patience(m, 0);
                        return Err(e);
                    }
                    cuts += 1;
                    self.patience(m, cuts);
                }
            }
        }
    }

    /// After many cuts of a followed path's step Newton gets more iterations; a jump's are the run's own matter.
    fn patience(&self, m: &mut Stepping, cuts: usize) {
        if self.following.is_some() {
            m.patient = cuts > PATIENT;
        }
    }

    /// A followed path shows its shape: the next step moves the actuator no further than asked for.
    fn keep_short(&mut self) {
        if let (Some(following), Measure::Softening) = (self.following, self.measure) {
            let most = following.step / self.tangent[0].abs().max(1.0);
            self.length = self.length.min(most);
            self.smallest = self.smallest.min(1e-4 * most);
        }
    }
}
