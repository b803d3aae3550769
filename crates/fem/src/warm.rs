//! First guesses from an earlier run over the same plan: its states, moved by their derivatives to
//! the new parameters.

use crate::state::Guess;
use crate::stepping::{Kept, Run};
use std::sync::Arc;

/// States of an earlier run over the same plan, with their derivatives where that run had them.
#[derive(Clone, Debug, Default)]
pub struct Warm {
    /// State at each target, where known.
    pub at_target: Vec<Option<Arc<Kept>>>,
    first_order: Option<FirstOrder>,
}

/// How the states move with the parameters.
#[derive(Clone, Debug)]
struct FirstOrder {
    theta: Vec<f64>,
    seeds: Vec<usize>,
    at_target: Vec<Option<Arc<Vec<f32>>>>,
}

impl Warm {
    /// The states of a run that kept them.
    pub fn of(run: &Run, targets: usize) -> Self {
        Self { at_target: pick(run, &run.states, targets), first_order: None }
    }

    /// States known at some targets only.
    pub const fn at(at_target: Vec<Option<Arc<Kept>>>) -> Self {
        Self { at_target, first_order: None }
    }

    /// The states with their derivatives by `seeds` (none: the states alone), of a run at `theta` that kept both.
    pub fn first_order(run: &Run, targets: usize, theta: &[f64], seeds: &[usize]) -> Self {
        let gradients = FirstOrder {
            theta: theta.to_vec(),
            seeds: seeds.to_vec(),
            at_target: if seeds.is_empty() { Vec::new() } else { pick(run, &run.gradients, targets) },
        };
        Self { first_order: Some(gradients), ..Self::of(run, targets) }
    }

    /// Whether the states move with the parameters.
    pub fn has_derivatives(&self) -> bool {
        self.first_order.as_ref().is_some_and(|f| !f.seeds.is_empty())
    }

    /// The states alone: little to keep.
    pub fn plain(&self) -> Self {
        Self { at_target: self.at_target.clone(), first_order: None }
    }

    /// How far the run's states are from those at these parameters: the root of the sum of squared relative
    /// changes, and where the states do not move with them, the root of that; infinite where the run's
    /// parameters are not known.
    pub fn distance(&self, theta: &[f64]) -> f64 {
        let Some(f) = &self.first_order else { return f64::INFINITY };
        let relative = |(a, b): (&f64, &f64)| if a == b { 0.0 } else { (a - b) / a.abs().max(b.abs()) };
        let change = f.theta.iter().zip(theta).map(relative).map(|d| d * d).sum::<f64>().sqrt();
        if f.seeds.is_empty() { change.sqrt() } else { change }
    }

    /// The state at a target, moved to the parameters `theta`.
    pub(crate) fn state(&self, target: usize, theta: &[f64]) -> Option<Guess> {
        let mut guess = self.at_target.get(target)?.as_ref()?.guess.clone();
        if let Some(f) = &self.first_order
            && let Some(Some(gradient)) = f.at_target.get(target)
        {
            let change: Vec<f64> = f.seeds.iter().map(|&s| theta[s] - f.theta[s]).collect();
            for (u, row) in guess.u.iter_mut().zip(gradient.chunks_exact(change.len())) {
                *u += row.iter().zip(&change).map(|(&g, c)| f64::from(g) * c).sum::<f64>();
            }
        }
        Some(guess)
    }
}

/// What the steps that answer targets kept.
fn pick<T>(run: &Run, kept: &[Arc<T>], targets: usize) -> Vec<Option<Arc<T>>> {
    let mut at_target = vec![None; targets];
    for (step, k) in run.steps.iter().zip(kept) {
        if let Some(t) = step.target {
            at_target[t] = Some(k.clone());
        }
    }
    at_target
}

/// Earlier run's state plus the extrapolated difference between the runs.
pub(crate) fn warm_guess(known: &Guess, differences: &[Guess]) -> Option<Guess> {
    match differences {
        [] => Some(known.clone()),
        [d] => Guess::combined(&[(1.0, known), (1.0, d)]),
        [.., d0, d1] => Guess::combined(&[(1.0, known), (2.0, d1), (-1.0, d0)]),
    }
}
