//! A record cut into named segments: toe, load, hold, unload, reload, rate change, onset, peak, plateau, tail.

use crate::protocol::{LIKE, MotionPart, displacement_noise, pieces};
use serde::Serialize;
use std::ops::Range;

/// What happens in a segment.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum SegmentKind {
    /// First loading while the force is still below 5 % of its peak.
    Toe,
    /// Loading beyond anything before.
    Load,
    /// No motion.
    Hold,
    /// Displacement falls.
    Unload,
    /// Loading again, not yet beyond the largest displacement so far.
    Reload,
    /// Loading beyond anything before at a rate other than just before.
    RateChange,
    /// Tearing: loading between 80 % and 95 % of the peak force, before the peak.
    Onset,
    /// Tearing: loading around the peak, force at least 95 % of it.
    Peak,
    /// Tearing: loading after the peak, force at least half of it.
    Plateau,
    /// Tearing: loading after the peak, force below half of it.
    Tail,
}

impl SegmentKind {
    /// The word used in names.
    pub fn word(self) -> &'static str {
        match self {
            Self::Toe => "toe",
            Self::Load => "load",
            Self::Hold => "hold",
            Self::Unload => "unload",
            Self::Reload => "reload",
            Self::RateChange => "rate change",
            Self::Onset => "onset",
            Self::Peak => "peak",
            Self::Plateau => "plateau",
            Self::Tail => "tail",
        }
    }

    fn always_numbered(self) -> bool {
        matches!(self, Self::Load | Self::Hold | Self::Unload | Self::Reload | Self::RateChange)
    }
}

/// The kind of test, as far as naming needs it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RecordKind {
    /// Intact strip: no onset, peak, plateau or tail.
    Intact,
    /// A specimen that tears.
    Tearing,
}

/// A named stretch of a record.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Segment {
    /// `hold 1`.
    pub name: String,
    /// Points; segments tile the record.
    pub range: Range<usize>,
    /// What happens there.
    pub kind: SegmentKind,
}

/// Cuts a record (time in any unit and increasing, displacement, force, one value per point) into segments
/// that tile it. Lengths beyond the shortest of the three are ignored; fewer than two points give none.
pub fn cut(time: &[f64], displacement: &[f64], force: &[f64], kind: RecordKind) -> Vec<Segment> {
    let n = time.len().min(displacement.len()).min(force.len());
    let (t, u, f) = (&time[..n], &displacement[..n], &force[..n]);
    if n < 2 {
        return Vec::new();
    }
    let parts = pieces(t, u);
    let mut labels = label_motion(t, u, &parts);
    let peak = peak_of_loading(f, &labels);
    match kind {
        RecordKind::Intact => mark_toe(f, &mut labels, peak),
        RecordKind::Tearing => {
            mark_tearing(f, &mut labels, peak);
            mark_toe(f, &mut labels, peak);
        }
    }
    name(&labels, &parts)
}

/// Indices at which a new smooth stretch begins: the breaks that [`crate::noise::estimate`] wants.
pub fn breaks(time: &[f64], displacement: &[f64]) -> Vec<usize> {
    let n = time.len().min(displacement.len());
    pieces(&time[..n], &displacement[..n]).iter().skip(1).map(|p| p.range.start).collect()
}

fn label_motion(t: &[f64], u: &[f64], parts: &[MotionPart]) -> Vec<SegmentKind> {
    let (low, high) = u.iter().fold((f64::MAX, f64::MIN), |(a, b), &x| (a.min(x), b.max(x)));
    let slack = (3.0 * displacement_noise(t, u)).max(2e-3 * (high - low));
    let mut labels = vec![SegmentKind::Load; u.len()];
    let mut reached = f64::MIN;
    let mut virgin_rate: Option<f64> = None;
    for piece in parts {
        let start_max = reached;
        let mut in_virgin = false;
        for i in piece.range.clone() {
            labels[i] = if piece.hold {
                SegmentKind::Hold
            } else if piece.rate < 0.0 {
                SegmentKind::Unload
            } else if u[i] < start_max - slack {
                SegmentKind::Reload
            } else {
                in_virgin = true;
                let changed = virgin_rate.is_some_and(|r| !LIKE.contains(&(piece.rate / r)));
                if changed { SegmentKind::RateChange } else { SegmentKind::Load }
            };
            reached = reached.max(u[i]);
        }
        if in_virgin {
            virgin_rate = Some(piece.rate);
        }
    }
    labels
}

fn is_virgin(kind: SegmentKind) -> bool {
    matches!(kind, SegmentKind::Load | SegmentKind::RateChange)
}

fn peak_of_loading(f: &[f64], labels: &[SegmentKind]) -> usize {
    (0..f.len())
        .filter(|&i| is_virgin(labels[i]))
        .max_by(|&a, &b| f[a].total_cmp(&f[b]).then(b.cmp(&a)))
        .unwrap_or(0)
}

/// At least four points of first loading below 5 % of the peak, and at most half of the first loading.
fn mark_toe(f: &[f64], labels: &mut [SegmentKind], peak: usize) {
    let first = labels.iter().position(|&k| k != SegmentKind::Load).unwrap_or(labels.len());
    let top = f.get(peak).copied().unwrap_or(0.0);
    let end = (0..first).rev().find(|&i| f[i] < 0.05 * top).map_or(0, |i| i + 1).min(first / 2);
    if end >= 4 {
        labels[..end].fill(SegmentKind::Toe);
    }
}

fn mark_tearing(f: &[f64], labels: &mut [SegmentKind], peak: usize) {
    let top = f.get(peak).copied().unwrap_or(0.0);
    let virgin: Vec<usize> = (0..f.len()).filter(|&i| is_virgin(labels[i])).collect();
    let Some(at) = virgin.iter().position(|&i| i == peak) else { return };
    if top <= 0.0 {
        return;
    }
    let before = |share: f64| virgin[..at].iter().rposition(|&i| f[i] < share * top).map_or(0, |p| p + 1);
    let (onset, near) = (before(0.80), before(0.95));
    let after =
        |share: f64| virgin[at..].iter().position(|&i| f[i] < share * top).map_or(virgin.len(), |p| at + p);
    let (over, tail) =
        (after(0.95), virgin.len() - virgin[at..].iter().rev().take_while(|&&i| f[i] < 0.5 * top).count());
    for (p, &i) in virgin.iter().enumerate() {
        labels[i] = if p < onset {
            continue;
        } else if p < near {
            SegmentKind::Onset
        } else if p < over {
            SegmentKind::Peak
        } else if p < tail {
            SegmentKind::Plateau
        } else {
            SegmentKind::Tail
        };
    }
}

/// Runs of one label within one piece (loading goes on across pieces of one rate), tiny ones joined to the
/// segment before, then numbered.
fn name(labels: &[SegmentKind], parts: &[MotionPart]) -> Vec<Segment> {
    let starts: Vec<usize> = parts.iter().map(|p| p.range.start).collect();
    let mut runs: Vec<(SegmentKind, Range<usize>)> = Vec::new();
    for (i, &kind) in labels.iter().enumerate() {
        match runs.last_mut() {
            Some((k, r)) if *k == kind && !starts.contains(&i) => r.end = i + 1,
            Some((_, r)) if tiny(labels, i) && !starts.contains(&i) => r.end = i + 1,
            _ => runs.push((kind, i..i + 1)),
        }
    }
    let total = |kind| runs.iter().filter(|r| r.0 == kind).count();
    let counts: Vec<usize> = runs.iter().map(|r| total(r.0)).collect();
    let mut seen: Vec<SegmentKind> = Vec::new();
    runs.into_iter()
        .zip(counts)
        .map(|((kind, range), count)| {
            seen.push(kind);
            let number = seen.iter().filter(|&&k| k == kind).count();
            let word = kind.word();
            let name = if kind.always_numbered() || count > 1 {
                format!("{word} {number}")
            } else {
                word.to_owned()
            };
            Segment { name, range, kind }
        })
        .collect()
}

/// Whether the run of equal labels around i has fewer than three points.
fn tiny(labels: &[SegmentKind], i: usize) -> bool {
    let same = |j: &usize| labels[*j] == labels[i];
    let back = (0..i).rev().take_while(same).count();
    let ahead = (i..labels.len()).take_while(same).count();
    back + ahead < 3
}
