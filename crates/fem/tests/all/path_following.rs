//! `control = "path"` on long compliant strips with brittle tears: snap-backs, once and element by element, to the end.
//! The energy balance is the check: whatever the way, all work goes into the tear, Gc times its area.
use crate::common;

use common::*;
use fem::{Run, SteppingOptions, Target};
use mesh::{Sizing, Strip};

/// A strip 4 mm wide and 1 mm thick with a cut of 1 mm.
struct Brittle {
    length: f64,
    divisions: [usize; 3],
    sigma_c: f64,
    gc: f64,
    to: f64,
    step: f64,
}

impl Brittle {
    fn followed(&self) -> Run {
        let strip = Strip {
            sizing: Sizing::Divisions(self.divisions),
            ..Strip { length: self.length, ..peer_strip(self.divisions, true, true) }
        };
        let problem = problem(&strip, Ends::Clamped, 1);
        let tissue = Tissue { gc: self.gc, penalty: 10.0, ..Tissue::peers(1.0, self.sigma_c) };
        let options = SteppingOptions { follow_path: true, arc_step: self.step, ..shipped() };
        complete(&problem, &tissue.theta(1), &[Target::new(0.0, 0.0), Target::new(self.to, self.to)], options)
    }

    /// Follows the path to its end; `turns`: how often it goes back at least.
    fn is_torn_at_the_price_of_its_tear(&self, turns: usize) {
        let run = self.followed();
        let u: Vec<f64> = run.steps.iter().map(|s| s.actuator).collect();
        let back = u.windows(3).filter(|w| w[1] > w[0] && w[1] > w[2]).count();
        let last = run.steps.last().unwrap();
        let (work, price) = (last.ledger.external_work, 3.0 * self.gc);
        let farthest = u.windows(2).fold(0.0f64, |m, w| m.max((w[1] - w[0]).abs()));
        println!(
            "{} mm, {:?}, {} MPa, {} N/mm: goes back {back} times, {} steps, {} iterations, work {work:.5} of {price:.5}, ledger open by {:.1e}",
            self.length,
            self.divisions,
            self.sigma_c,
            self.gc,
            run.steps.len(),
            run.iterations,
            worst_closure(&run)
        );
        assert_eq!(last.actuator, self.to);
        assert!(back >= turns, "{back} turns");
        assert!(last.force.abs() < 1e-6 * peak(&run), "the strip is separated");
        assert!((work / price - 1.0).abs() < 3e-3, "{work} of {price}");
        assert!(worst_closure(&run) < 1e-3);
        assert!(run.jumps.is_empty() && farthest < 1.6 * self.step, "a step of {farthest} mm");
    }
}

/// The process zone is resolved: one snap-back, over nine tenths of the way.
#[test]
fn a_long_strip_goes_back_once() {
    let strip = Brittle { length: 60.0, divisions: [12, 20, 2], sigma_c: 0.2, gc: 0.05, to: 20.0, step: 0.2 };
    strip.is_torn_at_the_price_of_its_tear(1);
}

/// It is not: the path goes back at every element, each time by a cusp at which both ways look alike in the plane
/// of actuator and mean opening.
#[test]
fn a_brittle_tear_goes_back_at_every_element() {
    for divisions in [[8, 12, 2], [14, 12, 2]] {
        let strip = Brittle { length: 20.0, divisions, sigma_c: 0.6, gc: 0.05, to: 6.0, step: 0.1 };
        strip.is_torn_at_the_price_of_its_tear(divisions[0] / 2);
    }
}
