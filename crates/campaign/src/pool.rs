//! A random-effects model over specimens: between-specimen scatter apart from each one's own uncertainty.
//!
//! y_i = μ + b_i + e_i, with b_i of variance τ² (specimens differ) and e_i of the known variance v_i (a specimen's own
//! interval). τ² by restricted maximum likelihood; the interval of μ after Hartung, Knapp, Sidik and Jonkman
//! (IntHout et al. 2014, 10.1186/1471-2288-14-25), never narrower than the plain one; the prediction interval after
//! Higgins et al. (10.1111/j.1467-985X.2008.00552.x).

use serde::Serialize;
use statrs::distribution::{ChiSquared, ContinuousCDF, StudentsT};

/// One specimen's value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Observation {
    /// The value.
    pub value: f64,
    /// Its standard error, > 0, same unit.
    pub std_error: f64,
}

/// What the specimens say together.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Pooled {
    /// Specimens.
    pub specimens: usize,
    /// μ, the mean over specimens as a population.
    pub mean: f64,
    /// Its standard error.
    pub std_error: f64,
    /// Its 95 % interval (t with one degree of freedom less than specimens); null of one specimen.
    pub interval_95: Option<[f64; 2]>,
    /// τ, standard deviation between specimens, their own uncertainty taken out.
    pub between_sd: f64,
    /// Standard deviation of a typical specimen's own uncertainty.
    pub within_sd: f64,
    /// Share of the scatter that is between specimens, τ²/(τ² + within²).
    pub i2: f64,
    /// Cochran's Q: scatter in units of the specimens' own variances.
    pub q: f64,
    /// Probability of a larger Q if specimens did not differ; null of one specimen.
    pub p_q: Option<f64>,
    /// Where 95 % of further specimens would lie; null below three specimens.
    pub prediction_95: Option<[f64; 2]>,
    /// τ² after DerSimonian and Laird, for comparison.
    pub tau2_dersimonian_laird: f64,
    /// Weight of each specimen in μ, in their order; they sum to 1.
    pub weights: Vec<f64>,
}

impl Pooled {
    /// τ and I²; of one specimen there is none.
    pub fn between(&self) -> Option<(f64, f64)> {
        (self.specimens > 1).then_some((self.between_sd, self.i2))
    }
}

/// Two groups.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Difference {
    /// Mean of the second minus that of the first.
    pub difference: f64,
    /// 95 % interval (Welch's degrees of freedom).
    pub interval_95: [f64; 2],
    /// Two-sided p-value.
    pub p_value: f64,
}

/// Pools specimens; `None` of none. Values that are not finite, or have no standard error above 0, are not for this.
pub fn pooled(all: &[Observation]) -> Option<Pooled> {
    let usable = |o: &Observation| o.value.is_finite() && o.std_error.is_finite() && o.std_error > 0.0;
    if all.is_empty() || !all.iter().all(usable) {
        return None;
    }
    let k = all.len() as f64;
    let fixed = Weights::at(all, 0.0);
    let (q, c) = (fixed.q(all), fixed.sum - fixed.squares / fixed.sum);
    let laird = if all.len() > 1 { ((q - (k - 1.0)) / c).max(0.0) } else { 0.0 };
    let tau2 = restricted(all, laird);
    let w = Weights::at(all, tau2);
    // Hartung & Knapp: the scatter that is seen, where it is more than what is expected.
    let seen = if all.len() > 1 { w.q(all) / (k - 1.0) } else { 1.0 };
    let std_error = (seen.max(1.0) / w.sum).sqrt();
    let t = |freedom: f64| quantile(freedom);
    let around = |half: f64| [w.mean - half, w.mean + half];
    let within2 = if all.len() > 1 { (k - 1.0) / c } else { all[0].std_error.powi(2) };
    Some(Pooled {
        specimens: all.len(),
        mean: w.mean,
        std_error,
        interval_95: (all.len() > 1).then(|| around(t(k - 1.0) * std_error)),
        between_sd: tau2.sqrt(),
        within_sd: within2.sqrt(),
        i2: tau2 / (tau2 + within2),
        q,
        p_q: (all.len() > 1).then(|| ChiSquared::new(k - 1.0).map_or(f64::NAN, |d| d.sf(q))),
        prediction_95: (all.len() > 2).then(|| around(t(k - 2.0) * (tau2 + std_error.powi(2)).sqrt())),
        tau2_dersimonian_laird: laird,
        weights: w.each.iter().map(|x| x / w.sum).collect(),
    })
}

/// The second mean minus the first.
pub fn difference(first: &Pooled, second: &Pooled) -> Option<Difference> {
    let (a, b) = (first.std_error.powi(2), second.std_error.powi(2));
    let of = |v: f64, n: usize| v * v / (n as f64 - 1.0);
    if first.specimens < 2 || second.specimens < 2 {
        return None;
    }
    let freedom = (a + b).powi(2) / (of(a, first.specimens) + of(b, second.specimens));
    let (d, sd) = (second.mean - first.mean, (a + b).sqrt());
    let half = quantile(freedom) * sd;
    let p = StudentsT::new(0.0, 1.0, freedom).map_or(f64::NAN, |t| 2.0 * t.sf((d / sd).abs()));
    Some(Difference { difference: d, interval_95: [d - half, d + half], p_value: p })
}

/// 97.5 % point of Student's t.
fn quantile(freedom: f64) -> f64 {
    StudentsT::new(0.0, 1.0, freedom).map_or(f64::NAN, |t| t.inverse_cdf(0.975))
}

struct Weights {
    each: Vec<f64>,
    sum: f64,
    squares: f64,
    mean: f64,
}

impl Weights {
    fn at(all: &[Observation], tau2: f64) -> Self {
        let each: Vec<f64> = all.iter().map(|o| 1.0 / (o.std_error.powi(2) + tau2)).collect();
        let sum: f64 = each.iter().sum();
        let mean = each.iter().zip(all).map(|(w, o)| w * o.value).sum::<f64>() / sum;
        Self { squares: each.iter().map(|w| w * w).sum(), sum, mean, each }
    }

    fn q(&self, all: &[Observation]) -> f64 {
        self.each.iter().zip(all).map(|(w, o)| w * (o.value - self.mean).powi(2)).sum()
    }

    /// Derivative of the restricted log-likelihood by τ², times 2.
    fn slope(&self, all: &[Observation]) -> f64 {
        let squares = self.each.iter().zip(all).map(|(w, o)| (w * (o.value - self.mean)).powi(2));
        squares.sum::<f64>() - self.sum + self.squares / self.sum
    }
}

/// τ² of the largest restricted likelihood, ≥ 0: where its slope, which falls from where it is positive, meets 0.
fn restricted(all: &[Observation], start: f64) -> f64 {
    let slope = |tau2: f64| Weights::at(all, tau2).slope(all);
    if all.len() < 2 || slope(0.0) <= 0.0 {
        return 0.0;
    }
    let typical = all.iter().map(|o| o.std_error.powi(2)).sum::<f64>() / all.len() as f64;
    let mut high = start.max(typical);
    while slope(high) > 0.0 && high < 1e300 {
        high *= 4.0;
    }
    let mut low = 0.0;
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if slope(middle) > 0.0 { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}
