//! Corners of the actuator's motion: where a leg of the protocol, or of what was measured, ends.

use super::path::{At, encoder_noise, simplified};
use input::{Leg, Record};

/// A record of more rows is simplified before its corners are looked for.
const PLAIN_ROWS: usize = 1000;

/// So is one whose displacement is noisier than this share of its mean travel from row to row: a rate from two rows
/// would say nothing.
const NOISY: f64 = 2e-3;

/// A corner of the actuator's motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Corner {
    /// Time, s.
    pub time: f64,
    /// Displacement, mm.
    pub displacement: f64,
}

/// Corners of a protocol, from displacement 0.
pub fn corners_of_protocol(legs: &[Leg]) -> Vec<Corner> {
    let mut at = Corner { time: 0.0, displacement: 0.0 };
    let mut out = vec![at];
    for leg in legs {
        match *leg {
            Leg::Ramp { to_mm, rate_mm_per_s } => {
                let travel: f64 = to_mm - at.displacement;
                if travel == 0.0 {
                    continue;
                }
                at = Corner { time: at.time + travel.abs() / rate_mm_per_s, displacement: to_mm };
            }
            Leg::Hold { hold_s } => {
                if hold_s == 0.0 {
                    continue;
                }
                at.time += hold_s;
            }
        }
        out.push(at);
    }
    out
}

/// Corners of a measured motion: turns, starts and ends of holds, lasting changes of rate.
/// Small reversals (noise of the displacement signal) are no corners, and where there is such noise, or a record is
/// long, corners lie on the lines through the rows beside them. How many rows a motion was recorded with does not matter.
pub fn corners_of_record(record: &Record) -> Vec<Corner> {
    corner_rows(record).into_iter().map(|c| c.1).collect()
}

/// The same with the row that each corner stands at.
pub fn corner_rows(record: &Record) -> Vec<At> {
    let (t, u) = (&record.time, &record.displacement);
    let n = t.len();
    if n < 2 {
        return (0..n).map(|i| (i, Corner { time: t[i], displacement: u[i] })).collect();
    }
    let travel: f64 = u.windows(2).map(|w| (w[1] - w[0]).abs()).sum();
    if n <= PLAIN_ROWS && encoder_noise(t, u) <= NOISY * travel / (n - 1) as f64 {
        return plain(t, u);
    }
    let corners = simplified(t, u);
    // One leg has no corner that its noise could move: its ends stay what was measured.
    if n <= PLAIN_ROWS && corners.len() == 2 && u[0] == 0.0 {
        return [0, n - 1].map(|i| (i, Corner { time: t[i], displacement: u[i] })).to_vec();
    }
    corners
}

/// Corners of a clean record, exactly at its rows.
fn plain(t: &[f64], u: &[f64]) -> Vec<At> {
    let n = t.len();
    let corner = |i: usize| (i, Corner { time: t[i], displacement: u[i] });
    let range = u.iter().fold(f64::MIN, |m, x| m.max(*x)) - u.iter().fold(f64::MAX, |m, x| m.min(*x));
    let travel: f64 = u.windows(2).map(|w| (w[1] - w[0]).abs()).sum();
    let typical = travel / (t[n - 1] - t[0]);
    // Class of each interval: hold, forth, back.
    let class: Vec<i8> = (0..n - 1)
        .map(|i| {
            let v = (u[i + 1] - u[i]) / (t[i + 1] - t[i]);
            if v.abs() < 0.01 * typical {
                0
            } else if v > 0.0 {
                1
            } else {
                -1
            }
        })
        .collect();
    let mut runs: Vec<(i8, usize, usize)> = Vec::new();
    for (i, &c) in class.iter().enumerate() {
        match runs.last_mut() {
            Some(r) if r.0 == c => r.2 = i + 1,
            _ => runs.push((c, i, i + 1)),
        }
    }
    absorb_small(&mut runs, u, t, 0.004 * range);
    let mut cuts = vec![0];
    for &(c, a, b) in &runs {
        if c != 0 {
            cuts.extend(rate_changes(t, u, a, b));
        }
        cuts.push(b);
    }
    cuts.dedup();
    cuts.into_iter().map(corner).collect()
}

/// Runs that travel next to nothing (and are no true hold) join their neighbours.
fn absorb_small(runs: &mut Vec<(i8, usize, usize)>, u: &[f64], t: &[f64], small: f64) {
    let duration = t[t.len() - 1] - t[0];
    let mut i = 0;
    while i < runs.len() && runs.len() > 1 {
        let (c, a, b) = runs[i];
        let tiny =
            if c == 0 { b - a < 3 && t[b] - t[a] < 0.01 * duration } else { (u[b] - u[a]).abs() < small };
        let merge_back = i > 0 && (i + 1 >= runs.len() || runs[i - 1].0 != 0);
        if tiny && merge_back {
            runs[i - 1].2 = b;
            runs.remove(i);
            if i < runs.len() && runs[i].0 == runs[i - 1].0 {
                runs[i - 1].2 = runs[i].2;
                runs.remove(i);
            }
        } else if tiny && i + 1 < runs.len() {
            runs[i + 1].1 = a;
            runs.remove(i);
        } else {
            i += 1;
        }
    }
}

/// Points where the rate changes by more than a factor 2 and stays changed.
fn rate_changes(t: &[f64], u: &[f64], a: usize, b: usize) -> Vec<usize> {
    let rate = |i: usize, j: usize| ((u[j] - u[i]) / (t[j] - t[i])).abs();
    let mut out = Vec::new();
    let mut start = a;
    let mut i = a + 3;
    while i + 3 <= b {
        let (before, after) = (rate(start.max(i.saturating_sub(8)), i), rate(i, (i + 3).min(b)));
        let next = rate(i, i + 1);
        let jump = |r: f64| !r.is_nan() && !(0.5..=2.0).contains(&r);
        if jump(after / before) && jump(next / before) {
            out.push(i);
            start = i;
            i += 3;
        } else {
            i += 1;
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    fn record(points: &[(f64, f64)]) -> Record {
        Record {
            time: points.iter().map(|p| p.0).collect(),
            displacement: points.iter().map(|p| p.1).collect(),
            force: vec![0.0; points.len()],
            ..Record::default()
        }
    }

    #[test]
    fn corners_are_turns_holds_and_rate_changes() {
        let mut points = Vec::new();
        let legs = [(0.0, 0.0), (20.0, 1.0), (40.0, 0.0), (42.0, 1.0), (100.0, 1.0), (120.0, 0.0)];
        for w in legs.windows(2) {
            for i in 0..40 {
                let s = f64::from(i) / 40.0;
                points.push((w[0].0 + s * (w[1].0 - w[0].0), w[0].1 + s * (w[1].1 - w[0].1)));
            }
        }
        points.push(legs[5]);
        let corners = corners_of_record(&record(&points));
        let found: Vec<(f64, f64)> = corners.iter().map(|c| (c.time, c.displacement)).collect();
        assert_eq!(found, legs);
    }

    #[test]
    fn noise_of_the_motion_makes_no_corners() {
        let points: Vec<(f64, f64)> = (0..200)
            .map(|i| (f64::from(i), 0.1 * f64::from(i) + 0.02 * f64::from(i * 7919 % 13 - 6) / 6.0))
            .collect();
        assert_eq!(corners_of_record(&record(&points)).len(), 2);
    }
}
