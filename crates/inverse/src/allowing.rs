//! Intervals that allow for more than noise.

use crate::{Estimate, Free, Uncertainty};
use params::Transform;

impl Uncertainty {
    /// The same with intervals and standard errors as much wider as the standard deviations of `wider` are: the uncertainty of the
    /// same fit with a further covariance in its data, that of what no model describes. Arms keep their shape;
    /// `interval_95_if_right` stays, and so does what counts as identifiable.
    pub fn allowing_for(mut self, wider: &Self) -> Self {
        for ((e, w), free) in self.estimates.iter_mut().zip(&wider.estimates).zip(&self.free) {
            let ratio = w.scaled_sd / e.scaled_sd;
            if ratio.is_finite() && ratio > 1.0 {
                e.interval_95 = stretched(e, free, ratio);
                e.std_error = e.std_error.map(|s| ratio * s).filter(|s| s.is_finite());
            }
        }
        self
    }
}

/// The interval with both sides `ratio` times as long, in the coordinate that it was made in, within the bounds.
fn stretched(e: &Estimate, free: &Free, ratio: f64) -> [f64; 2] {
    // At a bound intervals are made in physical units.
    let plain = e.at_bound || free.transform == Transform::Identity;
    let forward = |x: f64| if plain { x } else { free.forward(x) };
    let backward = |z: f64| if plain { z.clamp(free.lower, free.upper) } else { free.backward(z) };
    let at = forward(e.value);
    e.interval_95.map(|end| {
        let z = at + ratio * (forward(end) - at);
        // Beyond what a double holds there is only the bound.
        if z.is_finite() { backward(z) } else { end }
    })
}

#[cfg(test)]
mod tests {
    use crate::{
        Data, Fit, Free, Identifiability, NoiseModel, Objective, Prediction, StopReason, uncertainty,
    };
    use nalgebra::{DMatrix, DVector};
    use params::Transform;

    #[test]
    fn a_rest_as_large_as_the_noise_widens_by_root_two() {
        let n = 50;
        let noise = NoiseModel::white(0.1);
        // A rest without memory is noise once more.
        let rest = (0..n).map(|i| DVector::from_fn(n, |j, _| if i == j { 0.1 } else { 0.0 })).collect();
        let data =
            |noise: NoiseModel| Data::from_parts([("pull".to_owned(), vec![1.0; n], noise)]).expect("data");
        let (plain, with) = (data(noise.clone()), data(NoiseModel { nuisance: rest, ..noise }));
        let free = [Free::new("a".to_owned(), (0.1, 10.0), Transform::Log, 1.0)];
        let fit = Fit {
            theta: vec![1.0],
            f: 0.0,
            prediction: Prediction::new(
                DVector::from_element(n, 1.0),
                Some(DMatrix::from_element(n, 1, 1.0)),
            ),
            at_bound: vec![false],
            objective: Objective::Record,
            iterations: 0,
            forward_runs: 0,
            stop: StopReason::Converged,
            history: Vec::new(),
        };
        let rule = Identifiability::default();
        let of = |data: &Data| uncertainty(data, &free, &fit, &rule).expect("an uncertainty");
        let (straight, wider) = (of(&plain), of(&with));
        let both = straight.clone().allowing_for(&wider);
        let (before, after) = (&straight.estimates[0], &both.estimates[0]);
        assert_eq!(after.interval_95_if_right, before.interval_95);
        for k in 0..2 {
            let ratio = after.interval_95[k].ln() / before.interval_95[k].ln();
            assert!((ratio - 2f64.sqrt()).abs() < 1e-9, "{ratio}");
        }
        // What says less takes nothing away.
        let same = straight.clone().allowing_for(&straight);
        assert_eq!(same.estimates, straight.estimates);
    }
}
