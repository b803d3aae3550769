//! From a record or a protocol to the steps of a run, and back from steps to record points.
//!
//! A test is cut into **pieces** on which the force is smooth: ramps and holds, and a reload is cut
//! again where it passes the largest displacement so far. Targets lie on one displacement grid, so
//! that an unload and its reload visit the same states. Record points are interpolated inside their
//! piece by a cubic through the nearest steps; nothing is interpolated across a turn or a jump.

mod corners;
mod path;
mod stencil;

pub use corners::{Corner, corner_rows, corners_of_protocol, corners_of_record};
pub use path::encoder_noise;
pub use stencil::{Place, RunIndex, Stencil};

use fem::Target;

/// How a test is stepped.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stepping {
    /// Grid lines over the range of displacement.
    pub steps: usize,
    /// Whether a hold needs steps of its own (some law looks at time).
    pub holds: bool,
    /// Whether the ways from a turn and back to the largest displacement so far need steps of their own (play is taken up
    /// there, or the tissue remembers how far it was stretched).
    pub turns: bool,
}

/// A stretch of a test on which the force is smooth.
#[derive(Clone, Debug, PartialEq)]
pub struct PlanSegment {
    /// Time at its ends, s.
    pub time: [f64; 2],
    /// Displacement at its ends, mm.
    pub displacement: [f64; 2],
    /// First and last target (the first is the last of the piece before).
    pub targets: [usize; 2],
    /// Which leg of the protocol it belongs to.
    pub leg: usize,
}

impl PlanSegment {
    /// Whether the actuator stands still.
    pub fn is_hold(&self) -> bool {
        self.displacement[0] == self.displacement[1]
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
    pub pieces: Vec<PlanSegment>,
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
    let mut before = 0.0;
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
        let travel = b.displacement - a.displacement;
        let turned = how.turns && before * travel < 0.0;
        before = travel;
        for (i, e) in ends.windows(2).enumerate() {
            let ways = |wanted: bool| if wanted { by_a_turn(highest - lowest, spacing) } else { Vec::new() };
            let close = [ways(turned && i == 0), ways(how.turns && so_far.contains(&e[1].displacement))];
            ramp(&mut plan, e[0], e[1], leg, spacing, &close);
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

/// The nearest step to a turn, as a share of the range: play is a few times that.
const TURN_FIRST: f64 = 0.004;
/// Ratio of one such way to the one before.
const TURN_RATIO: f64 = 1.5;

/// Ways from a turn at which the force is followed, up to the grid's spacing.
fn by_a_turn(range: f64, spacing: f64) -> Vec<f64> {
    let ways = std::iter::successors(Some(TURN_FIRST * range), |w| Some(TURN_RATIO * w));
    ways.take_while(|w| *w < spacing).collect()
}

/// Steps from a corner to the next: on the grid, and at these ways from both ends outside it.
fn ramp(plan: &mut Plan, a: Corner, b: Corner, leg: usize, spacing: f64, close_by: &[Vec<f64>; 2]) {
    let first = plan.targets.len() - 1;
    let (low, high) = (a.displacement.min(b.displacement), a.displacement.max(b.displacement));
    let margin = 0.3 * spacing;
    let from = ((low + margin) / spacing).ceil() as i64;
    let to = ((high - margin) / spacing).floor() as i64;
    let mut lines: Vec<f64> = (from..=to).map(|i| i as f64 * spacing).collect();
    if lines.len() < 3 {
        lines = (1..4).map(|i| low + (high - low) * f64::from(i) / 4.0).collect();
    }
    let forth = (b.displacement - a.displacement).signum();
    if forth < 0.0 {
        lines.reverse();
    }
    let (first_line, last_line) = (lines[0], lines[lines.len() - 1]);
    let after = close_by[0].iter().map(|w| a.displacement + forth * w);
    let after =
        after.filter(|u| TURN_RATIO * (u - a.displacement).abs() < (first_line - a.displacement).abs());
    let before = close_by[1].iter().rev().map(|w| b.displacement - forth * w);
    let before =
        before.filter(|u| TURN_RATIO * (u - b.displacement).abs() < (last_line - b.displacement).abs());
    for u in after.chain(lines).chain(before) {
        let share = (u - a.displacement) / (b.displacement - a.displacement);
        push(plan, a.time + share * (b.time - a.time), u);
    }
    push(plan, b.time, b.displacement);
    close(plan, first, a, b, leg);
}

/// The piece from the target `first` to the last one, between two corners.
fn close(plan: &mut Plan, first: usize, a: Corner, b: Corner, leg: usize) {
    plan.pieces.push(PlanSegment {
        time: [a.time, b.time],
        displacement: [a.displacement, b.displacement],
        targets: [first, plan.targets.len() - 1],
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
    close(plan, first, a, b, leg);
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
        close(&mut plan, first, a, b, leg);
    }
    plan
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
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unload_and_reload_visit_the_same_states() {
        let c = |time: f64, displacement: f64| Corner { time, displacement };
        let p = plan(
            &[c(0.0, 0.0), c(20.0, 1.03), c(35.0, 0.31), c(60.0, 1.6)],
            Stepping { steps: 20, holds: false, turns: false },
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

    /// Wherever a play of 0.4 % of the range or more is taken up, the steps beside that corner are half of its way apart, or the
    /// grid's spacing.
    #[test]
    fn turns_are_followed_closely_where_they_are_remembered() {
        let c = |time: f64, displacement: f64| Corner { time, displacement };
        let corners = [c(0.0, 0.0), c(20.0, 4.0), c(35.0, 0.5), c(40.0, 0.5), c(60.0, 2.0), c(65.0, 4.5)];
        let steps = 11;
        let spacing = 4.5 / f64::from(steps);
        let how = |turns| Stepping { steps: 11, holds: false, turns };
        let (with, without) = (plan(&corners, how(true)), plan(&corners, how(false)));
        let of = |p: &Plan, i: usize| -> Vec<f64> {
            let t = p.pieces[i].targets;
            p.targets[t[0]..=t[1]].iter().map(|t| t.actuator).collect()
        };
        for (piece, turn) in [(1, 4.0), (3, 0.5)] {
            let ways: Vec<f64> = of(&with, piece).iter().map(|u| (u - turn).abs()).collect();
            assert!(ways.windows(2).all(|w| w[0] < w[1]), "{ways:?}");
            for k in 0..200 {
                let play = 0.0041 * 4.5 * (1.0 + 0.1 * f64::from(k));
                let after = ways.partition_point(|w| *w < play);
                let Some(w) = ways.get(after) else { break };
                let gap = w - ways[after - 1];
                assert!(gap <= 0.5 * play + 1e-12 || gap <= 1.3 * spacing + 1e-12, "{play}: {ways:?}");
                assert!(gap <= 0.5 * play + 1e-12 || ways[after] > 0.7 * spacing, "{play}: {ways:?}");
            }
            // What was there stays there: an unload and its reload visit the same states.
            assert!(of(&without, piece).iter().all(|u| of(&with, piece).contains(u)));
        }
        // Back to the largest displacement by the steps of the way from it; no turn: at the start, beyond the largest.
        let near = |p: usize| -> Vec<f64> {
            let of = of(&with, p).into_iter().filter(|u| (u - 4.0).abs() < 0.3);
            let mut near: Vec<f64> = of.collect();
            near.sort_by(f64::total_cmp);
            near
        };
        assert!(near(1).len() > 5);
        assert_eq!(near(4), near(1));
        assert_eq!(of(&with, 0), of(&without, 0));
        assert_eq!(of(&with, 5), of(&without, 5));
    }
}
