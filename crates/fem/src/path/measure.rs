//! What measures a step along the path: the arc, or the opening of the zone that softens.

use crate::error::FemError;
use crate::opening::{self, Weights};
use crate::state::State;
use crate::stepping::Stepping;

/// What measures the steps of a walk.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Measure {
    /// The arc in the plane of actuator displacement and mean opening.
    #[default]
    Arc,
    /// The opening of the zone that softens, chosen anew at every state: it grows wherever the tear does.
    Softening,
}

impl Measure {
    /// The opening that is measured at a state.
    pub(super) fn opening(self, m: &Stepping, state: &State) -> Weights {
        let equation = &m.system.equation;
        let softening = match self {
            Self::Arc => None,
            Self::Softening => opening::of_softening(m.problem, &m.local, &m.context(0.0), state, equation),
        };
        softening.unwrap_or_else(|| opening::mean(m.problem, equation))
    }

    /// Changes (actuator, opening) per unit of length, for rates per grip displacement. A softening zone opens; along
    /// the arc the sense is free.
    pub(super) fn tangent(self, [du, dw]: [f64; 2]) -> [f64; 2] {
        let unit = match self {
            Self::Arc => du.hypot(dw),
            Self::Softening => dw,
        };
        [du / unit, dw / unit]
    }

    /// Tangent of the control that holds a step.
    pub(super) const fn held(self, tangent: [f64; 2]) -> [f64; 2] {
        match self {
            Self::Arc => tangent,
            Self::Softening => [0.0, 1.0],
        }
    }

    /// The tangent at the end of a step, in the sense of the walk.
    pub(super) fn onward(
        self,
        next: [f64; 2],
        before: [f64; 2],
        last_resort: bool,
    ) -> Result<[f64; 2], FemError> {
        if self == Self::Softening {
            return Ok(next);
        }
        let along = next[0] * before[0] + next[1] * before[1];
        // A turn of more than about 45° in one step would skip a branch.
        if along.abs() < 0.7 && !last_resort {
            return Err(FemError::Singular);
        }
        Ok(if along < 0.0 { [-next[0], -next[1]] } else { next })
    }
}
