//! One-line plots.

const BARS: [char; 8] = ['▁', '▂', '▃', '▄', '▅', '▆', '▇', '█'];

/// `values` as a line of block characters, `width` wide, between `low` and `high`.
pub fn sparkline(values: &[f64], width: usize, low: f64, high: f64) -> String {
    let width = width.min(values.len());
    let span = (high - low).max(f64::MIN_POSITIVE);
    (0..width)
        .map(|i| {
            let (from, to) = (
                i * values.len() / width,
                ((i + 1) * values.len() / width).max(i * values.len() / width + 1),
            );
            let part = &values[from..to];
            let mean = part.iter().sum::<f64>() / part.len() as f64;
            let level = ((mean - low) / span * 7.0).round().clamp(0.0, 7.0);
            BARS[level as usize]
        })
        .collect()
}

/// Least and greatest of several series.
pub fn range<'a>(series: impl IntoIterator<Item = &'a f64>) -> (f64, f64) {
    let (low, high) = series.into_iter().fold((f64::MAX, f64::MIN), |(l, h), v| (l.min(*v), h.max(*v)));
    if low > high { (0.0, 1.0) } else { (low, high) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_of_blocks_shows_means_between_its_ends() {
        assert_eq!(sparkline(&[0.0, 0.0, 7.0, 7.0], 2, 0.0, 7.0), "▁█");
        assert_eq!(sparkline(&[0.0, 2.0, 4.0, 9.0], 4, 0.0, 7.0), "▁▃▅█");
        // No wider than there are values; the mean of each part.
        assert_eq!(sparkline(&[0.0, 4.0], 80, 0.0, 7.0), "▁▅");
        assert_eq!(sparkline(&[0.0, 4.0], 1, 0.0, 7.0), "▃");
        assert_eq!(sparkline(&[3.0; 3], 3, 3.0, 3.0), "▁▁▁");
        assert!(sparkline(&[], 5, 0.0, 1.0).is_empty() && sparkline(&[1.0], 0, 0.0, 1.0).is_empty());
    }

    #[test]
    fn the_range_of_several_series() {
        let (a, b) = ([1.0, -2.0], [5.0]);
        assert_eq!(range(a.iter().chain(&b)), (-2.0, 5.0));
        assert_eq!(range(&[0.0; 0]), (0.0, 1.0));
    }
}
