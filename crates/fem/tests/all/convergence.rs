//! Mesh and step convergence of a tear, with observed orders.
use crate::common;

use common::*;
use mesh::{Sizing, Strip, refine};

fn base(quarter: bool) -> Strip {
    Strip { sizing: Sizing::Divisions([4, 10, 2]), ..peer_strip([4, 10, 2], true, quarter) }
}

/// Peak force and work up to 4 mm on the base mesh split in `parts`.
fn tear(parts: usize) -> (f64, f64) {
    let problem = problem(&refine(&base(true), parts), Ends::Clamped, 1);
    let run = complete(&problem, &Tissue::peers(1.0, 0.1).theta(1), &plan(ramp(0.0, 4.0, 20)), shipped());
    let top = smooth_peak(&run);
    println!(
        "  split {parts}: {} unknowns, peak {:.6} N at {:.4} mm, work {:.6} N·mm",
        unknowns(&problem),
        top.1,
        top.0,
        run.steps.last().unwrap().ledger.external_work
    );
    (top.1, run.steps.last().unwrap().ledger.external_work)
}

fn unknowns(problem: &fem::Problem) -> usize {
    problem.supports.iter().filter(|s| s.is_none()).count()
}

fn report(values: &[(f64, f64)]) -> [f64; 2] {
    let last = values.len() - 3;
    let (a, b, c) = (values[last], values[last + 1], values[last + 2]);
    let orders = [order([a.0, b.0, c.0], 2.0), order([a.1, b.1, c.1], 2.0)];
    let limit = |b: f64, c: f64, p: f64| c + (c - b) / (2f64.powf(p) - 1.0);
    let (peak, work) = (limit(b.0, c.0, orders[0]), limit(b.1, c.1, orders[1]));
    println!(
        "  orders: peak {:.2}, work {:.2}; extrapolated {peak:.6}, {work:.6}; finest off by {:.3} %, {:.3} %",
        orders[0],
        orders[1],
        100.0 * (c.0 / peak - 1.0),
        100.0 * (c.1 / work - 1.0)
    );
    orders
}

#[test]
fn mesh_convergence_of_a_tear() {
    println!("tear σc = 0.1, quarter model, base 4 × 10 × 2 split 1, 2, 4");
    let values = [1, 2, 4].map(tear);
    let orders = report(&values);
    assert!(orders.iter().all(|&p| p > 0.8), "{orders:?}");
    assert!((values[2].0 / values[1].0 - 1.0).abs() < 0.02);
}

#[test]
#[ignore = "slow: run by `just verification`"]
fn mesh_convergence_of_a_tear_to_split_8() {
    println!("tear σc = 0.1, quarter model, base 4 × 10 × 2 split 2, 4, 8");
    let orders = report(&[2, 4, 8].map(tear));
    assert!(orders.iter().all(|&p| p > 0.8), "{orders:?}");
}

/// Loading on the envelope has no memory of the step: the force at a displacement does not depend
/// on the steps that lead there, and the work rule is of fourth order.
#[test]
fn step_convergence_of_a_tear() {
    let problem = problem(&base(true), Ends::Clamped, 1);
    let theta = Tissue::peers(1.0, 0.1).theta(1);
    let mut force = Vec::new();
    let (mut work, mut whole) = (Vec::new(), Vec::new());
    for n in [16, 32, 64, 128] {
        let run = complete(&problem, &theta, &plan(ramp(0.0, 4.0, n)), tight());
        assert_eq!(run.steps.len(), n + 1, "no step was cut");
        force.push(forces(&run).into_iter().step_by(n / 16).collect::<Vec<_>>());
        // From 0.5 mm on: at 0 all fibres stand on their switch, where the slope jumps.
        let at = |k: usize| run.steps[k].ledger.external_work;
        work.push(at(n) - at(n / 8));
        whole.push(at(n));
    }
    let differences: Vec<f64> = (0..3).map(|k| worst(&force[k], &force[3])).collect();
    let orders = [order([work[0], work[1], work[2]], 2.0), order([work[1], work[2], work[3]], 2.0)];
    println!("work from 0 to 4 mm: {whole:.7?}, order {:.2}", order([whole[1], whole[2], whole[3]], 2.0));
    println!(
        "steps 16, 32, 64 against 128: force {}; work from 0.5 to 4 mm {work:.8?}, orders {orders:.2?}",
        sci(&differences)
    );
    assert!(differences.iter().all(|&d| d < 1e-4));
    assert!(orders[1] > 2.5);
}
