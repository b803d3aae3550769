use super::*;
use crate::linear::{Linear, Parameter};
use crate::{Kernel, Place, Record};
use inverse::{Data, NoiseModel};
use nalgebra::DMatrix;

/// A line through noise-free points, with a constant: parameters that know each other. The constant may have a bound.
fn line(constant: Belief, misfit: impl Fn(f64) -> f64) -> (Record, Linear) {
    let n = 40;
    let s: Vec<f64> = (0..n).map(|i| f64::from(i) / f64::from(n - 1)).collect();
    let parts = [("pull".to_owned(), s.iter().map(|s| misfit(*s)).collect(), NoiseModel::white(0.02))];
    let data = Data::from_parts(parts).expect("data");
    let place = Place { test: "pull".into(), s: s.clone(), leg: vec![0; s.len()], peak: 1.0 };
    let record = Record::new(&data, &[place], 0.015).expect("a record");
    let parameter =
        |path: &str, belief, amplitude| Parameter { path: path.into(), at: 0.0, belief, amplitude };
    let linear = Linear {
        misfit: data.measured(),
        jacobian: DMatrix::from_fn(s.len(), 2, |i, k| if k == 0 { s[i] } else { 1.0 }),
        parameters: vec![
            parameter("slope", Belief::normal(0.0, 10.0), false),
            parameter("constant", constant, true),
        ],
        jumps: Vec::new(),
    };
    (record, linear)
}

fn slope(z: &DVector<f64>) -> (f64, DVector<f64>) {
    (z[0], DVector::from_vec(vec![1.0, 0.0]))
}

fn whole_line() -> [f64; 2] {
    [f64::NEG_INFINITY, f64::INFINITY]
}

#[test]
fn quantiles_of_a_mixture_are_where_its_mass_is() {
    let part = |weight, mean, sd| Normal { weight, mean, sd };
    let one = [part(3.0, 2.0, 0.5)];
    assert!((quantile(&one, whole_line(), 0.975) - 2.98).abs() < 1e-3);
    // A quarter of the mass lies far above: the 95 % quantile is the far part's 80 %.
    let two = [part(3.0, 0.0, 1.0), part(1.0, 100.0, 1.0)];
    assert!((quantile(&two, whole_line(), 0.95) - 100.8416).abs() < 1e-3);
    assert!((quantile(&two, whole_line(), 0.375)).abs() < 1e-6);
    // Half a normal distribution, and one that lies beyond its bound.
    assert!((quantile(&[part(1.0, 0.0, 1.0)], [0.0, f64::INFINITY], 0.5) - 0.6745).abs() < 1e-3);
    assert_eq!(quantile(&[part(1.0, -50.0, 1.0)], [0.0, 5.0], 0.5), 0.0);
    assert!(quantile(&[], whole_line(), 0.5).is_nan());
}

/// A parameter's own mixture has the quantiles of its interval, and a sum's those of a sum.
#[test]
fn a_quantity_of_one_parameter_is_that_parameter() {
    let (record, linear) = line(Belief::normal(0.0, 10.0), |s| 0.3 * s + 0.1);
    let rest = RestPrior::default();
    let evidence = Evidence::of(&record, &linear, &rest, Kernel::Plain).expect("an evidence");
    let sum = |z: &DVector<f64>| (z[0] + z[1], DVector::from_vec(vec![1.0, 1.0]));
    let said = evidence.says(&rest, 0.1, &[&slope, &sum]);
    let interval = evidence.intervals(&rest, 0.1)[0];
    for (p, of_interval) in
        [(0.025, interval.with_rest[0]), (0.5, interval.median), (0.975, interval.with_rest[1])]
    {
        let own = quantile(&said[0], whole_line(), p);
        assert!((own - of_interval).abs() < 1e-4, "{p}: {own} {of_interval}");
    }
    assert!((quantile(&said[1], whole_line(), 0.5) - 0.4).abs() < 1e-3);
    // The end of a line is known better than its slope.
    let width =
        |parts: &[Normal]| quantile(parts, whole_line(), 0.975) - quantile(parts, whole_line(), 0.025);
    assert!(width(&said[1]) < width(&said[0]));
    for parts in &said {
        assert!((parts.iter().map(|n| n.weight).sum::<f64>() - 1.0).abs() < 1e-12);
    }
}

/// Where an amplitude stands at its bound, what it has to do with a quantity is on one side: mean and spread of the slope are those
/// of the normal distribution of both, cut off there, by integration.
#[test]
fn an_amplitude_at_its_bound_moves_a_quantity_to_one_side() {
    let (record, linear) = line(Belief::above(0.0, 10.0), |s| 0.3 * s - 0.001);
    // Noise alone: one normal distribution.
    let rest = RestPrior { smooth: 1e-9, jerk: 1e-9, ..RestPrior::default() };
    let evidence = Evidence::of(&record, &linear, &rest, Kernel::Plain).expect("an evidence");
    let parts = evidence.says(&rest, 0.0, &[&slope]).remove(0);
    let (mean, sd) = moments(&parts);
    let x = linear.jacobian.clone();
    let covariance = (x.transpose() * &x / (0.02 * 0.02)).try_inverse().expect("regular");
    let free = &covariance * x.transpose() * linear.misfit / (0.02 * 0.02);
    let (mut mass, mut first, mut second) = (0.0, 0.0, 0.0);
    let given = covariance[(0, 1)] / covariance[(1, 1)];
    let left = covariance[(0, 0)] - given * covariance[(0, 1)];
    for k in 0..40_000 {
        let a = f64::from(k) * 1e-6;
        let w = (-0.5 * (a - free[1]).powi(2) / covariance[(1, 1)]).exp();
        let m = free[0] + given * (a - free[1]);
        mass += w;
        first += w * m;
        second += w * (m * m + left);
    }
    let right = first / mass;
    let spread = (second / mass - right * right).sqrt();
    // Within what eight slices and two digits of the noise are worth.
    assert!(
        (mean - right).abs() < 0.05 * spread && (sd / spread - 1.0).abs() < 0.05,
        "{mean} {right} {sd} {spread}"
    );
    assert!(mean < free[0] - 0.3 * spread, "a constant that is positive takes from the slope");
}

fn moments(parts: &[Normal]) -> (f64, f64) {
    let mean: f64 = parts.iter().map(|n| n.weight * n.mean).sum();
    let square: f64 = parts.iter().map(|n| n.weight * (n.sd * n.sd + n.mean * n.mean)).sum();
    (mean, (square - mean * mean).sqrt())
}

/// Two parameters whose sum, each in its logarithm, is all that a record knows: the mean of both is known however far either of them
/// is believed to go.
#[test]
fn what_a_record_fixes_together_is_known_together() {
    let (record, mut linear) = line(Belief::normal(0.0, 10.0), |_| 0.0);
    // ∂(e^a + e^b) at a = ln 1, b = ln 3.
    for (k, value) in [1.0f64, 3.0].into_iter().enumerate() {
        linear.parameters[k].at = value.ln();
        // They are believed elsewhere, so that the mode is far along what the record leaves open.
        linear.parameters[k].belief = Belief::normal(if k == 0 { 2.0 } else { 0.0 }, 1.0);
        linear.jacobian.column_mut(k).fill(value);
    }
    let rest = RestPrior { smooth: 1e-9, jerk: 1e-9, ..RestPrior::default() };
    let evidence = Evidence::of(&record, &linear, &rest, Kernel::Plain).expect("an evidence");
    let mean = |z: &DVector<f64>| {
        let [a, b] = [z[0].exp(), z[1].exp()];
        ((0.5 * (a + b)).ln(), DVector::from_vec(vec![a / (a + b), b / (a + b)]))
    };
    let parts = evidence.says(&rest, 0.0, &[&mean, &slope]);
    let (at, sd) = moments(&parts[0]);
    assert!((at - 2f64.ln()).abs() < 0.01 && sd < 0.01, "{at} {sd}");
    assert!(moments(&parts[1]).0 > 0.5, "the first is not where it was linearised");
}

#[test]
fn of_two_amplitudes_the_one_nearer_to_its_bound_is_asked() {
    let (record, mut linear) = line(Belief::above(0.0, 10.0), |s| 0.3 * s - 0.001);
    // Two standard deviations above its bound.
    let rest = RestPrior { smooth: 1e-9, jerk: 1e-9, ..RestPrior::default() };
    let nearest = |linear: &Linear| {
        let evidence = Evidence::of(&record, linear, &rest, Kernel::Plain).expect("an evidence");
        let solved = evidence.solved(0);
        let covariance = solved.covariance().view((0, 0), (2, 2)).into_owned();
        (evidence.near_its_bound(&solved, &covariance).map(|(a, _)| a), 0.3 - 2.0 * covariance[(0, 0)].sqrt())
    };
    let (own, bound) = nearest(&linear);
    assert_eq!(own, Some(1));
    linear.parameters[0].amplitude = true;
    linear.parameters[0].belief.lower = bound;
    assert_eq!(nearest(&linear).0, Some(1));
    linear.parameters[1].belief = Belief::normal(0.0, 10.0);
    assert_eq!(nearest(&linear).0, Some(0));
    linear.parameters[0].amplitude = false;
    assert_eq!(nearest(&linear).0, None);
}
