//! A low-discrepancy sequence: Halton's, with scrambled digits (Braaten & Weller 1979 kind), so that high
//! dimensions do not run in step.

/// The first primes, one per dimension; further dimensions reuse them with another scrambling.
const PRIMES: [u32; 40] = [
    2, 3, 5, 7, 11, 13, 17, 19, 23, 29, 31, 37, 41, 43, 47, 53, 59, 61, 67, 71, 73, 79, 83, 89, 97, 101, 103,
    107, 109, 113, 127, 131, 137, 139, 149, 151, 157, 163, 167, 173,
];

/// Point `index` (from 0) of the sequence in `dimensions` dimensions; every coordinate in (0, 1).
pub fn halton(index: usize, dimensions: usize) -> Vec<f64> {
    (0..dimensions)
        .map(|d| {
            let base = PRIMES[d % PRIMES.len()] as usize;
            let multiplier = scramble(base, d / PRIMES.len());
            radical_inverse(index + 1, base, multiplier)
        })
        .collect()
}

/// A digit multiplier near the golden section of the base: spreads neighbouring digits.
fn scramble(base: usize, round: usize) -> usize {
    let m = ((base as f64) * 0.618_034) as usize + round;
    (m % base).max(1)
}

fn radical_inverse(mut n: usize, base: usize, multiplier: usize) -> f64 {
    let (mut value, mut place) = (0.0, 1.0 / base as f64);
    while n > 0 {
        value += ((n % base) * multiplier % base) as f64 * place;
        n /= base;
        place /= base as f64;
    }
    value
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_coordinate_fills_its_interval_evenly() {
        for d in 0..12 {
            let mut x: Vec<f64> = (0..512).map(|i| halton(i, 12)[d]).collect();
            assert!(x.iter().all(|&v| 0.0 < v && v < 1.0));
            x.sort_by(f64::total_cmp);
            let gap = x.windows(2).map(|w| w[1] - w[0]).fold(0.0, f64::max);
            assert!(gap < 0.03, "dimension {d}: a gap of {gap}");
        }
    }

    #[test]
    fn pairs_of_coordinates_are_not_in_step() {
        for d in 0..11 {
            let n = 512;
            let points: Vec<Vec<f64>> = (0..n).map(|i| halton(i, 12)).collect();
            let c: f64 =
                points.iter().map(|p| (p[d] - 0.5) * (p[d + 1] - 0.5)).sum::<f64>() * 12.0 / n as f64;
            assert!(c.abs() < 0.15, "dimensions {d}, {}: correlation {c}", d + 1);
        }
    }
}
