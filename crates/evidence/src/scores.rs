//! Scores of stated probabilities: logarithmic, Brier, and the CORP reliability curve (Dimitriadis, Gneiting & Jordan 2021):
//! isotonic regression by pooling adjacent violators, with consistency bands and the decomposition of the Brier score.

use inverse::Random;
use serde::Serialize;

/// Mean of −ln p(what happened), natural units; probabilities are kept off 0 and 1 by `floor` (1e-6, say).
pub fn log_score(stated: &[f64], happened: &[bool], floor: f64) -> f64 {
    let one = |(&p, &y): (&f64, &bool)| -(if y { p } else { 1.0 - p }).clamp(floor, 1.0).ln();
    mean(stated.iter().zip(happened).map(one))
}

/// Mean of (p − y)².
pub fn brier(stated: &[f64], happened: &[bool]) -> f64 {
    mean(stated.iter().zip(happened).map(|(&p, &y)| (p - f64::from(u8::from(y))).powi(2)))
}

fn mean(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, n) = values.fold((0.0, 0.0), |(s, n), v| (s + v, n + 1.0));
    if n > 0.0 { sum / n } else { 0.0 }
}

/// One flat stretch of a reliability curve.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Bin {
    /// Smallest stated probability.
    pub from: f64,
    /// Largest.
    pub to: f64,
    /// How often it happened.
    pub frequency: f64,
    /// Number of statements.
    pub count: usize,
}

/// A stated probability with the recalibrated one, and where that would lie in 90 % of samples if all statements were
/// calibrated.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Banded {
    /// Stated probability.
    pub stated: f64,
    /// Frequency by isotonic regression.
    pub frequency: f64,
    /// 5 and 95 % of it under calibration.
    pub band: [f64; 2],
}

/// Reliability of statements.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Reliability {
    /// Flat stretches.
    pub bins: Vec<Bin>,
    /// The curve with consistency bands at every distinct stated probability.
    pub curve: Vec<Banded>,
    /// Brier score = miscalibration − discrimination + uncertainty.
    pub brier: f64,
    /// What recalibration would save.
    pub miscalibration: f64,
    /// What the statements know beyond the base rate.
    pub discrimination: f64,
    /// Brier score of the base rate.
    pub uncertainty: f64,
    /// Share of distinct statements whose frequency lies within its band; about 0.9 where all is calibrated.
    pub within: f64,
}

/// Isotonic regression of outcomes on sorted statements; equal statements are pooled first.
fn pooled(sorted: &[(f64, f64)]) -> Vec<Bin> {
    struct Pool {
        from: f64,
        to: f64,
        sum: f64,
        count: usize,
    }
    let rate = |p: &Pool| p.sum / p.count as f64;
    let mut pools: Vec<Pool> = Vec::new();
    for &(x, y) in sorted {
        match pools.last_mut() {
            Some(last) if last.from == x => {
                last.sum += y;
                last.count += 1;
            }
            _ => pools.push(Pool { from: x, to: x, sum: y, count: 1 }),
        }
    }
    let mut out: Vec<Pool> = Vec::new();
    for pool in pools {
        out.push(pool);
        while let [.., a, b] = out.as_slice() {
            if rate(a) < rate(b) {
                break;
            }
            let Some(b) = out.pop() else { break };
            if let Some(a) = out.last_mut() {
                (a.to, a.sum, a.count) = (b.to, a.sum + b.sum, a.count + b.count);
            }
        }
    }
    out.iter().map(|p| Bin { from: p.from, to: p.to, frequency: rate(p), count: p.count }).collect()
}

fn at(bins: &[Bin], x: f64) -> f64 {
    bins.iter().find(|b| x <= b.to).or(bins.last()).map_or(0.0, |b| b.frequency)
}

/// The reliability curve with 90 % consistency bands from `draws` samples of outcomes under calibration (1000, say). The same
/// numbers on every call.
pub fn reliability(stated: &[f64], happened: &[bool], draws: usize) -> Reliability {
    let mut sorted: Vec<(f64, f64)> =
        stated.iter().zip(happened).map(|(&p, &y)| (p, f64::from(u8::from(y)))).collect();
    sorted.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
    let bins = pooled(&sorted);
    let mut distinct: Vec<f64> = sorted.iter().map(|s| s.0).collect();
    distinct.dedup();
    let mut samples = vec![Vec::with_capacity(draws); distinct.len()];
    let mut random = Random::new(20_210_216);
    for _ in 0..draws {
        let drawn: Vec<(f64, f64)> =
            sorted.iter().map(|s| (s.0, f64::from(u8::from(random.uniform() < s.0)))).collect();
        let bins = pooled(&drawn);
        for (x, sample) in distinct.iter().zip(&mut samples) {
            sample.push(at(&bins, *x));
        }
    }
    let curve: Vec<Banded> = distinct
        .iter()
        .zip(&mut samples)
        .map(|(&x, sample)| {
            sample.sort_by(f64::total_cmp);
            let q = |p: f64| sample.get((p * draws as f64) as usize).copied().unwrap_or(x);
            Banded { stated: x, frequency: at(&bins, x), band: [q(0.05), q(0.95)] }
        })
        .collect();
    let rate = mean(sorted.iter().map(|s| s.1));
    let score = |p: &dyn Fn(f64) -> f64| mean(sorted.iter().map(|s| (p(s.0) - s.1).powi(2)));
    let (own, best, flat) = (score(&|x| x), score(&|x| at(&bins, x)), score(&|_| rate));
    let inside = curve.iter().filter(|c| c.frequency >= c.band[0] && c.frequency <= c.band[1]).count();
    Reliability {
        bins,
        within: inside as f64 / curve.len().max(1) as f64,
        curve,
        brier: own,
        miscalibration: own - best,
        discrimination: flat - best,
        uncertainty: flat,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn worked_examples() {
        let (p, y) = ([0.9, 0.2, 0.6], [true, false, false]);
        assert!((brier(&p, &y) - (0.01 + 0.04 + 0.36) / 3.0).abs() < 1e-15);
        let want = -(0.9f64.ln() + 0.8f64.ln() + 0.4f64.ln()) / 3.0;
        assert!((log_score(&p, &y, 1e-9) - want).abs() < 1e-15);
        assert!((log_score(&[0.0], &[true], 1e-6) - 1e6f64.ln()).abs() < 1e-9);
        // Pool-adjacent-violators by hand: 0, (1, 0) pooled to ½, 1.
        let r = reliability(&[0.1, 0.3, 0.5, 0.9], &[false, true, false, true], 10);
        let rates: Vec<f64> = r.bins.iter().map(|b| b.frequency).collect();
        assert_eq!(rates, [0.0, 0.5, 1.0]);
        assert_eq!((r.bins[1].from, r.bins[1].to, r.bins[1].count), (0.3, 0.5, 2));
        assert!((r.brier - (r.miscalibration - r.discrimination + r.uncertainty)).abs() < 1e-15);
    }

    #[test]
    fn calibrated_statements_lie_in_the_band_and_bold_ones_do_not() {
        let mut random = Random::new(9);
        let truth: Vec<f64> = (0..600).map(|i| 0.025 + 0.05 * f64::from(i % 20)).collect();
        let happened: Vec<bool> = truth.iter().map(|&p| random.uniform() < p).collect();
        let good = reliability(&truth, &happened, 300);
        let bold: Vec<f64> = truth.iter().map(|p| if *p > 0.5 { 0.99 } else { 0.01 }).collect();
        let bad = reliability(&bold, &happened, 300);
        assert!(good.within > 0.7 && good.miscalibration < 0.02, "{good:?}");
        assert!(bad.within < 0.1 && bad.miscalibration > 0.04, "{bad:?}");
    }
}
