//! Noise with the spectrum of a load cell's reading.

use inverse::Random;
use std::f64::consts::TAU;

/// Parts of the variance: white, flicker, mains.
const WHITE: f64 = 0.5;
const FLICKER: f64 = 0.4;

/// Octaves of the flicker.
const OCTAVES: u32 = 8;

/// `n` readings of this standard deviation: white noise; flicker, power as 1/f over eight octaves, by first-order processes whose times
/// are an octave apart; and the mains, folded by the sampling to some period of 3 to 9 readings.
pub fn load_cell(n: usize, sd: f64, random: &mut Random) -> Vec<f64> {
    let mut sum: Vec<f64> = (random.normals(n) * (sd * WHITE.sqrt())).as_slice().to_vec();
    let each = sd * (FLICKER / f64::from(OCTAVES)).sqrt();
    for k in 0..OCTAVES {
        let kept = (-0.5f64.powi(k as i32)).exp();
        sum.iter_mut().zip(random.ar1(n, each, kept).iter()).for_each(|(s, x)| *s += x);
    }
    let (period, phase) = (3.0 + 6.0 * random.uniform(), random.uniform());
    let size = sd * (2.0 * (1.0 - WHITE - FLICKER)).sqrt();
    sum.iter_mut().enumerate().for_each(|(i, s)| *s += size * (TAU * (i as f64 / period + phase)).sin());
    sum
}

#[cfg(test)]
mod tests {
    use super::load_cell;
    use inverse::Random;

    #[test]
    fn it_has_its_size_and_is_rougher_than_it_is_long() {
        let noise = load_cell(40_000, 2.0, &mut Random::new(5));
        let mean_square = |v: &[f64]| v.iter().map(|x| x * x).sum::<f64>() / v.len() as f64;
        assert!((mean_square(&noise) / 4.0 - 1.0).abs() < 0.1, "{}", mean_square(&noise));
        // White noise would leave a hundredth of its variance in means over 100; flicker leaves more.
        let means: Vec<f64> = noise.chunks_exact(100).map(|c| c.iter().sum::<f64>() / 100.0).collect();
        assert!(mean_square(&means) > 0.05 * 4.0, "{}", mean_square(&means));
    }
}
