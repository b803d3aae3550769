//! Linear models, where every error, interval and criterion has a closed form: dense matrices here against the crate.
#![allow(missing_docs)]

use crate::line;
use crate::toys;

use inverse::*;
use line::*;
use nalgebra::{DMatrix, DVector};
use params::Transform;
use toys::{Toy, data, quiet, truth};

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

/// Where the level of the noise is an estimate, errors stay and intervals widen by Student's quantile (tables: 2.228 for
/// ten degrees of freedom, 12.706 for one).
#[test]
fn noise_that_is_estimated_widens_intervals() {
    let half = |freedom: [f64; 2]| {
        let blocks = freedom.map(|freedom| {
            let noise = NoiseModel { freedom, ..NoiseModel::white(0.5) };
            (format!("{freedom}"), vec![-3.0, -1.1, 1.0, 3.2, 4.9], noise)
        });
        let d = Data::from_parts(blocks).unwrap();
        let twice = |i: usize, p: &[f64]| line(i % 5, p);
        let free = free(10.0);
        let end = quiet(&Toy(10, twice), &d, &free, &exactly(Objective::Whitened));
        let u = uncertainty(&d, &free, &end, &Identifiability::default()).unwrap();
        let e = &u.estimates[0];
        close(e.std_error.unwrap(), 0.5 / 10f64.sqrt());
        (e.interval_95[1] - e.value) / e.std_error.unwrap()
    };
    let rounded = |x: f64| (1e3 * x).round() / 1e3;
    assert_eq!(rounded(half([10.0, f64::INFINITY])), 2.228);
    assert_eq!(rounded(half([50.0, 1.0])), 12.706);
    close(half([f64::INFINITY; 2]), Z95);
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
    free[1] = Free::new("b", (1.0, 4.0), Transform::Logit { lower: 1.0, upper: 4.0 }, 2.0);
    let end = quiet(&Toy(5, line), &d, &free, &exactly(Objective::Whitened));
    let u = uncertainty(&d, &free, &end, &Identifiability::default()).unwrap();
    assert!(u.estimates[1].at_bound);
    close(u.estimates[1].scaled_sd, 0.5 / 10f64.sqrt() / 0.75);
}
