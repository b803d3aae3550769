//! Intervals of parameters that allow for what the model misses: a mixture over the sizes of the rest.

use crate::mixture::{Normal, quantile};
use crate::model::{Evidence, View};
use crate::rest::RestPrior;

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
                    noise_alone: self.nodes[k].support == 0,
                    normal: (0..self.parameters.len())
                        .map(|i| Normal {
                            weight: weights[k],
                            mean: self.parameters[i].at + solved.step[i],
                            sd: covariance[(i, i)].max(0.0).sqrt(),
                        })
                        .collect(),
                }
            })
            .collect();
        let one = |i: usize| {
            let all: Vec<Normal> = parts.iter().map(|p| p.normal[i]).collect();
            let alone = parts.iter().filter(|p| p.noise_alone);
            let right: Vec<Normal> = alone.map(|p| Normal { weight: 1.0, ..p.normal[i] }).collect();
            let belief = &self.parameters[i].belief;
            let q = |of: &[Normal], p: f64| quantile(of, [belief.lower, belief.upper], p);
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
    noise_alone: bool,
    normal: Vec<Normal>,
}
