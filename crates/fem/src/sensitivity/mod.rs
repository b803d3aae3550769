//! Sensitivities by direct differentiation through the load-step history.
//!
//! At each converged step: a **partial** sweep (parameters seeded, displacements constant, history
//! seeded with its stored total derivative) gives −∂R/∂θ; the tangent factorised at the converged
//! state solves for all columns at once; then the derivative of the history is carried on, by what the partial
//! sweep says of it and by ∂h/∂F̄ along the displacements ([`Group`]), or by a **total** sweep (displacements seeded
//! too). No ∂P/∂h matrix is ever formed; step sizes are frozen.
//!
//! A [`Columns`] object owns its own problem: the columns of an effect that is tried at its
//! neutral value use the decorated law on the states of the base model.

mod border;
mod chunk;
mod group;
mod sweeps;

pub use chunk::Chunk;
pub use group::Group;

use crate::equilibrium::Border;
use crate::state::State;
use crate::system::System;
use constitutive::Context;

/// One step as the columns see it.
pub struct Stage<'a> {
    /// Numbering and geometry.
    pub system: &'a System,
    /// Converged state.
    pub state: &'a State,
    /// Time and increment of the step that led to it.
    pub ctx: Context,
    /// What the step held fixed: (t_u, t_w) of a path step, `None` for a held actuator.
    pub arc: Option<[f64; 2]>,
    /// Where the actuator stood before the step, mm.
    pub from: f64,
}

impl Stage<'_> {
    /// Where the actuator stood before a step along a followed path.
    fn path_from(&self) -> Option<f64> {
        self.arc.map(|_| self.from)
    }
}

/// Derivatives of one step, per column.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct StepDerivatives {
    /// dF/dθ, N per unit.
    pub force: Vec<f64>,
    /// du_grip/dθ, mm per unit.
    pub grip: Vec<f64>,
    /// du_actuator/dθ (path steps only; zero at a held actuator).
    pub actuator: Vec<f64>,
    /// Derivatives of the measured forces: `reactions[reaction][column]`, N per unit.
    pub reactions: Vec<Vec<f64>>,
    /// Derivatives of the observer's extra outputs: `extra[output][column]`.
    pub extra: Vec<Vec<f64>>,
}

impl StepDerivatives {
    /// Derivatives of [`crate::StepRecord::along`].
    pub fn along(&self) -> &[f64] {
        self.reactions.first().unwrap_or(&self.force)
    }

    /// Puts the columns of `more` behind these, in every output.
    pub(crate) fn append(&mut self, more: Self) {
        self.force.extend(more.force);
        self.grip.extend(more.grip);
        self.actuator.extend(more.actuator);
        extend(&mut self.reactions, more.reactions);
        extend(&mut self.extra, more.extra);
    }
}

fn extend(all: &mut Vec<Vec<f64>>, more: Vec<Vec<f64>>) {
    if all.is_empty() {
        *all = more;
        return;
    }
    for (a, e) in all.iter_mut().zip(more) {
        a.extend(e);
    }
}

/// A set of derivative columns propagated through a run.
pub trait Columns: Send {
    /// Number of columns.
    fn count(&self) -> usize;
    /// Appends −∂R/∂θ of the free unknowns, column after column, to `rhs`.
    fn partial(&mut self, stage: &Stage, rhs: &mut Vec<f64>);
    /// Takes the solutions K⁻¹(−∂R/∂θ), closes the border, carries the history on.
    /// Returns the displacement derivatives (dof-major: `du[dof * count + c]`) and the step's
    /// derivatives (without extras).
    fn total(&mut self, stage: &Stage, border: &Border, solution: &[f64]) -> (Vec<f64>, StepDerivatives);
    /// Whether derivatives may be taken from an earlier visit of the same state (no law looks at
    /// time).
    fn repeatable(&self) -> bool;
    /// Whether the last step changed the values of any history variable of these columns.
    fn moved(&self) -> bool;
    /// Remembers the present history, for [`Self::restore`].
    fn save(&mut self);
    /// Goes back to the history that was saved last.
    fn restore(&mut self);
}
