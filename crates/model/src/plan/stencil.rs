//! From steps back to record points: the piece a point lies in, and its weights on the steps there.

use super::{Plan, PlanSegment};
use fem::Run;

/// Where a record point lies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// PlanSegment.
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

impl PlanSegment {
    fn abscissa(&self, time: f64, displacement: f64) -> f64 {
        if self.is_hold() {
            time.clamp(self.time[0], self.time[1])
        } else {
            let (a, b) = (self.displacement[0], self.displacement[1]);
            displacement.clamp(a.min(b), a.max(b))
        }
    }
}

impl Plan {
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
fn branch(
    nodes: &[(f64, usize)],
    run: &Run,
    at: f64,
    piece: &PlanSegment,
) -> Option<(Vec<(f64, usize)>, bool)> {
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
