//! Corners of a curve: where it turns, stops, changes its rate, or breaks (Douglas & Peucker 1973, doi
//! 10.3138/FM57-6770-U75U-7727, largest deviation first).

use std::cmp::Ordering;
use std::collections::BinaryHeap;

/// A piece between two corners and the point of it that lies farthest from the chord.
struct Stretch {
    deviation: f64,
    from: usize,
    to: usize,
    at: usize,
}

impl Stretch {
    fn new(t: &[f64], x: &[f64], from: usize, to: usize) -> Self {
        let slope = if t[to] > t[from] { (x[to] - x[from]) / (t[to] - t[from]) } else { 0.0 };
        let mut piece = Self { deviation: 0.0, from, to, at: from };
        for i in from + 1..to {
            let d = (x[i] - x[from] - slope * (t[i] - t[from])).abs();
            if d > piece.deviation {
                (piece.deviation, piece.at) = (d, i);
            }
        }
        piece
    }
}

impl PartialEq for Stretch {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}
impl Eq for Stretch {}
impl PartialOrd for Stretch {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}
impl Ord for Stretch {
    fn cmp(&self, other: &Self) -> Ordering {
        self.deviation.total_cmp(&other.deviation).then(other.from.cmp(&self.from))
    }
}

/// Indices of the corners of x(t), both ends among them: no point is farther than `tolerance` from the polygon
/// through them, unless that takes more than `most` corners.
pub(crate) fn corners(t: &[f64], x: &[f64], tolerance: f64, most: usize) -> Vec<usize> {
    let Some(last) = t.len().checked_sub(1) else { return Vec::new() };
    let mut out = vec![0, last];
    let mut open = BinaryHeap::from([Stretch::new(t, x, 0, last)]);
    while let Some(piece) = open.pop() {
        if piece.deviation <= tolerance || out.len() >= most.max(2) {
            break;
        }
        out.push(piece.at);
        open.push(Stretch::new(t, x, piece.from, piece.at));
        open.push(Stretch::new(t, x, piece.at, piece.to));
    }
    out.sort_unstable();
    out.dedup();
    // The first corners were chosen on long chords: on a plateau anywhere. Those that later ones made needless go.
    let mut k = 1;
    while k + 1 < out.len() {
        if Stretch::new(t, x, out[k - 1], out[k + 1]).deviation <= tolerance {
            out.remove(k);
        } else {
            k += 1;
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_triangle_with_a_hold_has_its_corners() {
        let t: Vec<f64> = (0..400).map(f64::from).collect();
        let path = |t: f64| {
            if t < 100.0 {
                t
            } else if t < 250.0 {
                100.0
            } else {
                350.0 - t
            }
        };
        let x: Vec<f64> =
            t.iter().enumerate().map(|(i, t)| path(*t) + 0.01 * (i as f64 * 1.7).sin()).collect();
        let mut x = x;
        // A plateau's highest value is no corner.
        x[170] += 0.05;
        assert_eq!(corners(&t, &x, 0.2, 50), [0, 100, 250, 399]);
        assert_eq!(corners(&t, &x, 0.2, 3).len(), 3);
    }
}
