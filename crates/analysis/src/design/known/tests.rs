//! Promised standard errors, and what is expected of them.

use super::*;
use diagnose::Side;
use inverse::{Data, Noise, NoiseModel, Prediction, Random};

const N: usize = 120;

fn column(f: impl Fn(f64) -> f64) -> DVector<f64> {
    DVector::from_fn(N, |i, _| f(i as f64 / N as f64))
}

fn line() -> (Vec<Free>, Whitened) {
    let free = |path: &str| Free::new(path, (-1e3, 1e3), params::Transform::Identity, 0.0);
    let list = vec![free("a"), free("b")];
    let zero = vec![0.0; N];
    let data = Data::from_parts([(String::from("r"), zero, NoiseModel::white(0.5))]).unwrap();
    let jacobian = DMatrix::from_columns(&[column(|_| 1.0), column(|x| x)]);
    let prediction = Prediction::new(DVector::zeros(N), Some(jacobian));
    let white = Whitened::new(&data, &list, &[4.0, 4.0], &prediction, Noise::Record);
    (list, white)
}

/// Fits of a line to noise and a mesh's error of random size scatter as far as is said, with and without a parabola
/// that is free too.
#[test]
fn standard_errors_are_the_scatter_of_fits() {
    let (list, white) = line();
    let error = column(|x| 0.3 * (1.0 - x));
    let parabola = Candidate::simple("parabola", Side::Both, 2.0, column(|x| x * x));
    let sums = Sums::new(&white, vec![white.column(&error)]);
    let known = sums.known((&list, &[4.0, 4.0]), &[]);
    let beside = sums.beside(&parabola, 2);
    let mut random = Random::new(3);
    let columns = [column(|_| 1.0), column(|x| x), column(|x| x * x)];
    let mut squares = [[0.0; 3]; 2];
    let runs = 4000;
    for _ in 0..runs {
        let noise = 0.5 * random.normals(N);
        let record = &noise + random.normal() * &error;
        for (k, sum) in squares[0].iter_mut().enumerate().take(2) {
            *sum += fit(&columns[..2], &record)[k].powi(2);
        }
        squares[0][2] += fit(&columns[..2], &noise)[0].powi(2);
        for (k, sum) in squares[1].iter_mut().enumerate().take(2) {
            *sum += fit(&columns, &record)[k].powi(2);
        }
    }
    let sd = |sum: f64| (sum / f64::from(runs)).sqrt();
    for k in 0..2 {
        let (promised, found) = (4.0 * known[k].relative_error, sd(squares[0][k]));
        assert!((found / promised - 1.0).abs() < 0.04, "{k}: {found} for {promised}");
        let found = sd(squares[1][k]);
        assert!((found / beside[k] - 1.0).abs() < 0.04, "{k} beside: {found} for {}", beside[k]);
    }
    let (promised, found) = (4.0 * known[0].by_noise, sd(squares[0][2]));
    assert!((found / promised - 1.0).abs() < 0.04, "by noise: {found} for {promised}");
}

fn fit(columns: &[DVector<f64>], record: &DVector<f64>) -> DVector<f64> {
    let j = DMatrix::from_columns(columns);
    (j.tr_mul(&j)).try_inverse().unwrap() * j.tr_mul(record)
}

/// Of two places the worse counts, and what opens either opens; what is open at one is not opened by an effect.
#[test]
fn the_worse_of_two_places_counts() {
    use Expected::{Fixed, Open, Uncertain};
    let at = |relative_error: f64, expected: Expected, beside: &[(&str, Expected)]| Known {
        path: "a".into(),
        value: relative_error,
        relative_error,
        by_noise: 0.5 * relative_error,
        expected,
        beside: beside.iter().map(|&(e, x)| (e.to_owned(), x)).collect(),
    };
    let first = || at(0.1, Fixed, &[("slack", Uncertain), ("gain", Open)]);
    let second = vec![at(0.2, Fixed, &[("drift", Open), ("slack", Open)]), at(0.9, Uncertain, &[])];
    let both = less_known(vec![first(), first()], second);
    assert_eq!((both[0].value, both[0].relative_error, both[0].by_noise), (0.1, 0.2, 0.1));
    assert_eq!(both[0].expected, Fixed);
    assert_eq!(both[0].beside, at(0.0, Fixed, &[("drift", Open), ("gain", Open), ("slack", Open)]).beside);
    assert_eq!(both[1].expected, Uncertain);
    assert_eq!(both[1].beside, at(0.0, Open, &[("gain", Open)]).beside);
    let beside = |effects: &[&str]| both[1].expected_beside(effects.iter().copied());
    assert_eq!((beside(&[]), beside(&["slack"]), beside(&["slack", "gain"])), (Uncertain, Uncertain, Open));
}

/// By the rule of an identification, with a factor of three either way: a half in natural scales, which for a share of a
/// box are those of its logit, and 0.7 of a prior.
#[test]
fn what_is_expected_goes_by_the_rule_of_identifications() {
    let log = Free::new("k", (1e-3, 1e3), params::Transform::Log, 1.0);
    let at = |sd: f64| Expected::of(&log, 1.0, sd);
    let seen = [0.16, 0.17, 1.49, 1.51, f64::INFINITY, f64::NAN].map(at);
    use Expected::{Fixed, Open, Uncertain};
    assert_eq!(seen, [Fixed, Uncertain, Uncertain, Open, Open, Open]);
    let prior = Free { prior: Some(inverse::Prior { mean: 0.0, sd: 0.2 }), ..log.clone() };
    let at = |sd: f64| Expected::of(&prior, 1.0, sd);
    assert_eq!([0.05, 0.07, 0.18, 0.19, 0.2].map(at), [Fixed, Uncertain, Uncertain, Open, Open]);
}

/// What an effect imitates is less sure beside it, and what it does not stays as it was.
#[test]
fn an_effect_opens_what_it_imitates() {
    let free = |path: &str| Free::new(path, (-10.0, 10.0), params::Transform::Identity, 0.0);
    let list = vec![free("a"), free("b")];
    let (_, white) = line();
    let slope = Candidate::simple("slope", Side::Both, 1.0, column(|x| x + 0.02 * (40.0 * x).sin()));
    let wave = Candidate::simple("wave", Side::Both, 1.0, column(|x| (40.0 * x).sin()));
    let known = Sums::new(&white, Vec::new()).known((&list, &[4.0, 4.0]), &[&slope, &wave]);
    let sure = |k: &Known| k.expected == Expected::Fixed && k.relative_error == k.by_noise;
    assert!(known.iter().all(sure), "{known:?}");
    let beside: Vec<Vec<&String>> = known.iter().map(|k| k.beside.keys().collect()).collect();
    assert_eq!((beside[0].len(), &beside[1][..]), (0, &[&"slope".to_owned()][..]), "{known:?}");
}
