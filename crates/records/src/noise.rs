//! Noise of a channel from its own fast changes: what a smooth curve cannot follow.

/// The middle value; 0 of none. Reorders.
pub(crate) fn median(x: &mut [f64]) -> f64 {
    if x.is_empty() {
        return 0.0;
    }
    let middle = x.len() / 2;
    *x.select_nth_unstable_by(middle, f64::total_cmp).1
}

/// Standard deviation of white noise, by the median of second differences: neither a smooth curve nor a few jumps
/// or turns reach it.
pub(crate) fn sd(x: &[f64]) -> f64 {
    let mut second: Vec<f64> = x.windows(3).map(|w| (w[0] - 2.0 * w[1] + w[2]).abs()).collect();
    // Var of a second difference is 6 σ²; the median of |N(0, 1)| is 0.6745.
    median(&mut second) / (0.674_489_75 * 6_f64.sqrt())
}

/// Standard deviation of means over `n` rows, by fourth differences of neighbouring means: noise that neighbouring
/// rows share (a filter, hum) shows here and not in [`sd`]. `None` for fewer than 24 means.
pub(crate) fn sd_of_means(x: &[f64], n: usize) -> Option<f64> {
    let means: Vec<f64> = x.chunks_exact(n.max(1)).map(|c| c.iter().sum::<f64>() / c.len() as f64).collect();
    if means.len() < 24 {
        return None;
    }
    let mut fourth: Vec<f64> =
        means.windows(5).map(|w| (w[0] - 4.0 * w[1] + 6.0 * w[2] - 4.0 * w[3] + w[4]).abs()).collect();
    Some(median(&mut fourth) / (0.674_489_75 * 70_f64.sqrt()))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Sums of twelve uniform numbers: normal enough, and the same every time.
    pub(crate) fn normal(n: usize, mut seed: u64) -> Vec<f64> {
        let mut uniform = || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (seed >> 11) as f64 / (1_u64 << 53) as f64
        };
        (0..n).map(|_| (0..12).map(|_| uniform()).sum::<f64>() - 6.0).collect()
    }

    #[test]
    fn noise_on_a_curve_is_measured_without_the_curve() {
        let noise = normal(20_000, 7);
        let curve = |i: usize| (i as f64 / 3000.0).exp() + if i > 9000 { 40.0 } else { 0.0 };
        let x: Vec<f64> = noise.iter().enumerate().map(|(i, e)| curve(i) + 0.1 * e).collect();
        assert!((sd(&x) / 0.1 - 1.0).abs() < 0.05, "{}", sd(&x));
        let of_means = sd_of_means(&x, 50).unwrap();
        assert!((of_means / (0.1 / 50_f64.sqrt()) - 1.0).abs() < 0.15, "{of_means}");
        // Neighbours that share their noise: the mean of 50 is worse than σ/√50.
        let shared: Vec<f64> = (0..20_000).map(|i| 0.1 * noise[i / 10]).collect();
        let of_means = sd_of_means(&shared, 50).unwrap();
        assert!((of_means / (0.1 / 5_f64.sqrt()) - 1.0).abs() < 0.15, "{of_means}");
    }
}
