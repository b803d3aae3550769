//! The path coordinate of a record.

/// s = ½ (travel of the actuator so far / its whole travel + time / whole time), from 0 to 1: a hold has length, and a fast
/// stretch as well. Where nothing moves, or no time passes, the other one alone.
///
/// `time` and `displacement` have one entry per row; units do not matter. Rows that are not finite count as not moved.
pub fn path(time: &[f64], displacement: &[f64]) -> Vec<f64> {
    let n = time.len().min(displacement.len());
    let steps = |x: &[f64]| {
        let mut sum = 0.0;
        let mut out = vec![0.0; n];
        for i in 1..n {
            let step = (x[i] - x[i - 1]).abs();
            sum += if step.is_finite() { step } else { 0.0 };
            out[i] = sum;
        }
        (out, sum)
    };
    let ((passed, duration), (travelled, travel)) = (steps(time), steps(displacement));
    let share = |x: f64, of: f64| if of > 0.0 { x / of } else { 0.0 };
    let both = f64::from(u8::from(duration > 0.0) + u8::from(travel > 0.0)).max(1.0);
    passed.iter().zip(&travelled).map(|(&t, &u)| (share(t, duration) + share(u, travel)) / both).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn holds_have_length_and_units_do_not_matter() {
        let (t, u) = ([0.0, 1.0, 2.0, 4.0], [0.0, 1.0, 1.0, 0.0]);
        let s = path(&t, &u);
        assert_eq!(s, [0.0, 0.375, 0.5, 1.0]);
        let (minutes, metres) = (t.map(|x| x / 64.0), u.map(|x| x * 1024.0));
        assert_eq!(path(&minutes, &metres), s);
        assert_eq!(path(&t, &[0.0; 4]), [0.0, 0.25, 0.5, 1.0]);
        assert!(path(&[], &[]).is_empty());
    }
}
