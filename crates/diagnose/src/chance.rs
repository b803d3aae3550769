//! The chance that the screen calls an effect, at a misfit and columns that are given: its own rules on many draws of the
//! noise.
//!
//! Where a truth is known but for the noise, the misfit that the base leaves of it is the mean of the screen's misfit.
//! Every statistic of the catalogue is drawn together, so that what a normal law of one statistic leaves out is in: the
//! largest of several shapes is more than that of the right one, and the false-discovery rate is shared by all that
//! are called.

use crate::score::{ScreenError, projected};
use crate::statistic::statistic;
use crate::sup::Family;
use crate::{Amplitude, Candidate, Policy, Side};
use inverse::{Random, Whitened};
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

/// Draws that are computed at once.
const BATCH: usize = 200;

/// What the screen would say of records whose misfit, the base refitted, is that of `white` and noise.
#[derive(Clone, Debug, PartialEq)]
pub struct Chance {
    /// Name in the catalogue.
    pub effect: String,
    /// Share of the draws in which the screen calls it significant.
    pub called: f64,
    /// Fall of χ² without noise.
    pub fall: f64,
}

/// The chance of each candidate (raw columns of full length n) on `draws` records.
///
/// # Errors
/// [`ScreenError`] when lengths disagree or a column holds a number that is not finite.
pub fn chances(
    white: &Whitened,
    at_bound: &[bool],
    candidates: &[Candidate],
    draws: usize,
    policy: &Policy,
) -> Result<Vec<Chance>, ScreenError> {
    let points = candidates.iter().flat_map(|c| &c.shapes).map(|s| s.columns.nrows()).next().unwrap_or(0);
    let shapes = projected(white, at_bound, candidates, points, policy)?;
    let tested: Vec<_> = shapes.into_iter().filter(|(c, _)| !c.shapes.is_empty()).collect();
    let levels: Vec<f64> = (1..=tested.len()).map(|k| policy.fdr * k as f64 / tested.len() as f64).collect();
    let all: Vec<Tested> =
        tested.into_par_iter().map(|(c, shapes)| Tested::new(c, shapes, &levels, policy)).collect();
    let falls: Vec<f64> = all.iter().map(|t| t.statistic(&white.r).0).collect();
    let rows = white.r.len() - white.prior_rows;
    let mut random = Random::new(policy.seed);
    let mut called = vec![0usize; all.len()];
    let mut left = draws;
    while left > 0 {
        let batch: Vec<DVector<f64>> =
            (0..left.min(BATCH)).map(|_| noisy(&white.r, rows, &mut random)).collect();
        left -= batch.len();
        let each: Vec<Vec<bool>> = batch.par_iter().map(|r| screened(&all, r, policy)).collect();
        for calls in each {
            called.iter_mut().zip(calls).for_each(|(n, c)| *n += usize::from(c));
        }
    }
    let one = |((t, n), fall): ((&Tested, usize), f64)| Chance {
        effect: t.candidate.effect.clone(),
        called: n as f64 / draws.max(1) as f64,
        fall,
    };
    Ok(all.iter().zip(called).zip(falls).map(one).collect())
}

/// The misfit with noise on its points; priors are what they are.
fn noisy(r: &DVector<f64>, rows: usize, random: &mut Random) -> DVector<f64> {
    let mut out = r.clone();
    out.rows_mut(0, rows).iter_mut().for_each(|v| *v += random.normal());
    out
}

/// A candidate that the false-discovery rate counts.
struct Tested<'a> {
    candidate: &'a Candidate,
    sides: Vec<Side>,
    live: Vec<(DMatrix<f64>, DMatrix<f64>)>,
    /// The fall at which its p-value is the share k of n of the rate, for k = 1 … n: not growing.
    critical: Vec<f64>,
}

impl<'a> Tested<'a> {
    fn new(candidate: &'a Candidate, shapes: Vec<DMatrix<f64>>, levels: &[f64], policy: &Policy) -> Self {
        let sides: Vec<Side> = candidate.amplitudes.iter().map(|a| a.side).collect();
        let live: Vec<DMatrix<f64>> = shapes.into_iter().filter(|s| s.norm() > 0.0).collect();
        let critical = match live.is_empty() {
            true => vec![f64::INFINITY; levels.len()],
            false => Family { shapes: &live, sides: &sides }.critical(levels, policy),
        };
        let live = live.into_iter().map(|s| (s.tr_mul(&s), s)).collect();
        Self { candidate, sides, live, critical }
    }

    /// The fall of the best shape, and what of it the amplitudes' limits admit.
    fn statistic(&self, r: &DVector<f64>) -> (f64, f64) {
        let falls = self.live.iter().map(|(gram, s)| statistic(gram, &s.tr_mul(r), &self.sides));
        let best = falls.max_by(|a, b| a.fall.total_cmp(&b.fall));
        let amplitudes: &[Amplitude] = &self.candidate.amplitudes;
        best.map_or((0.0, 0.0), |f| (f.fall, f.within(amplitudes).fall))
    }
}

/// Which candidates the screen calls on a misfit (Benjamini–Hochberg, then the least fall).
fn screened(all: &[Tested], r: &DVector<f64>, policy: &Policy) -> Vec<bool> {
    let falls: Vec<(f64, f64)> = all.iter().map(|t| t.statistic(r)).collect();
    // The least k whose level the p-value keeps to.
    let place = |t: &Tested, fall: f64| t.critical.partition_point(|c| *c > fall);
    let places: Vec<usize> = all.iter().zip(&falls).map(|(t, f)| place(t, f.0)).collect();
    let within = |k: usize| places.iter().filter(|p| **p < k).count() >= k;
    let called = (1..=all.len()).rev().find(|&k| within(k)).unwrap_or(0);
    places.iter().zip(&falls).map(|(p, f)| *p < called && f.1 >= policy.min_fall).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use inverse::{Data, Free, Noise, NoiseModel, Prediction};

    const N: usize = 120;

    fn column(f: impl Fn(f64) -> f64) -> DVector<f64> {
        DVector::from_fn(N, |i, _| f(i as f64 / N as f64))
    }

    fn white(record: &DVector<f64>) -> Whitened {
        let measured = record.iter().copied().collect();
        let data = Data::from_parts([(String::from("a"), measured, NoiseModel::white(1.0))]).unwrap();
        let base = DMatrix::from_columns(&[column(|_| 1.0), column(|x| x)]);
        let free = |path: &str| Free::new(path, (-1e3, 1e3), params::Transform::Identity, 0.0);
        let prediction = Prediction::new(DVector::zeros(N), Some(base));
        Whitened::new(&data, &[free("a"), free("b")], &[0.0; 2], &prediction, Noise::Record)
    }

    /// An effect of many shapes, one of a single shape that looks like it, one apart.
    fn catalogue() -> Vec<Candidate> {
        let mut steps = Candidate::simple("step", Side::Positive, 1.0, column(|x| f64::from(x > 0.1)));
        let more = (2..9).map(|k| crate::ShapeColumns {
            parameters: Vec::new(),
            columns: DMatrix::from_columns(&[column(|x| f64::from(x > 0.1 * f64::from(k)))]),
        });
        steps.shapes.extend(more);
        let cube = Candidate::simple("cube", Side::Both, 1.0, column(|x| (x - 0.5).powi(3)));
        vec![steps, cube, Candidate::simple("wave", Side::Both, 1.0, column(|x| (20.0 * x).sin()))]
    }

    #[test]
    fn the_chance_is_the_share_of_noisy_records_that_the_screen_calls() {
        let (candidates, policy) = (catalogue(), Policy { draws: 4000, ..Policy::default() });
        for size in [1.0, 1.6, 2.4] {
            let truth = candidates[0].shapes[3].columns.column(0) * size;
            let found = chances(&white(&truth), &[false; 2], &candidates, 2000, &policy).unwrap();
            let mut random = Random::new(5);
            let (mut called, runs) = ([0usize; 3], 300);
            for _ in 0..runs {
                let record = white(&(&truth + random.normals(N)));
                let screen = crate::screen(&record, &[false; 2], &candidates, N, &policy).unwrap();
                for (n, c) in called.iter_mut().zip(&candidates) {
                    *n += usize::from(screen.finding(&c.effect).is_some_and(|f| f.significant));
                }
            }
            for (n, chance) in called.iter().zip(&found) {
                let share = *n as f64 / f64::from(runs);
                assert!((share - chance.called).abs() < 0.08, "{chance:?} at {size}: {share}");
            }
        }
    }

    #[test]
    fn without_a_signal_nothing_is_called() {
        let candidates = catalogue();
        let found =
            chances(&white(&DVector::zeros(N)), &[false; 2], &candidates, 2000, &Policy::default()).unwrap();
        assert!(found.iter().all(|c| c.called < 0.01 && c.fall < 1e-9), "{found:?}");
    }
}
