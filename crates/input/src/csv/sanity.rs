//! Numbers of a record that nothing measures: beyond any rig, too small to be a test, a force that stands alone.

use super::lines;
use crate::case::Record;
use crate::diagnostics::{Report, Sink};
use crate::keys::plain;
use crate::text::SourceFile;
use std::ops::Range;

/// Largest number of a column that anything measures, internal unit: time (which may be counted in milliseconds since
/// 1970), force, and everything that is a length.
const MOST: [f64; 3] = [1e13, 1e9, 1e4];
/// Least time between two rows, s, and least way of the actuator in a record, mm: less is a unit mistake.
const INSTANT: f64 = 1e-7;
const LEAST_WAY: f64 = 1e-6;
/// Largest force, N, of a record in which nothing was pulled.
const LEAST_FORCE: f64 = 1e-9;
/// Faults told per record.
const TOLD: usize = 5;
/// Rows below which a force that stands alone cannot be told from a peak.
const FEWEST: usize = 12;
/// How many times further than 98 % of the rows a force lies that stands alone.
const ALONE: f64 = 5.0;

/// Whether every number of a record is one that a rig may have written; says what is not, and warns of forces that
/// stand alone.
pub(super) fn sane(file: &SourceFile, sink: &Sink, record: &Record) -> bool {
    let mut faults: Vec<(usize, Report)> = Vec::new();
    for (name, values, most) in columns(record) {
        let beyond = values.iter().position(|v| v.is_some_and(|v| v.abs() > most));
        if let Some((row, Some(v))) = beyond.map(|row| (row, values[row])) {
            let message = format!("{name} is {}; expected no more than {most:e}", plain(v));
            let help = "is the unit in the header the one of the numbers?";
            faults.push((row, Report::error(message).key(name).help(help)));
        }
    }
    let short = record.time.windows(2).position(|t| t[1] - t[0] < INSTANT);
    if let Some(row) = short {
        let dt = plain(record.time[row + 1] - record.time[row]);
        let message = format!("time goes on by {dt} s; expected at least {INSTANT:e} s from row to row");
        faults.push((row + 1, Report::error(message).key("time").help("is the unit of time right?")));
    }
    let (low, high) =
        record.displacement.iter().fold((f64::MAX, f64::MIN), |(l, h), &u| (l.min(u), h.max(u)));
    if high > low && high - low < LEAST_WAY {
        let way = plain(high - low);
        let message = format!(
            "displacement moves by {way} mm in all; expected a test that moves, by {LEAST_WAY:e} mm at least"
        );
        faults
            .push((0, Report::error(message).key("displacement").help("is the unit of displacement right?")));
    }
    let good = faults.is_empty();
    let strongest = record.force.iter().fold(0.0f64, |m, f| m.max(f.abs()));
    if good && strongest < LEAST_FORCE {
        let message = format!("no force is more than {} N; is the unit of force right?", plain(strongest));
        sink.push(Report::warning(message).key("force").at(file, line_of(file, 0)));
    }
    if good {
        warn_of_spikes(file, sink, &record.force);
    }
    for (row, report) in faults.into_iter().take(TOLD) {
        sink.push(report.at(file, line_of(file, row)));
    }
    good
}

/// Every column with its largest number.
fn columns(record: &Record) -> Vec<(&'static str, Vec<Option<f64>>, f64)> {
    let all = |values: &[f64]| values.iter().copied().map(Some).collect::<Vec<_>>();
    let [time, force, length] = MOST;
    let mut out = vec![
        ("time", all(&record.time), time),
        ("displacement", all(&record.displacement), length),
        ("force", all(&record.force), force),
    ];
    let cameras = [
        ("grip_displacement", &record.grip_displacement),
        ("tear_front", &record.tear_front),
        ("width_change", &record.width_change),
    ];
    out.extend(record.force_x.iter().map(|c| ("force_x", c.clone(), force)));
    out.extend(record.displacement_x.iter().map(|u| ("displacement_x", all(u), length)));
    out.extend(cameras.into_iter().filter_map(|(name, c)| Some((name, c.clone()?, length))));
    out
}

/// Where a row stands.
fn line_of(file: &SourceFile, row: usize) -> Range<usize> {
    lines(file).nth(row + 1).unwrap_or(0..0)
}

/// Warns of forces that lie far beyond all others, with neighbours that do not: what a plug pulled out writes.
fn warn_of_spikes(file: &SourceFile, sink: &Sink, force: &[f64]) {
    let spikes = spikes(force);
    for &row in spikes.iter().take(TOLD) {
        let message = format!(
            "the force of this row, {} N, stands alone: neither its neighbours nor any other rows come near it",
            plain(force[row])
        );
        let help =
            "if the load cell was disturbed take the row out; as it stands the fit is pulled towards it";
        sink.push(Report::warning(message).key("force").help(help).at(file, line_of(file, row)));
    }
    if spikes.len() > TOLD {
        let message = format!("… and {} more forces that stand alone", spikes.len() - TOLD);
        sink.push(Report::warning(message).key("force").about(file.path.clone()));
    }
}

/// Rows whose force lies five times as far from the median as 98 % of the rows, and from both neighbours at least half
/// as far.
fn spikes(force: &[f64]) -> Vec<usize> {
    if force.len() < FEWEST {
        return Vec::new();
    }
    let quantile = |values: &[f64], share: f64| {
        let mut sorted = values.to_vec();
        sorted.sort_by(f64::total_cmp);
        sorted[(share * (sorted.len() - 1) as f64) as usize]
    };
    let median = quantile(force, 0.5);
    let away: Vec<f64> = force.iter().map(|f| (f - median).abs()).collect();
    // Of few rows the farthest one is always among the last 2 %: the next one counts.
    let share = 0.98f64.min((force.len() - 2) as f64 / (force.len() - 1) as f64);
    let bound = ALONE * quantile(&away, share);
    let beyond = |i: usize, k: usize| (force[i] - force[k]) * (force[i] - median).signum() >= 0.5 * away[i];
    let alone = |i: usize| (i == 0 || beyond(i, i - 1)) && (i + 1 == force.len() || beyond(i, i + 1));
    (0..force.len()).filter(|&i| bound > 0.0 && away[i] > bound && alone(i)).collect()
}

#[cfg(test)]
mod tests {
    use super::spikes;

    #[test]
    fn one_force_that_stands_alone_is_found_and_a_peak_is_not() {
        let mut force: Vec<f64> = (0..200).map(|i| (f64::from(i) * 0.03).sin().max(0.0)).collect();
        assert!(spikes(&force).is_empty());
        force[70] = 1e6;
        assert_eq!(spikes(&force), [70]);
        force[70] = 0.9;
        force[3] = -8.0;
        assert_eq!(spikes(&force), [3]);
        // A short test in a long record is no spike: it has neighbours.
        let short: Vec<f64> = (0..2000)
            .map(|i: i32| 1e-3 * f64::from(i % 3) + (3.0 - f64::from((i - 900).abs())).max(0.0))
            .collect();
        assert!(spikes(&short).is_empty());
        assert!(spikes(&[0.0, 0.0, 5.0, 0.0]).is_empty());
    }
}
