//! The equations around the specimen: load train and control, in a border of the tangent.
//!
//! Unknowns: free displacements u_f and the grip displacement u_g (and the actuator displacement
//! u_a when a path is followed). The train closes the loop: u_g + Σ eᵢ(F) − s(u_a) = 0, with F the
//! work-conjugate force; zero compliance needs no special case.

use crate::error::FemError;
use crate::problem::Problem;
use crate::system::{NONE, System};
use constitutive::{Context, Jet, tangent_by_jets_1};

/// What is held while a step is solved.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Control {
    /// The actuator stands at this displacement, mm.
    Actuator(f64),
    /// Pseudo-arc length in the plane (actuator displacement, opening by [`System::opening`]):
    /// t_u (u_a − u₀) + t_w (w − w₀) = length.
    Arc {
        /// Start of the step: actuator displacement and opening, mm.
        from: [f64; 2],
        /// Unit tangent of the path at the start.
        tangent: [f64; 2],
        /// Arc length, mm.
        length: f64,
    },
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

/// Take-up s(u_a), its slope, and its new history (behind the train's, which is left alone). `from`: see [`Problem::take_up`].
pub fn take_up(
    problem: &Problem,
    params: &[Vec<f64>],
    (actuator, from): (f64, Option<f64>),
    old: &[f64],
    new: &mut [f64],
) -> (f64, f64) {
    if problem.takeup.is_empty() {
        return (actuator, 1.0);
    }
    let lift = |v: &[f64]| v.iter().map(|&x| Jet::constant(x)).collect::<Vec<Jet<1>>>();
    let params: Vec<Vec<Jet<1>>> = params.iter().map(|p| lift(p)).collect();
    let (old, mut after) = (lift(old), lift(new));
    let u = problem.take_up(Jet::<1>::variable(actuator, 0), from, &params, &old, &mut after);
    for (new, after) in new.iter_mut().zip(after) {
        *new = after.re;
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

/// Opening of the tear path by the measure of `system`, mm.
pub fn opening(system: &System, u: &[f64], free: &[usize]) -> f64 {
    system.opening.iter().map(|&(eq, w)| w * u[free[eq]]).sum()
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
