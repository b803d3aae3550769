//! Intervals of parameters that allow for what the model misses: a mixture over the sizes of the rest.

use crate::model::{Evidence, View};
use crate::rest::RestPrior;
use crate::special::phi;
use crate::truncated::Belief;

/// A parameter's 95 % intervals in the coordinate of its transform.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    /// Median, allowing for the rest.
    pub median: f64,
    /// 2.5 and 97.5 %, allowing for the rest.
    pub with_rest: [f64; 2],
    /// The same if the model were right: noise and the mesh's error alone.
    pub if_right: [f64; 2],
}

impl Evidence {
    /// Intervals of every parameter. `beyond` is the prior probability of a cause outside the catalogue.
    pub fn intervals(&self, rest: &RestPrior, beyond: f64) -> Vec<Interval> {
        let weights = self.weights(&View { rest, amplitude: 1.0 }, beyond);
        let parts: Vec<Part> = (0..self.nodes.len())
            .filter(|&k| weights[k] > 1e-6 || self.nodes[k].support == 0)
            .map(|k| {
                let solved = self.solved(k);
                let covariance = solved.covariance();
                Part {
                    weight: weights[k],
                    noise_alone: self.nodes[k].support == 0,
                    normal: (0..self.parameters.len())
                        .map(|i| (self.parameters[i].at + solved.step[i], covariance[(i, i)].max(0.0).sqrt()))
                        .collect(),
                }
            })
            .collect();
        let one = |i: usize| {
            let all: Vec<(f64, f64, f64)> =
                parts.iter().map(|p| (p.weight, p.normal[i].0, p.normal[i].1)).collect();
            let right: Vec<(f64, f64, f64)> =
                parts.iter().filter(|p| p.noise_alone).map(|p| (1.0, p.normal[i].0, p.normal[i].1)).collect();
            let belief = &self.parameters[i].belief;
            let q = |of: &[(f64, f64, f64)], p: f64| quantile(of, belief, p);
            Interval {
                median: q(&all, 0.5),
                with_rest: [q(&all, 0.025), q(&all, 0.975)],
                if_right: [q(&right, 0.025), q(&right, 0.975)],
            }
        };
        (0..self.parameters.len()).map(one).collect()
    }
}

struct Part {
    weight: f64,
    noise_alone: bool,
    normal: Vec<(f64, f64)>,
}

/// Quantile of a mixture (weight, mean, sd) of normal distributions, each cut off at the belief's bounds; by bisection.
fn quantile(parts: &[(f64, f64, f64)], belief: &Belief, p: f64) -> f64 {
    let mass = |m: f64, s: f64| (phi((belief.lower - m) / s), phi((belief.upper - m) / s));
    let below = |x: f64| {
        let (mut sum, mut total) = (0.0, 0.0);
        for &(w, m, s) in parts {
            let (a, b) = mass(m, s);
            total += w;
            // Where all of it lies beyond a bound, it stands on that bound.
            sum += w * if b - a > 1e-12 {
                ((phi((x - m) / s) - a) / (b - a)).clamp(0.0, 1.0)
            } else {
                f64::from(u8::from(x >= m.clamp(belief.lower, belief.upper)))
            };
        }
        sum / total
    };
    let low = parts
        .iter()
        .map(|(_, m, s)| m - 9.0 * s)
        .fold(f64::INFINITY, f64::min)
        .clamp(belief.lower, belief.upper);
    let high = parts
        .iter()
        .map(|(_, m, s)| m + 9.0 * s)
        .fold(f64::NEG_INFINITY, f64::max)
        .clamp(belief.lower, belief.upper);
    let (mut low, mut high) = (low, high);
    for _ in 0..80 {
        let middle = 0.5 * (low + high);
        if below(middle) < p { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}
