//! Normal distributions cut off at bounds.

use crate::special::{ln_phi, phi_inverse};
use nalgebra::{DMatrix, DVector};
use serde::Serialize;

/// What is believed of a parameter before the record: a normal distribution, cut off at bounds, in the coordinate of the
/// parameter's transform. A half-normal one has its mean at its lower (or upper) bound.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Belief {
    /// Mean before cutting.
    pub mean: f64,
    /// Standard deviation before cutting, positive.
    pub sd: f64,
    /// Smallest value; may be −∞.
    pub lower: f64,
    /// Largest value; may be +∞.
    pub upper: f64,
}

impl Belief {
    /// Normal, without bounds.
    pub const fn normal(mean: f64, sd: f64) -> Self {
        Self { mean, sd, lower: f64::NEG_INFINITY, upper: f64::INFINITY }
    }

    /// Half-normal on the upper side of `neutral`: an amplitude that has a sign.
    pub const fn above(neutral: f64, sd: f64) -> Self {
        Self { mean: neutral, sd, lower: neutral, upper: f64::INFINITY }
    }

    /// Half-normal on the lower side of `neutral`.
    pub const fn below(neutral: f64, sd: f64) -> Self {
        Self { mean: neutral, sd, lower: f64::NEG_INFINITY, upper: neutral }
    }

    /// The same within bounds.
    pub const fn within(self, lower: f64, upper: f64) -> Self {
        Self { lower, upper, ..self }
    }

    /// ln of the probability that the bounds leave.
    pub(crate) fn ln_mass(&self) -> f64 {
        ln_interval((self.lower - self.mean) / self.sd, (self.upper - self.mean) / self.sd)
    }

    /// A draw: the value below which a share `u` of the belief lies, 0 < u < 1.
    pub fn quantile(&self, u: f64) -> f64 {
        let p = |x: f64| crate::special::phi((x - self.mean) / self.sd);
        let (a, b) = (p(self.lower), p(self.upper));
        let x = self.mean + self.sd * phi_inverse((a + u * (b - a)).clamp(1e-300, 1.0 - 1e-16));
        x.clamp(self.lower, self.upper)
    }
}

/// ln[Φ(b) − Φ(a)], a < b, exact in both tails.
pub(crate) fn ln_interval(a: f64, b: f64) -> f64 {
    if a > 0.0 {
        return ln_interval(-b, -a);
    }
    let (high, low) = (ln_phi(b), ln_phi(a));
    if low == f64::NEG_INFINITY { high } else { high + (-(low - high).exp()).ln_1p() }
}

/// Mean and variance of a standard normal number between a and b.
fn moments(a: f64, b: f64) -> (f64, f64) {
    let ln_p = ln_interval(a, b);
    let density = |x: f64| {
        if x.is_finite() { (-0.5 * x * x - 0.918_938_533_204_672_8 - ln_p).exp() } else { 0.0 }
    };
    let (at_a, at_b) = (density(a), density(b));
    let mean = at_a - at_b;
    let moved = |x: f64, d: f64| if x.is_finite() { x * d } else { 0.0 };
    (mean, (1.0 + moved(a, at_a) - moved(b, at_b) - mean * mean).max(1e-12))
}

/// ln of the probability that a normal vector (mean, covariance) lies between its bounds: exact for one, else by one
/// pass of conditioning in which what was cut off stays normal (Mendell & Elston 1974), the least probable first.
pub(crate) fn ln_box(mean: &DVector<f64>, covariance: &DMatrix<f64>, bounds: &[(f64, f64)]) -> f64 {
    let (mut m, mut c) = (mean.clone(), covariance.clone());
    let mut left: Vec<usize> = (0..m.len()).collect();
    let mut total = 0.0;
    while !left.is_empty() {
        let cut = |k: usize, m: &DVector<f64>, c: &DMatrix<f64>| {
            let sd = c[(k, k)].max(1e-300).sqrt();
            ((bounds[k].0 - m[k]) / sd, (bounds[k].1 - m[k]) / sd, sd)
        };
        let ln_p = |k: usize| {
            let (a, b, _) = cut(k, &m, &c);
            ln_interval(a, b)
        };
        let each: Vec<f64> = left.iter().map(|&k| ln_p(k)).collect();
        let Some(at) = (0..left.len()).min_by(|&i, &j| each[i].total_cmp(&each[j])) else { break };
        let k = left.remove(at);
        total += each[at];
        if left.is_empty() {
            break;
        }
        let (a, b, sd) = cut(k, &m, &c);
        let (shift, spread) = moments(a, b);
        let column: DVector<f64> = c.column(k) / sd;
        m += &column * shift;
        c -= &column * column.transpose() * (1.0 - spread);
    }
    total
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn intervals_are_exact_in_the_tails() {
        let half = f64::INFINITY;
        assert!((ln_interval(0.0, half) + std::f64::consts::LN_2).abs() < 1e-15);
        assert!((ln_interval(10.0, half) - ln_phi(-10.0)).abs() < 1e-12);
        assert!((ln_interval(-1.0, 1.0) - 0.682_689_492_137_f64.ln()).abs() < 1e-10);
        // φ(30)·width, to first order in the width.
        let want = -450.0 - 0.918_938_533_204_672_8 + 1e-6f64.ln();
        assert!((ln_interval(30.0, 30.000_001) - want).abs() < 1e-3);
    }

    #[test]
    fn boxes_of_two_agree_with_quadrature() {
        for (rho, m) in [(0.0, [0.3, -0.5]), (0.7, [0.3, -0.5]), (-0.7, [1.0, 0.2]), (-0.5, [-1.5, -1.0])] {
            let c = DMatrix::from_row_slice(2, 2, &[1.0, rho, rho, 1.0]);
            let n = 4000;
            let h = 12.0 / f64::from(n);
            let sum: f64 = (0..n)
                .map(|i| {
                    let x = h * (f64::from(i) + 0.5);
                    let d = x - m[0];
                    let second = (m[1] + rho * d) / f64::sqrt(1.0 - rho * rho);
                    h * (-0.5 * d * d).exp() / std::f64::consts::TAU.sqrt() * crate::special::phi(second)
                })
                .sum();
            let got = ln_box(&DVector::from_row_slice(&m), &c, &[(0.0, f64::INFINITY); 2]);
            assert!((got - sum.ln()).abs() < 0.06, "{rho} {m:?}: {got} {}", sum.ln());
        }
    }

    #[test]
    fn quantiles_stay_within_bounds() {
        let b = Belief::above(0.0, 2.0);
        assert!((b.quantile(0.5) - 2.0 * 0.674_489_750_196).abs() < 1e-8);
        assert!(b.quantile(1e-12) >= 0.0);
    }
}
