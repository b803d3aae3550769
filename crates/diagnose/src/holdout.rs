//! Which part of a record is kept back to judge by: whole segments, never single points (neighbours of a
//! smooth curve tell on each other).

use crate::segments::{Segment, SegmentKind};

/// What is kept back.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct HoldOut {
    /// `true` for points that are kept back; length of the record.
    pub mask: Vec<bool>,
    /// Names of the segments.
    pub segments: Vec<String>,
}

/// Keeps back about `share` of a record of `n` points, deterministically: later segments of kinds that occur more
/// than once first (so that every kind is still trained on); where no kind occurs twice, the third fifth of
/// each long segment. Toe and onset are never kept back.
pub fn split(segments: &[Segment], n: usize, share: f64) -> HoldOut {
    let goal = share.clamp(0.0, 0.5) * n as f64;
    let mut mask = vec![false; n];
    let mut names = Vec::new();
    let mut kept = 0.0;
    for (i, s) in segments.iter().enumerate().rev() {
        let trained = |k: SegmentKind| segments[..i].iter().any(|o| o.kind == k);
        let size = s.range.len() as f64;
        let vital = matches!(s.kind, SegmentKind::Toe | SegmentKind::Onset);
        if vital || !trained(s.kind) || kept + size > 1.3 * goal || kept >= goal {
            continue;
        }
        fill(&mut mask, s.range.start, s.range.end);
        names.push(s.name.clone());
        kept += size;
    }
    if names.is_empty() && goal > 0.0 {
        for s in segments.iter().filter(|s| s.range.len() >= 15) {
            let fifth = s.range.len() / 5;
            fill(&mut mask, s.range.start + 2 * fifth, s.range.start + 3 * fifth);
            names.push(format!("middle of {}", s.name));
        }
    }
    names.reverse();
    HoldOut { mask, segments: names }
}

fn fill(mask: &mut [bool], from: usize, to: usize) {
    let to = to.min(mask.len());
    if from < to {
        mask[from..to].fill(true);
    }
}
