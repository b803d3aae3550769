//! Asymmetric intervals: the standard error changes along them.
//!
//! A true value belongs into a 95 % interval where its *own* standard error allows the estimate that was found (Neyman
//! 1937). One standard error for both sides, that of the estimate, is right where it is the same everywhere: a tear whose
//! process zone shrinks below the elements knows its strength far less on one side than on the other. So the standard
//! errors are asked once more at both ends of the least known combinations of parameters ([`Uncertainty::probes`]), and
//! each side takes their mean along it ([`Uncertainty::with_asymmetric_intervals`]). No side gets shorter for it.

use crate::Uncertainty;
use crate::half_width::Z95;
use nalgebra::{DMatrix, DVector};

/// No combination is followed beyond the 95 % of this standard deviation, in natural scales: what the data do not fix has
/// no end to go to.
const FARTHEST_SD: f64 = 0.5;

/// A side is at most so much longer, as a share of its length: the change is linear in two points.
const LONGEST: f64 = 1.0;

/// A place where the standard errors are asked again.
#[derive(Clone, Debug, PartialEq)]
pub struct Probe {
    /// Values there, one per free parameter, physical units, within the bounds.
    pub theta: Vec<f64>,
    /// Correlation of each parameter with the combination, times the side.
    loading: Vec<f64>,
}

impl Uncertainty {
    /// Both ends of the 95 % intervals of the `axes` least known combinations of identifiable parameters; the other
    /// parameters follow as the covariance says. Empty where nothing is identifiable.
    pub fn probes(&self, axes: usize) -> Vec<Probe> {
        let known: Vec<usize> = (0..self.estimates.len())
            .filter(|&k| self.estimates[k].identifiable && !self.estimates[k].at_bound)
            .collect();
        let scaled = |i: usize, j: usize| self.covariance_z[(i, j)] / (self.scales[i] * self.scales[j]);
        let own = DMatrix::from_fn(known.len(), known.len(), |a, b| scaled(known[a], known[b]));
        if known.is_empty() || own.iter().any(|v| !v.is_finite()) {
            return Vec::new();
        }
        let eigen = own.symmetric_eigen();
        let mut order: Vec<usize> =
            (0..known.len()).filter(|&k| eigen.eigenvalues[k] > f64::MIN_POSITIVE).collect();
        order.sort_by(|&a, &b| eigen.eigenvalues[b].total_cmp(&eigen.eigenvalues[a]).then(a.cmp(&b)));
        let mut out = Vec::new();
        for &axis in order.iter().take(axes) {
            let sd = eigen.eigenvalues[axis].sqrt();
            // Covariance of every parameter with the combination in its own standard deviations.
            let along = DVector::from_fn(self.scales.len(), |i, _| {
                let sum: f64 =
                    (0..known.len()).map(|a| scaled(i, known[a]) * eigen.eigenvectors[(a, axis)]).sum();
                sum / sd * self.scales[i]
            });
            let length = Z95 * (FARTHEST_SD / sd).min(1.0);
            out.extend([1.0, -1.0].map(|side| self.probe(&along, side, length)));
        }
        out
    }

    fn probe(&self, along: &DVector<f64>, side: f64, length: f64) -> Probe {
        let moved =
            |k: usize| self.free[k].backward(self.free[k].forward(self.theta[k]) + side * length * along[k]);
        let sd = |k: usize| self.covariance_z[(k, k)].max(f64::MIN_POSITIVE).sqrt();
        let all = 0..self.theta.len();
        Probe {
            theta: all
                .clone()
                .map(|k| if self.estimates[k].at_bound { self.theta[k] } else { moved(k) })
                .collect(),
            loading: all.map(|k| side * (along[k] / sd(k)).clamp(-1.0, 1.0)).collect(),
        }
    }

    /// The same with asymmetric intervals, from how the standard errors change towards the probes: `there` is what the same data say
    /// with the optimum at each probe, `None` where there is no answer. A parameter takes part as far as it loads on a
    /// probe's combination; estimates and standard errors stay. `there` has one answer per probe, in their order and over the
    /// same free parameters; both come from [`Uncertainty::probes`] of this uncertainty.
    pub fn with_asymmetric_intervals(mut self, probes: &[Probe], there: &[Option<Uncertainty>]) -> Self {
        for k in 0..self.estimates.len() {
            if self.estimates[k].at_bound {
                continue;
            }
            let here = self.covariance_z[(k, k)].max(f64::MIN_POSITIVE).sqrt();
            // Half of each pair's difference is the change towards one end, half of that the mean along that side.
            let tilt: f64 = probes
                .iter()
                .zip(there)
                .filter_map(|(p, u)| Some((p.loading[k], u.as_ref()?.covariance_z[(k, k)].sqrt())))
                // At a bound there is no standard error.
                .filter(|(_, sd)| *sd > 0.0 && sd.is_finite())
                .map(|(loading, sd)| loading * (sd / here - 1.0))
                .sum();
            let longer = (0.25 * tilt).clamp(-LONGEST, LONGEST);
            let interval = self.estimate(k, [1.0 + (-longer).max(0.0), 1.0 + longer.max(0.0)]).interval_95;
            (self.estimates[k].interval_95, self.estimates[k].interval_95_if_right) = (interval, interval);
        }
        self
    }
}
