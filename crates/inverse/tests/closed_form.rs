//! Linear models, where every answer has a closed form: dense matrices here against the crate.
#![allow(missing_docs)]

mod toys;

use inverse::*;
use nalgebra::{DMatrix, DVector};
use params::Transform;
use std::ops::ControlFlow;
use toys::{Toy, data, quiet, truth};

/// y = a + b t at t = −2, …, 2: XᵀX = diag(5, 10).
fn line(i: usize, p: &[f64]) -> (f64, Vec<f64>) {
    let t = i as f64 - 2.0;
    (p[0] + p[1] * t, vec![1.0, t])
}

fn design(n: usize) -> DMatrix<f64> {
    DMatrix::from_fn(n, 2, |i, k| line(i, &[0.0; 2]).1[k])
}

fn free(reach: f64) -> Vec<Free> {
    let one = |name: &str| Free::new(name, (-reach, reach), Transform::Identity, 0.1);
    vec![one("a"), one("b")]
}

fn exactly(objective: Objective) -> FitOptions {
    FitOptions { objective, tolerance: 1e-13, insignificant: 0.0, ..FitOptions::default() }
}

fn close(a: f64, b: f64) {
    assert!((a - b).abs() <= 1e-7 * b.abs().max(1e-12), "{a} {b}");
}

fn same(a: &DMatrix<f64>, b: &DMatrix<f64>) {
    assert!((a - b).norm() <= 1e-7 * b.norm(), "{a} {b}");
}

#[test]
fn errors_intervals_and_spectrum_of_a_line_are_textbook() {
    let d = data(&DVector::from_vec(vec![-3.0, -1.1, 1.0, 3.2, 4.9]), NoiseModel::white(0.5));
    let free = free(10.0);
    let end = quiet(&Toy(5, line), &d, &free, &exactly(Objective::Whitened));
    let u = uncertainty(&d, &free, &end, &Identifiability::default()).unwrap();
    let sd = [0.5 / 5f64.sqrt(), 0.5 / 10f64.sqrt()];
    for ((e, sd), value) in u.estimates.iter().zip(sd).zip([1.0, 2.01]) {
        close(e.value, value);
        close(e.std_error.unwrap(), sd);
        close(e.scaled_sd, sd / 10.0);
        close(e.interval_95[0], value - 1.959_963_985 * sd);
        close(e.interval_95[1], value + 1.959_963_985 * sd);
        assert!(e.identifiable && !e.at_bound);
    }
    assert_eq!((u.correlation[(0, 0)], u.correlation[(1, 1)]), (1.0, 1.0));
    assert!(u.correlation[(0, 1)].abs() < 1e-12);
    close(u.singular_values[0], 10.0 / sd[1]);
    close(u.singular_values[1], 10.0 / sd[0]);
    close(u.directions[(1, 0)].abs(), 1.0);
    same(&u.covariance(), &DMatrix::from_diagonal(&DVector::from_vec(vec![sd[0].powi(2), sd[1].powi(2)])));
    assert!(u.sloppy_directions().is_empty());
}

#[test]
fn a_logarithm_has_relative_errors_and_an_interval_by_factors() {
    let d = data(&truth(&Toy(5, line), &[1.0, 2.0]), NoiseModel::white(0.5));
    let mut free = free(10.0);
    free[1] = Free::new("b", (1e-3, 1e3), Transform::Log, 1.0);
    let end = quiet(&Toy(5, line), &d, &free, &exactly(Objective::Whitened));
    let u = uncertainty(&d, &free, &end, &Identifiability::default()).unwrap();
    let (e, sd) = (&u.estimates[1], 0.5 / 10f64.sqrt());
    close(e.std_error.unwrap(), sd);
    close(e.scaled_sd, sd / 2.0);
    close(e.interval_95[0], 2.0 * (-Z95 * sd / 2.0).exp());
    close(e.interval_95[1], 2.0 * (Z95 * sd / 2.0).exp());
    close(u.covariance()[(1, 1)], sd * sd);
    close(u.covariance_z[(1, 1)], sd * sd / 4.0);
}

#[test]
fn identifiable_is_a_threshold_on_the_sd_and_on_what_the_data_add_to_a_prior() {
    let first = |noise: f64, prior: Option<f64>, max_sd: f64| {
        let mut free = free(1.0);
        free[0].prior = prior.map(|sd| Prior { mean: 0.0, sd });
        let d = data(&DVector::zeros(5), NoiseModel::white(noise));
        let end = quiet(&Toy(5, line), &d, &free, &exactly(Objective::Whitened));
        let rule = Identifiability { max_sd, ..Identifiability::default() };
        uncertainty(&d, &free, &end, &rule).unwrap().estimates[0].clone()
    };
    // The sd is noise/√5 in units of half the box.
    assert!(first(0.49 * 5f64.sqrt(), None, 0.5).identifiable);
    assert!(!first(0.51 * 5f64.sqrt(), None, 0.5).identifiable);
    // With a prior of 1 and information i of the data it is 1/√(1 + i): 0.7 at i = 1.0408.
    let informed = |i: f64| first((5.0 / i).sqrt(), Some(1.0), 1.0);
    close(informed(3.0).scaled_sd, 0.5);
    assert!(informed(1.05).identifiable && !informed(1.03).identifiable);
    // With a prior of 2 the sd must come down to 1.4: 1/√(1/4 + i) at i = 0.2602.
    let wide = |i: f64| first((5.0 / i).sqrt(), Some(2.0), 10.0);
    assert!(wide(0.262).identifiable && !wide(0.258).identifiable);
    // Too far off for a standard error to mean anything.
    assert!(first(999.0 * 5f64.sqrt(), None, 0.5).std_error.is_some());
    assert!(first(1001.0 * 5f64.sqrt(), None, 0.5).std_error.is_none());
}

/// Two blocks of five points, own noise each, numerical error of a block and across both, one point held out.
fn two_blocks() -> Data {
    let error = DVector::from_vec(vec![0.1, 0.3, -0.2, 0.0, 0.4]);
    let noise = [NoiseModel::ar1(0.3, 0.5), NoiseModel::ar1(0.8, -0.4).with_nuisance(error)];
    let values = [1.0, 0.7, 1.9, 2.2, 3.3, 2.9, 4.8, 4.0, 5.5, 6.1];
    let part = |k: usize| (format!("{k}"), values[5 * k..5 * k + 5].to_vec(), noise[k].clone());
    let mut d = Data::from_parts([part(0), part(1)]).unwrap();
    d.nuisance = vec![DVector::from_fn(10, |i, _| 0.05 * i as f64 - 0.2)];
    d.held_out = (0..10).map(|i| i == 3).collect();
    d
}

/// Rows of that data, the design there, the record's covariance R and the total one.
fn dense(d: &Data) -> (Vec<usize>, DMatrix<f64>, DMatrix<f64>, DMatrix<f64>) {
    let rows: Vec<usize> = (0..10).filter(|&i| i != 3).collect();
    let x = design(10).select_rows(&rows);
    let record = DMatrix::from_fn(9, 9, |a, b| {
        let (i, j) = (rows[a], rows[b]);
        let noise = &d.blocks[i / 5].noise;
        if i / 5 == j / 5 { noise.sd.powi(2) * noise.ar1.powi(i.abs_diff(j) as i32) } else { 0.0 }
    });
    let mut columns = [d.nuisance[0].clone(), DVector::zeros(10)];
    columns[1].rows_mut(5, 5).copy_from(&d.blocks[1].noise.nuisance[0]);
    let total = columns.iter().fold(record.clone(), |sum, e| {
        let e = e.select_rows(&rows);
        sum + &e * e.transpose()
    });
    (rows, x, record, total)
}

fn inverse(m: &DMatrix<f64>) -> DMatrix<f64> {
    m.clone().try_inverse().unwrap()
}

#[test]
fn covariances_of_the_three_objectives_are_their_dense_formulas() {
    let d = two_blocks();
    let (_, x, record, total) = dense(&d);
    let prior = 0.7;
    let mut free = free(100.0);
    free[1].prior = Some(Prior { mean: 0.5, sd: prior });
    let only_b = |w: f64| DMatrix::from_diagonal(&DVector::from_vec(vec![0.0, w]));
    let got = |objective: Objective| {
        let end = quiet(&Toy(10, line), &d, &free, &exactly(objective));
        let u = uncertainty(&d, &free, &end, &Identifiability::default()).unwrap();
        assert!(end.at_bound == [false; 2] && u.estimates.iter().all(|e| e.identifiable));
        (u.covariance_z, end)
    };
    let information = 1.0 / (prior * prior);
    let whitened = inverse(&(x.transpose() * inverse(&total) * &x + only_b(information)));
    same(&got(Objective::Whitened).0, &whitened);
    // Weighed by the record's noise alone, Σ total: the sandwich.
    let weighed = inverse(&record) * &x;
    let bread = inverse(&(x.transpose() * &weighed + only_b(information)));
    let sandwich = &bread * (weighed.transpose() * &total * &weighed + only_b(information)) * &bread;
    same(&got(Objective::Record).0, &sandwich);
    // The plain sum, where a prior weighs by the mean square of the noise.
    let mean = (4.0 * 0.09 + 5.0 * 0.64) / 9.0;
    let bread = inverse(&(x.transpose() * &x + only_b(mean * information)));
    let meat = x.transpose() * &total * &x + only_b(mean * mean * information);
    let (plain, end) = got(Objective::PaperSum);
    same(&plain, &(&bread * meat * &bread));
    // And its optimum is that of the normal equations.
    let y = d.measured().select_rows(&(0..10).filter(|&i| i != 3).collect::<Vec<_>>());
    let mut right = x.transpose() * y;
    right[1] += mean * information * 0.5;
    let best = bread * right;
    assert!(
        (DVector::from_vec(end.theta.clone()) - &best).norm() < 1e-7 * best.norm(),
        "{:?} {best}",
        end.theta
    );
}

#[test]
fn quality_of_a_line_is_its_sums_of_squares() {
    let d = two_blocks();
    let (rows, _, record, total) = dense(&d);
    assert_eq!(Whitener::new(&d, None, Noise::Total).rows(), rows);
    let end = quiet(&Toy(10, line), &d, &free(100.0), &exactly(Objective::Whitened));
    let q = quality(&d, &free(100.0), &end);
    let r = d.misfit(&end.prediction.values).select_rows(&rows);
    let chi2 = |sigma: &DMatrix<f64>| r.dot(&(inverse(sigma) * &r));
    close(q.chi2, chi2(&record));
    close(q.chi2_total, chi2(&total));
    assert_eq!((q.points, q.parameters, q.blocks.len()), (9, 2, 2));
    close(q.freedom, 7.0);
    close(q.reduced_chi2, q.chi2 / 7.0);
    close(q.reduced_chi2_total, q.chi2_total / 7.0);
    close(q.bic, q.chi2_total + 2.0 * 9f64.ln());
    close(q.aicc, q.chi2_total + 4.0 + 12.0 / 6.0);
    let first = &q.blocks[0];
    let square: f64 = r.iter().take(4).map(|v| v * v).sum();
    assert_eq!((first.points, first.noise, q.blocks[1].points), (4, 0.3, 5));
    close(first.objective, square);
    close(first.rms, (square / 4.0).sqrt());
    let own = record.view((0, 0), (4, 4)).into_owned();
    let own_chi2 = r.rows(0, 4).dot(&(inverse(&own) * r.rows(0, 4)));
    close(first.chi2, own_chi2);
    close(first.reduced_chi2, own_chi2 / (4.0 - first.degrees_of_freedom));
    close(first.degrees_of_freedom + q.blocks[1].degrees_of_freedom, 2.0);
    // White noise: the trace of X (XᵀX)⁻¹ Xᵀ over the first two of five points is 2/5 + (4 + 1)/10.
    let noise = NoiseModel::white(0.2);
    let parts =
        [("x".to_owned(), vec![1.0, 2.0], noise.clone()), ("y".to_owned(), vec![2.0, 4.0, 4.5], noise)];
    let split = Data::from_parts(parts).unwrap();
    let end = quiet(&Toy(5, line), &split, &free(100.0), &exactly(Objective::Whitened));
    close(quality(&split, &free(100.0), &end).blocks[0].degrees_of_freedom, 0.9);
}

#[test]
fn criteria_and_rms_are_their_formulas() {
    close(bic(10.0, 3, 100), 10.0 + 3.0 * 100f64.ln());
    close(aicc(10.0, 3, 100), 10.0 + 6.0 + 24.0 / 96.0);
    close(aicc(10.0, 3, 5), 10.0 + 6.0 + 24.0);
    assert_eq!((aicc(10.0, 3, 4), aicc(10.0, 3, 2)), (f64::INFINITY, f64::INFINITY));
    close(rms([3.0, -4.0]), 12.5f64.sqrt());
    assert_eq!(rms([]), 0.0);
}

#[test]
fn a_basis_is_orthonormal_and_as_large_as_the_rank() {
    let a = DMatrix::from_columns(&[
        DVector::from_vec(vec![1e-6, 0.0, 0.0, 0.0]),
        DVector::from_vec(vec![1e6, 2e6, 0.0, 0.0]),
        DVector::from_vec(vec![3.0, 1.0, 0.0, 0.0]),
        DVector::zeros(4),
    ]);
    let q = orthonormal(&a);
    assert_eq!(q.shape(), (4, 2));
    assert!((q.tr_mul(&q) - DMatrix::identity(2, 2)).norm() < 1e-14);
    assert!((&a - &q * q.tr_mul(&a)).norm() < 1e-9, "it spans the columns");
    assert_eq!(orthonormal(&DMatrix::zeros(4, 2)).shape(), (4, 0));
}

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

/// One-sided at a bound: from the bound inwards, by the sd with the other parameters free.
#[test]
fn an_interval_at_a_bound_is_one_sided() {
    let d = data(&truth(&Toy(5, line), &[1.0, 2.0]), NoiseModel::white(0.5));
    let sd = 0.5 / 10f64.sqrt();
    let at = |lower: f64, upper: f64| {
        let mut free = free(10.0);
        (free[1].lower, free[1].upper, free[1].start) = (lower, upper, 0.5 * (lower + upper));
        let end = quiet(&Toy(5, line), &d, &free, &exactly(Objective::Whitened));
        let u = uncertainty(&d, &free, &end, &Identifiability::default()).unwrap();
        assert!(u.covariance_z[(1, 1)] == 0.0 && u.singular_values.len() == 1);
        close(u.estimates[0].std_error.unwrap(), 0.5 / 5f64.sqrt());
        u.estimates[1].clone()
    };
    let low = at(3.0, 5.0);
    assert_eq!((low.value, low.interval_95[0], low.at_bound, low.identifiable), (3.0, 3.0, true, true));
    close(low.interval_95[1], 3.0 + Z95 * sd);
    close(low.std_error.unwrap(), sd);
    close(low.scaled_sd, sd);
    let high = at(-1.0, 1.0);
    assert_eq!((high.value, high.interval_95[1]), (1.0, 1.0));
    close(high.interval_95[0], 1.0 - Z95 * sd);
    let narrow = at(3.0, 3.1);
    assert_eq!((narrow.interval_95, narrow.identifiable), ([3.0, 3.1], false));
}

/// What stands at a bound takes no part: one parameter is left, and the held one moves nothing but that.
#[test]
fn a_parameter_at_a_bound_costs_no_freedom_and_answers_to_nothing() {
    let d = data(&truth(&Toy(5, line), &[1.0, 2.0]), NoiseModel::white(0.5));
    let mut free = free(10.0);
    (free[1].lower, free[1].start) = (3.0, 4.0);
    let end = quiet(&Toy(5, line), &d, &free, &exactly(Objective::Whitened));
    let q = quality(&d, &free, &end);
    assert_eq!(q.parameters, 1);
    close(q.freedom, 4.0);
    close(q.chi2, 10.0 / 0.25);
    let gain =
        held_gain(&d, &free, &end, &DMatrix::from_fn(5, 1, |i, _| 1.0 + 3.0 * (i as f64 - 2.0))).unwrap();
    same(&gain, &DMatrix::from_vec(2, 1, vec![-1.0, 0.0]));
}

/// In a logit the unit of an sd is a quarter of the interval, the largest slope of the coordinate.
#[test]
fn a_logit_at_its_end_is_measured_in_quarters() {
    let d = data(&truth(&Toy(5, line), &[1.0, -1.0]), NoiseModel::white(0.5));
    let mut free = free(10.0);
    free[1] = Free::new("b", (0.0, 3.0), Transform::Logit { lower: 0.0, upper: 3.0 }, 1.0);
    let end = quiet(&Toy(5, line), &d, &free, &exactly(Objective::Whitened));
    let u = uncertainty(&d, &free, &end, &Identifiability::default()).unwrap();
    assert!(u.estimates[1].at_bound);
    close(u.estimates[1].scaled_sd, 0.5 / 10f64.sqrt() / 0.75);
}

/// One number, p + 0.8 p², to be 1: the first step is 1/(1 + λ), the fall r² (1 − (λ/(1 + λ))²), and the damping goes
/// on as Nielsen's 1 − (2 gain − 1)³.
#[test]
fn damping_follows_the_gain() {
    let toy = Toy(1, |_, p: &[f64]| (p[0] + 0.8 * p[0] * p[0], vec![1.0 + 1.6 * p[0]]));
    let d = data(&DVector::from_vec(vec![1.0]), NoiseModel::white(1.0));
    let free = vec![Free::new("p", (-100.0, 100.0), Transform::Identity, 0.0)];
    let end = quiet(&toy, &d, &free, &exactly(Objective::Whitened));
    let lambda: f64 = 1e-3;
    let step = 1.0 / (1.0 + lambda);
    let after = (1.0 - step - 0.8 * step * step).powi(2);
    let gain = (1.0 - after) / (1.0 - (lambda * step).powi(2));
    assert!((0.3..0.5).contains(&gain), "less than was promised: {gain}");
    let [start, first, second, ..] = end.history.as_slice() else { panic!("{:?}", end.history) };
    assert!(start.iteration == 0 && first.accepted);
    close(first.damping, lambda);
    close(first.theta[0], step);
    close(first.f.unwrap(), after);
    close(second.damping, lambda * (1.0 - (2.0 * gain - 1.0).powi(3)));
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
fn a_model_that_breaks_its_promise_is_told_which() {
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

#[test]
fn starts_lie_where_the_sequence_says() {
    // Base 2: 1/2, 1/4, 3/4. Base 3 (digits times 1): 1/3, 2/3, 1/9. Base 5 (digits times 3): 3/5, 1/5, 4/5.
    for (i, want) in
        [[0.5, 1.0 / 3.0, 0.6], [0.25, 2.0 / 3.0, 0.2], [0.75, 1.0 / 9.0, 0.8]].iter().enumerate()
    {
        for (x, want) in halton(i, 3).iter().zip(want) {
            close(*x, *want);
        }
    }
    close(halton(4, 3)[2], 3.0 / 25.0);
    // Further dimensions use the primes again, with digits times one more.
    let far = halton(0, 43);
    for (k, want) in [(40, 0.5), (41, 2.0 / 3.0), (42, 4.0 / 5.0)] {
        close(far[k], want);
    }
    let free = vec![
        Free::new("x", (-1.0, 3.0), Transform::Identity, 0.0),
        Free::new("y", (1.0, f64::INFINITY), Transform::Log, 5.0),
        Free::new("z", (1.0, 1e4), Transform::Log, 5.0),
    ];
    let of = |spread: Spread| starts(&free, &MultiStart { starts: 3, spread, ..MultiStart::default() });
    let within = of(Spread::Bounds);
    assert_eq!((within.len(), within[0].clone()), (3, vec![0.0, 5.0, 5.0]));
    close(within[1][0], 1.0);
    close(within[2][0], 0.0 + 0.25 * 4.0 - 1.0);
    // No upper bound: two natural scales around the start, cut at ln 1 = 0.
    let (lo, hi) = (0.0f64.max(5f64.ln() - 2.0), 5f64.ln() + 2.0);
    close(within[1][1], (lo + (hi - lo) / 3.0).exp());
    // Between both bounds, in logarithms.
    close(within[1][2], 1e4f64.powf(0.6));
    // Half a natural scale (2) around 0: from −1 to 1.
    let around = of(Spread::Around(0.5));
    close(around[1][0], 0.0);
    close(around[2][0], -0.5);
    close(around[1][1], (5f64.ln() - 0.5 + 1.0 / 3.0).exp());
}

#[test]
fn the_agreement_of_starts_is_a_sentence() {
    let toy = Toy(60, |i: usize, p: &[f64]| {
        let t = i as f64 / 10.0;
        ((p[0] * t).sin(), vec![t * (p[0] * t).cos()])
    });
    let d = data(&truth(&toy, &[4.0]), NoiseModel::white(0.05));
    let run = |bounds: (f64, f64), fails: bool| {
        let free = vec![Free::new("omega", bounds, Transform::Identity, 4.1)];
        let how = MultiStart { starts: 6, spread: Spread::Bounds, ..MultiStart::default() };
        let options = FitOptions::default();
        let watch: &mut dyn FnMut(usize, &Iterate) -> ControlFlow<()> = &mut |_, _| ControlFlow::Continue(());
        if fails {
            multi_start(&Picky(&toy), &d, &free, &options, &how, watch).unwrap()
        } else {
            multi_start(&toy, &d, &free, &options, &how, watch).unwrap()
        }
    };
    assert_eq!(run((3.9, 4.3), false).sentence(), "All 6 starts end at the same optimum.");
    let failing = run((3.9, 4.3), true);
    let failed = failing.ends.iter().filter(|e| e.1.is_err()).count();
    assert!(failed > 0 && failing.ended == 6 - failed);
    assert_eq!(
        failing.sentence(),
        format!("All {} starts end at the same optimum. {failed} could not start.", 6 - failed)
    );
    let some = run((0.2, 8.0), false);
    assert_eq!(
        some.sentence(),
        format!("{} of 6 starts end at the best optimum, the others at worse ones.", some.agreeing)
    );
    // Each start is the one that the list says.
    for (theta, end) in &some.ends {
        assert_eq!(&end.as_ref().unwrap().history[0].theta, theta);
    }
}

/// Cannot be computed beyond 4.18.
struct Picky<'a, P>(&'a P);

impl<P: Problem> Problem for Picky<'_, P> {
    fn predict(&self, theta: &[f64], jacobian: bool) -> Result<Prediction, PredictError> {
        if theta[0] > 4.18 {
            Err(PredictError::NotComputable("too far".into()))
        } else {
            self.0.predict(theta, jacobian)
        }
    }
}

#[test]
fn random_numbers_are_the_published_generator_and_its_transforms() {
    // SplitMix64 (Steele, Lea & Flood 2014) from the state 1234567, which this seed becomes.
    let stream = || Random::new(6_433_677_232_918_919_796);
    let mut random = stream();
    for published in [6_457_827_717_110_365_317u64, 3_203_168_211_198_807_973, 9_817_491_932_198_370_423] {
        close(random.uniform(), published as f64 / 2f64.powi(64));
    }
    // Box and Muller: two normal numbers of two uniform ones.
    let (mut uniform, mut normal) = (stream(), stream());
    for _ in 0..3 {
        let (u, v) = (uniform.uniform(), uniform.uniform());
        let radius = (-2.0 * u.ln()).sqrt();
        close(normal.normal(), radius * (std::f64::consts::TAU * v).cos());
        close(normal.normal(), radius * (std::f64::consts::TAU * v).sin());
    }
    // The record's noise: AR(1) block by block, then a factor for each column.
    let d = two_blocks();
    let (fresh, noise) = (stream().normals(12), d.simulate_noise(&mut stream()));
    let mut want = DVector::zeros(10);
    for (k, block) in d.blocks.iter().enumerate() {
        let (sd, phi) = (block.noise.sd, block.noise.ar1);
        let mut last = fresh[5 * k];
        want[5 * k] = sd * last;
        for i in 5 * k + 1..5 * k + 5 {
            last = phi * last + (1.0 - phi * phi).sqrt() * fresh[i];
            want[i] = sd * last;
        }
    }
    let columns = d.nuisance_columns();
    want += &columns[0] * fresh[10] + &columns[1] * fresh[11];
    assert!((noise - want).norm() < 1e-12);
}

fn sloppy(free: Vec<Free>, model: impl Fn(usize, &[f64]) -> (f64, Vec<f64>) + Sync) -> String {
    let toy = Toy(30, model);
    let at: Vec<f64> = free.iter().map(|f| f.start).collect();
    let d = data(&truth(&toy, &at), NoiseModel::white(1e-6));
    let end = quiet(&toy, &d, &free, &FitOptions::default());
    let u = uncertainty(&d, &free, &end, &Identifiability::default()).unwrap();
    u.sloppy_directions().join(" | ")
}

/// A parameter with a normal prior around its start: the only knowledge of a direction that the record does not fix.
fn believed(name: &str, start: f64, sd: f64) -> Free {
    Free::new(name, (1e-6, 1e6), Transform::Log, start).prior(start.ln(), sd)
}

#[test]
fn a_direction_is_named_by_what_moves_and_by_how_much() {
    // Only a bᵏ matters: along (k, −1) in logarithms nothing but priors of sd 1 holds.
    let power = |k: f64| {
        sloppy(vec![believed("a", 2.0, 1.0), believed("b", 3.0, 1.0)], move |i, p| {
            let y = p[0] * p[1].powf(k) * (1.0 + i as f64);
            (y, vec![y / p[0], k * y / p[1]])
        })
    };
    // (2, −1)/√5: exp(0.894) − 1 and exp(−0.447) − 1.
    assert_eq!(power(2.0), "The record hardly fixes a / b: a +145 %, b -36 % together raise χ² by only 1.");
    // (0.8, −1)/1.281: near enough to a product to say so.
    assert_eq!(
        power(0.8),
        "The record hardly fixes b / a, only b · a: b +118 %, a -46 % together raise χ² by only 1."
    );
    assert_eq!(
        power(-0.8),
        "The record hardly fixes b · a, only b / a: b +118 %, a +87 % together raise χ² by only 1."
    );
    // Three ratios of powers are seen, so that (4, 3, 2.5, 2)/5.937 is not; more than three are counted.
    let names = ["a", "b", "c", "d"];
    let four = sloppy(names.iter().map(|n| believed(n, 2.0, 2.0)).collect(), |i, p| {
        let (j, m, n) = [(0, 3.0, 4.0), (1, 2.5, 3.0), (2, 2.0, 2.5)][i % 3];
        let y = p[j].powf(m) / p[j + 1].powf(n);
        let mut slope = vec![0.0; 4];
        (slope[j], slope[j + 1]) = (m * y / p[j], -n * y / p[j + 1]);
        (y, slope)
    });
    assert_eq!(
        four,
        "The record hardly fixes 4 parameters against each other: a +285 %, b +175 %, c +132 % and 1 smaller \
         changes together raise χ² by only 1."
    );
    // One parameter alone, by the sd of its prior; no sentence below a sd of 1/2.
    let idle = |f: Free| {
        let seen = Free::new("a", (1e-6, 1e6), Transform::Log, 2.0);
        sloppy(vec![seen, f], |i, p| (p[0] * (1.0 + i as f64), vec![1.0 + i as f64, 0.0]))
    };
    let said = |change: &str| format!("The record hardly fixes idle: idle {change} raises χ² by only 1.");
    assert_eq!(idle(believed("idle", 3.0, 2.2)), said("+803 %"));
    assert_eq!(idle(believed("idle", 3.0, 2.4)), said("up more than 10-fold"));
    assert_eq!(idle(believed("idle", 3.0, 0.49)), "");
    assert_eq!(idle(believed("idle", 3.0, 0.51)), said("+67 %"));
    let plain = |at: f64| Free::new("idle", (-10.0, 10.0), Transform::Identity, at).prior(at, 5.2);
    assert_eq!(idle(plain(4.0)), said("+130 %"));
    assert_eq!(idle(plain(0.0)), said("+5.200"));
    assert_eq!(idle(plain(0.1)), said("+5.200"), "fifty times its value is no percentage");
}

#[test]
fn bounds_scales_and_coordinates_of_a_parameter() {
    let f = |lower: f64, upper: f64, transform: Transform| Free::new("p", (lower, upper), transform, 1.0);
    let unit = Transform::Logit { lower: 0.0, upper: 2.0 };
    let (box_, log, logit) =
        (f(-1.0, 3.0, Transform::Identity), f(1.0, 100.0, Transform::Log), f(0.0, 2.0, unit));
    assert_eq!((box_.natural_scale(9.0), log.natural_scale(9.0), logit.natural_scale(1.0)), (2.0, 1.0, 1.0));
    let open = f(f64::NEG_INFINITY, f64::INFINITY, Transform::Identity);
    assert_eq!((open.natural_scale(-7.0), open.natural_scale(0.0)), (7.0, 1.0));
    assert_eq!(open.clone().prior(0.0, 0.3).natural_scale(-7.0), 0.3);
    assert_eq!((log.bounds_z(), open.bounds_z()), ((0.0, 100f64.ln()), (f64::NEG_INFINITY, f64::INFINITY)));
    assert_eq!((box_.forward(5.0), box_.forward(-5.0), log.forward(0.5)), (3.0, -1.0, 0.0));
    assert_eq!((box_.backward(5.0), box_.backward(-5.0), box_.backward(0.5)), (3.0, -1.0, 0.5));
    assert_eq!([-1.0, -0.999, 2.999, 3.0].map(|x| box_.at_bound(x)), [true, false, false, true]);
    assert_eq!([1.0009, 1.0011, 99.89, 99.91].map(|x| log.at_bound(x)), [true, false, false, true]);
    assert_eq!([0.0019, 0.0021, 1.9979, 1.9981].map(|x| logit.at_bound(x)), [true, false, false, true]);
}

#[test]
fn a_faulty_description_is_named_with_its_fault() {
    let toy = Toy(5, line);
    let good = data(&truth(&toy, &[1.0, 2.0]), NoiseModel::white(0.5));
    let fails = |d: &Data, change: &dyn Fn(&mut Free)| {
        let mut free = free(10.0);
        change(&mut free[1]);
        fit(&toy, d, &free, &FitOptions::default(), &mut |_| ControlFlow::Continue(()))
            .map_err(|e| e.to_string())
    };
    let parameter = |change: &dyn Fn(&mut Free)| fails(&good, change).unwrap_err();
    assert_eq!(parameter(&|f| f.upper = -10.0), "parameter b: lower bound -10 is not below upper bound -10");
    assert_eq!(
        parameter(&|f| f.lower = f64::NAN),
        "parameter b: lower bound NaN is not below upper bound 10"
    );
    assert_eq!(parameter(&|f| f.start = f64::NAN), "parameter b: start value is not a finite number");
    let negative = |f: &mut Free| (f.upper, f.transform) = (0.0, Transform::Log);
    assert_eq!(parameter(&negative), "parameter b: a logarithmic coordinate needs a positive upper bound");
    for (mean, sd) in [(f64::NAN, 1.0), (0.0, 0.0), (0.0, -1.0), (0.0, f64::INFINITY)] {
        let said = parameter(&|f| f.prior = Some(Prior { mean, sd }));
        assert_eq!(said, "parameter b: prior needs a finite mean and a positive sd");
    }
    let record = |change: &dyn Fn(&mut Data)| {
        let mut d = two_blocks();
        change(&mut d);
        d.check().unwrap_err().to_string()
    };
    assert_eq!(record(&|d| d.blocks[1].range = 4..9), "block 1: starts at point 4, expected 5");
    assert_eq!(record(&|d| d.blocks[0].measured.truncate(4)), "block 0: 4 numbers for 5 points");
    assert_eq!(
        record(&|d| d.blocks[1].noise.sd = -1.0),
        "block 1: noise sd is -1, expected a positive number"
    );
    assert_eq!(
        record(&|d| d.blocks[1].noise.ar1 = -1.0),
        "block 1: ar1 is -1, expected a number between -1 and 1"
    );
    assert_eq!(
        record(&|d| d.blocks[0].measured[3] = f64::INFINITY),
        "block 0: measured value 3 is not finite"
    );
    let column = |n: usize, x: f64| DVector::from_element(n, x);
    let own = |c: DVector<f64>| record(&|d| d.blocks[1].noise.nuisance[0] = c.clone());
    assert_eq!(own(column(4, 1.0)), "block 1: a nuisance column of 4 for 5 points");
    assert_eq!(own(column(5, f64::NAN)), "block 1: a nuisance column holds a number that is not finite");
    let across = |c: DVector<f64>| record(&|d| d.nuisance[0] = c.clone());
    assert_eq!(across(column(9, 1.0)), "a nuisance column has length 9, expected 10");
    assert_eq!(
        across(column(10, f64::NAN)),
        "block (all): a nuisance column holds a number that is not finite"
    );
    assert_eq!(record(&|d| d.held_out = vec![false; 9]), "the held-out mask has length 9, expected 10");
    assert!(two_blocks().check().is_ok() && fails(&good, &|_| ()).is_ok());
    assert_eq!((two_blocks().points(), two_blocks().used_points()), (10, 9));
}
