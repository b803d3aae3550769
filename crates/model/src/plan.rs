//! From a record or a protocol to the steps of a run, and back from steps to record points.
//!
//! A test is cut into **pieces** on which the force is smooth: ramps and holds, and a reload is cut
//! again where it passes the largest displacement so far. Targets lie on one displacement grid, so
//! that an unload and its reload visit the same states. Record points are interpolated inside their
//! piece by a cubic through the nearest steps; nothing is interpolated across a turn or a jump.

use fem::{Run, Target};
use input::{Leg, Record};

/// How a test is stepped.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stepping {
    /// Grid lines over the range of displacement.
    pub steps: usize,
    /// Whether a hold needs steps of its own (some law looks at time).
    pub holds: bool,
}

/// A stretch of a test on which the force is smooth.
#[derive(Clone, Debug, PartialEq)]
pub struct Piece {
    /// Time at its ends, s.
    pub time: [f64; 2],
    /// Displacement at its ends, mm.
    pub displacement: [f64; 2],
    /// First and last target (the first is the last of the piece before).
    pub targets: [usize; 2],
    /// Which leg of the protocol it belongs to.
    pub leg: usize,
}

impl Piece {
    /// Whether the actuator stands still.
    pub fn is_hold(&self) -> bool {
        self.displacement[0] == self.displacement[1]
    }
    fn abscissa(&self, time: f64, displacement: f64) -> f64 {
        if self.is_hold() {
            time.clamp(self.time[0], self.time[1])
        } else {
            let (a, b) = (self.displacement[0], self.displacement[1]);
            displacement.clamp(a.min(b), a.max(b))
        }
    }
}

/// Steps of a test and the pieces they belong to.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Plan {
    /// Targets, the first one at the start.
    pub targets: Vec<Target>,
    /// Time of each target since the start of the test, s.
    pub times: Vec<f64>,
    /// Pieces in order.
    pub pieces: Vec<Piece>,
}

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
/// Small reversals (noise of the displacement signal) are no corners.
pub fn corners_of_record(record: &Record) -> Vec<Corner> {
    let (t, u) = (&record.time, &record.displacement);
    let n = t.len();
    let corner = |i: usize| Corner { time: t[i], displacement: u[i] };
    if n < 2 {
        return (0..n).map(corner).collect();
    }
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

/// Pieces and targets for an identification.
pub fn plan(corners: &[Corner], how: Stepping) -> Plan {
    let Some(first) = corners.first() else { return Plan::default() };
    let lowest = corners.iter().fold(f64::MAX, |m, c| m.min(c.displacement));
    let highest = corners.iter().fold(f64::MIN, |m, c| m.max(c.displacement));
    let spacing = ((highest - lowest) / how.steps.max(1) as f64).max(1e-9);
    let mut plan = Plan {
        targets: vec![Target::new(first.displacement, 0.0)],
        times: vec![first.time],
        pieces: Vec::new(),
    };
    let mut so_far = [first.displacement; 2];
    for (leg, w) in corners.windows(2).enumerate() {
        let (a, b) = (w[0], w[1]);
        if a.displacement == b.displacement {
            hold(&mut plan, a, b, leg, how.holds);
            continue;
        }
        let mut ends = vec![a];
        for mark in so_far {
            if (mark - a.displacement) * (b.displacement - mark) > 1e-9 {
                let share = (mark - a.displacement) / (b.displacement - a.displacement);
                ends.push(Corner { time: a.time + share * (b.time - a.time), displacement: mark });
            }
        }
        ends.push(b);
        for e in ends.windows(2) {
            ramp(&mut plan, e[0], e[1], leg, spacing);
        }
        so_far = [so_far[0].min(b.displacement), so_far[1].max(b.displacement)];
    }
    plan
}

fn push(plan: &mut Plan, time: f64, displacement: f64) {
    let dt = time - plan.times[plan.times.len() - 1];
    plan.targets.push(Target::new(displacement, dt));
    plan.times.push(time);
}

fn ramp(plan: &mut Plan, a: Corner, b: Corner, leg: usize, spacing: f64) {
    let first = plan.targets.len() - 1;
    let (low, high) = (a.displacement.min(b.displacement), a.displacement.max(b.displacement));
    let margin = 0.3 * spacing;
    let from = ((low + margin) / spacing).ceil() as i64;
    let to = ((high - margin) / spacing).floor() as i64;
    let mut lines: Vec<f64> = (from..=to).map(|i| i as f64 * spacing).collect();
    if lines.len() < 3 {
        lines = (1..4).map(|i| low + (high - low) * f64::from(i) / 4.0).collect();
    }
    if b.displacement < a.displacement {
        lines.reverse();
    }
    for u in lines {
        let share = (u - a.displacement) / (b.displacement - a.displacement);
        push(plan, a.time + share * (b.time - a.time), u);
    }
    push(plan, b.time, b.displacement);
    let last = plan.targets.len() - 1;
    plan.pieces.push(Piece {
        time: [a.time, b.time],
        displacement: [a.displacement, b.displacement],
        targets: [first, last],
        leg,
    });
}

/// Shares of a hold at which a relaxing force is followed.
const HOLD_SHARES: [f64; 10] = [0.003, 0.008, 0.02, 0.045, 0.09, 0.16, 0.28, 0.45, 0.7, 1.0];

fn hold(plan: &mut Plan, a: Corner, b: Corner, leg: usize, steps: bool) {
    let first = plan.targets.len() - 1;
    let shares: &[f64] = if steps { &HOLD_SHARES } else { &[1.0] };
    for s in shares {
        push(plan, a.time + s * (b.time - a.time), a.displacement);
    }
    let last = plan.targets.len() - 1;
    plan.pieces.push(Piece {
        time: [a.time, b.time],
        displacement: [a.displacement; 2],
        targets: [first, last],
        leg,
    });
}

/// Plan of `fct simulate`: answers at t = 0, every multiple of `step` of travel in each leg, every
/// corner. With `path`, only the corners: the steps are the path's own.
pub fn plan_simulation(corners: &[Corner], step: f64, holds: bool, path: bool) -> Plan {
    let Some(first) = corners.first() else { return Plan::default() };
    let mut plan = Plan {
        targets: vec![Target::new(first.displacement, 0.0)],
        times: vec![first.time],
        pieces: Vec::new(),
    };
    for (leg, w) in corners.windows(2).enumerate() {
        let (a, b) = (w[0], w[1]);
        if a.displacement == b.displacement {
            hold(&mut plan, a, b, leg, holds);
            continue;
        }
        let first = plan.targets.len() - 1;
        let travel = b.displacement - a.displacement;
        let count = if path { 0 } else { ((travel.abs() / step) * (1.0 - 1e-9)).floor() as usize };
        for i in 1..=count {
            let share = (i as f64 * step / travel.abs()).min(1.0);
            push(&mut plan, a.time + share * (b.time - a.time), a.displacement + travel * share);
        }
        push(&mut plan, b.time, b.displacement);
        let last = plan.targets.len() - 1;
        plan.pieces.push(Piece {
            time: [a.time, b.time],
            displacement: [a.displacement, b.displacement],
            targets: [first, last],
            leg,
        });
    }
    plan
}

/// Where a record point lies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// Piece.
    pub piece: usize,
    /// Time, s.
    pub time: f64,
    /// Displacement, mm.
    pub displacement: f64,
}

/// A value as a sum over steps, whether the point belongs to the linearisation, and the slope by
/// time of the same sum.
#[derive(Clone, Debug, PartialEq)]
pub struct Stencil {
    /// (step, weight).
    pub terms: Vec<(usize, f64)>,
    /// False between a jump's neighbours: the value is not differentiable there.
    pub smooth: bool,
}

impl Plan {
    /// First guesses for this plan from states kept over another plan of the same test (one without
    /// steps in its holds, say): the state of the same time, else that from which a hold began.
    pub fn guesses(&self, other: &Self, warm: &fem::Warm) -> fem::Warm {
        let same = |a: f64, b: f64| (a - b).abs() <= 1e-9 * b.abs().max(1.0);
        let at_target = (0..self.targets.len())
            .map(|i| {
                let after = other.times.partition_point(|t| *t < self.times[i] && !same(*t, self.times[i]));
                let exact = other.times.get(after).is_some_and(|t| same(*t, self.times[i]));
                let from = if exact { after } else { after.checked_sub(1)? };
                let stands = same(other.targets[from].actuator, self.targets[i].actuator);
                stands.then(|| warm.at_target.get(from).cloned().flatten()).flatten()
            })
            .collect();
        fem::Warm::at(at_target)
    }

    /// The piece that a time belongs to (the first of two at their common end).
    pub fn place(&self, time: f64, displacement: f64) -> Place {
        let at = self.pieces.partition_point(|p| p.time[1] < time - 1e-9);
        Place { piece: at.min(self.pieces.len().saturating_sub(1)), time, displacement }
    }

    /// The actuator's displacement at a time, from the pieces.
    pub fn displacement_at(&self, time: f64) -> f64 {
        let Some(p) = self.pieces.get(self.place(time, 0.0).piece) else { return 0.0 };
        let share = ((time - p.time[0]) / (p.time[1] - p.time[0])).clamp(0.0, 1.0);
        p.displacement[0] + share * (p.displacement[1] - p.displacement[0])
    }

    /// Interpolates a record point from the steps of a run; `None` where the run never got.
    pub fn stencil(&self, index: &RunIndex, run: &Run, place: &Place) -> Option<Stencil> {
        let piece = &self.pieces[place.piece];
        let at = piece.abscissa(place.time, place.displacement);
        let nodes = index.nodes(self, run, place.piece, piece.is_hold());
        let (nodes, near_jump) = branch(&nodes, run, at, piece)?;
        let terms = cubic(&nodes, at)?;
        Some(Stencil { terms, smooth: !near_jump })
    }
}

/// Which step answers which target.
pub struct RunIndex {
    step_of_target: Vec<Option<usize>>,
}

impl RunIndex {
    /// Index of a run over a plan.
    pub fn new(plan: &Plan, run: &Run) -> Self {
        let mut step_of_target = vec![None; plan.targets.len()];
        for (i, s) in run.steps.iter().enumerate() {
            if let Some(t) = s.target {
                step_of_target[t] = Some(i);
            }
        }
        Self { step_of_target }
    }

    /// The step at a target.
    pub fn step(&self, target: usize) -> Option<usize> {
        self.step_of_target.get(target).copied().flatten()
    }

    /// (abscissa, step) of a piece: its targets, and all its steps if it holds a jump.
    fn nodes(&self, plan: &Plan, run: &Run, piece: usize, hold: bool) -> Vec<(f64, usize)> {
        let p = &plan.pieces[piece];
        let Some(first) = self.step(p.targets[0]) else { return Vec::new() };
        let last = (p.targets[0]..=p.targets[1]).rev().find_map(|t| self.step(t)).unwrap_or(first);
        let jumps = run.steps[first..=last].iter().any(|s| s.after_jump);
        let abscissa = |i: usize, t: Option<usize>| match (hold, t) {
            (true, Some(t)) => plan.times[t],
            (true, None) => run.steps[i].time - run.steps[first].time + p.time[0],
            _ => run.steps[i].actuator,
        };
        (first..=last)
            .filter(|&i| jumps || run.steps[i].target.is_some())
            .map(|i| (abscissa(i, run.steps[i].target), i))
            .collect()
    }
}

/// The steps on the same side of every jump as the point; whether a jump is next to it.
fn branch(nodes: &[(f64, usize)], run: &Run, at: f64, piece: &Piece) -> Option<(Vec<(f64, usize)>, bool)> {
    if nodes.is_empty() {
        return None;
    }
    let forth = if piece.displacement[1] >= piece.displacement[0] { 1.0 } else { -1.0 };
    let (mut from, mut to) = (0, nodes.len());
    let mut near = false;
    for (k, &(x, step)) in nodes.iter().enumerate() {
        if !run.steps[step].after_jump {
            continue;
        }
        if (at - x) * forth >= 0.0 {
            from = k;
        } else {
            to = to.min(k);
        }
        let gap = nodes.get(1).map_or(1.0, |n| (n.0 - nodes[0].0).abs()).max(1e-12);
        near |= (at - x).abs() < gap;
    }
    let nodes = nodes[from..to].to_vec();
    // Beyond the last step that was reached there is nothing to interpolate.
    let (low, high) = nodes.iter().fold((f64::MAX, f64::MIN), |(l, h), n| (l.min(n.0), h.max(n.0)));
    let slack = 1e-6 * (1.0 + at.abs()) + if near { 1e-2 * (high - low).abs() + 1e-3 } else { 0.0 };
    (at >= low - slack && at <= high + slack).then_some((nodes, near))
}

/// Cubic (or lower) Lagrange weights on the four nodes around the point.
fn cubic(nodes: &[(f64, usize)], at: f64) -> Option<Vec<(usize, f64)>> {
    if nodes.is_empty() {
        return None;
    }
    if let Some(&(_, step)) = nodes.iter().find(|n| (n.0 - at).abs() < 1e-12) {
        return Some(vec![(step, 1.0)]);
    }
    let forth = nodes.len() < 2 || nodes[nodes.len() - 1].0 >= nodes[0].0;
    let right = nodes.partition_point(|n| if forth { n.0 < at } else { n.0 > at });
    let start = right.saturating_sub(2).min(nodes.len().saturating_sub(4));
    let used = &nodes[start..(start + 4).min(nodes.len())];
    let weight = |i: usize| -> f64 {
        (0..used.len()).filter(|&j| j != i).map(|j| (at - used[j].0) / (used[i].0 - used[j].0)).product()
    };
    let terms: Vec<(usize, f64)> = (0..used.len()).map(|i| (used[i].1, weight(i))).collect();
    terms.iter().all(|t| t.1.is_finite()).then_some(terms)
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

    #[test]
    fn unload_and_reload_visit_the_same_states() {
        let c = |time: f64, displacement: f64| Corner { time, displacement };
        let p = plan(
            &[c(0.0, 0.0), c(20.0, 1.03), c(35.0, 0.31), c(60.0, 1.6)],
            Stepping { steps: 20, holds: false },
        );
        let of = |i: usize| -> Vec<u64> {
            let t = p.pieces[i].targets;
            let mut v: Vec<u64> = p.targets[t[0]..=t[1]].iter().map(|t| t.actuator.to_bits()).collect();
            v.sort_unstable();
            v
        };
        assert_eq!(p.pieces.len(), 4);
        assert_eq!(of(1), of(2));
    }
}
