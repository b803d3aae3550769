//! How a search goes from place to place, and where it ends.

use crate::acceleration::Last;
use crate::curvature::Curvature;
use crate::fit::{Search, State};
use crate::poll::ENOUGH;
use crate::step_control::StepControl;
use crate::{FitOptions, StopReason};

/// How a search goes: what it has learnt of its steps.
pub(crate) struct Course {
    pub control: StepControl,
    curvature: Curvature,
    pub last: Option<Last>,
    /// Steps in a row that lowered f by less than the tolerance.
    small: usize,
    /// Steps in a row that lowered f by what does not count (`FitOptions::insignificant`).
    idle: usize,
}

impl Course {
    pub fn begin(options: &FitOptions, free: usize) -> Self {
        Self {
            control: StepControl::new(options.initial_damping),
            curvature: Curvature::none(free),
            last: None,
            small: 0,
            idle: 0,
        }
    }
}

impl Search<'_> {
    /// Goes to the next place; why to end there, if there is a reason.
    pub(crate) fn take(&self, state: &mut State, next: State, course: &mut Course) -> Option<StopReason> {
        let change = (state.f - next.f) / state.f;
        let told = (state.f - next.f) / self.options.worth(self.data, next.f);
        course.last = state.system.take().map(|s| Last { dz: &next.z - &state.z, whitened: s.whitened });
        *state = next;
        if let (Some(last), Some(system)) = (&course.last, &mut state.system) {
            course.curvature.learn(last, &system.whitened);
            system.curved = course.curvature.system(&system.reduced, &system.scale);
        }
        course.idle = if told < self.options.insignificant { course.idle + 1 } else { 0 };
        course.small = if change < self.options.tolerance { course.small + 1 } else { 0 };
        if course.idle >= 3 {
            return Some(StopReason::Insignificant);
        }
        if course.small > 0 && self.settled(state) {
            return Some(StopReason::Converged);
        }
        (course.small >= 3).then_some(StopReason::Flat)
    }

    /// Whether a search ends although its derivatives promise more: no step lowers f, or but by little where there is much to
    /// gain. A jump nearby does that: steps that stay before it are short.
    pub(crate) fn is_stuck(&self, state: &State, reason: StopReason) -> bool {
        match reason {
            StopReason::NoDescent => true,
            StopReason::Flat | StopReason::Insignificant => self.predicted_reduction(state) > 1.0 - ENOUGH,
            _ => false,
        }
    }

    /// Whether no step predicts a reduction that counts.
    pub(crate) fn settled(&self, state: &State) -> bool {
        self.predicted_reduction(state) < 10.0 * self.options.tolerance
    }
}
