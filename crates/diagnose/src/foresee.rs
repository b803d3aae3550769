//! What a screen would see, before there is a misfit: the power of its test against each effect at a plausible size.
//!
//! The columns are those of the screen, and so is the threshold: an effect is seen when its fall of χ² reaches the
//! policy's least fall, and the p-value the false-discovery rate allows the first of the catalogue.

use crate::score::{ScreenError, projected};
use crate::statistic::statistic;
use crate::sup::Family;
use crate::tails::normal_sf;
use crate::{Candidate, Policy, Side};
use inverse::Whitened;
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;
use serde::Serialize;

/// What records of some kind would say of an effect.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Foreseen {
    /// Name in the catalogue.
    pub effect: String,
    /// Name of its amplitude.
    pub amplitude: String,
    /// A plausible size of it, as a deviation from neutral.
    pub plausible: f64,
    /// Shape parameters of the shape that shows best.
    pub shape: Vec<(String, f64)>,
    /// Standard deviations beyond what base parameters can imitate, at the plausible size.
    pub snr: f64,
    /// Chance that the screen calls it significant at the plausible size.
    pub power: f64,
    /// Size that is seen with 90 % power; `None` where none is.
    pub least: Option<f64>,
    /// Whether records show it at its plausible size.
    pub shown: Shown,
}

impl Foreseen {
    /// Whether records show it where it is of this many standard deviations: at another size than the plausible one.
    pub fn at(&self, snr: f64, policy: &Policy) -> Shown {
        Shown::of(snr, normal_sf(self.critical() - snr), policy)
    }

    /// Standard deviations from which on the screen calls it, one time in two.
    fn critical(&self) -> f64 {
        self.least.map_or(f64::INFINITY, |l| self.snr * l / self.plausible - NINETY)
    }

    /// How many times its plausible size it must have to be found one time in two; infinite where no size is.
    pub fn found_from(&self) -> f64 {
        self.critical() / self.snr
    }

    /// How many times its plausible size it must have to be [`Shown::Shown`]; infinite where no size is.
    pub fn shown_from(&self, policy: &Policy) -> f64 {
        (self.critical() + NINETY).max(policy.visible_snr) / self.snr
    }
}

/// Whether records show an effect.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Shown {
    /// It is called with 90 % power, and is visible ([`Policy::visible_snr`]): told from its rivals, too.
    Shown,
    /// It is called with 50 % power.
    Faint,
    /// No.
    Hidden,
}

impl Shown {
    /// Of an effect of this many standard deviations beyond what base parameters imitate, called with this power.
    pub fn of(snr: f64, power: f64, policy: &Policy) -> Self {
        match power {
            0.9.. if snr >= policy.visible_snr => Self::Shown,
            0.5.. => Self::Faint,
            _ => Self::Hidden,
        }
    }

    /// `shown`, `faint`, `hidden`.
    pub fn word(self) -> &'static str {
        match self {
            Self::Shown => "shown",
            Self::Faint => "faint",
            Self::Hidden => "hidden",
        }
    }
}

/// z of 90 % power.
const NINETY: f64 = 1.281_551_565_5;

/// Every candidate (raw columns of full length n) against the jacobian of a linearised problem, most visible first.
/// Effects that only a refit tells are judged by their secant.
///
/// # Errors
/// [`ScreenError`] when lengths disagree or a column holds a number that is not finite.
pub fn foresee(
    white: &Whitened,
    at_bound: &[bool],
    candidates: &[Candidate],
    points: usize,
    policy: &Policy,
) -> Result<Vec<Foreseen>, ScreenError> {
    let shaped = candidates.iter().filter(|c| !c.shapes.is_empty()).count().max(1);
    let all = projected(white, at_bound, candidates, points, policy)?;
    let seen: Vec<Seen> = all.into_iter().map(|(candidate, shapes)| Seen::new(candidate, shapes)).collect();
    let level = policy.fdr / shaped as f64;
    let mut out: Vec<Foreseen> =
        (0..seen.len()).into_par_iter().map(|i| one(&seen, i, level, policy)).collect();
    out.sort_by(|a, b| b.snr.total_cmp(&a.snr).then(a.effect.cmp(&b.effect)));
    Ok(out)
}

/// A candidate with what of its shapes no base parameter imitates.
struct Seen<'a> {
    candidate: &'a Candidate,
    sides: Vec<Side>,
    live: Vec<DMatrix<f64>>,
    /// Index of the shape that shows best, and what it does at the plausible size.
    best: Option<(usize, DVector<f64>)>,
}

impl<'a> Seen<'a> {
    fn new(candidate: &'a Candidate, shapes: Vec<DMatrix<f64>>) -> Self {
        let sized = |s: &DMatrix<f64>| {
            let plausible = candidate.amplitudes.iter().zip(s.column_iter());
            plausible.fold(DVector::zeros(s.nrows()), |sum, (a, c)| sum + c * a.plausible)
        };
        let all = shapes.iter().map(sized).enumerate();
        let best = all.max_by(|a, b| a.1.norm().total_cmp(&b.1.norm()).then(b.0.cmp(&a.0)));
        let sides = candidate.amplitudes.iter().map(|a| a.side).collect();
        Self { candidate, sides, live: shapes.into_iter().filter(|s| s.norm() > 0.0).collect(), best }
    }

    /// Standard deviations at which the screen calls it at a p-value.
    fn critical(&self, level: f64, policy: &Policy) -> f64 {
        if self.live.is_empty() {
            return f64::INFINITY;
        }
        let family = Family { shapes: &self.live, sides: &self.sides };
        critical_fall(&family, level).max(policy.min_fall).sqrt()
    }

    /// Standard deviations that a truth looks like through this effect.
    fn looks(&self, truth: &DVector<f64>) -> f64 {
        let through = |s: &DMatrix<f64>| -> f64 {
            let b = s.tr_mul(truth);
            statistic(&s.tr_mul(s), &b, &self.sides).fall.max(0.0).sqrt()
        };
        self.live.iter().map(through).fold(0.0, f64::max)
    }
}

/// The false-discovery rate is shared by all that a truth looks like: the more effects are called with this one, the larger a
/// p-value does.
fn one(all: &[Seen], i: usize, level: f64, policy: &Policy) -> Foreseen {
    let this = &all[i];
    let amplitude = &this.candidate.amplitudes[0];
    let snr = this.best.as_ref().map_or(0.0, |b| b.1.norm());
    let mut critical = this.critical(level, policy);
    if let Some((_, at)) = this.best.as_ref().filter(|_| snr > 0.0) {
        for _ in 0..3 {
            // What else would be called where this one just is.
            let truth = at * (critical / snr);
            let with = |o: &(usize, &Seen)| o.0 != i && o.1.looks(&truth) >= 0.9 * critical;
            let called = 1 + all.iter().enumerate().filter(with).count();
            critical = this.critical(level * called as f64, policy);
        }
    }
    let power = if critical.is_finite() { normal_sf(critical - snr) } else { 0.0 };
    Foreseen {
        effect: this.candidate.effect.clone(),
        amplitude: amplitude.name.clone(),
        plausible: amplitude.plausible,
        shape: this.best.as_ref().map_or_else(Vec::new, |b| this.candidate.shapes[b.0].parameters.clone()),
        snr,
        power,
        shown: Shown::of(snr, power, policy),
        least: (snr > 0.0).then(|| amplitude.plausible * (critical + NINETY) / snr),
    }
}

/// The fall of χ² whose p-value is `level`.
fn critical_fall(family: &Family, level: f64) -> f64 {
    let (mut low, mut high) = (0.0, 200.0);
    for _ in 0..40 {
        let middle = 0.5 * (low + high);
        if family.bound(middle) > level { low = middle } else { high = middle }
    }
    high
}

#[cfg(test)]
mod tests {
    use super::*;
    use inverse::{Data, Free, Noise, NoiseModel, Prediction, Random};
    use nalgebra::DVector;

    const N: usize = 200;

    fn column(f: impl Fn(f64) -> f64) -> DVector<f64> {
        DVector::from_fn(N, |i, _| f(i as f64 / N as f64))
    }

    /// A line as base model, two effects that curve it, noise of sd 1.
    fn setting(measured: &DVector<f64>) -> (Whitened, Vec<Candidate>) {
        let name = String::from("a");
        let data =
            Data::from_parts([(name, measured.iter().copied().collect(), NoiseModel::white(1.0))]).unwrap();
        let base = DMatrix::from_columns(&[column(|_| 1.0), column(|x| x)]);
        let free = |path: &str| Free::new(path, (-1e3, 1e3), params::Transform::Identity, 0.0);
        let prediction = Prediction::new(DVector::zeros(N), Some(base));
        let white = Whitened::new(&data, &[free("a"), free("b")], &[0.0; 2], &prediction, Noise::Record);
        let curve = Candidate::simple("curve", Side::Positive, 6.0, column(|x| x * x));
        let wave = Candidate::simple("wave", Side::Both, 0.3, column(|x| (20.0 * x).sin()));
        (white, vec![curve, wave])
    }

    #[test]
    fn the_promised_power_is_the_share_of_noisy_records_that_the_screen_calls() {
        let policy = Policy::default();
        let (white, candidates) = setting(&DVector::zeros(N));
        let foreseen = foresee(&white, &[false; 2], &candidates, N, &policy).unwrap();
        let mut random = Random::new(9);
        for f in &foreseen {
            let candidate = candidates.iter().find(|c| c.effect == f.effect).unwrap();
            // At the size of a power of one half, and at the plausible one.
            let half = f.plausible * (f.least.unwrap() / f.plausible - NINETY / f.snr);
            for (size, predicted) in [(half, 0.5), (f.least.unwrap(), 0.9)] {
                let truth = candidate.shapes[0].columns.column(0) * size;
                let runs = 400;
                let mut called = 0;
                for _ in 0..runs {
                    let record = &truth + random.normals(N);
                    let (white, candidates) = setting(&record);
                    let screen = crate::screen(&white, &[false; 2], &candidates, N, &policy).unwrap();
                    called += usize::from(screen.finding(&f.effect).is_some_and(|s| s.significant));
                }
                let share = called as f64 / f64::from(runs);
                assert!((share - predicted).abs() < 0.08, "{}: {share} for {predicted}", f.effect);
            }
        }
    }

    #[test]
    fn what_is_shown_is_called_and_visible_and_another_size_is_judged_likewise() {
        let policy = Policy::default();
        let (white, candidates) = setting(&DVector::zeros(N));
        for f in foresee(&white, &[false; 2], &candidates, N, &policy).unwrap() {
            assert_eq!(f.at(f.snr, &policy), f.shown);
            let least = f.snr * f.least.unwrap() / f.plausible;
            assert_eq!(f.at(0.99 * least, &policy), Shown::Faint, "{}: called with less than 90 %", f.effect);
            assert!(least < policy.visible_snr, "{least}");
            // Multiples of the plausible size.
            let times = |multiple: f64| f.at(multiple * f.snr, &policy);
            let (found, shown) = (f.found_from(), f.shown_from(&policy));
            assert_eq!((times(0.999 * found), times(1.001 * found)), (Shown::Hidden, Shown::Faint));
            assert_eq!((times(0.999 * shown), times(1.001 * shown)), (Shown::Faint, Shown::Shown));
            assert_eq!(f.at(1.01 * least, &policy), Shown::Faint, "called, not yet visible");
            assert_eq!(f.at(1.01 * policy.visible_snr, &policy), Shown::Shown);
            assert_eq!(f.at(least - 2.0 * NINETY, &policy), Shown::Hidden);
        }
    }

    #[test]
    fn what_the_base_imitates_is_not_seen() {
        let (white, _) = setting(&DVector::zeros(N));
        let shift = Candidate::simple("shift", Side::Both, 5.0, column(|x| 1.0 - 2.0 * x));
        let foreseen = foresee(&white, &[false; 2], &[shift], N, &Policy::default()).unwrap();
        assert!(foreseen[0].power < 1e-9 && foreseen[0].least.is_none());
    }
}
