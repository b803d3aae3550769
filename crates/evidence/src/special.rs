//! Normal tails that do not underflow, and sums of exponentials.

use libm::erfc;
use statrs::function::erf::erfc_inv;
use std::f64::consts::{FRAC_1_SQRT_2, LN_2, PI};

/// e^{x²} erfc(x), scaled complementary error function; relative error below 1e-13 for x ≥ −5.
///
/// Up to 2 from its definition; beyond by Laplace's continued fraction (Abramowitz & Stegun 7.1.14), evaluated
/// from its tail.
pub fn erfcx(x: f64) -> f64 {
    if x < 2.0 {
        return (x * x).exp() * erfc(x);
    }
    if x > 1e7 {
        return 1.0 / (x * PI.sqrt());
    }
    let terms = 20 + (400.0 / (x * x)) as usize;
    let tail = (1..=terms).rev().fold(x, |f, k| x + 0.5 * k as f64 / f);
    1.0 / (tail * PI.sqrt())
}

/// ln Φ(x), Φ the standard normal distribution; exact far into the lower tail, where erfc underflows (above 26).
pub fn ln_phi(x: f64) -> f64 {
    let u = -x * FRAC_1_SQRT_2;
    if u > 25.0 { erfcx(u).ln() - u * u - LN_2 } else { (0.5 * erfc(u)).ln() }
}

/// Φ(x).
pub fn phi(x: f64) -> f64 {
    0.5 * erfc(-x * FRAC_1_SQRT_2)
}

/// x with Φ(x) = p, 0 < p < 1.
pub fn phi_inverse(p: f64) -> f64 {
    -std::f64::consts::SQRT_2 * erfc_inv(2.0 * p)
}

/// ln ∫₀^∞ exp(−g x − ½ h x²) dx = ln[√(π/2h) erfcx(g/√(2h))]: what stands for a Gaussian integral where a bound is
/// active, with slope g of −ln posterior at the bound and curvature h > 0.
pub fn ln_half_line(g: f64, h: f64) -> f64 {
    let x = g / (2.0 * h).sqrt();
    let front = 0.5 * (0.5 * PI / h).ln();
    if x > -5.0 { front + erfcx(x).ln() } else { front + x * x + LN_2 + ln_phi(-g / h.sqrt()) }
}

/// ln Σ exp(x); −∞ of an empty list.
pub fn ln_sum_exp(x: impl IntoIterator<Item = f64> + Clone) -> f64 {
    let most = x.clone().into_iter().fold(f64::NEG_INFINITY, f64::max);
    if most == f64::NEG_INFINITY {
        return most;
    }
    most + x.into_iter().map(|x| (x - most).exp()).sum::<f64>().ln()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tails_have_their_tabulated_values() {
        // Abramowitz & Stegun, table 7.1 and 26.2; ln Φ(−10), ln Φ(−40) from the asymptotic series to 1e-10.
        assert!((erfcx(0.0) - 1.0).abs() < 1e-15);
        assert!((erfcx(2.0) - 0.255_395_676_310_505_8).abs() < 1e-14);
        assert!((erfcx(10.0) - 0.056_140_992_743_822_59).abs() < 1e-15);
        assert!((ln_phi(-10.0) + 53.231_285_150_512_47).abs() < 1e-9);
        assert!((ln_phi(-40.0) + 804.608_442_013_754).abs() < 1e-8);
        assert!((phi_inverse(0.975) - 1.959_963_984_540_054).abs() < 1e-9);
        assert!((erfcx(2.0 - 1e-12) - erfcx(2.0)).abs() < 1e-11);
    }

    #[test]
    fn half_line_is_its_integral() {
        for (g, h) in [(0.3, 2.0), (5.0, 0.1), (-2.0, 1.0), (-30.0, 4.0), (50.0, 3.0)] {
            let (n, end) = (400_000, (if g < 0.0 { -g / h } else { 0.0 }) + 12.0 / f64::sqrt(h) + 0.0);
            let step = end / f64::from(n);
            let peak = if g < 0.0 { 0.5 * g * g / h } else { 0.0 };
            let value = |x: f64| (-g * x - 0.5 * h * x * x - peak).exp();
            let inner: f64 = (1..n).map(|i| value(step * f64::from(i))).sum();
            let want = (step * (inner + 0.5 * value(0.0))).ln() + peak;
            assert!((ln_half_line(g, h) - want).abs() < 1e-6, "{g} {h}: {} {want}", ln_half_line(g, h));
        }
    }

    #[test]
    fn sums_neither_overflow_nor_vanish() {
        assert!((ln_sum_exp([1000.0, 1000.0]) - 1000.0 - LN_2).abs() < 1e-12);
        assert_eq!(ln_sum_exp([]), f64::NEG_INFINITY);
        assert_eq!(ln_sum_exp([f64::NEG_INFINITY]), f64::NEG_INFINITY);
    }
}
