//! Searches of models whose steps, damping, profiles and later stages can be worked out on paper.
#![allow(missing_docs)]

use crate::line;
use crate::toys;

use inverse::*;
use line::*;
use nalgebra::{DMatrix, DVector};
use params::Transform;
use std::ops::ControlFlow;
use toys::{Toy, data, quiet, truth};

/// The profile of a linear model is the parabola (b − b̂)²/sd², whose crossings interpolation of its root finds exactly.
#[test]
fn the_profile_of_a_line_is_a_parabola() {
    let d = data(&DVector::from_vec(vec![-3.0, -1.1, 1.0, 3.2, 4.9]), NoiseModel::white(0.5));
    for (objective, prior) in
        [(Objective::Whitened, None), (Objective::Whitened, Some(0.2)), (Objective::PaperSum, Some(0.2))]
    {
        let mut free = free(100.0);
        free[1].prior = prior.map(|sd| Prior { mean: 1.5, sd });
        let options = exactly(objective);
        let end = quiet(&Toy(5, line), &d, &free, &options);
        let unit = if objective == Objective::PaperSum { 0.25 } else { 1.0 };
        let curvature = unit * (10.0 / 0.25 + prior.map_or(0.0, |sd: f64| sd.powi(-2)));
        let grid: Vec<f64> = [3.1, f64::NAN, 2.6, 1.1, 2.2, 1.4, 0.9].to_vec();
        let points = profile(&Toy(5, line), &d, &free, &end, 1, &grid, &options).unwrap();
        assert_eq!(points.iter().map(|p| p.value).collect::<Vec<_>>(), [0.9, 1.1, 1.4, 2.2, 2.6, 3.1]);
        for p in &points {
            close(p.f.unwrap() - end.f, curvature * (p.value - end.theta[1]).powi(2));
            close(p.theta[0], 1.0);
            assert_eq!(p.theta[1], p.value);
        }
        let half = (unit * 3.84 / curvature).sqrt();
        let [lo, hi] = profile_interval(&points, end.theta[1], end.f, unit * 3.84);
        close(lo.unwrap(), end.theta[1] - half);
        close(hi.unwrap(), end.theta[1] + half);
        let rise = 1.01 * curvature * (0.9 - end.theta[1]).powi(2).max((3.1 - end.theta[1]).powi(2));
        assert_eq!(profile_interval(&points, end.theta[1], end.f, rise), [None, None]);
    }
}

#[test]
fn a_later_stage_moves_with_what_an_earlier_one_holds() {
    // The held parameter adds 1 + 3 t: the line answers with −1 and −3.
    let free = free(10.0);
    let d = data(&truth(&Toy(5, line), &[1.0, 2.0]), NoiseModel::white(0.5));
    let end = quiet(&Toy(5, line), &d, &free, &exactly(Objective::Whitened));
    let jacobian = DMatrix::from_fn(5, 1, |i, _| 1.0 + 3.0 * (i as f64 - 2.0));
    let gain = held_gain(&d, &free, &end, &jacobian).unwrap();
    same(&gain, &DMatrix::from_vec(2, 1, vec![-1.0, -3.0]));
    let held = Held { jacobian, covariance: DMatrix::from_element(1, 1, 0.04) };
    let rule = Identifiability::default();
    let u = staged_uncertainty(&d, &free, &end, &held, &rule).unwrap();
    let want = DMatrix::from_row_slice(2, 2, &[0.25 / 5.0 + 0.04, 0.12, 0.12, 0.25 / 10.0 + 9.0 * 0.04]);
    same(&u.covariance_z, &want);
    close(u.correlation[(0, 1)], 0.12 / (want[(0, 0)] * want[(1, 1)]).sqrt());
    let wide = Held { covariance: DMatrix::identity(2, 2), ..held.clone() };
    assert!(matches!(staged_uncertainty(&d, &free, &end, &wide, &rule), Err(FitError::Contract(_))));
    let short = Held { jacobian: DMatrix::zeros(4, 1), ..held };
    assert!(matches!(staged_uncertainty(&d, &free, &end, &short, &rule), Err(FitError::Contract(_))));
    // Joined as (b, other a, a, other b): blocks in their places, nothing between the stages.
    let other = uncertainty(&d, &free, &end, &rule).unwrap();
    let v = other.covariance_z.clone();
    let all = u.join(other, &[2, 0], &[1, 3]);
    let names: Vec<&str> = all.estimates.iter().map(|e| e.path.as_str()).collect();
    assert_eq!(names, ["b", "a", "a", "b"]);
    let joined = [want[(1, 1)], v[(0, 0)], want[(0, 0)], v[(1, 1)]];
    for (k, want) in joined.into_iter().enumerate() {
        close(all.covariance_z[(k, k)], want);
    }
    close(all.covariance_z[(0, 2)], 0.12);
    assert_eq!(
        (all.covariance_z[(0, 1)], all.covariance_z[(2, 3)], all.correlation[(0, 3)]),
        (0.0, 0.0, 0.0)
    );
    assert!(all.singular_values.windows(2).all(|w| w[0] >= w[1]) && all.singular_values.len() == 4);
    // Every direction belongs to one stage and has length 1.
    for c in all.directions.column_iter() {
        let (first, second) = (c[0].hypot(c[2]), c[1].hypot(c[3]));
        close(first.max(second), 1.0);
        assert!(first.min(second) < 1e-12, "{c}");
    }
}

/// One number, p + 0.8 p², to be 1: the first step is 1/(1 + λ). What it lost against its prediction, over the
/// fourth power of its length, is what the next step is weighed with; then the parabola's curvature is taken back.
#[test]
fn the_second_step_is_worth_most() {
    let toy = Toy(1, |_, p: &[f64]| (p[0] + 0.8 * p[0] * p[0], vec![1.0 + 1.6 * p[0]]));
    let d = data(&DVector::from_vec(vec![1.0]), NoiseModel::white(1.0));
    let free = vec![Free::new("p", (-100.0, 100.0), Transform::Identity, 0.0)];
    let end = quiet(&toy, &d, &free, &exactly(Objective::Whitened));
    let lambda: f64 = 1e-3;
    let step = 1.0 / (1.0 + lambda);
    let after = (1.0 - step - 0.8 * step * step).powi(2);
    let gain = (1.0 - after) / (1.0 - (lambda * step).powi(2));
    assert!((0.3..0.5).contains(&gain), "less than was predicted: {gain}");
    let [start, first, second, ..] = end.history.as_slice() else { panic!("{:?}", end.history) };
    assert!(start.iteration == 0 && first.accepted);
    close(first.damping, lambda);
    close(first.theta[0], step);
    close(first.f.unwrap(), after);
    // d at the start is 1; the second step ends at x + s, slope 1 + 1.6 x.
    let (loss, slope, left) = (1.0 - (lambda * step).powi(2) - (1.0 - after), 1.0 + 1.6 * step, after.sqrt());
    assert!(loss > 0.0 && left > 0.0);
    let worth = |s: f64| left * left - (left + slope * s).powi(2) - 0.3 * loss * (slope * s).powi(4);
    let straight = (0..10_000).map(|k| -1e-4 * k as f64).max_by(|a, b| worth(*a).total_cmp(&worth(*b)));
    let v = straight.unwrap();
    let expected = v - 0.8 * v * v / (slope * (1.0 + second.damping));
    let taken = second.theta[0] - step;
    assert!((taken / expected - 1.0).abs() < 0.02, "{taken} against {expected}, straight {v}");
}

/// A model that answers with other shapes than it was asked for.
struct Wrong(usize, Option<(usize, usize)>, Option<usize>);

impl Problem for Wrong {
    fn predict(&self, _: &[f64], _: bool) -> Result<Prediction, PredictError> {
        let jacobian = self.1.map(|(n, p)| DMatrix::from_element(n, p, 1.0));
        let valid = self.2.map(|n| vec![true; n]);
        Ok(Prediction { valid, ..Prediction::new(DVector::zeros(self.0), jacobian) })
    }
}

#[test]
fn a_model_that_breaks_its_contract_is_told_which() {
    let d = data(&DVector::zeros(5), NoiseModel::white(1.0));
    let said = |n: usize, jacobian: Option<(usize, usize)>, valid: Option<usize>| {
        let watch: &mut dyn FnMut(&Iterate) -> ControlFlow<()> = &mut |_| ControlFlow::Continue(());
        let end = fit(&Wrong(n, jacobian, valid), &d, &free(10.0), &FitOptions::default(), watch);
        end.map(|_| ()).map_err(|e| e.to_string().replace("the model's answer cannot be used: ", ""))
    };
    let fault = |s: &str| Err(s.to_owned());
    assert_eq!(said(4, Some((5, 2)), None), fault("4 predicted numbers for 5 points"));
    assert_eq!(said(5, Some((5, 1)), None), fault("a jacobian of 5 by 1, expected 5 by 2"));
    assert_eq!(said(5, None, None), fault("no jacobian although it was asked for"));
    let mask = "the mask of valid points has another length than the prediction";
    assert_eq!(said(5, Some((5, 2)), Some(6)), fault(mask));
    assert_eq!(said(5, Some((5, 2)), Some(5)), Ok(()));
}

#[test]
fn a_search_that_is_stopped_starts_no_further_one() {
    let d = data(&truth(&Toy(5, line), &[1.0, 2.0]), NoiseModel::white(0.5));
    for parallel in [false, true] {
        let how = MultiStart { starts: 5, parallel, ..MultiStart::default() };
        let stop_at = |at: usize| {
            let watch: &mut dyn FnMut(usize, &Iterate) -> ControlFlow<()> =
                &mut |start, _| if start == at { ControlFlow::Break(()) } else { ControlFlow::Continue(()) };
            multi_start(&Toy(5, line), &d, &free(10.0), &FitOptions::default(), &how, watch)
                .unwrap()
                .ends
                .len()
        };
        assert_eq!([stop_at(0), stop_at(2), stop_at(9)], [1, 3, 5], "parallel: {parallel}");
    }
}

/// A linear model is solved by its first step, a bound that it meets included; a start on a bound is no trap.
#[test]
fn bounds_hold_what_pushes_outwards_and_nothing_else() {
    // t = 0 … 4: the two parameters are correlated. With b held at 1.5, a = 5 − 2 · 1.5.
    let toy = Toy(5, |i: usize, p: &[f64]| (p[0] + p[1] * i as f64, vec![1.0, i as f64]));
    let d = data(&truth(&toy, &[1.0, 2.0]), NoiseModel::white(0.1));
    let mut bounded = free(10.0);
    bounded[1].upper = 1.5;
    let end = quiet(&toy, &d, &bounded, &exactly(Objective::Whitened));
    let first = &end.history[1];
    assert!(first.accepted && first.theta[1] == 1.5 && (first.theta[0] - 2.0).abs() < 0.01, "{first:?}");
    let mut bounded = free(10.0);
    (bounded[1].lower, bounded[1].start) = (2.5, 5.0);
    let first = &quiet(&toy, &d, &bounded, &exactly(Objective::Whitened)).history[1];
    assert!(first.accepted && first.theta[1] == 2.5 && first.theta[0].abs() < 0.01, "{first:?}");
    for start in [-10.0, 10.0] {
        let free: Vec<Free> = free(10.0).into_iter().map(|f| Free { start, ..f }).collect();
        let end = quiet(&toy, &d, &free, &exactly(Objective::Whitened));
        close(end.theta[0], 1.0);
        close(end.theta[1], 2.0);
    }
}

/// Writes down where it was asked.
struct Asked<P>(P, std::sync::Mutex<Vec<Vec<f64>>>);

impl<P: Problem> Problem for Asked<P> {
    fn predict(&self, theta: &[f64], jacobian: bool) -> Result<Prediction, PredictError> {
        self.1.lock().unwrap().push(theta.to_vec());
        self.0.predict(theta, jacobian)
    }
}

#[test]
fn a_profile_starts_from_the_optimum_and_goes_on_from_its_neighbours() {
    let toy = Asked(
        Toy(5, |i: usize, p: &[f64]| (p[0] + p[1] * i as f64, vec![1.0, i as f64])),
        Default::default(),
    );
    let d = data(&truth(&toy.0, &[1.0, 2.0]), NoiseModel::white(0.1));
    let options = exactly(Objective::Whitened);
    let end = quiet(&toy, &d, &free(10.0), &options);
    assert_eq!(end.forward_runs, toy.1.lock().unwrap().len());
    assert_eq!(end.forward_runs, end.history.len());
    toy.1.lock().unwrap().clear();
    let points = profile(&toy, &d, &free(10.0), &end, 1, &[2.5, 3.0], &options).unwrap();
    let asked = toy.1.lock().unwrap();
    assert_eq!(asked[0], [end.theta[0], 2.5]);
    let second = asked.iter().find(|t| t[1] == 3.0).unwrap();
    assert_eq!(second[0], points[0].theta[0]);
}
