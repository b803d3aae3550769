//! Protocols that are weighed, and records as they would be sampled.

use input::{Leg, Record, TestKind};

/// Rows of a planned record.
const ROWS: f64 = 240.0;
/// Fewest rows of a leg.
const LEAST: usize = 16;
/// Long and short holds, s.
const HOLDS: [f64; 3] = [120.0, 60.0, 20.0];
/// How much faster than the usual rate a protocol may be driven to keep to its time, and a fast leg is.
const FASTER: [f64; 4] = [1.0, 2.0, 5.0, 10.0];
const FAST: f64 = 10.0;

/// What is done to each test.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Program {
    pub name: &'static str,
    pub words: &'static str,
    /// Loops, holds, a second rate.
    has: [bool; 3],
}

pub(super) const PROGRAMS: [Program; 5] = [
    Program { name: "pull", words: "one pull", has: [false, false, false] },
    Program { name: "loops", words: "a pull with unloadings", has: [true, false, false] },
    Program { name: "holds", words: "a pull with holds", has: [false, true, false] },
    Program { name: "loops and holds", words: "a pull with unloadings and holds", has: [true, true, false] },
    Program {
        name: "loops, holds, two rates",
        words: "a pull with unloadings, holds and a leg at ten times the rate",
        has: [true, true, true],
    },
];

/// A test that could be done.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pull {
    pub kind: TestKind,
    pub to_mm: f64,
    pub rate: f64,
}

impl Program {
    /// Legs of a test, and of all tests together the time; `None` where no rate and no hold keeps to the budget.
    pub fn within(&self, pulls: &[Pull], budget_s: f64) -> Option<Vec<Vec<Leg>>> {
        let mut ways = FASTER.iter().flat_map(|f| HOLDS.iter().map(move |h| (*f, *h)));
        ways.find_map(|(faster, hold)| {
            let legs: Vec<Vec<Leg>> = pulls.iter().map(|p| self.legs(p, faster, hold)).collect();
            (legs.iter().map(|l| seconds(l)).sum::<f64>() <= budget_s).then_some(legs)
        })
    }

    fn legs(&self, pull: &Pull, faster: f64, hold: f64) -> Vec<Leg> {
        let [loops, holds, two_rates] = self.has;
        let (top, rate) = (pull.to_mm, faster * pull.rate);
        let to = |share: f64, rate: f64| Leg::Ramp { to_mm: share * top, rate_mm_per_s: rate };
        let mut legs = Vec::new();
        let tear = pull.kind.tears;
        let (first, low, second) = if tear { (0.45, 0.25, 0.65) } else { (0.6, 0.15, 0.85) };
        if loops || holds {
            legs.push(to(first, rate));
        }
        if holds {
            legs.push(Leg::Hold { hold_s: hold });
        }
        if loops {
            legs.push(to(low, rate));
            legs.push(to(second, if two_rates { FAST * rate } else { rate }));
        }
        if loops && !tear {
            legs.push(to(0.0, rate));
            if holds {
                legs.push(Leg::Hold { hold_s: hold });
            }
        }
        legs.push(to(1.0, rate));
        if holds && !tear {
            legs.push(Leg::Hold { hold_s: hold });
        }
        legs
    }
}

/// Duration of legs from displacement 0, s.
pub(super) fn seconds(legs: &[Leg]) -> f64 {
    let mut at = 0.0;
    legs.iter()
        .map(|leg| match *leg {
            Leg::Ramp { to_mm, rate_mm_per_s } => {
                let travel: f64 = to_mm - at;
                at = to_mm;
                travel.abs() / rate_mm_per_s
            }
            Leg::Hold { hold_s } => hold_s,
        })
        .sum()
}

/// Rows along the legs: evenly on ramps, ever longer apart in holds. Nothing is measured in them yet.
pub(super) fn record(legs: &[Leg], camera: bool, kind: TestKind) -> Record {
    let way: f64 = seconds(legs).max(f64::MIN_POSITIVE);
    let (mut time, mut displacement) = (vec![0.0], vec![0.0]);
    for leg in legs {
        let (t0, u0) = (time[time.len() - 1], displacement[displacement.len() - 1]);
        let (to, duration): (f64, f64) = match *leg {
            Leg::Ramp { to_mm, rate_mm_per_s } => (to_mm, (to_mm - u0).abs() / rate_mm_per_s),
            Leg::Hold { hold_s } => (u0, hold_s),
        };
        if duration <= 0.0 {
            continue;
        }
        let rows = ((ROWS * duration / way) as usize).max(LEAST);
        for k in 1..=rows {
            let even = k as f64 / rows as f64;
            let share = if to == u0 { (50f64.powf(even) - 1.0) / 49.0 } else { even };
            time.push(t0 + share * duration);
            displacement.push(if k == rows { to } else { u0 + share * (to - u0) });
        }
    }
    let n = time.len();
    let channel = |wanted: bool| (camera && wanted).then(|| vec![Some(0.0); n]);
    Record {
        force: vec![0.0; n],
        grip_displacement: channel(kind.measures("grip_displacement")),
        tear_front: channel(kind.measures("tear_front")),
        width_change: channel(kind.measures("width_change")),
        force_x: kind.two_axes.then(|| vec![Some(0.0); n]),
        displacement_x: kind.two_axes.then(|| displacement.clone()),
        time,
        displacement,
        ..Record::default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use input::ExperimentRegistry;

    fn pulls() -> [Pull; 2] {
        let kinds = experiments::registry().kinds();
        let pull = |name: &str, to_mm| {
            let kind = kinds.iter().copied().find(|k| k.word() == name).expect("in the registry");
            Pull { kind, to_mm, rate: 0.02 }
        };
        [pull("uniaxial", 2.0), pull("tearing", 5.0)]
    }

    #[test]
    fn a_program_keeps_to_its_budget_or_is_left_out() {
        for program in PROGRAMS {
            for budget in [30.0, 120.0, 900.0, 3600.0] {
                if let Some(legs) = program.within(&pulls(), budget) {
                    assert!(legs.iter().map(|l| seconds(l)).sum::<f64>() <= budget, "{}", program.name);
                }
            }
            assert!(program.within(&pulls(), 3600.0).is_some() && program.within(&pulls(), 1.0).is_none());
        }
    }

    #[test]
    fn a_planned_record_ends_each_leg_exactly() {
        let legs = PROGRAMS[4].within(&pulls(), 3600.0).unwrap_or_default();
        for (l, pull) in legs.iter().zip(pulls()) {
            let r = record(l, true, pull.kind);
            assert!(r.time.windows(2).all(|w| w[1] > w[0]));
            assert!((r.time[r.len() - 1] - seconds(l)).abs() < 1e-9 * seconds(l));
            assert!(r.displacement.contains(&pull.to_mm));
            assert_eq!(model::corners_of_record(&r).len(), l.len() + 1);
            assert_eq!(r.tear_front.is_some(), pull.kind.tears);
        }
    }
}
