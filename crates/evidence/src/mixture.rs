//! What a model, and many models together, say of a quantity: mixtures of normal distributions.

use crate::linear::{Parameter, Solved};
use crate::model::{Evidence, View};
use crate::rest::RestPrior;
use crate::special::phi;
use crate::truncated::Belief;
use nalgebra::{DMatrix, DVector};

/// Sizes of the rest that weigh less are left out.
const NEGLIGIBLE: f64 = 1e-4;
/// Slices of equal probability in which an amplitude near its bound is taken.
const SLICES: usize = 8;
/// An amplitude whose mode is no farther from its bound, standard deviations, is near it.
const NEAR: f64 = 3.0;

/// One part of a mixture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Normal {
    /// Share of the mixture, up to a common factor.
    pub weight: f64,
    /// Mean.
    pub mean: f64,
    /// Standard deviation.
    pub sd: f64,
}

/// A quantity at values of a model's parameters, all in the coordinates of their transforms: its value and its gradient.
pub type Quantity<'a> = dyn Fn(&DVector<f64>) -> (f64, DVector<f64>) + 'a;

impl Evidence {
    /// What the model says of some quantities, one list of parts each, in the quantity's own unit: a mixture over the sizes of the rest whose weights sum to 1; the quantities to
    /// first order in the parameters. `beyond` is the prior probability of a cause outside the catalogue. What an amplitude near its
    /// bound has to do with a quantity is known to be on one side.
    pub fn says(&self, rest: &RestPrior, beyond: f64, quantities: &[&Quantity]) -> Vec<Vec<Normal>> {
        let weights = self.weights(&View { rest, amplitude: 1.0 }, beyond);
        let kept = |w: f64| w > NEGLIGIBLE;
        let sum: f64 = weights.iter().filter(|w| kept(**w)).sum();
        let mut out = vec![Vec::new(); quantities.len()];
        for (k, w) in weights.iter().enumerate().filter(|(_, w)| kept(**w)) {
            let solved = self.solved(k);
            for (parts, quantity) in out.iter_mut().zip(quantities) {
                let of_node = self.at_node(&solved, quantity);
                parts.extend(of_node.into_iter().map(|n| Normal { weight: n.weight * w / sum, ..n }));
            }
        }
        out
    }

    /// The same at one size of the rest. A quantity is followed along its tangent at the point of linearisation, as the model is: what
    /// a record fixes of many parameters together stays fixed then, however far each of them goes.
    fn at_node(&self, solved: &Solved, quantity: &Quantity) -> Vec<Normal> {
        let p = self.parameters.len();
        let covariance = solved.covariance().view((0, 0), (p, p)).into_owned();
        let (at, gradient) = quantity(&DVector::from_fn(p, |i, _| self.parameters[i].at));
        let along = &covariance * &gradient;
        let variance = gradient.dot(&along);
        let Some((a, amplitude)) = self.near_its_bound(solved, &covariance) else {
            let step = solved.bounded_step(&self.parameters);
            let mean = at + gradient.dot(&step.rows(0, p));
            return vec![Normal { weight: 1.0, mean, sd: variance.max(0.0).sqrt() }];
        };
        let free = at + gradient.dot(&solved.step.rows(0, p));
        let left = (variance - along[a] * along[a] / covariance[(a, a)]).max(0.0).sqrt();
        let slice = |j: usize| {
            let value = amplitude.quantile((j as f64 + 0.5) / SLICES as f64);
            let mean = free + along[a] / covariance[(a, a)] * (value - amplitude.mean);
            Normal { weight: 1.0 / SLICES as f64, mean, sd: left }
        };
        (0..SLICES).map(slice).collect()
    }

    /// The amplitude that is nearest to its bound, if one is near, with what the records say of it without the others.
    fn near_its_bound(&self, solved: &Solved, covariance: &DMatrix<f64>) -> Option<(usize, Belief)> {
        let said = |i: usize| {
            let Parameter { at, belief, .. } = &self.parameters[i];
            Belief { mean: at + solved.step[i], sd: covariance[(i, i)].sqrt(), ..*belief }
        };
        let room = |b: &Belief| (b.mean - b.lower).min(b.upper - b.mean) / b.sd;
        (0..self.parameters.len())
            .filter(|&i| self.parameters[i].amplitude)
            .map(|i| (i, said(i)))
            .filter(|(_, b)| b.sd > 0.0 && room(b) < NEAR)
            .min_by(|(_, a), (_, b)| room(a).total_cmp(&room(b)))
    }
}

/// The value below which a share `p`, 0 < p < 1, of a mixture of normal distributions lies, each cut off at the bounds, in the
/// coordinate of their means; by bisection. Weights need not sum to 1; NaN where there is no part.
///
/// # Panics
/// When the bounds are not in order.
pub fn quantile(parts: &[Normal], [lower, upper]: [f64; 2], p: f64) -> f64 {
    if parts.is_empty() {
        return f64::NAN;
    }
    let below = |x: f64| {
        let (mut sum, mut total) = (0.0, 0.0);
        for &Normal { weight, mean, sd } in parts {
            let (a, b) = (phi((lower - mean) / sd), phi((upper - mean) / sd));
            total += weight;
            // Where all of it lies beyond a bound, it stands on that bound.
            sum += weight
                * if b - a > 1e-12 {
                    ((phi((x - mean) / sd) - a) / (b - a)).clamp(0.0, 1.0)
                } else {
                    f64::from(u8::from(x >= mean.clamp(lower, upper)))
                };
        }
        sum / total
    };
    let ends = |sign: f64| parts.iter().map(move |n| n.mean + sign * 9.0 * n.sd);
    let mut low = ends(-1.0).fold(f64::INFINITY, f64::min).clamp(lower, upper);
    let mut high = ends(1.0).fold(f64::NEG_INFINITY, f64::max).clamp(lower, upper);
    for _ in 0..80 {
        let middle = 0.5 * (low + high);
        if below(middle) < p { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

#[cfg(test)]
mod tests;
