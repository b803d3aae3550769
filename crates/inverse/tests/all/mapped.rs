//! Fits of an expensive model that search on a cheap one.

use super::toys::{Toy, data, exponential, exponential_free, quiet, truth};
use inverse::{
    Data, Fit, FitError, FitOptions, Free, Mapped, MappedOptions, NoiseModel, Poll, PredictError, Prediction,
    Problem, Random, StopReason, fit_mapped,
};
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicUsize, Ordering};

/// The exponential with everything a little wrong: rate, offset, and a bend that the true one does not have.
fn coarse(i: usize, p: &[f64]) -> (f64, Vec<f64>) {
    let t = i as f64 / 10.0;
    let e = (-0.9 * p[1] * t).exp();
    (1.1 * p[0] * e + p[2] + 0.05 * t, vec![1.1 * e, -0.99 * p[0] * t * e, 1.0])
}

fn noisy() -> Data {
    let values = truth(&Toy(40, exponential), &[3.0, 0.7, 0.5]) + 0.02 * Random::new(3).normals(40);
    data(&values, NoiseModel::white(0.02))
}

fn options() -> MappedOptions {
    let outer = FitOptions { tolerance: 1e-12, ..FitOptions::default() };
    MappedOptions {
        inner: FitOptions { tolerance: 1e-10, ..outer.clone() },
        outer,
        settled: 1e-8,
        ratio: 10.0,
        radius: f64::INFINITY,
    }
}

fn mapped(expensive: &dyn Problem, cheap: &dyn Problem, data: &Data, free: &[Free]) -> Result<Fit, FitError> {
    let mut go = |_: &inverse::Iterate| ControlFlow::Continue(());
    fit_mapped(expensive, cheap, data, free, &options(), &mut go, &mut |_| ControlFlow::Continue(()))
}

/// A model that counts its runs and may refuse some.
struct Counted<P>(P, AtomicUsize, Option<f64>);

impl<P: Problem> Problem for Counted<P> {
    fn predict(&self, theta: &[f64], jacobian: bool) -> Result<Prediction, PredictError> {
        self.1.fetch_add(1, Ordering::Relaxed);
        if self.2.is_some_and(|most| theta[1] > most) {
            return Err(PredictError::NotComputable("too fast".into()));
        }
        self.0.predict(theta, jacobian)
    }
}

#[test]
fn ends_at_the_optimum_of_the_expensive_model_in_fewer_of_its_runs() {
    let (data, free) = (noisy(), exponential_free());
    let expensive = Counted(Toy(40, exponential), AtomicUsize::new(0), None);
    let direct = quiet(&expensive, &data, &free, &FitOptions { tolerance: 1e-12, ..FitOptions::default() });
    let alone = expensive.1.swap(0, Ordering::Relaxed);
    let end = mapped(&expensive, &Toy(40, coarse), &data, &free).expect("a fit");
    let runs = expensive.1.load(Ordering::Relaxed);
    assert!(end.stop.converged(), "{:?}", end.stop);
    for (a, b) in end.theta.iter().zip(&direct.theta) {
        assert!((a - b).abs() < 1e-4 * b.abs(), "{:?} {:?}", end.theta, direct.theta);
    }
    assert!(end.f - direct.f < 1e-6 && end.forward_runs == runs && runs < alone, "{runs} {alone}");
    // The cheap model alone would have ended elsewhere.
    let cheap = quiet(&Toy(40, coarse), &data, &free, &FitOptions::default());
    assert!((cheap.theta[2] - direct.theta[2]).abs() > 0.1, "{:?} {:?}", cheap.theta, direct.theta);
}

#[test]
fn the_map_is_the_expensive_model_to_first_order_at_its_anchor() {
    let free = exponential_free();
    let (expensive, cheap) = (Toy(40, exponential), Toy(40, coarse));
    let theta = [2.0, 0.4, -0.1];
    let there = expensive.predict(&theta, true).expect("a prediction");
    let map = Mapped::at(&cheap, &free, &theta, &there).expect("a map");
    let here = map.predict(&theta, true).expect("a prediction");
    assert!((&here.values - &there.values).norm() < 1e-12);
    let jacobians = (here.jacobian.expect("one"), there.jacobian.expect("one"));
    assert!((&jacobians.0 - &jacobians.1).norm() < 1e-12 * jacobians.1.norm());
    // Its own jacobian is that of its values.
    let at = [2.1, 0.45, -0.05];
    let whole = map.predict(&at, true).expect("a prediction");
    for k in 0..3 {
        let step = 1e-6;
        let side = |s: f64| {
            let mut moved = at;
            moved[k] += s * step;
            map.predict(&moved, false).expect("a prediction").values
        };
        let slope = (side(1.0) - side(-1.0)) / (2.0 * step);
        let own = whole.jacobian.as_ref().expect("one").column(k).into_owned();
        assert!((&slope - &own).norm() < 1e-6 * own.norm(), "{k}");
    }
}

#[test]
fn steps_that_the_expensive_model_refuses_get_shorter() {
    let (data, free) = (noisy(), exponential_free());
    // From b = 0.3 the first step of the search overshoots 0.72.
    let from: Vec<Free> = free
        .iter()
        .map(|f| if f.path == "b" { Free { start: 0.3, ..f.clone() } } else { f.clone() })
        .collect();
    let picky = Counted(Toy(40, exponential), AtomicUsize::new(0), Some(0.72));
    // A cheap model that decays too slowly sends the search too far.
    let slow = |i: usize, p: &[f64]| exponential(i, &[p[0], 0.7 * p[1], p[2]]);
    let slow = Toy(40, move |i: usize, p: &[f64]| {
        let (v, d) = slow(i, p);
        (v, vec![d[0], 0.7 * d[1], d[2]])
    });
    let end = mapped(&picky, &slow, &data, &from).expect("a fit");
    let direct =
        quiet(&Toy(40, exponential), &data, &free, &FitOptions { tolerance: 1e-12, ..FitOptions::default() });
    assert!(
        (end.theta[1] - direct.theta[1]).abs() < 1e-3,
        "{:?} {:?} {:?}",
        end.theta,
        direct.theta,
        end.stop
    );
}

#[test]
fn without_a_cheap_model_the_expensive_one_searches_alone() {
    struct Never;
    impl Problem for Never {
        fn predict(&self, _: &[f64], _: bool) -> Result<Prediction, PredictError> {
            Err(PredictError::NotComputable("never".into()))
        }
    }
    let (data, free) = (noisy(), exponential_free());
    let end = mapped(&Toy(40, exponential), &Never, &data, &free).expect("a fit");
    let direct =
        quiet(&Toy(40, exponential), &data, &free, &FitOptions { tolerance: 1e-12, ..FitOptions::default() });
    assert_eq!(end.theta, direct.theta);
}

/// A map that is worse wherever one goes is no sign that the expensive model has its optimum there.
#[test]
fn where_the_map_leads_nowhere_far_from_the_data_the_expensive_one_searches_alone() {
    let (data, free) = (noisy(), exponential_free());
    let jumps = |i: usize, p: &[f64]| {
        let (v, d) = coarse(i, p);
        (if p[1] == 1.0 { v } else { v + 1e3 }, d)
    };
    let end = |poll: Option<Poll>| {
        let mut how = options();
        how.outer.poll = poll;
        let mut go = |_: &inverse::Iterate| ControlFlow::Continue(());
        let mut watch = |_: &inverse::Iterate| ControlFlow::Continue(());
        fit_mapped(&Toy(40, exponential), &Toy(40, jumps), &data, &free, &how, &mut go, &mut watch)
            .expect("a fit")
    };
    let stays = end(None);
    assert_eq!((stays.stop, stays.iterations), (StopReason::NoDescent, 0));
    // What is left of the data is near enough, or it is not.
    let left = stays.f / 40.0;
    assert_eq!(end(Some(Poll::each(2.0 * left, 3))).theta, stays.theta);
    let direct =
        quiet(&Toy(40, exponential), &data, &free, &FitOptions { tolerance: 1e-12, ..FitOptions::default() });
    assert_eq!(end(Some(Poll::each(0.5 * left, 3))).theta, direct.theta);
}

/// A cheap model that cannot be computed any more after some runs: what is left of the iterations is for the expensive one.
#[test]
fn rounds_and_what_follows_them_alone_are_no_more_than_the_whole() {
    struct Until(usize, AtomicUsize);
    impl Problem for Until {
        fn predict(&self, theta: &[f64], jacobian: bool) -> Result<Prediction, PredictError> {
            if self.1.fetch_add(1, Ordering::Relaxed) < self.0 {
                return Toy(40, coarse).predict(theta, jacobian);
            }
            Err(PredictError::NotComputable("no more".into()))
        }
    }
    let (data, free) = (noisy(), exponential_free());
    let mut how = options();
    how.outer.max_iterations = 3;
    how.inner.max_iterations = 2;
    let mut fits = Vec::new();
    for runs in 0..20 {
        let (mut go, mut watch) = (
            |_: &inverse::Iterate| ControlFlow::Continue(()),
            |_: &inverse::Iterate| ControlFlow::Continue(()),
        );
        let cheap = Until(runs, AtomicUsize::new(0));
        let fit = fit_mapped(&Toy(40, exponential), &cheap, &data, &free, &how, &mut go, &mut watch);
        fits.push(fit.expect("a fit").iterations);
    }
    assert!(fits.iter().all(|n| *n <= 3) && fits.contains(&3), "{fits:?}");
}

#[test]
fn who_watches_may_stop_it() {
    let (data, free) = (noisy(), exponential_free());
    let mut stop = |_: &inverse::Iterate| ControlFlow::Break(());
    let mut go = |_: &inverse::Iterate| ControlFlow::Continue(());
    let (expensive, cheap) = (Toy(40, exponential), Toy(40, coarse));
    let inner = fit_mapped(&expensive, &cheap, &data, &free, &options(), &mut go, &mut stop).expect("a fit");
    assert_eq!((inner.stop, inner.iterations), (StopReason::Stopped, 0));
    let mut stop = |_: &inverse::Iterate| ControlFlow::Break(());
    let outer = fit_mapped(&expensive, &cheap, &data, &free, &options(), &mut stop, &mut go).expect("a fit");
    assert_eq!(outer.stop, StopReason::Stopped);
}

/// A model that keeps where it was computed.
struct Kept<P>(P, std::sync::Mutex<Vec<Vec<f64>>>);

impl<P: Problem> Problem for Kept<P> {
    fn predict(&self, theta: &[f64], jacobian: bool) -> Result<Prediction, PredictError> {
        self.1.lock().expect("a lock").push(theta.to_vec());
        self.0.predict(theta, jacobian)
    }
}

#[test]
fn a_round_computes_the_cheap_model_once_at_its_anchor() {
    let (data, free) = (noisy(), exponential_free());
    let cheap = Kept(Toy(40, coarse), std::sync::Mutex::default());
    let end = mapped(&Toy(40, exponential), &cheap, &data, &free).expect("a fit");
    let places = cheap.1.into_inner().expect("a lock");
    let again = (1..places.len()).filter(|&k| places[..k].contains(&places[k])).count();
    // An anchor is where the round before it ended: computed there, and once more as the map's.
    assert!(
        end.iterations > 1 && again <= end.iterations,
        "{again} of {} in {}",
        places.len(),
        end.iterations
    );
}
