//! Homogeneous uniaxial tension along y with stress-free sides: the law without finite elements.
//!
//! F = diag(λx, λy, λz), with λy given and λx, λz such that P_xx = P_zz = 0. For a law that
//! answers a diagonal F with a diagonal P: isotropic, or two symmetric families in the x–y plane.
//! No history is carried over, so the law must have no history.

use constitutive::{Context, Jet, Law};

/// A state of uniaxial tension.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct State {
    /// Stretch along the load, λy.
    pub stretch: f64,
    /// Lateral stretches, [λx, λz].
    pub lateral: [f64; 2],
    /// Nominal (first Piola) stress P_yy, MPa.
    pub nominal_stress: f64,
    /// dP_yy/dλy with the sides free, MPa.
    pub modulus: f64,
    /// Energy Ψ, MPa.
    pub energy: f64,
}

/// Why a curve stopped.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum Error {
    /// No lateral stretches with stress-free sides were found, even in small steps from the last
    /// state: the exponential overflows, or the parameters are out of range.
    #[error("uniaxial tension: no equilibrium found between stretches {reached} and {wanted}")]
    NoEquilibrium {
        /// Last stretch with a solution.
        reached: f64,
        /// Stretch asked for.
        wanted: f64,
    },
}

const UNLOADED: [f64; 2] = [1.0, 1.0];
const ITERATIONS: usize = 60;
/// How often a step between two stretches is halved before giving up.
const HALVINGS: usize = 10;

/// Nominal stress and lateral stretches at each of `stretches`, in order, each starting from the
/// one before and the first from the unloaded state.
pub fn curve<L: Law<Jet<3>, 9>>(law: &L, params: &[f64], stretches: &[f64]) -> Result<Vec<State>, Error> {
    let mut from = (1.0, UNLOADED);
    let mut states = Vec::with_capacity(stretches.len());
    for &stretch in stretches {
        let state = advance(law, params, from, stretch, HALVINGS)?;
        from = (stretch, state.lateral);
        states.push(state);
    }
    Ok(states)
}

/// The state at one stretch, reached from the unloaded state.
pub fn at<L: Law<Jet<3>, 9>>(law: &L, params: &[f64], stretch: f64) -> Result<State, Error> {
    advance(law, params, (1.0, UNLOADED), stretch, HALVINGS)
}

fn advance<L: Law<Jet<3>, 9>>(
    law: &L,
    params: &[f64],
    from: (f64, [f64; 2]),
    stretch: f64,
    halvings: usize,
) -> Result<State, Error> {
    // The sides of a nearly incompressible material contract by λ^(−1/2) in the mean.
    let contraction = (stretch / from.0).powf(-0.5);
    let guess = from.1.map(|l| l * contraction);
    if let Some(state) = newton(law, params, stretch, guess) {
        return Ok(state);
    }
    if halvings == 0 {
        return Err(Error::NoEquilibrium { reached: from.0, wanted: stretch });
    }
    let middle = 0.5 * (from.0 + stretch);
    let half = advance(law, params, from, middle, halvings - 1)?;
    advance(law, params, (middle, half.lateral), stretch, halvings - 1)
}

/// Residual, its derivatives and the stress at logarithmic lateral stretches `z`: seeds 0, 1 are
/// z, seed 2 is λy. P_xx λx and P_zz λz are the derivatives of Ψ with respect to z.
struct Point {
    residual: [Jet<3>; 2],
    stress: Jet<3>,
    energy: f64,
}

fn evaluate<L: Law<Jet<3>, 9>>(law: &L, params: &[Jet<3>], stretch: f64, z: [f64; 2]) -> Point {
    let o = Jet::constant(0.0);
    let (x, y) = (exp_variable(z[0], 0), Jet::variable(stretch, 2));
    let w = exp_variable(z[1], 1);
    let r = law.respond(&Context::default(), &[x, o, o, o, y, o, o, o, w], params, &[], &mut []);
    Point { residual: [r.force[0] * x, r.force[8] * w], stress: r.force[4], energy: r.energy.re }
}

fn exp_variable(z: f64, i: usize) -> Jet<3> {
    constitutive::Scalar::exp(Jet::variable(z, i))
}

impl Point {
    fn size(&self) -> f64 {
        self.residual[0].re.hypot(self.residual[1].re)
    }

    /// Solution of (∂residual/∂z) x = −`rhs`.
    fn solve(&self, rhs: [f64; 2]) -> [f64; 2] {
        let ([a, b, _], [c, d, _]) = (self.residual[0].eps, self.residual[1].eps);
        let det = a * d - b * c;
        [(b * rhs[1] - d * rhs[0]) / det, (c * rhs[0] - a * rhs[1]) / det]
    }
}

fn newton<L: Law<Jet<3>, 9>>(law: &L, params: &[f64], stretch: f64, guess: [f64; 2]) -> Option<State> {
    let params: Vec<Jet<3>> = params.iter().map(|&p| Jet::constant(p)).collect();
    let mut z = guess.map(f64::ln);
    let mut here = evaluate(law, &params, stretch, z);
    for _ in 0..ITERATIONS {
        let full = here.solve([here.residual[0].re, here.residual[1].re]);
        let length = full[0].hypot(full[1]);
        if !length.is_finite() {
            return None;
        }
        // The step itself measures convergence: it needs no stress scale. The last step is
        // taken before the answer.
        let done = length < 1e-9;
        let mut scale = (0.2 / length).min(1.0);
        loop {
            let trial = [z[0] + scale * full[0], z[1] + scale * full[1]];
            let there = evaluate(law, &params, stretch, trial);
            if done || there.size() < here.size() {
                (z, here) = (trial, there);
                break;
            }
            scale *= 0.5;
            if scale * length < 1e-12 {
                return None;
            }
        }
        if done {
            return Some(here.state(stretch, z));
        }
    }
    None
}

impl Point {
    fn state(&self, stretch: f64, z: [f64; 2]) -> State {
        let dz = self.solve([self.residual[0].eps[2], self.residual[1].eps[2]]);
        let s = self.stress.eps;
        State {
            stretch,
            lateral: z.map(f64::exp),
            nominal_stress: self.stress.re,
            modulus: s[2] + s[0] * dz[0] + s[1] * dz[1],
            energy: self.energy,
        }
    }
}
