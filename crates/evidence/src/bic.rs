//! The simple competitor: BIC with the effective number of points of the misfit.

/// n / (1 + 2 Σ ρ_k), the sum over the initial positive sequence of pairs of autocorrelations (Geyer 1992); between 2 and n.
pub fn effective_points(misfit: &[f64]) -> f64 {
    let n = misfit.len();
    let square: f64 = misfit.iter().map(|x| x * x).sum();
    if n < 4 || square <= 0.0 {
        return n as f64;
    }
    // The misfit of a model has mean zero by right, not by subtraction.
    let rho = |k: usize| misfit[k..].iter().zip(misfit).map(|(a, b)| a * b).sum::<f64>() / square;
    let (mut sum, mut k) = (0.0, 1);
    while k + 1 < n {
        let pair = rho(k) + rho(k + 1);
        if pair <= 0.0 {
            break;
        }
        sum += pair;
        k += 2;
    }
    (n as f64 / (1.0 + 2.0 * sum)).clamp(2.0, n as f64)
}

/// ln of a model's weight: Σ over blocks −½ n_eff ln(RSS/n), less ½ k ln Σ n_eff. `rss` has (sum of squares, points) per block,
/// `effective` the effective points of the same blocks, common to all models that are compared (those of the model that
/// misses least).
pub fn ln_weight(rss: &[(f64, usize)], effective: &[f64], parameters: usize) -> f64 {
    let fit: f64 = rss
        .iter()
        .zip(effective)
        .map(|(&(s, n), e)| -0.5 * e * (s.max(f64::MIN_POSITIVE) / n.max(1) as f64).ln())
        .sum();
    let all: f64 = effective.iter().sum();
    fit - 0.5 * parameters as f64 * all.max(1.0).ln()
}

#[cfg(test)]
mod tests {
    use super::*;
    use inverse::Random;

    #[test]
    fn white_noise_counts_in_full_and_slow_noise_little() {
        let mut random = Random::new(5);
        let white = effective_points(random.ar1(4000, 1.0, 0.0).as_slice());
        assert!(white > 3400.0, "{white}");
        // (1 − φ)/(1 + φ) = 1/19.
        let slow = effective_points(random.ar1(8000, 1.0, 0.9).as_slice());
        assert!((slow / 8000.0 * 19.0 - 1.0).abs() < 0.35, "{slow}");
        assert_eq!(effective_points(&[]), 0.0);
    }

    #[test]
    fn a_parameter_must_pay() {
        let better = ln_weight(&[(0.9, 100)], &[50.0], 3) - ln_weight(&[(1.0, 100)], &[50.0], 2);
        let want = -25.0 * 0.9f64.ln() - 0.5 * 50f64.ln();
        assert!((better - want).abs() < 1e-12);
    }
}
