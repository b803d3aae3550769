//! How much is left: the rest itself, drawn from its posterior.

use crate::linear::Linear;
use crate::model::{Evidence, Kernel, View};
use crate::node::{Node, reduce};
use crate::record::{EvidenceError, Record};
use crate::rest::{RestPrior, RestSize};
use crate::shares::Shares;
use inverse::Random;
use nalgebra::DVector;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// A share of the peak with its interval.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Share {
    /// Median of the root mean square of the rest, share of the peak.
    pub share_of_peak: f64,
    /// 95 % interval.
    pub interval_95: [f64; 2],
}

/// What a model leaves unexplained beyond noise.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Remains {
    /// Over all tests.
    #[serde(flatten)]
    pub all: Share,
    /// For each test.
    pub tests: BTreeMap<String, Share>,
    /// Posterior probability that nothing at all is left.
    #[serde(skip)]
    pub none: f64,
    /// The same before the records are looked at.
    #[serde(skip)]
    pub none_before: f64,
}

/// What a record is explained to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ExplainedTo {
    /// Noise (and the mesh) explain what is left: the records speak rather for nothing beyond them than against it.
    Noise,
    /// The rest is no larger than a complete model of such a test leaves in practice.
    Practice,
    /// It is larger.
    Not,
}

impl Remains {
    /// `practice`: the largest share of the peak that a complete model leaves (`[diagnose] practice`, 0.02).
    pub fn explained_to(&self, practice: f64) -> ExplainedTo {
        if self.none >= self.none_before {
            ExplainedTo::Noise
        } else if self.all.share_of_peak <= practice {
            ExplainedTo::Practice
        } else {
            ExplainedTo::Not
        }
    }
}

const DRAWS: usize = 400;

/// Draws the rest of a model from its posterior. Sizes of the rest are taken in proportion to their weights; given one, parameters from their
/// normal posterior, and the rest by correcting a draw from the prior with what it gets wrong (Matheron's
/// rule): δ = δ* + K C⁻¹(r − Hx − δ* − ε*), K C⁻¹u = u − R C⁻¹u. The same numbers on every call.
pub fn remains(
    record: &Record,
    linear: &Linear,
    evidence: &Evidence,
    rest: &RestPrior,
    beyond: f64,
) -> Remains {
    let shares = Shares::of(record, linear);
    let weights = evidence.weights(&View { rest, amplitude: 1.0 }, beyond);
    let none = evidence.noise_alone(&View { rest, amplitude: 1.0 }, beyond);
    let mut random = Random::new(20_260_727);
    let mut names: Vec<&str> = record.blocks.iter().map(|b| b.test.as_str()).collect();
    names.dedup();
    let (mut all, mut each) = (Vec::new(), vec![Vec::new(); names.len()]);
    let (mut node, mut below) = (0, weights.first().copied().unwrap_or(1.0));
    for k in 0..DRAWS {
        let u = (k as f64 + 0.5) / DRAWS as f64;
        while below < u && node + 1 < weights.len() {
            node += 1;
            below += weights[node];
        }
        let squares = one_draw(record, &shares, evidence, node, &mut random);
        let (mut sum, mut count) = (0.0, 0.0);
        for (name, shares) in names.iter().zip(&mut each) {
            let of = record.blocks.iter().zip(&squares).filter(|(b, _)| b.test == *name);
            let (s, n) = of.fold((0.0, 0.0), |(s, n), (b, q)| (s + q, n + b.rows.len() as f64));
            shares.push(f64::sqrt(s / f64::max(n, 1.0)));
            (sum, count) = (sum + s, count + n);
        }
        all.push(f64::sqrt(sum / f64::max(count, 1.0)));
    }
    let tests = names.iter().zip(each).map(|(n, s)| ((*n).to_owned(), share(s))).collect();
    let none_before = rest.zero * rest.zero * (1.0 - beyond);
    Remains { all: share(all), tests, none, none_before }
}

/// Mean square of a model's misfit beyond that of the noise, where its parameters are moved to the least squares of its linearisation; of
/// shares of the peak, 0 at least.
///
/// # Errors
/// [`EvidenceError`] when the model does not fit the record.
pub fn excess(record: &Record, linear: &Linear) -> Result<f64, EvidenceError> {
    linear.check(record)?;
    let shares = Shares::of(record, linear);
    let reduced = reduce(record, &shares, (RestSize::NONE, None), Kernel::Plain);
    let step = reduced.solve(&linear.parameters, 0.5).bounded_step(&linear.parameters);
    let q = shares.x.ncols() - 1;
    let misfit = shares.x.column(q) - shares.x.columns(0, q) * step.rows(0, q);
    let (mut sum, mut at) = (0.0, 0);
    for (block, jumps) in record.blocks.iter().zip(&shares.jumps) {
        let noise = block.points.sd.powi(2);
        for k in 0..block.rows.len() {
            // Where the model jumps its misfit counts as little as what is known of it there.
            let known = noise / (noise + jumps.get(k).map_or(0.0, |j| j * j));
            sum += known * (misfit[at + k].powi(2) - noise);
        }
        at += block.rows.len();
    }
    Ok((sum / record.used as f64).max(0.0))
}

/// Sum of squares of the rest in each block.
fn one_draw(
    record: &Record,
    shares: &Shares,
    evidence: &Evidence,
    node: usize,
    random: &mut Random,
) -> Vec<f64> {
    let Node { size, only, support, .. } = evidence.nodes[node];
    if support == 0 {
        return vec![0.0; record.blocks.len()];
    }
    let solved = evidence.solved(node);
    let x = &shares.x;
    let q = x.ncols() - 1;
    let z = random.normals(q);
    let spread = solved.root.solve_upper_triangular(&z).unwrap_or_else(|| DVector::zeros(q));
    let u = x.column(q) - x.columns(0, q) * (&solved.step + spread);
    let mut at = 0;
    let mut squares = Vec::new();
    for process in shares.processes(record, size, only) {
        let (prior, noise) = process.draw(random);
        let n = prior.len();
        let wrong: Vec<f64> = (0..n).map(|i| u[at + i] - prior[i] - noise[i]).collect();
        let mut solved = wrong.clone();
        process.solve(&mut solved);
        let back = process.noise_times(&solved);
        squares.push((0..n).map(|i| (prior[i] + wrong[i] - back[i]).powi(2)).sum());
        at += n;
    }
    squares
}

fn share(mut values: Vec<f64>) -> Share {
    values.sort_by(f64::total_cmp);
    let at = |p: f64| values.get((p * values.len() as f64) as usize).copied().unwrap_or(0.0);
    Share { share_of_peak: at(0.5), interval_95: [at(0.025), at(0.975)] }
}
