//! Reproducible normal numbers for simulating noise (SplitMix64 and Box–Muller); no cryptography, no
//! dependence on platform or thread.

use crate::Data;
use nalgebra::DVector;

/// A seeded stream of random numbers; the same seed gives the same numbers everywhere.
#[derive(Clone, Debug)]
pub struct Random {
    state: u64,
    spare: Option<f64>,
}

impl Random {
    /// A stream from a seed.
    pub fn new(seed: u64) -> Self {
        Self { state: seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) ^ 0xD1B5_4A32_D192_ED03, spare: None }
    }

    /// Uniform in (0, 1).
    pub fn uniform(&mut self) -> f64 {
        self.state = self.state.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.state;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^= z >> 31;
        ((z >> 11) as f64 + 0.5) / (1u64 << 53) as f64
    }

    /// Standard normal.
    pub fn normal(&mut self) -> f64 {
        if let Some(z) = self.spare.take() {
            return z;
        }
        let radius = (-2.0 * self.uniform().ln()).sqrt();
        let (sin, cos) = (std::f64::consts::TAU * self.uniform()).sin_cos();
        self.spare = Some(radius * sin);
        radius * cos
    }

    /// `n` independent standard normal numbers.
    pub fn normals(&mut self, n: usize) -> DVector<f64> {
        DVector::from_fn(n, |_, _| self.normal())
    }

    /// A stretch of `n` points of a stationary AR(1) process of standard deviation `sd`.
    pub fn ar1(&mut self, n: usize, sd: f64, ar1: f64) -> DVector<f64> {
        let mut last = 0.0;
        DVector::from_fn(n, |i, _| {
            let fresh = self.normal();
            last = if i == 0 { fresh } else { ar1 * last + (1.0 - ar1 * ar1).sqrt() * fresh };
            sd * last
        })
    }
}

impl Data {
    /// One draw of the total noise: AR(1) in each block, numerical-error columns with N(0, 1) factors.
    pub fn simulate_noise(&self, random: &mut Random) -> DVector<f64> {
        let mut noise = DVector::zeros(self.points());
        for block in &self.blocks {
            let model = &block.noise;
            let part = if model.spread.is_empty() && model.position.is_empty() {
                random.ar1(block.range.len(), model.sd, model.ar1)
            } else {
                let mut last = 0.0;
                DVector::from_fn(block.range.len(), |i, _| {
                    let phi = if i == 0 { 0.0 } else { model.correlation(i - 1, i) };
                    last = phi * last + (1.0 - phi * phi).sqrt() * random.normal();
                    model.sd_of(i) * last
                })
            };
            noise.rows_mut(block.range.start, block.range.len()).copy_from(&part);
        }
        for e in self.nuisance_columns() {
            noise.axpy(random.normal(), &e, 1.0);
        }
        noise
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn moments_are_those_of_the_normal_distribution() {
        let x = Random::new(3).normals(100_000);
        let moment = |k: i32| x.iter().map(|v| v.powi(k)).sum::<f64>() / 1e5;
        assert!(moment(1).abs() < 0.01 && (moment(2) - 1.0).abs() < 0.02);
        assert!(moment(3).abs() < 0.04 && (moment(4) - 3.0).abs() < 0.1);
    }

    #[test]
    fn ar1_has_its_sd_and_correlation() {
        let x = Random::new(5).ar1(100_000, 2.0, 0.6);
        let variance = x.norm_squared() / 1e5;
        let lag: f64 = (1..x.len()).map(|i| x[i] * x[i - 1]).sum::<f64>() / 1e5;
        assert!((variance - 4.0).abs() < 0.1 && (lag / variance - 0.6).abs() < 0.01);
    }
}
