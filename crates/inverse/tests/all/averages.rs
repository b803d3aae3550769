//! Points that are averages of unequal numbers of readings: whitening against a dense covariance.

use inverse::{Data, Noise, NoiseModel, Random, Whitener};
use nalgebra::{DMatrix, DVector};

const SPREAD: [f64; 6] = [3.0, 1.0, 1.0, 0.5, 2.0, 1.0];
const POSITION: [f64; 6] = [0.0, 0.6, 1.6, 3.0, 3.2, 4.2];

fn data(noise: NoiseModel) -> Data {
    Data::from_parts([("a".into(), vec![0.0; noise.spread.len()], noise)]).expect("good data")
}

fn averages(ar1: f64) -> NoiseModel {
    NoiseModel { spread: SPREAD.to_vec(), position: POSITION.to_vec(), ..NoiseModel::ar1(0.2, ar1) }
}

/// Covariance as it is defined.
fn dense(ar1: f64) -> DMatrix<f64> {
    DMatrix::from_fn(6, 6, |i, j| 0.04 * SPREAD[i] * SPREAD[j] * ar1.powf((POSITION[i] - POSITION[j]).abs()))
}

#[test]
fn averages_are_whitened_by_their_own_sd_and_distance() {
    let mut random = Random::new(7);
    for ar1 in [0.0, 0.6] {
        let whitener = Whitener::new(&data(averages(ar1)), None, Noise::Record);
        let inverse = dense(ar1).try_inverse().expect("positive");
        for _ in 0..20 {
            let v = DVector::from_fn(6, |_, _| random.normal());
            let expected = (v.transpose() * &inverse * &v)[0];
            assert!((whitener.apply(&v).norm_squared() / expected - 1.0).abs() < 1e-12);
        }
    }
}

#[test]
fn averages_are_drawn_with_their_own_sd_and_distance() {
    let data = data(averages(0.6));
    let mut random = Random::new(11);
    let mut sum = DMatrix::zeros(6, 6);
    for _ in 0..40_000 {
        let v = data.simulate_noise(&mut random);
        sum += &v * v.transpose();
    }
    let (found, expected) = (sum / 40_000.0, dense(0.6));
    for i in 0..6 {
        for j in 0..6 {
            let size = (expected[(i, i)] * expected[(j, j)]).sqrt();
            assert!((found[(i, j)] - expected[(i, j)]).abs() < 0.03 * size, "{i} {j}");
        }
    }
}

/// Equal averages at even places are what they are without both lists, to the bit.
#[test]
fn equal_averages_are_plain_points() {
    let plain = Data::from_parts([("a".into(), vec![0.0; 6], NoiseModel::ar1(0.2, 0.0))]).expect("good");
    let same = NoiseModel { spread: vec![1.0; 6], ..NoiseModel::ar1(0.2, 0.0) };
    let v = DVector::from_fn(6, |i, _| (i as f64).sin());
    let of = |d: &Data| Whitener::new(d, None, Noise::Record).apply(&v);
    assert_eq!(of(&plain), of(&data(same)));
}

#[test]
fn lists_of_another_length_or_order_are_refused() {
    let refused = |noise: NoiseModel| Data::from_parts([("a".into(), vec![0.0; 6], noise)]).is_err();
    assert!(refused(NoiseModel { spread: vec![1.0; 5], ..NoiseModel::white(1.0) }));
    assert!(refused(NoiseModel { spread: vec![0.0; 6], ..NoiseModel::white(1.0) }));
    assert!(refused(NoiseModel { position: vec![1.0; 6], ..NoiseModel::white(1.0) }));
    assert!(!refused(averages(0.3)));
}
