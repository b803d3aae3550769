//! Newton's method for one step, with the load train and the control in a border.
//!
//! Unknowns: free displacements u_f and the grip displacement u_g (and the actuator displacement
//! u_a when a path is followed). The train closes the loop: u_g + Σ eᵢ(F) − s(u_a) = 0, with F the
//! work-conjugate force; zero compliance needs no special case.

use crate::error::FemError;
use crate::problem::{LocalParams, Problem};
use crate::state::State;
use crate::system::{NONE, System};
use constitutive::{Context, Jet, Law, tangent_by_jets_1};

/// What is held while a step is solved.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Control {
    /// The actuator stands at this displacement, mm.
    Actuator(f64),
    /// Pseudo-arc length in the plane (actuator displacement, mean opening):
    /// t_u (u_a − u₀) + t_w (w − w₀) = length.
    Arc {
        /// Start of the step: actuator displacement and mean opening, mm.
        from: [f64; 2],
        /// Unit tangent of the path at the start.
        tangent: [f64; 2],
        /// Arc length, mm.
        length: f64,
    },
}

/// Tolerances of one step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NewtonOptions {
    /// Largest out-of-balance force over the largest element force.
    pub tolerance: f64,
    /// Iterations before a step is given up.
    pub max_iterations: usize,
}

impl Default for NewtonOptions {
    fn default() -> Self {
        Self { tolerance: 1e-9, max_iterations: 25 }
    }
}

/// Out-of-balance force below which the tangent of an iterate stands for the converged one.
const NEAR: f64 = 1e-6;

/// A converged step.
pub struct Converged {
    /// Iterations (factorisations) used.
    pub iterations: usize,
    /// Response to the grip from the last factor, if that was made next to the converged state.
    pub border: Option<Border>,
}

/// Elongation of the load train at a force, its slope, and its new history.
pub fn train_elongation(
    problem: &Problem,
    params: &[Vec<f64>],
    ctx: &Context,
    force: f64,
    old: &[f64],
    new: &mut [f64],
) -> (f64, f64) {
    let (mut e, mut slope, mut at) = (0.0, 0.0, 0);
    for (link, p) in problem.train.iter().zip(params) {
        let nh = link.law.history().len();
        let (v, d) =
            tangent_by_jets_1(&*link.law, ctx, &[force], p, &old[at..at + nh], &mut new[at..at + nh]);
        e += v[0];
        slope += d[0][0];
        at += nh;
    }
    (e, slope)
}

/// Take-up s(u_a) and its slope.
pub fn take_up(problem: &Problem, params: &[Vec<f64>], actuator: f64) -> (f64, f64) {
    let mut u = Jet::<1>::variable(actuator, 0);
    for (link, p) in problem.takeup.iter().zip(params) {
        let p: Vec<Jet<1>> = p.iter().map(|&v| Jet::constant(v)).collect();
        u = Law::<Jet<1>, 1>::respond(&*link.law, &Context::default(), &[u], &p, &[], &mut []).force[0];
    }
    (u.re, u.eps[0])
}

/// Writes the prescribed displacements for a grip displacement.
pub fn impose(problem: &Problem, grip: f64, u: &mut [f64]) {
    for (dof, s) in problem.supports.iter().enumerate() {
        if let Some(p) = s {
            u[dof] = p.grip * grip + p.mount;
        }
    }
}

/// Mean opening of the tear path, mm.
pub fn mean_opening(system: &System, u: &[f64], free: &[usize]) -> f64 {
    system.mean_opening.iter().map(|&(eq, w)| w * u[free[eq]]).sum()
}

/// The linearised step: responses of the free unknowns to their residual and to the grip.
pub struct Border {
    /// K⁻¹(−residual).
    pub correction: Vec<f64>,
    /// K⁻¹(−∂residual/∂grip) = ∂u_f/∂u_g at equilibrium.
    pub response: Vec<f64>,
    /// dF/du_g of the whole specimen, N/mm.
    pub stiffness: f64,
    /// Change of F by `correction`, N.
    pub force_correction: f64,
}

impl Border {
    /// Factorises the assembled tangent and solves for the border.
    ///
    /// # Errors
    /// [`FemError::Singular`].
    pub fn of(system: &mut System, multiplicity: f64) -> Result<Self, FemError> {
        let n = system.unknowns;
        let values = std::mem::take(&mut system.values);
        system.factor.factorise(&values);
        system.values = values;
        let mut rhs = vec![0.0; 2 * n];
        for i in 0..n {
            rhs[i] = -system.residual[i];
            rhs[n + i] = -system.grip_column[i];
        }
        system.factor.solve(&mut rhs, 2)?;
        let response = rhs.split_off(n);
        let along = |x: &[f64]| -> f64 { system.grip_column.iter().zip(x).map(|(a, b)| a * b).sum() };
        Ok(Self {
            stiffness: multiplicity * (system.grip_stiffness + along(&response)),
            force_correction: multiplicity * along(&rhs),
            correction: rhs,
            response,
        })
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
    /// Finds equilibrium from the guess in `state` (displacements, grip, actuator); on success
    /// `state` is converged with its new history, and `system` holds residual and tangent there.
    ///
    /// # Errors
    /// [`FemError`] with what the last iteration ran into; `state` is then arbitrary.
    pub fn solve(&self, system: &mut System, state: &mut State) -> Result<Converged, FemError> {
        if let Control::Actuator(u) = self.control {
            state.actuator = u;
        }
        impose(self.problem, state.grip, &mut state.u);
        let (mut imbalance, mut loop_error) = self.evaluate(system, state)?;
        // The first step leaves an equilibrium for a new load: it may be as bad as it likes.
        let mut best = f64::INFINITY;
        let mut near = None;
        for iteration in 0..=self.options.max_iterations {
            if imbalance <= self.options.tolerance && loop_error <= 1e-12 {
                return Ok(Converged { iterations: iteration, border: near });
            }
            if iteration == self.options.max_iterations || imbalance >= 1e12 || imbalance.is_nan() {
                break;
            }
            let border = Border::of(system, self.problem.multiplicity)?;
            let (du_g, du_a) = self.scalar_step(system, state, &border);
            let close = imbalance <= NEAR;
            (imbalance, loop_error) =
                self.line_search(system, state, &border, (du_g, du_a), best, iteration)?;
            near = close.then_some(border);
            best = best.min(imbalance);
        }
        Err(self.failure(&format!(
            "out-of-balance force {imbalance:.1e} after {} iterations",
            self.options.max_iterations
        )))
    }

    fn failure(&self, reason: &str) -> FemError {
        FemError::NoConvergence { displacement: self.old.actuator, step: 0.0, reason: reason.into() }
    }

    /// Assembles and measures: relative out-of-balance force, relative error of the train loop.
    fn evaluate(&self, system: &mut System, state: &mut State) -> Result<(f64, f64), FemError> {
        system.assemble(
            self.problem,
            self.local,
            &self.ctx,
            &state.u,
            &self.old.history,
            &mut state.history,
        )?;
        state.force = self.problem.multiplicity * system.grip_force;
        let (closing, _) = self.loop_closing(system, state);
        let length = self.length_scale(state);
        let arc = match self.control {
            Control::Actuator(_) => 0.0,
            Control::Arc { length, .. } => self.arc_error(system, state).abs() / length.max(1e-12),
        };
        // Below this the residual is rounding of deformation gradients near the unit tensor.
        let rounding = 10.0 * f64::EPSILON * system.stiffness_scale / self.options.tolerance;
        let floor = self.force_floor.max(1e-10 * system.stiffness_scale * length).max(rounding);
        Ok((system.imbalance() / system.force_scale.max(floor), (closing.abs() / length).max(arc * 1e-4)))
    }

    fn length_scale(&self, state: &State) -> f64 {
        state.actuator.abs().max(self.old.actuator.abs()).max(1e-3)
    }

    /// u_g + e(F) − s(u_a), and e'(F).
    fn loop_closing(&self, _system: &System, state: &mut State) -> (f64, f64) {
        let (e, slope) = train_elongation(
            self.problem,
            &self.local.train,
            &self.ctx,
            state.force,
            &self.old.history.train,
            &mut state.history.train,
        );
        let (s, _) = take_up(self.problem, &self.local.takeup, state.actuator);
        (state.grip + e - s, slope)
    }

    fn arc_error(&self, system: &System, state: &State) -> f64 {
        match self.control {
            Control::Actuator(_) => 0.0,
            Control::Arc { from, tangent, length } => {
                let w = mean_opening(system, &state.u, self.free);
                tangent[0] * (state.actuator - from[0]) + tangent[1] * (w - from[1]) - length
            }
        }
    }

    /// Newton step of the scalars (grip, actuator).
    fn scalar_step(&self, system: &System, state: &mut State, b: &Border) -> (f64, f64) {
        let (closing, slope) = self.loop_closing(system, state);
        // Linearised train: (1 + e' k) du_g + e' δF₀ + closing = s' du_a.
        let rhs = -(closing + slope * b.force_correction);
        let lhs = 1.0 + slope * b.stiffness;
        match self.control {
            Control::Actuator(_) => (rhs / lhs, 0.0),
            Control::Arc { tangent, .. } => {
                let (_, s_slope) = take_up(self.problem, &self.local.takeup, state.actuator);
                let along = |x: &[f64]| -> f64 { system.mean_opening.iter().map(|&(eq, w)| w * x[eq]).sum() };
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
    /// residual is taken. Early on a growing residual is no fault: the load has just changed.
    fn line_search(
        &self,
        system: &mut System,
        state: &mut State,
        b: &Border,
        (du_g, du_a): (f64, f64),
        best: f64,
        iteration: usize,
    ) -> Result<(f64, f64), FemError> {
        let start = (state.u.clone(), state.grip, state.actuator);
        let place = |state: &mut State, factor: f64| {
            state.grip = start.1 + factor * du_g;
            state.actuator = start.2 + factor * du_a;
            for (eq, &dof) in self.free.iter().enumerate() {
                state.u[dof] = start.0[dof] + factor * (b.correction[eq] + b.response[eq] * du_g);
            }
            impose(self.problem, state.grip, &mut state.u);
        };
        let allowed = if iteration < 4 { (10.0 * best).max(1e-6) } else { 0.9 * best };
        let mut tried: Option<(f64, f64, f64)> = None;
        let mut fault = None;
        for factor in [1.0, 0.5, 0.25, 0.1, 0.04] {
            place(state, factor);
            match self.evaluate(system, state) {
                Ok((imbalance, closing)) => {
                    if imbalance <= allowed || imbalance <= self.options.tolerance {
                        return Ok((imbalance, closing));
                    }
                    if tried.is_none_or(|t| imbalance < t.1) {
                        tried = Some((factor, imbalance, closing));
                    }
                }
                Err(e) => fault = Some(e),
            }
        }
        match tried {
            Some((factor, imbalance, closing)) => {
                place(state, factor);
                self.evaluate(system, state)?;
                Ok((imbalance, closing))
            }
            None => Err(fault.unwrap_or_else(|| self.failure("line search failed"))),
        }
    }
}

/// Degrees of freedom in equation order.
pub fn free_dofs(system: &System) -> Vec<usize> {
    let mut free = vec![0; system.unknowns];
    for (dof, &eq) in system.equation.iter().enumerate() {
        if eq != NONE {
            free[eq] = dof;
        }
    }
    free
}
