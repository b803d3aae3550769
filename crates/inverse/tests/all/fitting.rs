//! The search: exact recovery, bounds, hard valleys, failures of the model, stop reasons.
#![allow(missing_docs)]

use crate::toys;

use inverse::*;
use nalgebra::{DMatrix, DVector};
use params::Transform;
use proptest::prelude::*;
use std::ops::ControlFlow;
use toys::{Toy, data, exponential, exponential_free, quiet, truth};

#[test]
fn an_exact_record_gives_the_exact_parameters() {
    let toy = Toy(40, exponential);
    let d = data(&truth(&toy, &[3.0, 0.7, -0.4]), NoiseModel::white(0.01));
    for objective in [Objective::PaperSum, Objective::Whitened] {
        let end = quiet(&toy, &d, &exponential_free(), &FitOptions { objective, ..Default::default() });
        for (x, want) in end.theta.iter().zip([3.0, 0.7, -0.4]) {
            assert!((x - want).abs() < 1e-7, "{:?} {:?}", end.theta, end.stop);
        }
        assert!(end.stop.converged());
    }
}

#[test]
fn an_optimum_outside_the_bounds_ends_on_the_bound() {
    let toy = Toy(40, exponential);
    let d = data(&truth(&toy, &[3.0, 0.7, -0.4]), NoiseModel::white(0.01));
    let mut free = exponential_free();
    free[2].lower = 0.1;
    free[2].start = 0.5;
    let end = quiet(&toy, &d, &free, &FitOptions::default());
    assert_eq!(end.theta[2], 0.1);
    assert_eq!(end.at_bound, [false, false, true]);
    assert!(end.stop.converged(), "{:?}", end.stop);
    // The others are at their own optimum with c held: the gradient over them is zero.
    let white = Whitened::new(&d, &free, &end.theta, &end.prediction, Noise::Total);
    let g = white.jacobian.tr_mul(&white.r);
    assert!(g[0].abs() < 1e-3 * white.r.norm() * white.jacobian.column(0).norm());
    assert!(g[1].abs() < 1e-3 * white.r.norm() * white.jacobian.column(1).norm());
}

#[test]
fn a_logit_parameter_at_its_end_is_reported_at_the_bound() {
    let toy = Toy(20, |i: usize, p: &[f64]| {
        let t = i as f64 / 20.0;
        (p[0] + p[1] * t, vec![1.0, t])
    });
    let d = data(&truth(&toy, &[-0.3, 1.0]), NoiseModel::white(0.01));
    let logit = Transform::Logit { lower: 0.0, upper: 1.0 };
    let free =
        vec![Free::new("p", (0.0, 1.0), logit, 0.5), Free::new("q", (-5.0, 5.0), Transform::Identity, 0.0)];
    let end = quiet(&toy, &d, &free, &FitOptions::default());
    assert!(end.at_bound[0] && end.theta[0] < 1e-3, "{:?} {:?}", end.theta, end.stop);
    let u = uncertainty(&d, &free, &end, &Identifiability::default()).unwrap();
    assert!(u.estimates[0].interval_95[1] < 0.1 && u.estimates[0].std_error.is_some());
}

#[test]
fn the_bent_valley_of_rosenbrock_is_followed_to_its_end() {
    let toy = Toy(2, |i: usize, p: &[f64]| match i {
        0 => (10.0 * (p[1] - p[0] * p[0]), vec![-20.0 * p[0], 10.0]),
        _ => (p[0], vec![1.0, 0.0]),
    });
    let d = data(&DVector::from_vec(vec![0.0, 1.0]), NoiseModel::white(1.0));
    let free = vec![
        Free::new("x", (-5.0, 5.0), Transform::Identity, -1.2),
        Free::new("y", (-5.0, 5.0), Transform::Identity, 1.0),
    ];
    let end =
        quiet(&toy, &d, &free, &FitOptions { max_iterations: 60, insignificant: 0.0, ..Default::default() });
    assert!((end.theta[0] - 1.0).abs() < 1e-6 && (end.theta[1] - 1.0).abs() < 1e-6, "{end:?}");
}

#[test]
fn a_direction_without_any_influence_neither_stalls_nor_runs_away() {
    let toy = Toy(30, |i: usize, p: &[f64]| {
        let t = i as f64 / 10.0;
        let e = (-t * p[1]).exp();
        (p[0] * p[2] * e, vec![p[2] * e, -t * p[0] * p[2] * e, p[0] * e, 0.0])
    });
    let mut values = truth(&toy, &[2.0, 0.5, 3.0, 1.0]);
    values += Random::new(1).normals(30) * 0.02;
    let d = data(&values, NoiseModel::white(0.02));
    let free: Vec<Free> =
        ["a", "b", "c", "idle"].iter().map(|n| Free::new(*n, (1e-4, 1e4), Transform::Log, 1.0)).collect();
    let end = quiet(&toy, &d, &free, &FitOptions::default());
    assert!(end.stop.converged(), "{:?}", end.stop);
    assert!((end.theta[3] - 1.0).abs() < 1e-9, "{}", end.theta[3]);
    assert!((end.theta[0] * end.theta[2] - 6.0).abs() < 0.1);
    assert!(end.theta[0] > 0.5 && end.theta[0] < 20.0, "{:?}", end.theta);
    let u = uncertainty(&d, &free, &end, &Identifiability::default()).unwrap();
    let flags: Vec<bool> = u.estimates.iter().map(|e| e.identifiable).collect();
    assert_eq!(flags, [false, true, false, false]);
    assert!(u.estimates.iter().all(|e| e.interval_95.iter().all(|x| x.is_finite())));
    let words = u.sloppy_directions().join("\n");
    assert!(words.contains("only a · c") || words.contains("only c · a"), "{words}");
    assert!(words.contains("idle"), "{words}");
}

struct Fragile;

impl Problem for Fragile {
    fn predict(&self, theta: &[f64], jacobian: bool) -> Result<Prediction, PredictError> {
        if theta[0] > 2.5 {
            return Err(PredictError::NotComputable("no equilibrium".into()));
        }
        Toy(40, exponential).predict(theta, jacobian)
    }
}

#[test]
fn a_model_that_fails_shortens_the_step_and_is_remembered() {
    let d = data(&truth(&Toy(40, exponential), &[2.4, 0.7, -0.4]), NoiseModel::white(0.01));
    let mut free = exponential_free();
    free[0].start = 0.2;
    free[1].start = 4.0;
    let end = quiet(&Fragile, &d, &free, &FitOptions { max_iterations: 60, ..Default::default() });
    assert!((end.theta[0] - 2.4).abs() < 1e-6, "{:?} {:?}", end.theta, end.stop);
    let d = data(&truth(&Toy(40, exponential), &[2.6, 0.7, -0.4]), NoiseModel::white(0.01));
    let end = quiet(&Fragile, &d, &free, &FitOptions { max_iterations: 60, ..Default::default() });
    assert!(end.theta[0] <= 2.5 && end.history.iter().any(|it| it.f.is_none() && !it.accepted));
    free[0].start = 3.0;
    let refused = fit(&Fragile, &d, &free, &FitOptions::default(), &mut |_| ControlFlow::Continue(()));
    assert!(matches!(refused, Err(FitError::Start(_))));
}

#[test]
fn stop_reasons_are_told_apart() {
    let toy = Toy(40, exponential);
    let exact = truth(&toy, &[3.0, 0.7, -0.4]);
    let noisy = &exact + Random::new(2).normals(40) * 0.05;
    let (free, options) = (exponential_free(), FitOptions::default());
    let d = data(&noisy, NoiseModel::white(0.05));
    assert_eq!(quiet(&toy, &d, &free, &options).stop, StopReason::Converged);
    let one = FitOptions { max_iterations: 1, ..options.clone() };
    assert_eq!(quiet(&toy, &d, &free, &one).stop, StopReason::MaxIterations);
    let d_exact = data(&exact, NoiseModel::white(0.05));
    let to_the_end = FitOptions { insignificant: 0.0, ..options.clone() };
    assert_eq!(quiet(&toy, &d_exact, &free, &to_the_end).stop, StopReason::Exact);
    let anything = FitOptions { insignificant: 1e9, ..options.clone() };
    let idle = quiet(&toy, &d_exact, &free, &anything);
    assert_eq!((idle.stop, idle.iterations), (StopReason::Insignificant, 3));
    assert_eq!(
        quiet(&Toy(40, |i, _: &[f64]| (i as f64, vec![])), &d, &[], &options).stop,
        StopReason::NothingFree
    );
    let stopped = fit(&toy, &d, &free, &options, &mut |it| {
        if it.iteration == 2 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    })
    .unwrap();
    assert_eq!(stopped.stop, StopReason::Stopped);
    assert_eq!(stopped.iterations, 2);
    let at_end: Vec<Free> = free
        .iter()
        .zip(&quiet(&toy, &d, &free, &FitOptions { tolerance: 1e-14, ..options.clone() }).theta)
        .map(|(f, &x)| Free { start: x, ..f.clone() })
        .collect();
    assert_eq!(quiet(&toy, &d, &at_end, &options).stop, StopReason::Stationary);
    let liar = Toy(40, |i, p: &[f64]| {
        let (y, j) = exponential(i, p);
        (y, j.iter().map(|v| -v).collect())
    });
    assert_eq!(quiet(&liar, &d, &free, &options).stop, StopReason::NoDescent);
    assert!(StopReason::NoDescent.sentence().ends_with('.'));
}

#[test]
fn many_trials_are_for_steps_that_predict_a_reduction() {
    let d = data(&truth(&Toy(40, exponential), &[3.0, 0.7, -0.4]), NoiseModel::white(0.05));
    // Its steps predict much and go uphill.
    let liar = Toy(40, |i, p: &[f64]| {
        let (y, j) = exponential(i, p);
        (y, j.iter().map(|v| -v).collect())
    });
    let rejected = |tolerance: f64| {
        let options = FitOptions { tolerance, max_trials: 12, ..FitOptions::default() };
        quiet(&liar, &d, &exponential_free(), &options).history.iter().filter(|it| !it.accepted).count()
    };
    assert_eq!(rejected(1e-6), 12);
    assert_eq!(rejected(2.0), 5, "no fall is worth twice the objective");
}

#[test]
fn bad_input_is_an_error_not_a_panic() {
    let toy = Toy(40, exponential);
    let values = truth(&toy, &[3.0, 0.7, -0.4]);
    let d = data(&values, NoiseModel::white(0.05));
    let run = |d: &Data, free: &[Free]| {
        fit(&toy, d, free, &FitOptions::default(), &mut |_| ControlFlow::Continue(())).err()
    };
    let mut free = exponential_free();
    free[0].upper = free[0].lower;
    assert!(matches!(run(&d, &free), Some(FitError::Parameter(_))));
    let mut short = d.clone();
    short.blocks[0].measured.pop();
    assert!(matches!(run(&short, &exponential_free()), Some(FitError::Data(_))));
    for noise in [NoiseModel::white(0.0), NoiseModel::ar1(1.0, 1.0), NoiseModel::white(f64::NAN)] {
        let mut bad = d.clone();
        bad.blocks[0].noise = noise;
        assert!(matches!(run(&bad, &exponential_free()), Some(FitError::Data(_))));
    }
    let two = data(&values.rows(0, 20).into_owned(), NoiseModel::white(0.05));
    assert!(matches!(run(&two, &exponential_free()), Some(FitError::Contract(_))));
}

/// A step whose place depends on the parameter: points between its old and new place leave the linearisation.
struct Jumping;

impl Problem for Jumping {
    fn predict(&self, theta: &[f64], jacobian: bool) -> Result<Prediction, PredictError> {
        let toy = Toy(60, |i: usize, p: &[f64]| {
            let t = i as f64 / 60.0;
            let fallen = f64::from(u8::from(t > p[0]));
            (p[1] * t * (1.0 - 0.7 * fallen) + 0.2 * p[0] * t, vec![0.2 * t, t * (1.0 - 0.7 * fallen)])
        });
        let mut answer = toy.predict(theta, jacobian)?;
        let between = |t: f64| t > theta[0].min(0.508) && t <= theta[0].max(0.508);
        answer.valid = Some((0..60).map(|i| !between(i as f64 / 60.0)).collect());
        Ok(answer)
    }
}

#[test]
fn points_at_a_jump_count_in_the_objective_but_not_in_the_step() {
    let d = data(&Jumping.predict(&[0.508, 2.0], false).unwrap().values, NoiseModel::ar1(0.02, 0.4));
    let free = vec![
        Free::new("where", (0.1, 0.9), Transform::Log, 0.45),
        Free::new("slope", (0.1, 10.0), Transform::Log, 1.5),
    ];
    let end = quiet(&Jumping, &d, &free, &FitOptions::default());
    assert!((end.theta[1] - 2.0).abs() < 0.02 && (end.theta[0] - 0.508).abs() < 0.02, "{:?}", end.theta);
    let early = Jumping.predict(&[0.4, 2.0], true).unwrap();
    assert_eq!(Whitened::new(&d, &free, &[0.4, 2.0], &early, Noise::Total).rows.len(), 54);
}

#[test]
fn held_out_points_have_no_influence() {
    let toy = Toy(40, exponential);
    let mut values = truth(&toy, &[3.0, 0.7, -0.4]);
    for i in 10..20 {
        values[i] += 5.0;
    }
    let mut d = data(&values, NoiseModel::ar1(0.05, 0.3));
    d.held_out = (0..40).map(|i| (10..20).contains(&i)).collect();
    let end = quiet(&toy, &d, &exponential_free(), &FitOptions::default());
    assert!((end.theta[0] - 3.0).abs() < 1e-6);
    assert_eq!(quality(&d, &exponential_free(), &end).points, 30);
}

#[test]
fn many_starts_find_the_deeper_well() {
    let toy = Toy(60, |i: usize, p: &[f64]| {
        let t = i as f64 / 10.0;
        ((p[0] * t).sin(), vec![t * (p[0] * t).cos()])
    });
    let d = data(&truth(&toy, &[4.0]), NoiseModel::white(0.05));
    let free = vec![Free::new("omega", (0.2, 8.0), Transform::Identity, 0.9)];
    let options = FitOptions::default();
    assert!((quiet(&toy, &d, &free, &options).theta[0] - 4.0).abs() > 0.5, "one start is trapped");
    let ask = MultiStart { starts: 16, spread: Spread::Bounds, ..Default::default() };
    let run = |how: &MultiStart| {
        multi_start(&toy, &d, &free, &options, how, &mut |_, _| ControlFlow::Continue(())).unwrap()
    };
    let serial = run(&ask);
    assert!((serial.best.theta[0] - 4.0).abs() < 1e-6);
    assert!(serial.agreeing >= 1 && serial.agreeing < serial.ended, "{}", serial.sentence());
    let parallel = run(&MultiStart { parallel: true, ..ask });
    assert_eq!(parallel.best.theta, serial.best.theta);
    assert_eq!(parallel.best_start, serial.best_start);
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(24) })]

    /// A fit does not depend on the unit of a parameter, of the data, or on the order of the parameters.
    #[test]
    fn a_fit_does_not_depend_on_units(unit in 1e-4f64..1e4, force in 1e-3f64..1e3, seed in 0u64..1000) {
        let plain = Toy(30, |i: usize, p: &[f64]| exponential(i, p));
        let scaled = Toy(30, move |i: usize, p: &[f64]| {
            let (y, j) = exponential(i, &[p[1], p[2], p[0] * unit]);
            (y * force, vec![j[2] * unit * force, j[0] * force, j[1] * force])
        });
        let noise = Random::new(seed).normals(30) * 0.03;
        let y = truth(&plain, &[3.0, 0.7, -0.4]) + noise;
        let d1 = data(&y, NoiseModel::ar1(0.03, 0.2));
        let d2 = data(&(y * force), NoiseModel::ar1(0.03 * force, 0.2));
        let free = exponential_free();
        let c = Free::new("c", (-10.0 / unit, 10.0 / unit), Transform::Identity, 0.0);
        let other = vec![c, free[0].clone(), free[1].clone()];
        let options = FitOptions { tolerance: 1e-10, ..Default::default() };
        let (a, b) = (quiet(&plain, &d1, &free, &options), quiet(&scaled, &d2, &other, &options));
        prop_assert!((a.f - b.f).abs() < 1e-6 * a.f);
        prop_assert!((a.theta[0] - b.theta[1]).abs() < 1e-4 * a.theta[0]);
        prop_assert!((a.theta[2] - b.theta[0] * unit).abs() < 1e-4);
    }

    /// Whatever the start, the answer respects the bounds and never raises the objective.
    #[test]
    fn the_objective_never_rises_and_bounds_hold(a in 0.01f64..500.0, b in 0.01f64..50.0, c in -9.0f64..9.0) {
        let toy = Toy(25, exponential);
        let y = truth(&toy, &[3.0, 0.7, -0.4]) + Random::new(4).normals(25) * 0.1;
        let mut free = exponential_free();
        for (f, x) in free.iter_mut().zip([a, b, c]) {
            f.start = x;
        }
        let end = quiet(&toy, &data(&y, NoiseModel::white(0.1)), &free, &FitOptions::default());
        let accepted: Vec<f64> = end.history.iter().filter(|i| i.accepted).filter_map(|i| i.f).collect();
        prop_assert!(accepted.windows(2).all(|w| w[1] < w[0]));
        for (f, x) in free.iter().zip(&end.theta) {
            prop_assert!(f.lower <= *x && *x <= f.upper);
        }
    }

    /// The whitened square is rᵀΣ⁻¹r, computed here densely.
    #[test]
    fn whitening_is_the_inverse_covariance(phi in -0.8f64..0.9, sd in 0.1f64..3.0, seed in 0u64..500) {
        let n = 12;
        let mut random = Random::new(seed);
        let mut d = data(&random.normals(n), NoiseModel::ar1(sd, phi).with_nuisance(random.normals(n)));
        d.nuisance = vec![random.normals(n), random.normals(n)];
        d.held_out = (0..n).map(|i| i == 3 || i == 4).collect();
        let rows: Vec<usize> = (0..n).filter(|&i| i != 3 && i != 4).collect();
        let mut sigma = DMatrix::from_fn(rows.len(), rows.len(), |i, j| {
            sd * sd * phi.powi(rows[i].abs_diff(rows[j]) as i32)
        });
        for e in d.nuisance_columns() {
            let part = DVector::from_iterator(rows.len(), rows.iter().map(|&i| e[i]));
            sigma += &part * part.transpose();
        }
        let r = random.normals(n);
        let part = DVector::from_iterator(rows.len(), rows.iter().map(|&i| r[i]));
        let want = part.dot(&sigma.clone().lu().solve(&part).unwrap());
        let got = Whitener::new(&d, None, Noise::Total).apply(&r).norm_squared();
        prop_assert!((got - want).abs() < 1e-8 * want, "{} {}", got, want);
    }
}
