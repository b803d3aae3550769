//! What a run is asked for: its targets, how it is made, what is observed on the way.

use crate::newton::NewtonOptions;
use crate::state::State;

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
pub struct SteppingOptions {
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
    /// Steps along the path before a jump is given up; the snap-back of the peers takes about 150.
    pub jump_steps: usize,
    /// Follow the equilibrium path instead of being held at planned displacements.
    pub follow_path: bool,
    /// Newton iterations after which a run is given up (a search need not wait for a hopeless
    /// trial).
    pub budget: usize,
}

impl Default for SteppingOptions {
    fn default() -> Self {
        Self {
            newton: NewtonOptions::default(),
            min_step_fraction: 1.0 / 256.0,
            continuity: 0.05,
            ledger: false,
            keep_states: false,
            keep_gradients: false,
            arc_step: 0.05,
            jump_steps: 800,
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
