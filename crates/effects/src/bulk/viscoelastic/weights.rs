//! What a step makes of the branches. It depends on the relaxation times and the length of the step alone, so that a
//! thread computes it once for all integration points it visits.

use super::times::Times;
use crate::numeric::{decay, mean_decay, mean_rise};
use constitutive::Scalar;
use std::any::Any;
use std::cell::RefCell;

/// Of one branch: H after the step is `left` H + `taken` ΔS, its mean over the step `kept` H + `rise` ΔS.
pub(super) struct Weights<S> {
    pub left: S,
    pub taken: S,
    pub kept: S,
    pub rise: S,
}

/// The latest weights over one kind of number, and what they are of.
struct Latest<S> {
    times: Times,
    own: Vec<S>,
    dt: f64,
    weights: Vec<Weights<S>>,
}

thread_local! {
    /// One [`Latest`] for each kind of number.
    static LATEST: RefCell<Vec<Box<dyn Any>>> = const { RefCell::new(Vec::new()) };
}

impl<S: Scalar> Latest<S> {
    fn of(times: Times, own: &[S], dt: f64) -> Self {
        let one = |b: usize| {
            let (g, tau) = times.of(own, b);
            let x = S::from(dt) / tau;
            Weights { left: decay(x), taken: g * mean_decay(x), kept: mean_decay(x), rise: g * mean_rise(x) }
        };
        Self { times, own: own.to_vec(), dt, weights: (0..times.count()).map(one).collect() }
    }

    fn is_of(&self, times: Times, own: &[S], dt: f64) -> bool {
        self.times == times && self.dt == dt && self.own == own
    }
}

/// Calls `then` with the weights of every branch. `then` must not ask for weights itself.
#[inline]
pub(super) fn with_weights<S: Scalar, R>(
    times: Times,
    own: &[S],
    dt: f64,
    then: impl FnOnce(&[Weights<S>]) -> R,
) -> R {
    LATEST.with_borrow_mut(|all| {
        let known = all.iter_mut().find_map(|kept| kept.downcast_mut::<Latest<S>>());
        if let Some(latest) = known {
            if !latest.is_of(times, own, dt) {
                *latest = Latest::of(times, own, dt);
            }
            return then(&latest.weights);
        }
        let latest = Latest::of(times, own, dt);
        let answer = then(&latest.weights);
        all.push(Box::new(latest));
        answer
    })
}
