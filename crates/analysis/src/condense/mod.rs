//! Long records brought to the points that carry information.
//!
//! A model's answer is smooth between the corners of the motion, so what hundreds of rows tell about a short stretch is
//! their mean. Corners stay single rows; stretches between them are averaged evenly on ramps and evenly in the logarithm
//! of time in holds, never across a corner, a change of the user's segment or a jump of the force. How much surer a mean
//! is than a row is taken from the record: independent errors average out, slow ones do not.

mod weights;

pub(crate) use weights::{position, spread, typical, weights};

use diagnose::noise::{Averages as Weights, NoiseError, NoiseEstimate, estimate, estimate_averages};
use input::{Averaged, Case, Record};
use model::{Channel, Corner, corner_rows};
use std::ops::Range;
use std::sync::Arc;
use weights::Whole;

/// Records of no more rows stay as they are.
const PLAIN_ROWS: usize = 1000;
/// Points of all ramps of a record, about.
const POINTS: f64 = 400.0;
/// Fewest points of a ramp.
const RAMP: f64 = 8.0;
/// Points of a hold, and of all holds together, about.
const HOLD: usize = 32;
const HOLDS: usize = 320;
/// Points are wider by this where their noise asks for it; still wider ones would round a tear's peak.
const WIDER: usize = 2;
/// Correlation of neighbours from which it is asked whether it ends sooner than an autoregressive one's.
const CORRELATED: f64 = 0.5;
/// How much less correlated wider points must be than an autoregressive noise's would be: about what an estimate errs.
const SOONER: f64 = 0.1;
/// A force that changes from row to row by more than this share of its peak and this many times the usual is a jump.
const JUMP_SHARE: f64 = 0.02;
const JUMP_RATIO: f64 = 12.0;
/// More jumps than that are noise.
const JUMPS: usize = 50;

/// The case with its long records averaged; the same where there are none.
pub fn condensed(case: &Arc<Case>) -> Arc<Case> {
    let long = |r: &Record| r.averaged.is_none() && r.len() > PLAIN_ROWS;
    if !case.tests.iter().any(|t| t.record.as_ref().is_some_and(long)) {
        return case.clone();
    }
    let mut out = (**case).clone();
    for test in &mut out.tests {
        if let Some(record) = test.record.as_ref().filter(|r| long(r)) {
            test.record = Some(condense(record, &edges(test, record)));
        }
    }
    Arc::new(out)
}

/// Rows at which the weight of a test's record changes.
fn edges(test: &input::Test, record: &Record) -> Vec<usize> {
    let weight = |i: usize| test.weight_at(record.time[i]);
    (1..record.len()).filter(|&i| weight(i) != weight(i - 1)).collect()
}

/// The noise of the force at the points that a fit sees, and how many they are.
pub(crate) fn force_noise(
    record: &Record,
    corners: &[(usize, Corner)],
) -> (Result<NoiseEstimate, NoiseError>, usize) {
    if record.len() <= PLAIN_ROWS {
        let breaks: Vec<usize> = corners.iter().map(|c| c.0).collect();
        return (estimate(&record.time, &record.force, &breaks), record.len());
    }
    let points = condense(record, &[]);
    let averages = points.averaged.as_ref().map(|a| a.channels[0].clone()).unwrap_or_default();
    let (spread, position) = (spread(&averages.readings), position(&averages.readings));
    let weights = Weights { spread: &spread, position: &position };
    let breaks: Vec<usize> = corners.iter().map(|c| points.time.partition_point(|t| *t < c.1.time)).collect();
    (estimate_averages(&points.time, &points.force, weights, &breaks), points.len())
}

/// A point: rows that are averaged, and where the point stands where no mean tells it.
struct Bin {
    rows: Range<usize>,
    /// The corner, or the level of a hold.
    displacement: Option<f64>,
    /// The start of the hold that the point lies in, s.
    hold_since: Option<f64>,
}

/// Points of about the usual number, or wider ones: where rows share their errors over a stretch and no farther (a filter,
/// an interpolation), close points look like an autoregressive noise whose memory is much longer, and would say less
/// than they do. Points as wide as that stretch have errors of their own.
/// No point stands across one of the `edges`.
fn condense(record: &Record, edges: &[usize]) -> Record {
    let corners = corner_rows(record);
    let whole = Whole::new(record, &corners, edges);
    let (points, noise) = condensed_to(&whole, 1);
    let Some(close) = noise.map(|n| n.ar1).filter(|c| *c > CORRELATED) else { return points };
    let (wide, noise) = condensed_to(&whole, WIDER);
    // Means of two neighbours of an autoregressive noise would be correlated as much as this.
    let expected = 0.5 * close * (1.0 + close);
    match noise.map(|n| n.ar1) {
        Some(apart) if apart < expected - SOONER => wide,
        _ => points,
    }
}

/// Points `wider` times as wide as usual, and the noise of the force at them.
fn condensed_to(whole: &Whole, wider: usize) -> (Record, Option<NoiseEstimate>) {
    let record = whole.record;
    let bins = bins(record, whole.corners, wider, whole.edges);
    let mean = |rows: &Range<usize>, v: &[f64]| v[rows.clone()].iter().sum::<f64>() / rows.len() as f64;
    let time = |b: &Bin| match b.hold_since {
        // A force that relaxes is even in the logarithm of time.
        Some(since) if b.rows.len() > 1 => {
            let logs: f64 = b.rows.clone().map(|i| (record.time[i] - since).ln()).sum();
            since + (logs / b.rows.len() as f64).exp()
        }
        _ => mean(&b.rows, &record.time),
    };
    let mut out = Record {
        path: record.path.clone(),
        time: bins.iter().map(time).collect(),
        displacement: bins
            .iter()
            .map(|b| b.displacement.unwrap_or_else(|| mean(&b.rows, &record.displacement)))
            .collect(),
        force: bins.iter().map(|b| mean(&b.rows, &record.force)).collect(),
        segment: record
            .segment
            .as_ref()
            .map(|s| bins.iter().map(|b| s[b.rows.start + b.rows.len() / 2].clone()).collect()),
        ..Record::default()
    };
    let camera = |channel: &Option<Vec<Option<f64>>>| {
        channel.as_ref().map(|c| camera_means(record, c, &bins, &out.time))
    };
    out.grip_displacement = camera(&record.grip_displacement);
    out.tear_front = camera(&record.tear_front);
    out.width_change = camera(&record.width_change);
    out.force_x = camera(&record.force_x);
    out.displacement_x =
        record.displacement_x.as_ref().map(|x| bins.iter().map(|b| mean(&b.rows, x)).collect());
    let all = Channel::ALL.map(|channel| weights::averages(whole, &out, channel, &bins));
    let noise = all[0].1;
    out.averaged = Some(Averaged { rows: record.len(), channels: all.map(|a| a.0) });
    (out, noise)
}

/// Points of a record, in order, every row in one of them.
fn bins(record: &Record, corners: &[(usize, Corner)], wider: usize, edges: &[usize]) -> Vec<Bin> {
    let travel = |w: &[(usize, Corner)]| (w[1].1.displacement - w[0].1.displacement).abs();
    let way: f64 = corners.windows(2).map(travel).sum();
    let holds = corners.windows(2).filter(|w| travel(w) == 0.0).count().max(1);
    let mut breaks = breaks(record);
    breaks.extend(edges);
    breaks.sort_unstable();
    breaks.dedup();
    let single = |c: &(usize, Corner)| Bin {
        rows: c.0..c.0 + 1,
        displacement: Some(c.1.displacement),
        hold_since: None,
    };
    let mut out: Vec<Bin> = corners.first().map(single).into_iter().collect();
    for w in corners.windows(2) {
        let inside = w[0].0 + 1..w[1].0;
        let hold = travel(w) == 0.0;
        let points = if hold {
            (HOLDS / holds).clamp(8, HOLD)
        } else {
            (POINTS / wider as f64 * travel(w) / way).max(RAMP).ceil() as usize
        };
        for part in parts(inside.clone(), &breaks) {
            let share = (points as f64 * part.len() as f64 / inside.len() as f64).ceil() as usize;
            let rows = if hold && part == inside { log_even(part, share) } else { even(part, share) };
            let bin = |rows| Bin {
                rows,
                displacement: hold.then_some(w[0].1.displacement),
                hold_since: hold.then_some(record.time[w[0].0]),
            };
            out.extend(rows.into_iter().map(bin));
        }
        out.push(single(&w[1]));
    }
    out
}

/// A range cut at the breaks inside it.
fn parts(range: Range<usize>, breaks: &[usize]) -> Vec<Range<usize>> {
    let inside = breaks.iter().copied().filter(|b| range.start < *b && *b < range.end);
    let edges: Vec<usize> = [range.start].into_iter().chain(inside).chain([range.end]).collect();
    edges.windows(2).map(|w| w[0]..w[1]).filter(|r| !r.is_empty()).collect()
}

/// Rows at which a mean must end: changes of the user's segment, jumps of the force.
fn breaks(record: &Record) -> Vec<usize> {
    let mut out: Vec<usize> = match &record.segment {
        Some(names) => (1..names.len()).filter(|&i| names[i] != names[i - 1]).collect(),
        None => Vec::new(),
    };
    let f = &record.force;
    let steps: Vec<f64> = f.windows(2).map(|w| (w[1] - w[0]).abs()).collect();
    let mut sorted = steps.clone();
    let middle = sorted.len() / 2;
    let usual = *sorted.select_nth_unstable_by(middle, f64::total_cmp).1;
    let peak = f.iter().fold(0.0f64, |m, f| m.max(f.abs()));
    let least = (JUMP_RATIO * usual).max(JUMP_SHARE * peak);
    let jumps: Vec<usize> = (1..f.len()).filter(|&i| steps[i - 1] > least).collect();
    if jumps.len() <= JUMPS {
        out.extend(jumps);
    }
    out.sort_unstable();
    out.dedup();
    out
}

/// A range in equal parts; single rows where there are not enough.
fn even(range: Range<usize>, points: usize) -> Vec<Range<usize>> {
    let (n, points) = (range.len(), points.clamp(1, range.len().max(1)));
    let edge = |k: usize| range.start + k * n / points;
    (0..points).map(|k| edge(k)..edge(k + 1)).filter(|r| !r.is_empty()).collect()
}

/// A range in parts that grow in proportion to the rows before them, each of a row at least.
fn log_even(range: Range<usize>, points: usize) -> Vec<Range<usize>> {
    let n = range.len();
    let mut edges: Vec<usize> = Vec::new();
    for k in 0..=points {
        let at = ((n + 1) as f64).powf(k as f64 / points as f64).round() as usize - 1;
        edges.push(range.start + at.min(n));
    }
    edges.dedup();
    edges.windows(2).map(|w| w[0]..w[1]).collect()
}

/// Means of a camera channel at the times of the points. Cameras are slower than load cells: frames need not lie evenly
/// about a point's time, so each mean is moved there along the slope through its neighbours.
fn camera_means(record: &Record, channel: &[Option<f64>], bins: &[Bin], time: &[f64]) -> Vec<Option<f64>> {
    let frames = |b: &Bin| {
        let (mut n, mut t, mut v) = (0.0, 0.0, 0.0);
        for (i, x) in b.rows.clone().filter_map(|i| channel[i].map(|x| (i, x))) {
            (n, t, v) = (n + 1.0, t + record.time[i], v + x);
        }
        (n > 0.0).then_some((t / n, v / n))
    };
    let means: Vec<Option<(f64, f64)>> = bins.iter().map(frames).collect();
    (0..bins.len())
        .map(|i| {
            let (t, v) = means[i]?;
            // Not beyond a corner: the slope is another there.
            let corner = |j: &usize| bins[*j].displacement.is_some() && bins[*j].hold_since.is_none();
            let ahead = if corner(&i) { i } else { (i + 1..bins.len()).find(corner).unwrap_or(i) };
            let behind = if corner(&i) { i } else { (0..i).rev().find(corner).unwrap_or(i) };
            let a = (behind..i).rev().find_map(|j| means[j]).unwrap_or((t, v));
            let b = (i + 1..=ahead).find_map(|j| means[j]).unwrap_or((t, v));
            let slope = if b.0 > a.0 { (b.1 - a.1) / (b.0 - a.0) } else { 0.0 };
            Some(v + slope * (time[i] - t))
        })
        .collect()
}
