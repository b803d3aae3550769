//! How much each point of an averaged record weighs, and how much surer it is than a row.

use super::Bin;
use diagnose::noise::{Averages as Weights, estimate, estimate_averages};
use input::{Averages, Record};
use model::{Channel, Corner};

/// Readings behind the points of a channel, and how fast their means get surer.
pub(super) fn averages(
    whole: &Record,
    points: &Record,
    channel: Channel,
    bins: &[Bin],
    corners: &[(usize, Corner)],
) -> Averages {
    let rows = channel.of(whole);
    if rows.is_empty() {
        return Averages::default();
    }
    let mut readings = vec![0; bins.len()];
    let mut bin = 0;
    for (row, _) in &rows {
        while bins[bin].rows.end <= *row {
            bin += 1;
        }
        readings[bin] += 1;
    }
    let decay = decay(whole, points, channel, &readings, corners).unwrap_or(0.0);
    Averages { readings, decay }
}

/// From the noise of single readings and that of the means; `None` where the means show none or single readings are
/// smooth: then they share their error.
fn decay(
    whole: &Record,
    points: &Record,
    channel: Channel,
    readings: &[usize],
    corners: &[(usize, Corner)],
) -> Option<f64> {
    let breaks_in = |time: &[f64]| -> Vec<usize> {
        corners.iter().map(|c| time.partition_point(|t| *t < c.1.time)).collect()
    };
    let noise = |record: &Record, weights: Weights| {
        let (rows, values): (Vec<usize>, Vec<f64>) = channel.of(record).into_iter().unzip();
        let time: Vec<f64> = rows.iter().map(|&r| record.time[r]).collect();
        match weights.spread.is_empty() {
            true => estimate(&time, &values, &breaks_in(&time)).ok(),
            false => estimate_averages(&time, &values, weights, &breaks_in(&time)).ok(),
        }
    };
    let readings: Vec<usize> = readings.iter().copied().filter(|r| *r > 0).collect();
    let typical = typical(&readings);
    if typical < 2.0 {
        return Some(0.5);
    }
    let (spread, position) = (spread(&readings), position(&readings));
    let of_means = noise(points, Weights { spread: &spread, position: &position })?;
    let of_rows = noise(whole, Weights::default())?;
    Some(((of_rows.sd / of_means.sd).ln() / typical.ln()).clamp(0.0, 0.5))
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
