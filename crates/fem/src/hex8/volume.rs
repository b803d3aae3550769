//! Volume and pressure of a brick during Newton's iterations.
//!
//! Displacements that solve a linearised step change the volume to second order too, and a large bulk modulus
//! makes of that a pressure far beyond the one looked for. As in a mixed method the pressure is therefore
//! carried over from iterate to iterate to first order and used where it multiplies second derivatives of the volume
//! (after the mixed integration points of Magisano, Leonetti and Garcea, Comput. Methods Appl. Mech. Eng. 313,
//! 2017, 986, there for slender bodies and the whole stress).
//! At convergence both pressures are one, and so are the equilibria found.

use super::deformation::{Lane, NO_LANES};

/// Where the pressure of the tangent's geometric part comes from.
#[derive(Clone, Copy, Debug)]
pub enum Pressure<'a> {
    /// The law, at the volume at hand.
    Own,
    /// A first guess, N·mm (mean stress times volume).
    Guessed(f64),
    /// An iterate, linearised.
    Linearised {
        /// The iterate that the Newton step left.
        from: &'a Volume,
        /// Share of the step taken.
        share: f64,
    },
}

/// Volume and pressure of a brick at an iterate.
#[derive(Clone, Copy, Debug)]
pub struct Volume {
    u: [Lane; 3],
    /// Derivative of the volume by the displacements over the volume, 1/mm.
    mean: [Lane; 3],
    /// Current volume, mm³.
    current: f64,
    /// Mean Cauchy stress of the law times volume, N·mm.
    pub pressure: f64,
    /// What that has beyond the pressure that the tangent uses, N·mm.
    pub excess: f64,
    /// v² dp/dv with the mean Cauchy stress p and the volume v, N·mm.
    pub(super) stiffness: f64,
}

impl Default for Volume {
    fn default() -> Self {
        Self { u: NO_LANES, mean: NO_LANES, current: 0.0, pressure: 0.0, excess: 0.0, stiffness: 0.0 }
    }
}

impl Volume {
    #[inline(always)]
    pub(super) fn at(u: [Lane; 3], mean: [Lane; 3], current: f64, pressure: f64, of: Pressure<'_>) -> Self {
        let excess = match of {
            Pressure::Own => 0.0,
            Pressure::Guessed(guess) => pressure - guess,
            Pressure::Linearised { from, share } => {
                let linear: f64 = (0..3).map(|i| (from.mean[i] * (u[i] - from.u[i])).reduce_add()).sum();
                // What the iterate itself had too much goes with the share of the step that was not taken.
                from.stiffness * (current / from.current - 1.0 - linear) + (1.0 - share) * from.excess
            }
        };
        Self { u, mean, current, pressure, excess, stiffness: 0.0 }
    }

    /// Residual of the excess at the brick's unknown `i`, N.
    pub fn excess_force(&self, i: usize) -> f64 {
        self.excess * self.mean[i % 3].as_array()[i / 3]
    }
}
