//! Shares of what may be nothing.

/// a / b; nothing of nothing is nothing.
pub(crate) fn ratio(a: f64, b: f64) -> f64 {
    if b > 0.0 { a / b } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::ratio;

    #[test]
    fn a_share_of_nothing_is_nothing() {
        assert_eq!(
            [ratio(3.0, 2.0), ratio(-3.0, 2.0), ratio(0.0, 0.0), ratio(1.0, 0.0)],
            [1.5, -1.5, 0.0, 0.0]
        );
    }
}
