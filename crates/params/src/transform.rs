//! Bounded physical values seen by an optimiser as unbounded numbers.

use serde::{Deserialize, Serialize};

/// How a physical value is mapped to the coordinate an optimiser works in.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Transform {
    /// z = x; amplitudes that may be zero or negative.
    Identity,
    /// z = ln x; stiffnesses and strengths.
    Log,
    /// z = ln((x − lower)/(upper − x)); dispersion and angles.
    Logit {
        /// Lower end of the open interval.
        lower: f64,
        /// Upper end of the open interval.
        upper: f64,
    },
}

impl Transform {
    /// Optimiser coordinate of a physical value. The value is first pulled a hair inside the
    /// open domain, so that a value exactly on a bound stays finite.
    pub fn forward(self, x: f64) -> f64 {
        match self {
            Self::Identity => x,
            Self::Log => x.max(1e-300).ln(),
            Self::Logit { lower, upper } => {
                let s = ((x - lower) / (upper - lower)).clamp(1e-9, 1.0 - 1e-9);
                (s / (1.0 - s)).ln()
            }
        }
    }

    /// Physical value of an optimiser coordinate.
    pub fn backward(self, z: f64) -> f64 {
        match self {
            Self::Identity => z,
            Self::Log => z.exp(),
            Self::Logit { lower, upper } => lower + (upper - lower) / (1.0 + (-z).exp()),
        }
    }

    /// Whether a search cannot start at `x`: a limit (no fibres, all fibres along one line) that lies at infinity.
    pub fn is_limit(self, x: f64) -> bool {
        match self {
            Self::Identity => false,
            Self::Log => x <= 0.0,
            Self::Logit { lower, upper } => {
                let hair = 1e-12 * (upper - lower);
                x <= lower + hair || x >= upper - hair
            }
        }
    }

    /// dx/dz at the physical value `x`.
    pub fn slope(self, x: f64) -> f64 {
        match self {
            Self::Identity => 1.0,
            Self::Log => x,
            Self::Logit { lower, upper } => (x - lower) * (upper - x) / (upper - lower),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn backward_undoes_forward(x in 0.01f64..0.32) {
            for t in [Transform::Identity, Transform::Log, Transform::Logit { lower: 0.0, upper: 1.0 / 3.0 }] {
                prop_assert!((t.backward(t.forward(x)) - x).abs() < 1e-12);
            }
        }

        #[test]
        fn only_the_open_ends_are_limits(x in 0.01f64..0.32) {
            let angle = Transform::Logit { lower: 0.0, upper: 1.0 / 3.0 };
            for t in [Transform::Identity, Transform::Log, angle] {
                prop_assert!(!t.is_limit(x));
            }
            prop_assert!(Transform::Log.is_limit(0.0) && !Transform::Identity.is_limit(0.0));
            prop_assert!(angle.is_limit(0.0) && angle.is_limit(1.0 / 3.0) && !angle.is_limit(0.3333));
        }

        #[test]
        fn slope_is_the_derivative(x in 0.01f64..0.32) {
            for t in [Transform::Identity, Transform::Log, Transform::Logit { lower: 0.0, upper: 1.0 / 3.0 }] {
                let (z, h) = (t.forward(x), 1e-6);
                let fd = (t.backward(z + h) - t.backward(z - h)) / (2.0 * h);
                prop_assert!((fd - t.slope(x)).abs() < 1e-8);
            }
        }
    }
}
