//! What is believed of the rest: the part of a record that no model of the catalogue describes.

use serde::Serialize;
use std::f64::consts::TAU;

/// What the rest does along a record.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum RestForm {
    /// It is as large everywhere, and goes on from one leg of the protocol to the next.
    #[default]
    Even,
    /// It goes with the model's own prediction, as where a gain wanders: it is multiplied at each point by the prediction over its root
    /// mean square, so that it is as large over a record as it would be otherwise.
    Proportional,
    /// It begins anew with every leg of the protocol, as where something rubs or comes late: what is wrong on the way out says nothing
    /// of the way back.
    PerLeg,
}

/// Correlation length, size and form of the two parts of the rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RestSize {
    /// Standard deviation of the smooth part, share of the peak.
    pub tau: f64,
    /// Standard deviation of the jerks, share of the peak.
    pub upsilon: f64,
    /// Length ℓ of the smooth part, share of the record; Matérn (1 + √3 d/ℓ) e^{−√3 d/ℓ}.
    pub smooth_length: f64,
    /// Length of the jerks, share of the record; e^{−d/ℓ}.
    pub jerk_length: f64,
    /// What both do along the record.
    pub form: RestForm,
}

impl RestSize {
    /// No rest: noise alone.
    pub const NONE: Self =
        Self { tau: 0.0, upsilon: 0.0, smooth_length: 0.2, jerk_length: 0.014, form: RestForm::Even };

    /// The rest in one test, where it is in `only` that or in all.
    pub(crate) fn in_test(self, test: usize, only: Option<usize>) -> Self {
        if only.is_none_or(|t| t == test) { self } else { Self { tau: 0.0, upsilon: 0.0, ..self } }
    }

    /// Covariance of the rest at path distance `d ≥ 0`; of a proportional one, to be multiplied by the profile at both points; of one
    /// that begins anew, within one leg.
    pub fn covariance(&self, d: f64) -> f64 {
        let a = 3f64.sqrt() * d / self.smooth_length;
        self.tau.powi(2) * (1.0 + a) * (-a).exp() + self.upsilon.powi(2) * (-d / self.jerk_length).exp()
    }
}

/// Prior of the size of the rest. `Default` is the method's sentence: a complete model of such a test is off by a percent or two.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RestPrior {
    /// Scale of the half-normal prior of the smooth part's size τ, share of the peak (`[diagnose] rest`).
    pub smooth: f64,
    /// The same of the jerks' size υ.
    pub jerk: f64,
    /// Prior mass at zero, of each.
    pub zero: f64,
    /// Prior mass of one test alone, all of them alike, where one part is there without the other.
    pub alone: f64,
    /// Prior mass of a rest that goes with the model's own prediction ([`RestForm::Proportional`]).
    pub proportional: f64,
    /// Prior mass of a rest that begins anew with every leg ([`RestForm::PerLeg`]).
    pub per_leg: f64,
    /// Lengths ℓ₁ of the smooth part, share of the record, with their prior masses.
    pub smooth_lengths: Vec<(f64, f64)>,
    /// Lengths ℓ₂ of the jerks.
    pub jerk_lengths: Vec<(f64, f64)>,
    /// Median of the size that a cause outside the catalogue has, in scales of `smooth` or `jerk`.
    pub else_median: f64,
    /// Standard deviation of the logarithm of that size.
    pub else_spread: f64,
}

impl Default for RestPrior {
    /// Lengths: three-point Gauss–Legendre rule in ln ℓ₁ over 0.025 to 0.4; ℓ₂ the geometric middle of 0.01 and 0.02.
    fn default() -> Self {
        Self {
            smooth: 0.015,
            jerk: 0.010,
            zero: 0.5,
            alone: 0.5,
            proportional: 1.0 / 3.0,
            per_leg: 1.0 / 3.0,
            smooth_lengths: vec![(0.0342, 5.0 / 18.0), (0.1, 8.0 / 18.0), (0.293, 5.0 / 18.0)],
            jerk_lengths: vec![(0.0141, 1.0)],
            else_median: 4.0,
            else_spread: 0.8,
        }
    }
}

/// Which parts of the rest are there.
pub(crate) const SUPPORTS: [[bool; 2]; 4] = [[false, false], [true, false], [false, true], [true, true]];

impl RestPrior {
    /// The same with the sizes of a complete model's rest scaled: the sensitivity that is part of every answer. What a cause outside the
    /// catalogue does is another statement, and stays.
    pub fn scaled(&self, factor: f64) -> Self {
        Self {
            smooth: factor * self.smooth,
            jerk: factor * self.jerk,
            else_median: self.else_median / factor,
            ..self.clone()
        }
    }

    /// Mean square of the rest that a complete model is believed to leave, both parts there.
    pub(crate) fn mean_square(&self) -> f64 {
        self.smooth.powi(2) + self.jerk.powi(2)
    }

    /// Where the rest of a support may be, with prior masses: in all of so many tests (`None`) or in one alone.
    pub(crate) fn places(&self, support: [bool; 2], tests: usize) -> Vec<(Option<usize>, f64)> {
        if tests < 2 || support[0] == support[1] {
            return vec![(None, 1.0)];
        }
        let one = (0..tests).map(|t| (Some(t), self.alone / tests as f64));
        std::iter::once((None, 1.0 - self.alone)).chain(one).collect()
    }

    /// What the rest of a support may do along the record, with prior masses.
    pub(crate) fn forms(&self, support: [bool; 2]) -> Vec<(RestForm, f64)> {
        if support == [false; 2] {
            return vec![(RestForm::Even, 1.0)];
        }
        let all = [
            (RestForm::Even, 1.0 - self.proportional - self.per_leg),
            (RestForm::Proportional, self.proportional),
            (RestForm::PerLeg, self.per_leg),
        ];
        all.into_iter().filter(|f| f.1 > 1e-12).collect()
    }

    /// Lengths and forms that the rest of a support may have, of no size, with prior masses.
    pub(crate) fn shapes(&self, support: [bool; 2]) -> Vec<(RestSize, f64)> {
        let one = [(RestSize::NONE.smooth_length, 1.0)];
        let lengths = |there: bool, own: &'_ [(f64, f64)]| if there { own.to_vec() } else { one.to_vec() };
        let mut out = Vec::new();
        for (smooth_length, m1) in lengths(support[0], &self.smooth_lengths) {
            for (jerk_length, m2) in lengths(support[1], &self.jerk_lengths) {
                for (form, m3) in self.forms(support) {
                    let shape = RestSize { smooth_length, jerk_length, form, ..RestSize::NONE };
                    out.push((shape, m1 * m2 * m3));
                }
            }
        }
        out
    }

    fn half_normal(x: f64, scale: f64) -> f64 {
        2.0 / (scale * TAU.sqrt()) * (-0.5 * (x / scale).powi(2)).exp()
    }

    fn outside(&self, x: f64, scale: f64) -> f64 {
        let z = (x / (scale * self.else_median)).ln() / self.else_spread;
        (-0.5 * z * z).exp() / (x * self.else_spread * TAU.sqrt())
    }

    /// Prior density of sizes (τ, υ) on one support, by ln τ and ln υ where they are not zero: of a complete model's rest, and of a
    /// rest that holds a cause outside the catalogue (smooth or jerky with probability ½ each, the other part as
    /// ever). Over all supports each of the two sums to 1.
    pub(crate) fn density(&self, support: [bool; 2], [tau, upsilon]: [f64; 2]) -> [f64; 2] {
        let here = |there: bool, x: f64, scale: f64| {
            if there { (1.0 - self.zero) * x * Self::half_normal(x, scale) } else { self.zero }
        };
        let beyond = |there: bool, x: f64, scale: f64| if there { x * self.outside(x, scale) } else { 0.0 };
        let (t, u) = (here(support[0], tau, self.smooth), here(support[1], upsilon, self.jerk));
        let (far_t, far_u) = (beyond(support[0], tau, self.smooth), beyond(support[1], upsilon, self.jerk));
        [t * u, 0.5 * (far_t * u + t * far_u)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_densities_hold_all_their_mass() {
        let prior = RestPrior::default();
        let line: Vec<f64> = (0..400).map(|i| -14.0 + 0.05 * f64::from(i)).collect();
        let mut sum = prior.density([false; 2], [0.0; 2]);
        for &y in &line {
            for (support, x) in [([true, false], [y.exp(), 0.0]), ([false, true], [0.0, y.exp()])] {
                let d = prior.density(support, x);
                sum = [sum[0] + 0.05 * d[0], sum[1] + 0.05 * d[1]];
            }
            for &v in &line {
                let d = prior.density([true, true], [y.exp(), v.exp()]);
                sum = [sum[0] + 0.0025 * d[0], sum[1] + 0.0025 * d[1]];
            }
        }
        assert!((sum[0] - 1.0).abs() < 1e-4 && (sum[1] - 1.0).abs() < 1e-4, "{sum:?}");
    }

    #[test]
    fn places_hold_all_their_mass() {
        let prior = RestPrior::default();
        for (tests, one, both) in [(1, 1, 1), (2, 3, 1), (5, 6, 1)] {
            for support in SUPPORTS {
                let places = prior.places(support, tests);
                let sum: f64 = places.iter().map(|p| p.1).sum();
                let want = if support[0] == support[1] { both } else { one };
                assert!((sum - 1.0).abs() < 1e-12 && places.len() == want, "{tests} {support:?}: {places:?}");
            }
        }
    }

    /// The odds that the README states, at the prior of a cause that leaves a rest.
    #[test]
    fn a_cause_outside_leads_from_between_four_and_five_percent_on() {
        let (rest, sets) = (RestPrior::default(), crate::SetPrior::of_catalogue(20));
        let odds = |tau: f64| {
            let d = rest.density([true, false], [tau, 0.0]);
            d[1] / d[0] * sets.unlike() / (1.0 - sets.beyond)
        };
        for (tau, stated) in [(0.02, 0.025), (0.04, 0.40), (0.05, 2.6)] {
            assert!((odds(tau) / stated - 1.0).abs() < 0.02, "{tau}: {}", odds(tau));
        }
    }
}
