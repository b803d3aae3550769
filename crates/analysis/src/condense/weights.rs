//! How much each point of an averaged record weighs, and how much surer it is than a row.

use super::Bin;
use diagnose::noise::{Averages as Weights, NoiseEstimate, estimate_averages};
use input::{Averages, Record};
use model::{Channel, Corner};
use std::cell::OnceCell;

/// A record with the noise of its single readings, by channel, estimated once for points of any width.
pub(super) struct Whole<'a> {
    pub record: &'a Record,
    pub corners: &'a [(usize, Corner)],
    /// Rows that no point may stand across.
    pub edges: &'a [usize],
    noise: [OnceCell<Option<NoiseEstimate>>; Channel::ALL.len()],
}

impl<'a> Whole<'a> {
    pub fn new(record: &'a Record, corners: &'a [(usize, Corner)], edges: &'a [usize]) -> Self {
        Self { record, corners, edges, noise: Default::default() }
    }

    fn noise(&self, channel: Channel) -> Option<NoiseEstimate> {
        let at = Channel::ALL.iter().position(|c| *c == channel)?;
        *self.noise[at].get_or_init(|| noise_of(self.record, channel, self.corners, Weights::default()))
    }
}

/// Noise of a channel of a record, or of points with their weights.
fn noise_of(
    record: &Record,
    channel: Channel,
    corners: &[(usize, Corner)],
    weights: Weights,
) -> Option<NoiseEstimate> {
    let (rows, values): (Vec<usize>, Vec<f64>) = channel.of(record).into_iter().unzip();
    let time: Vec<f64> = rows.iter().map(|&r| record.time[r]).collect();
    let breaks: Vec<usize> = corners.iter().map(|c| time.partition_point(|t| *t < c.1.time)).collect();
    estimate_averages(&time, &values, weights, &breaks).ok()
}

/// Readings behind the points of a channel, and how fast their means get surer; the noise of the means.
pub(super) fn averages(
    whole: &Whole,
    points: &Record,
    channel: Channel,
    bins: &[Bin],
) -> (Averages, Option<NoiseEstimate>) {
    let rows = channel.of(whole.record);
    if rows.is_empty() {
        return (Averages::default(), None);
    }
    let mut readings = vec![0; bins.len()];
    let mut bin = 0;
    for (row, _) in &rows {
        while bins[bin].rows.end <= *row {
            bin += 1;
        }
        readings[bin] += 1;
    }
    let there: Vec<usize> = readings.iter().copied().filter(|r| *r > 0).collect();
    let (spread, position) = (spread(&there), position(&there));
    let weights = Weights { spread: &spread, position: &position };
    let of_means = noise_of(points, channel, whole.corners, weights);
    let decay = match typical(&there) {
        few if few < 2.0 => 0.5,
        typical => {
            // Where the means show no noise, or single readings are smooth, they share their error.
            let both = of_means.and_then(|means| Some((whole.noise(channel)?.sd, means.sd)));
            both.map_or(0.0, |(rows, means)| ((rows / means).ln() / typical.ln()).clamp(0.0, 0.5))
        }
    };
    (Averages { readings, decay }, of_means)
}

/// The usual number of readings in a point.
pub(crate) fn typical(readings: &[usize]) -> f64 {
    let mut sorted = readings.to_vec();
    sorted.sort_unstable();
    sorted.get(sorted.len() / 2).map_or(1.0, |r| *r as f64)
}

/// Sd of each point in units of that of a point with the usual number of readings: a point weighs as much as it has readings.
/// So do points whose errors are shared, all of them in a stretch of the usual length together.
pub(crate) fn spread(readings: &[usize]) -> Vec<f64> {
    let typical = typical(readings);
    readings.iter().map(|r| (*r as f64 / typical).powf(-0.5)).collect()
}

/// Readings of each point in units of the usual number.
pub(crate) fn weights(readings: &[usize]) -> Vec<f64> {
    let typical = typical(readings);
    readings.iter().map(|r| *r as f64 / typical).collect()
}

/// Middle of each point, in units of the usual number of readings.
pub(crate) fn position(readings: &[usize]) -> Vec<f64> {
    let typical = typical(readings);
    let mut before = 0.0;
    readings
        .iter()
        .map(|r| {
            let middle = (before + 0.5 * *r as f64) / typical;
            before += *r as f64;
            middle
        })
        .collect()
}
