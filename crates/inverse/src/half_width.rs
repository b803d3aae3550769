//! How wide a 95 % interval is in standard deviations.

use statrs::distribution::{ContinuousCDF, StudentsT};

/// Half width of a 95 % interval in standard deviations, where the noise is known.
pub const Z95: f64 = 1.959_963_984_540_054;

/// Degrees of freedom from which noise counts as known: the half width is within 0.02 % then, and statrs' quantile does
/// not end at infinity.
const KNOWN: f64 = 1e4;

/// The same where the level of the noise is itself an estimate with so many degrees of freedom: the quantile of
/// Student's distribution.
pub(crate) fn half_width(freedom: f64) -> f64 {
    if freedom >= KNOWN {
        return Z95;
    }
    StudentsT::new(0.0, 1.0, freedom.max(1.0)).map_or(Z95, |t| t.inverse_cdf(0.975))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Whatever a record says of its noise, the quantile comes to an end, and more freedom never widens an interval.
    #[test]
    fn half_widths_fall_to_that_of_known_noise() {
        let mut last = f64::INFINITY;
        for k in -100..=800 {
            let width = half_width(10f64.powf(f64::from(k) / 100.0));
            assert!(width <= last + 1e-9 && width >= Z95, "{k}: {width} after {last}");
            last = width;
        }
        assert_eq!([half_width(f64::INFINITY), half_width(f64::NAN).max(Z95)], [Z95, half_width(1.0)]);
    }
}
