//! Upper tails of the normal, χ² and F distributions, and false-discovery control.

use statrs::distribution::{ChiSquared, ContinuousCDF, FisherSnedecor, Normal};

/// Smallest p-value that is reported.
pub const SMALLEST: f64 = 1e-300;

/// P(Z > z), Z standard normal.
pub fn normal_sf(z: f64) -> f64 {
    Normal::new(0.0, 1.0).map_or(f64::NAN, |n| n.sf(z))
}

/// z with P(Z > z) = p.
pub fn normal_isf(p: f64) -> f64 {
    Normal::new(0.0, 1.0).map_or(f64::NAN, |n| -n.inverse_cdf(p.clamp(SMALLEST, 1.0 - 1e-16)))
}

/// P(X > x), X χ² with `k` degrees of freedom (k > 0).
pub fn chi2_sf(x: f64, k: f64) -> f64 {
    if x <= 0.0 {
        return 1.0;
    }
    ChiSquared::new(k).map_or(f64::NAN, |d| d.sf(x)).clamp(SMALLEST, 1.0)
}

/// x with P(X > x) = p, X χ² with `k` degrees of freedom (k > 0).
pub fn chi2_isf(p: f64, k: f64) -> f64 {
    ChiSquared::new(k).map_or(f64::NAN, |d| d.inverse_cdf(1.0 - p))
}

/// P(X > x), X of Fisher's F with `a` and `b` degrees of freedom.
pub fn f_sf(x: f64, a: f64, b: f64) -> f64 {
    if x <= 0.0 {
        return 1.0;
    }
    FisherSnedecor::new(a, b).map_or(1.0, |d| d.sf(x)).clamp(SMALLEST, 1.0)
}

/// Adjusted p-values ("q-values") of Benjamini & Hochberg 1995: calling everything with q ≤ 0.05 missing
/// is wrong for at most 5 % of what is called, on average.
pub fn benjamini_hochberg(p: &[f64]) -> Vec<f64> {
    let n = p.len();
    let mut order: Vec<usize> = (0..n).collect();
    order.sort_by(|&a, &b| p[b].total_cmp(&p[a]).then(b.cmp(&a)));
    let mut q = vec![1.0; n];
    let mut least: f64 = 1.0;
    for (place, &i) in order.iter().enumerate() {
        least = least.min(p[i] * n as f64 / (n - place) as f64);
        q[i] = least;
    }
    q
}

/// Probability that a test of level `alpha` sees a signal of `snr` standard deviations.
pub fn power(snr: f64, alpha: f64, one_sided: bool) -> f64 {
    if one_sided {
        normal_sf(normal_isf(alpha) - snr)
    } else {
        let c = normal_isf(0.5 * alpha);
        normal_sf(c - snr) + normal_sf(c + snr)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tails_have_their_textbook_values() {
        assert!((normal_sf(1.959_964) - 0.025).abs() < 1e-8);
        assert!((normal_isf(0.025) - 1.959_964).abs() < 1e-5);
        assert!((chi2_sf(3.841_459, 1.0) - 0.05).abs() < 1e-7);
        assert!((chi2_isf(0.05, 1.0) - 3.841_459).abs() < 1e-4);
        assert!((f_sf(4.964_6, 1.0, 10.0) - 0.05).abs() < 1e-4);
        assert!(normal_sf(30.0) > 0.0 && normal_sf(30.0) < 1e-190);
        assert_eq!(chi2_sf(1e6, 2.0), SMALLEST);
    }

    #[test]
    fn benjamini_hochberg_reproduces_the_worked_example() {
        let p = [0.01, 0.04, 0.03, 0.005];
        let q = benjamini_hochberg(&p);
        for (q, want) in q.iter().zip([0.02, 0.04, 0.04, 0.02]) {
            assert!((q - want).abs() < 1e-12, "{q} {want}");
        }
        assert!(benjamini_hochberg(&[]).is_empty());
    }

    #[test]
    fn power_is_the_level_without_signal_and_half_at_the_critical_value() {
        assert!((power(0.0, 0.01, false) - 0.01).abs() < 1e-9);
        assert!((power(0.0, 0.01, true) - 0.01).abs() < 1e-9);
        assert!((power(normal_isf(0.01), 0.01, true) - 0.5).abs() < 1e-9);
    }
}
