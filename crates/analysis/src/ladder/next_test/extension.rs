//! What could be added to a protocol: segments at the end of a uniaxial test or in the middle of a tear, and camera
//! channels on the tests as they are.

use input::{Case, Record, Test};
use model::Channel;
use std::ops::Range;

/// Length of holds and rests, s.
const HOLD: f64 = 300.0;

/// How much faster or slower an added cycle is.
const FASTER: f64 = 10.0;

/// Rows of an added leg: at the record's own interval, but no fewer and no more than these.
const ROWS: Range<usize> = 20..100;

/// Noise that a camera is taken to have, mm: of edges and of a width, and of a tear front.
const CAMERA_SD: f64 = 0.01;
const FRONT_SD: f64 = 0.1;

/// More data from one test.
pub(crate) struct Part {
    /// Index of the test.
    pub test: usize,
    /// Its record with the added rows; what is measured there does not matter.
    pub record: Record,
    /// What is measured.
    pub channel: Channel,
    /// The rows that are new.
    pub rows: Range<usize>,
    /// Noise where the records at hand tell none.
    pub sd: Option<f64>,
}

/// Something to add to the tests of the next piece.
pub(crate) struct Extension {
    /// In words.
    pub words: String,
    /// How much longer the tests get, s.
    pub seconds: f64,
    /// The data it brings.
    pub parts: Vec<Part>,
}

/// A leg of motion.
enum Leg {
    /// To a displacement, mm, at a rate, mm/s.
    To(f64, f64),
    /// At rest, s.
    Hold(f64),
}

/// All that is tried.
pub(crate) fn extensions(case: &Case) -> Vec<Extension> {
    let tests = || case.tests.iter().enumerate().filter_map(|(i, t)| Some((i, t, t.record.as_ref()?)));
    let mut list: Vec<Extension> = tests().flat_map(|(i, t, r)| segments(i, t, r)).collect();
    list.extend(cameras(&tests().collect::<Vec<_>>()));
    list
}

/// Segments for one test.
fn segments(index: usize, test: &Test, record: &Record) -> Vec<Extension> {
    let Some((rate, interval)) = pace(record) else { return Vec::new() };
    let top = record.displacement.iter().fold(0.0f64, |m, u| m.max(*u));
    let name = &test.name;
    let (keep, at, proposals) = if test.kind.tears {
        let keep = middle(record);
        let at = record.displacement[keep - 1];
        (keep, format!("in the test {name}, at {at:.3} mm"), in_a_tear(at, top, rate))
    } else {
        let end = format!("after the test {name}");
        (record.len(), end, after_a_uniaxial(top, rate))
    };
    let extension = |(what, legs): (String, Vec<Leg>)| {
        let mut longer = record.clone();
        longer.truncate(keep);
        let seconds = legs.iter().map(|l| run(l, &mut longer, interval)).sum();
        let rows = keep..longer.len();
        let part = Part { test: index, record: longer, channel: Channel::Force, rows, sd: None };
        Extension { words: format!("{at}: {what}"), seconds, parts: vec![part] }
    };
    proposals.into_iter().map(extension).collect()
}

fn after_a_uniaxial(top: f64, rate: f64) -> Vec<(String, Vec<Leg>)> {
    use Leg::{Hold, To};
    let beyond = 1.15 * top;
    vec![
        (format!("a hold of {HOLD:.0} s at {top:.3} mm"), vec![To(top, rate), Hold(HOLD)]),
        (
            format!("a cycle to {top:.3} mm at {FASTER:.0} times the rate"),
            vec![To(0.0, rate), To(top, FASTER * rate), To(0.0, FASTER * rate)],
        ),
        (
            format!("a pull to {top:.3} mm at 1/{FASTER:.0} of the rate"),
            vec![To(0.0, rate), To(top, rate / FASTER)],
        ),
        (
            format!("a rest of {HOLD:.0} s at 0 mm, and a pull to {top:.3} mm"),
            vec![To(0.0, rate), Hold(HOLD), To(top, rate)],
        ),
        (
            format!("a cycle and a pull to {beyond:.3} mm, beyond the largest displacement so far"),
            vec![To(beyond, rate), To(0.0, rate), To(beyond, rate)],
        ),
    ]
}

fn in_a_tear(at: f64, top: f64, rate: f64) -> Vec<(String, Vec<Leg>)> {
    use Leg::{Hold, To};
    let on = at + 0.1 * top;
    let cycles = (0..5).flat_map(|_| [To(0.7 * at, rate), To(at, rate)]).collect();
    vec![
        (
            format!("an unloading to {:.3} mm, and on", 0.3 * at),
            vec![To(0.3 * at, rate), To(at, rate), To(on, rate)],
        ),
        (format!("a hold of {HOLD:.0} s, and on"), vec![Hold(HOLD), To(on, rate)]),
        (format!("on at {FASTER:.0} times the rate"), vec![To(on, FASTER * rate)]),
        (format!("five cycles between {:.3} and {at:.3} mm", 0.7 * at), cycles),
    ]
}

/// Channels that no test has yet.
fn cameras(tests: &[(usize, &Test, &Record)]) -> Vec<Extension> {
    let on = |channel: Channel, words: &str, sd: f64| {
        let lacks = |r: &Record| channel.of(r).is_empty();
        let parts: Vec<Part> = tests
            .iter()
            .filter(|(_, t, r)| t.kind.measures(channel.word()) && lacks(r))
            .map(|(i, _, r)| {
                let (mut record, rows) = ((*r).clone(), 0..r.len());
                let empty = Some(vec![Some(0.0); r.len()]);
                match channel {
                    Channel::GripDisplacement => record.grip_displacement = empty,
                    Channel::TearFront => record.tear_front = empty,
                    Channel::WidthChange => record.width_change = empty,
                    Channel::Force | Channel::ForceX => {}
                }
                Part { test: *i, record, channel, rows, sd: Some(sd) }
            })
            .collect();
        let words = format!("the same tests with a camera on {words} (noise {sd} mm)");
        (!parts.is_empty()).then_some(Extension { words, seconds: 0.0, parts })
    };
    [
        on(Channel::GripDisplacement, "the clamped edges, grip_displacement_mm", CAMERA_SD),
        on(Channel::TearFront, "the tear, tear_front_mm", FRONT_SD),
        on(Channel::WidthChange, "the strip's width, width_change_mm", CAMERA_SD),
    ]
    .into_iter()
    .flatten()
    .collect()
}

/// Typical rate of the motion, mm/s, and typical interval of rows, s.
fn pace(r: &Record) -> Option<(f64, f64)> {
    let middle = |mut v: Vec<f64>| {
        v.sort_by(f64::total_cmp);
        v.get(v.len() / 2).copied()
    };
    let steps: Vec<(f64, f64)> = (1..r.len())
        .map(|i| (r.time[i] - r.time[i - 1], (r.displacement[i] - r.displacement[i - 1]).abs()))
        .collect();
    let interval = middle(steps.iter().map(|s| s.0).collect())?;
    let most = steps.iter().fold(0.0f64, |m, s| m.max(s.1 / s.0));
    let rate = middle(steps.iter().map(|s| s.1 / s.0).filter(|v| *v > 0.05 * most).collect())?;
    (rate > 0.0 && interval > 0.0).then_some((rate, interval))
}

/// Number of rows up to half way from the largest force to the largest displacement.
fn middle(r: &Record) -> usize {
    let peak = (0..r.len()).fold(0, |m, i| if r.force[i] > r.force[m] { i } else { m });
    let top = r.displacement.iter().fold(0.0f64, |m, u| m.max(*u));
    let half = 0.5 * (r.displacement[peak] + top);
    r.displacement.iter().position(|u| *u >= half).map_or(r.len(), |i| i + 1)
}

/// Appends a leg's rows; its duration, s.
fn run(leg: &Leg, record: &mut Record, interval: f64) -> f64 {
    let last = record.len() - 1;
    let (t0, u0) = (record.time[last], record.displacement[last]);
    let (to, seconds) = match *leg {
        Leg::To(u, rate) => (u, (u - u0).abs() / rate),
        Leg::Hold(s) => (u0, s),
    };
    if seconds <= 0.0 {
        return 0.0;
    }
    let rows = ((seconds / interval).round() as usize).clamp(ROWS.start, ROWS.end);
    for k in 1..=rows {
        let share = k as f64 / rows as f64;
        record.time.push(t0 + share * seconds);
        record.displacement.push(u0 + share * (to - u0));
        record.force.push(0.0);
        // In proportion, as the record was until here.
        let ratio = ratio_of(record);
        record.displacement_x.iter_mut().for_each(|x| x.push(ratio * (u0 + share * (to - u0))));
        for channel in record.measured_beside() {
            channel.iter_mut().for_each(|c| c.push(None));
        }
        record.segment.iter_mut().for_each(|s| s.push("added".into()));
    }
    seconds
}

/// Displacement of the second axis over that of the first, at the largest of the first.
fn ratio_of(record: &Record) -> f64 {
    let u = &record.displacement;
    let largest = (0..u.len()).max_by(|a, b| u[*a].abs().total_cmp(&u[*b].abs()));
    let at = |k: usize| record.displacement_x.as_ref()?.get(k).map(|x| x / u[k]);
    largest.and_then(at).filter(|r| r.is_finite()).unwrap_or_default()
}
