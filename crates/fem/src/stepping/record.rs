//! What a run leaves behind: steps, jumps, states, and the reason if it ended early.

use crate::energy::Ledger;
use crate::error::FemError;
use crate::sensitivity::StepDerivatives;
use crate::state::{Guess, State};
use std::sync::Arc;

/// A jump at a held actuator.
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
    /// The problem's measured forces, N (whole specimen).
    pub reactions: Vec<f64>,
    /// dF/du_actuator, N/mm.
    pub slope: f64,
    /// Newton iterations.
    pub iterations: usize,
    /// Negative pivots of the tangent at a held grip: 0 where stable.
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

/// What is kept of a state: for fields, and for the first guesses of another run.
#[derive(Clone, Debug, PartialEq)]
pub struct Kept {
    /// Displacements and pressures.
    pub guess: Guess,
    /// History of the tear path (δ_max).
    pub path: Vec<f64>,
}

/// A whole run; `failure` says why it ended early, if it did.
#[derive(Clone, Debug, Default)]
pub struct Run {
    /// Converged steps in order.
    pub steps: Vec<StepRecord>,
    /// States of each step, where kept.
    pub states: Vec<Arc<Kept>>,
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

impl StepRecord {
    /// What the first load cell measures, N: the first of the measured forces, where there are such, else the
    /// work-conjugate force.
    pub fn along(&self) -> f64 {
        self.reactions.first().copied().unwrap_or(self.force)
    }
}
