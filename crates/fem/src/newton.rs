//! Newton's method for one step, with the load train and the control in a border.

use crate::equilibrium::{Border, Control, impose, opening, take_up, train_elongation};
use crate::error::FemError;
use crate::problem::{LocalParams, Problem};
use crate::state::State;
use crate::system::{Pressures, System};
use constitutive::Context;

/// Tolerances of one step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NewtonOptions {
    /// Largest out-of-balance force over the largest element force.
    pub tolerance: f64,
    /// Iterations before a step is given up.
    pub max_iterations: usize,
    /// Out-of-balance force (as for `tolerance`) below which the tangent of an iterate stands for the converged one.
    pub near: f64,
}

impl Default for NewtonOptions {
    fn default() -> Self {
        Self { tolerance: 1e-9, max_iterations: 25, near: 1e-6 }
    }
}

/// A converged step.
pub struct Converged {
    /// Iterations (factorisations) used.
    pub iterations: usize,
    /// Response to the grip from the last factor, if that was made next to the converged state.
    pub border: Option<Border>,
}

impl Converged {
    /// Response to the grip at the converged state.
    ///
    /// # Errors
    /// [`FemError::Singular`].
    pub fn border(&mut self, system: &mut System, multiplicity: f64) -> Result<Border, FemError> {
        self.border.take().map_or_else(|| Border::of(system, multiplicity), Ok)
    }
}

/// Everything a step needs that does not change during it.
pub struct Step<'a> {
    /// Problem.
    pub problem: &'a Problem,
    /// Its parameters.
    pub local: &'a LocalParams<f64>,
    /// Degree of freedom of each equation.
    pub free: &'a [usize],
    /// Time and increment.
    pub ctx: Context,
    /// Last converged state.
    pub old: &'a State,
    /// What is held.
    pub control: Control,
    /// Tolerances.
    pub options: NewtonOptions,
    /// Largest element force seen in the run: a floor for the yardstick.
    pub force_floor: f64,
}

impl Step<'_> {
    /// Finds equilibrium from the guess in `state` (displacements, pressures, grip, actuator); on success
    /// `state` is converged with its new history, and `system` holds the residual there, and the tangent there or
    /// (where a border is returned) that of the iterate before.
    ///
    /// # Errors
    /// [`FemError`] with what the last iteration ran into, and the iterations used; `state` is then arbitrary.
    pub fn solve(&self, system: &mut System, state: &mut State) -> Result<Converged, (FemError, usize)> {
        if let Control::Actuator(u) = self.control {
            state.actuator = u;
        }
        impose(self.problem, state.grip, &mut state.u);
        let mut at = self.first_evaluation(system, state).map_err(|e| (e, 0))?;
        let mut merits: Vec<f64> = Vec::new();
        let mut near = None;
        let mut iteration = 0;
        loop {
            if self.balanced(at) {
                state.pressure.clear();
                state.pressure.extend(system.pressures());
                return Ok(Converged { iterations: iteration, border: near });
            }
            // Where only the train's loop is still open the forces stand at rounding.
            let stuck = at.imbalance > self.options.tolerance && self.stagnates(&merits);
            let hopeless = at.imbalance >= 1e12 || at.imbalance.is_nan() || stuck;
            if iteration == self.options.max_iterations || hopeless {
                let reason =
                    format!("out-of-balance force {:.1e} after {iteration} iterations", at.imbalance);
                return Err((self.failure(&reason), iteration));
            }
            let spent = |e| (e, iteration + 1);
            let border = Border::of(system, self.problem.multiplicity).map_err(spent)?;
            let step = self.scalar_step(system, state, &border);
            let close = at.imbalance <= self.options.near;
            at = self.line_search(system, state, &border, step, &merits, close).map_err(spent)?;
            near = close.then_some(border);
            merits.push(at.merit);
            iteration += 1;
        }
    }

    fn balanced(&self, at: Measure) -> bool {
        at.imbalance <= self.options.tolerance && at.loop_error <= 1e-12
    }

    /// Evaluates the guess, with the guessed pressures where they leave the smaller residual: displacements that
    /// are nearly right know their pressures better than any guess.
    fn first_evaluation(&self, system: &mut System, state: &mut State) -> Result<Measure, FemError> {
        let guess = std::mem::take(&mut state.pressure);
        if guess.len() == self.problem.body.hexes.len() {
            let at = self.evaluate(system, state, Pressures::Guessed(&guess))?;
            if at.merit <= at.imbalance {
                return Ok(at);
            }
        }
        self.evaluate(system, state, Pressures::Own)
    }

    /// Whether the last quarter of the iterations allowed has not even halved the merit.
    fn stagnates(&self, merits: &[f64]) -> bool {
        let window = self.options.max_iterations / 4;
        let least = |m: &[f64]| m.iter().copied().fold(f64::INFINITY, f64::min);
        merits.len() >= window + 2 && {
            let (before, last) = merits.split_at(merits.len() - window);
            least(last) > 0.5 * least(before)
        }
    }

    fn failure(&self, reason: &str) -> FemError {
        FemError::NoConvergence { displacement: self.old.actuator, step: 0.0, reason: reason.into() }
    }

    /// Assembles and measures.
    fn evaluate(
        &self,
        system: &mut System,
        state: &mut State,
        pressures: Pressures<'_>,
    ) -> Result<Measure, FemError> {
        let (old, new) = (&self.old.history, &mut state.history);
        system.assemble(self.problem, self.local, &self.ctx, &state.u, pressures, old, new)?;
        Ok(self.measure(system, state))
    }

    /// The same without a tangent: whether a step from a near iterate has arrived.
    fn arrives(&self, system: &mut System, state: &mut State) -> Result<Option<Measure>, FemError> {
        let (old, new) = (&self.old.history, &mut state.history);
        system.forces(self.problem, self.local, &self.ctx, &state.u, old, new)?;
        let at = self.measure(system, state);
        Ok(self.balanced(at).then_some(at))
    }

    fn measure(&self, system: &System, state: &mut State) -> Measure {
        state.force = self.problem.multiplicity * system.grip_force;
        let (closing, _) = self.loop_closing(state);
        let length = self.length_scale(state);
        let arc = match self.control {
            Control::Actuator(_) => 0.0,
            Control::Arc { length, .. } => self.arc_error(system, state).abs() / length.max(1e-12),
        };
        // Below this the residual is rounding of deformation gradients near the unit tensor.
        let rounding = 10.0 * f64::EPSILON * system.stiffness_scale / self.options.tolerance;
        let floor = self.force_floor.max(1e-10 * system.stiffness_scale * length).max(rounding);
        let [imbalance, merit] = system.imbalance().map(|r| r / system.force_scale.max(floor));
        Measure { imbalance, merit, loop_error: (closing.abs() / length).max(arc * 1e-4) }
    }

    fn length_scale(&self, state: &State) -> f64 {
        state.actuator.abs().max(self.old.actuator.abs()).max(1e-3)
    }

    /// Where the actuator is, and along a followed path where it was.
    fn moves(&self, actuator: f64) -> (f64, Option<f64>) {
        (actuator, matches!(self.control, Control::Arc { .. }).then_some(self.old.actuator))
    }

    /// u_g + e(F) − s(u_a), and e'(F).
    fn loop_closing(&self, state: &mut State) -> (f64, f64) {
        let (e, slope) = train_elongation(
            self.problem,
            &self.local.train,
            &self.ctx,
            state.force,
            &self.old.history.train,
            &mut state.history.train,
        );
        let (old, new) = (&self.old.history.train, &mut state.history.train);
        let (s, _) = take_up(self.problem, &self.local.takeup, self.moves(state.actuator), old, new);
        (state.grip + e - s, slope)
    }

    fn arc_error(&self, system: &System, state: &State) -> f64 {
        match self.control {
            Control::Actuator(_) => 0.0,
            Control::Arc { from, tangent, length } => {
                let w = opening(system, &state.u, self.free);
                tangent[0] * (state.actuator - from[0]) + tangent[1] * (w - from[1]) - length
            }
        }
    }

    /// Newton step of the scalars (grip, actuator).
    fn scalar_step(&self, system: &System, state: &mut State, b: &Border) -> (f64, f64) {
        let (closing, slope) = self.loop_closing(state);
        // Linearised train: (1 + e' k) du_g + e' δF₀ + closing = s' du_a.
        let rhs = -(closing + slope * b.force_correction);
        let lhs = 1.0 + slope * b.stiffness;
        match self.control {
            Control::Actuator(_) => (rhs / lhs, 0.0),
            Control::Arc { tangent, .. } => {
                let (old, mut scratch) = (&self.old.history.train, state.history.train.clone());
                let (_, s_slope) =
                    take_up(self.problem, &self.local.takeup, self.moves(state.actuator), old, &mut scratch);
                let along = |x: &[f64]| -> f64 { system.opening.iter().map(|&(eq, w)| w * x[eq]).sum() };
                // t_u du_a + t_w (w·(correction + response du_g)) = −arc_error, s' du_a = lhs du_g − rhs
                let need = -self.arc_error(system, state) - tangent[1] * along(&b.correction);
                let per_grip = tangent[0] * lhs / s_slope + tangent[1] * along(&b.response);
                let du_g = (need + tangent[0] * rhs / s_slope) / per_grip;
                (du_g, (lhs * du_g - rhs) / s_slope)
            }
        }
    }

    /// The full step where it helps; else the best of a few shorter ones.
    ///
    /// The tension switch of the fibres and the unloading branch of the tear path make the residual
    /// only piecewise smooth: there full steps may cycle, and the shorter one that lowers the
    /// residual is taken. Early on a growing residual is no fault: the load has just changed; and later a step
    /// need not be better than each of the last ones, or kinks would be crept along.
    ///
    /// From a `close` iterate the full step is expected to arrive, and no tangent is made there.
    #[allow(clippy::too_many_arguments)]
    fn line_search(
        &self,
        system: &mut System,
        state: &mut State,
        b: &Border,
        (du_g, du_a): (f64, f64),
        merits: &[f64],
        close: bool,
    ) -> Result<Measure, FemError> {
        let start = (state.u.clone(), state.grip, state.actuator);
        system.leave();
        let place = |state: &mut State, factor: f64| {
            state.grip = start.1 + factor * du_g;
            state.actuator = start.2 + factor * du_a;
            for (eq, &dof) in self.free.iter().enumerate() {
                state.u[dof] = start.0[dof] + factor * (b.correction[eq] + b.response[eq] * du_g);
            }
            impose(self.problem, state.grip, &mut state.u);
        };
        if close {
            place(state, 1.0);
            if let Ok(Some(at)) = self.arrives(system, state) {
                return Ok(at);
            }
        }
        let allowed = match merits {
            [] | [_] | [_, _] | [_, _, _] => {
                (10.0 * merits.iter().copied().fold(f64::INFINITY, f64::min)).max(1e-6)
            }
            [.., a, b, c] => a.max(*b).max(*c),
        };
        let mut tried: Option<(f64, f64)> = None;
        let mut fault = None;
        for share in [1.0, 0.5, 0.25, 0.1, 0.04] {
            place(state, share);
            match self.evaluate(system, state, Pressures::Linearised { share }) {
                Ok(at) => {
                    if at.merit <= allowed || at.imbalance <= self.options.tolerance {
                        return Ok(at);
                    }
                    if tried.is_none_or(|t| at.merit < t.1) {
                        tried = Some((share, at.merit));
                    }
                }
                Err(e) => fault = Some(e),
            }
        }
        match tried {
            Some((share, _)) => {
                place(state, share);
                self.evaluate(system, state, Pressures::Linearised { share })
            }
            None => Err(fault.unwrap_or_else(|| self.failure("line search failed"))),
        }
    }
}

/// How far an iterate is from a solution, in relative terms.
#[derive(Clone, Copy)]
struct Measure {
    /// Out-of-balance force: what convergence is about.
    imbalance: f64,
    /// The same with the pressures that the tangent uses: whether a Newton step came nearer. What the step leaves
    /// in the volumes, to second order, is not held against it.
    merit: f64,
    /// Error of train and control.
    loop_error: f64,
}
