//! Models that jump: where derivatives lead nowhere a search looks around.

use inverse::{
    Data, Fit, FitOptions, Free, NoiseModel, Objective, Poll, PredictError, Prediction, Problem, StopReason,
    fit,
};
use nalgebra::{DMatrix, DVector};
use params::Transform;
use std::ops::ControlFlow;

const POINTS: usize = 50;
const NOISE: f64 = 0.01;

/// A strip that softens, u (1 − 0.3 (u/c)²), and breaks at c: nothing carries beyond.
struct Breaks;

fn at(i: usize) -> f64 {
    (i + 1) as f64 / POINTS as f64
}

impl Problem for Breaks {
    fn predict(&self, theta: &[f64], _jacobian: bool) -> Result<Prediction, PredictError> {
        let c = theta[0];
        let carries = |u: f64, v: f64| if u < c { v } else { 0.0 };
        let values =
            DVector::from_fn(POINTS, |i, _| carries(at(i), at(i) * (1.0 - 0.3 * (at(i) / c).powi(2))));
        let slope = DMatrix::from_fn(POINTS, 1, |i, _| carries(at(i), 0.6 * at(i).powi(3) / c.powi(3)));
        Ok(Prediction::new(values, Some(slope)))
    }
}

/// Fits a record of a strip that holds to its end, but softens as one that breaks before does: from just before its end.
fn fitted(poll: Option<Poll>, softens: f64) -> Fit {
    fitted_until(0.0, poll, softens)
}

/// The same; three steps in a row that lower χ² by less than `insignificant` end it.
fn fitted_until(insignificant: f64, poll: Option<Poll>, softens: f64) -> Fit {
    let values = (0..POINTS).map(|i| at(i) * (1.0 - softens * at(i).powi(2))).collect();
    let data = Data::from_parts([("pull".to_owned(), values, NoiseModel::white(NOISE))]).expect("data");
    let free = [Free::new("c", (0.1, 10.0), Transform::Log, 0.985)];
    let options = FitOptions { objective: Objective::Record, insignificant, poll, ..FitOptions::default() };
    fit(&Breaks, &data, &free, &options, &mut |_| ControlFlow::Continue(())).expect("a fit")
}

#[test]
fn a_jump_that_no_step_leads_over_is_looked_over() {
    let stuck = fitted(None, 0.36);
    assert!(
        stuck.f > 0.9 * (0.64 / NOISE).powi(2) && stuck.theta[0] < 1.0,
        "{} at {}",
        stuck.f,
        stuck.theta[0]
    );
    assert!(!stuck.stop.converged(), "{:?}", stuck.stop);
    let out = fitted(Some(Poll::each(3.0, 1)), 0.36);
    assert!(out.f < 0.1 * stuck.f && out.theta[0] > 1.0, "{} at {}", out.f, out.theta[0]);
    let accepted: Vec<f64> = out.history.iter().filter(|i| i.accepted).filter_map(|i| i.f).collect();
    assert!(accepted.windows(2).all(|w| w[1] < w[0]), "{accepted:?}");
}

#[test]
fn what_is_left_below_the_limit_is_not_looked_over() {
    let stuck = fitted(None, 0.36);
    let above = 2.0 * stuck.f / POINTS as f64;
    let same = fitted(Some(Poll::each(above, 1)), 0.36);
    assert_eq!((same.theta, same.forward_runs), (stuck.theta, stuck.forward_runs));
}

/// Above what another start came to, a look around is not worth its runs; up to there it is.
#[test]
fn what_another_start_is_below_of_is_not_looked_over() {
    let stuck = fitted(None, 0.36);
    let below = |times: f64| Some(Poll { below: times * stuck.f, ..Poll::each(3.0, 1) });
    let [same, out] = [0.99, 1.01].map(|times| fitted(below(times), 0.36));
    assert_eq!((same.theta, same.forward_runs), (stuck.theta, stuck.forward_runs));
    assert!(out.f < 0.1 * stuck.f && out.forward_runs > stuck.forward_runs, "{} at {:?}", out.f, out.theta);
}

/// Where another fit looked around, nothing is to be found; a little beside there may be.
#[test]
fn where_another_fit_looked_around_is_not_looked_over() {
    let stuck = fitted(None, 0.36);
    let known = |from: f64, to: f64| {
        fitted(Some(Poll { known: from * stuck.f..to * stuck.f, ..Poll::each(3.0, 1) }), 0.36)
    };
    let same = known(0.9, 1.1);
    assert_eq!((same.theta, same.forward_runs), (stuck.theta, stuck.forward_runs));
    for out in [known(0.5, 0.9), known(1.1, 2.0)] {
        assert!(out.f < 0.1 * stuck.f, "{} at {:?}", out.f, out.theta);
    }
}

/// Before a jump steps get shorter and shorter, and lower f, if by next to nothing.
#[test]
fn steps_that_creep_up_to_a_jump_are_no_end() {
    let stuck = fitted_until(10.0, None, 0.5);
    assert_eq!(stuck.stop, StopReason::Insignificant);
    let out = fitted_until(10.0, Some(Poll::each(3.0, 1)), 0.5);
    assert!(out.f < 0.7 * stuck.f && out.theta[0] > 1.0, "{} at {}", out.f, out.theta[0]);
    // Where derivatives promise no more than a look around has to bring, steps that gain little are the end.
    let [alone, beside] = [None, Some(Poll::each(3.0, 1))].map(|poll| fitted_until(10.0, poll, 0.35));
    assert_eq!(alone.stop, StopReason::Insignificant);
    assert_eq!((beside.theta, beside.forward_runs), (alone.theta, alone.forward_runs));
}

/// Where a search begins far above what the model came to elsewhere, a jump lies between; a little above, none does.
#[test]
fn a_search_that_begins_amiss_looks_around_first() {
    let alone = fitted_until(10.0, None, 0.35);
    let begun = alone.history[0].f.expect("a start");
    let expecting = |f: f64| fitted_until(10.0, Some(Poll { expected: f, ..Poll::each(3.0, 1) }), 0.35);
    let same = expecting(0.6 * begun);
    assert_eq!((same.theta, same.forward_runs), (alone.theta, alone.forward_runs));
    let out = expecting(0.4 * begun);
    assert!(out.f < 0.1 * alone.f && out.theta[0] > 1.0, "{} at {:?}", out.f, out.theta);
}

/// A start beyond the jump, but far off: steps lead on, and go on as if nothing else had been expected.
#[test]
fn a_search_that_begins_far_off_and_finds_its_way_does_not_look_around() {
    let from = |expected: f64| {
        let values = (0..POINTS).map(|i| at(i) * (1.0 - 0.2 * at(i).powi(2))).collect();
        let data = Data::from_parts([("pull".to_owned(), values, NoiseModel::white(NOISE))]).expect("data");
        let free = [Free::new("c", (0.1, 10.0), Transform::Log, 5.0)];
        let poll = Some(Poll { expected, ..Poll::each(3.0, 1) });
        let options = FitOptions { objective: Objective::Record, poll, ..FitOptions::default() };
        fit(&Breaks, &data, &free, &options, &mut |_| ControlFlow::Continue(())).expect("a fit")
    };
    let (alone, expecting) = (from(f64::INFINITY), from(1.0));
    assert!((alone.theta[0] - (0.3f64 / 0.2).sqrt()).abs() < 1e-3, "{:?}", alone.theta);
    assert!(alone.history[0].f > Some(2.0), "{:?}", alone.history[0]);
    assert_eq!((expecting.theta, expecting.forward_runs), (alone.theta, alone.forward_runs));
}
