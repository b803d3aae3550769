//! The ledger: external work is accounted for on every kind of run.
use crate::common;
use crate::laws;

use common::*;
use fem::{Link, Problem, Run, SteppingOptions};
use laws::{Compliance, Slip, Softening};
use mesh::Strip;
use std::sync::Arc;

fn closes(title: &str, run: &Run) {
    let worst = worst_closure(run);
    let l = &run.steps.last().unwrap().ledger;
    println!(
        "{title}: open by {worst:.1e}; work {:.5} = stored {:.5} + bulk {:.5} + path {:.5} recoverable, {:.5} lost + rig {:.5} + jumps {:.5}",
        l.external_work,
        l.stored,
        l.dissipated_bulk,
        l.cohesive_recoverable,
        l.cohesive_dissipated,
        l.rig,
        l.released_in_jumps
    );
    assert!(worst < 1e-3, "{title}: {worst:e}");
}

fn cycle(top: f64, n: usize) -> Vec<fem::Target> {
    let first = ramp(0.0, top, n).chain(ramp(top, 0.2 * top, n / 2));
    plan(first.chain(ramp(0.2 * top, top, n / 2)).chain(ramp(top, 1.5 * top, n / 2)))
}

fn strip(tear: bool, quarter: bool) -> Strip {
    Strip { half_thickness: true, ..peer_strip([8, 20, 2], tear, quarter) }
}

#[test]
fn ledger_of_tension() {
    let theta = Tissue::peers(1.0, 0.1).theta(1);
    closes(
        "tension",
        &complete(&problem(&strip(false, true), Ends::Clamped, 1), &theta, &cycle(1.6, 16), shipped()),
    );
}

#[test]
fn ledger_of_a_tear_unloaded_and_reloaded() {
    let theta = Tissue::peers(1.0, 0.1).theta(1);
    for (title, quarter) in [("tear, quarter model", true), ("tear, full height", false)] {
        let run =
            complete(&problem(&strip(true, quarter), Ends::Clamped, 1), &theta, &cycle(2.8, 28), shipped());
        closes(title, &run);
        assert!(run.steps.iter().any(|s| s.revisited) || !quarter);
    }
}

#[test]
fn ledger_of_a_tear_with_a_jump() {
    let theta = Tissue::peers(1.0, 0.2).theta(1);
    let run = complete(
        &problem(&strip(true, true), Ends::Clamped, 1),
        &theta,
        &plan(ramp(0.0, 5.0, 50)),
        shipped(),
    );
    assert_eq!(run.jumps.len(), 1);
    closes("tear with a jump", &run);
}

fn with_train(law: Arc<dyn constitutive::PointLaw<1>>, tear: bool) -> Problem {
    Problem { train: vec![Link { law, params: vec![11] }], ..problem(&strip(tear, true), Ends::Clamped, 1) }
}

#[test]
fn ledger_with_a_load_train() {
    let mut theta = Tissue::peers(1.0, 0.1).theta(1);
    theta.push(1.0);
    closes(
        "tear in a compliant rig",
        &complete(&with_train(Arc::new(Compliance), true), &theta, &cycle(2.8, 28), shipped()),
    );
    theta[11] = 3.0;
    closes(
        "tear in a slipping grip",
        &complete(&with_train(Arc::new(Slip), true), &theta, &cycle(2.8, 28), shipped()),
    );
}

/// An elastic excursion that is left between two visited states: what the rig holds must be that of
/// the state, not of the last state computed.
#[test]
fn ledger_of_the_rig_after_a_revisit() {
    let mut theta = Tissue::peers(1.0, 0.1).theta(1);
    theta.push(2.0);
    let problem = with_train(Arc::new(Compliance), false);
    let run = complete(&problem, &theta, &plan(ramp(0.0, 1.6, 16).chain([1.2, 0.8, 0.85, 0.9])), shipped());
    // The step at 0.85 mm is new, between two that were taken over.
    let last = &run.steps[run.steps.len() - 2];
    assert!(!last.revisited);
    let exact = 0.5 * 2.0 * last.force * last.force;
    println!("rig after a revisit: {:.6} N·mm, ½ C F² = {exact:.6}", last.ledger.rig);
    assert!(run.steps.iter().any(|s| s.revisited));
    assert!((last.ledger.rig / exact - 1.0).abs() < 5e-3);
    closes("revisited states in a compliant rig", &run);
}

#[test]
fn ledger_with_a_bulk_that_softens() {
    let mut theta = Tissue::peers(1.0, 0.1).theta(1);
    theta.extend([0.4, 0.004]);
    let mut p = problem(&strip(true, true), Ends::Clamped, 1);
    p.bulk = Arc::new(Softening);
    p.bulk_params.extend([11, 12]);
    let run = complete(&p, &theta, &cycle(2.8, 28), SteppingOptions { ..shipped() });
    assert!(run.steps.last().unwrap().ledger.dissipated_bulk > 0.0);
    closes("tear in a softening bulk", &run);
}
