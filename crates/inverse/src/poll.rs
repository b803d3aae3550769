//! A look around where derivatives lead nowhere.
//!
//! Where a model jumps (a tear that runs through before its record ends), the points behind the jump have large misfits and
//! derivatives that say nothing of where it moves to: no step along them lowers f, and the way out is short. There the
//! objective itself is asked at a few places around, as pattern searches do (Torczon 1997, doi:10.1137/S1052623493250780):
//! along each group of parameters, both ways, near and farther.

use crate::course::Course;
use crate::fit::{Advance, Failure, Search, State};
use crate::{Data, FitError, FitOptions, Free, Iterate, PredictError, StopReason};
use nalgebra::DVector;
use std::ops::{ControlFlow, Range};

/// When and along what to look around.
#[derive(Clone, Debug, PartialEq)]
pub struct Poll {
    /// χ² per point above which it is worth the runs: what is left below that may be how well the model can do.
    pub above: f64,
    /// Objective above which it is not worth the runs: another start came to that.
    pub below: f64,
    /// Objective that the model came to elsewhere, on another mesh: a search that begins at more than twice that, and that no
    /// step leads out of, looks around first. What a jump does to a record is no small change, and no derivative at its far side
    /// leads back.
    pub expected: f64,
    /// Objectives at which it is not worth the runs: another fit looked around there.
    pub known: Range<f64>,
    /// Free parameters that move together, by their places in the list of free parameters.
    pub groups: Vec<Vec<usize>>,
}

/// How far to look, in natural scales: a twenty-fifth, and about four times that. Half and twice as far led out of the same places
/// (docs/decisions/evidence.md).
const STEPS: [f64; 2] = [0.04, 0.15];

/// A search is amiss where it begins at so many times what is expected.
const AMISS: f64 = 2.0;

/// Derivatives lead on from there as long as a step leaves at most this share.
const LEADS_ON: f64 = 0.5;

/// Looks around at its beginning at most.
const FIRST_LOOKS: usize = 4;

/// Share of f that a place must not exceed to be worth going on from.
pub(crate) const ENOUGH: f64 = 0.95;

impl Poll {
    /// Each parameter alone, however far f is.
    pub fn each(above: f64, free: usize) -> Self {
        let expected = f64::INFINITY;
        Self {
            above,
            below: f64::INFINITY,
            expected,
            known: 0.0..0.0,
            groups: (0..free).map(|k| vec![k]).collect(),
        }
    }

    /// Whether an objective is far from the records.
    pub(crate) fn is_far(&self, f: f64, data: &Data, options: &FitOptions) -> bool {
        f > self.above * options.unit(data) * data.points().max(1) as f64
    }

    /// Whether a look around is worth its runs: not above what another start came to, nor where another fit looked.
    fn is_worth_it(&self, f: f64) -> bool {
        f <= self.below && !self.known.contains(&f)
    }

    /// The places around a point, in transformed coordinates; those that bounds leave where they are are left out.
    fn around(&self, free: &[Free], theta: &[f64], z: &DVector<f64>) -> Vec<DVector<f64>> {
        let mut places = Vec::new();
        for (group, step) in self.groups.iter().flat_map(|g| STEPS.map(|s| (g, s))) {
            for signed in [step, -step] {
                let mut there = z.clone();
                for &k in group.iter().filter(|k| **k < free.len()) {
                    let (low, high) = free[k].bounds_z();
                    there[k] = (z[k] + signed * free[k].natural_scale(theta[k])).clamp(low, high);
                }
                if there != *z {
                    places.push(there);
                }
            }
        }
        places
    }
}

impl Search<'_> {
    /// Where a search that begins amiss should begin, and why to stop, if it is to: steps go on while derivatives lead on,
    /// and where they do not it looks around.
    pub(crate) fn arrive(
        &mut self,
        mut state: State,
        course: &mut Course,
        observer: &mut dyn FnMut(&Iterate) -> ControlFlow<()>,
    ) -> Result<(State, Option<StopReason>), FitError> {
        let expected = self.options.poll.as_ref().map_or(f64::INFINITY, |p| p.expected);
        for _ in 0..FIRST_LOOKS {
            let (there, stopped) = self.stride(state, AMISS * expected, course, observer)?;
            state = there;
            if stopped {
                return Ok((state, Some(StopReason::Stopped)));
            }
            if state.f <= AMISS * expected {
                break;
            }
            match self.look_around(&state, 0, observer)? {
                Advance::To(next) => {
                    state = *next;
                    *course = Course::begin(self.options, self.free.len());
                }
                Advance::Stop(best, StopReason::Stopped) => {
                    return Ok((best.map_or(state, |b| *b), Some(StopReason::Stopped)));
                }
                Advance::Stop(..) => break,
            }
        }
        Ok((state, None))
    }

    /// Steps, one trial each, until f is `enough` or derivatives do not lead on; whether to stop.
    fn stride(
        &mut self,
        mut state: State,
        enough: f64,
        course: &mut Course,
        observer: &mut dyn FnMut(&Iterate) -> ControlFlow<()>,
    ) -> Result<(State, bool), FitError> {
        while state.f > enough {
            match self.advance(&state, 0, 1, course, observer)? {
                Advance::To(next) => {
                    let leads_on = next.f <= LEADS_ON * state.f;
                    self.take(&mut state, *next, course);
                    if !leads_on {
                        break;
                    }
                }
                Advance::Stop(best, why) => {
                    return Ok((best.map_or(state, |b| *b), why == StopReason::Stopped));
                }
            }
        }
        Ok((state, false))
    }

    /// The best place around one that no step leads out of, if that is clearly better.
    pub(crate) fn look_around(
        &mut self,
        state: &State,
        iteration: usize,
        observer: &mut dyn FnMut(&Iterate) -> ControlFlow<()>,
    ) -> Result<Advance, FitError> {
        let worth = |p: &&Poll| p.is_far(state.f, self.data, self.options) && p.is_worth_it(state.f);
        let Some(poll) = self.options.poll.as_ref().filter(worth) else {
            return Ok(Advance::Stop(None, StopReason::NoDescent));
        };
        let (mut enough, mut best) = (ENOUGH * state.f, None);
        for z in poll.around(self.free, &state.theta, &state.z) {
            let theta = self.physical(&z);
            let flow = match self.evaluate(z, false) {
                Ok(there) => {
                    let flow = self.record(iteration, Ok(&there), false, 0.0, observer);
                    if there.f < enough {
                        (enough, best) = (there.f, Some(there.z));
                    }
                    flow
                }
                Err(Failure::Fatal(e)) => return Err(e),
                Err(Failure::Model(PredictError::Interrupted)) => ControlFlow::Break(()),
                Err(Failure::Model(_)) => self.record(iteration, Err(theta), false, 0.0, observer),
            };
            if flow.is_break() {
                return Ok(Advance::Stop(None, StopReason::Stopped));
            }
        }
        let Some(z) = best else { return Ok(Advance::Stop(None, StopReason::NoDescent)) };
        match self.evaluate(z, true) {
            Ok(next) if next.f < state.f => {
                let flow = self.record(iteration, Ok(&next), true, 0.0, observer);
                Ok(if flow.is_break() {
                    Advance::Stop(Some(Box::new(next)), StopReason::Stopped)
                } else {
                    Advance::To(Box::new(next))
                })
            }
            Err(Failure::Fatal(e)) => Err(e),
            Err(Failure::Model(PredictError::Interrupted)) => Ok(Advance::Stop(None, StopReason::Stopped)),
            _ => Ok(Advance::Stop(None, StopReason::NoDescent)),
        }
    }
}
