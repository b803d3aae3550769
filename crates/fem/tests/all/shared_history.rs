//! Columns that share the tangent of the bulk's history: what a chunk says must not hang on the others, and one test
//! of a piece follows another.
use crate::common;
use crate::laws;

use common::*;
use fem::sensitivity::Group;
use fem::{NewtonOptions, NoObserver, Problem, Run, State, SteppingOptions, System, Target, run_steps};
use laws::Fading;
use std::sync::Arc;

/// Strength of the overstress and its time, behind the parameters of the strip.
const G: usize = 11;
const TAU: usize = 12;

fn theta() -> Vec<f64> {
    let mut t = Tissue { penalty: 10.0, ..Tissue::peers(1.0, 0.1) }.theta(1);
    // At 0 the unloaded strip stands on the fibres' switch.
    t[6] = 0.004;
    t.extend([0.5, 3.0]);
    t
}

fn fading() -> Arc<Problem> {
    let mut p = problem(&peer_strip([4, 8, 2], true, true), Ends::Clamped, 1);
    p.bulk = Arc::new(Fading);
    p.bulk_params.extend([G, TAU]);
    Arc::new(p)
}

/// Up with a hold, and back.
fn pull(to: f64) -> Vec<Target> {
    let mut targets = plan(ramp(0.0, to, 5));
    targets.push(Target::new(to, 2.0));
    targets.extend(ramp(to, 0.6 * to, 2).map(|u| Target::new(u, 0.5)));
    targets
}

fn run(theta: &[f64], start: Option<State>, group: &mut Group, targets: &[Target]) -> Run {
    let problem = fading();
    let mut system = System::new(&problem).unwrap();
    let newton = NewtonOptions { tolerance: 1e-12, ..NewtonOptions::default() };
    let options = SteppingOptions { newton, ..SteppingOptions::default() };
    let mut columns = group.columns();
    let run = run_steps(
        &problem,
        theta,
        &mut system,
        start,
        targets,
        &mut columns,
        &NoObserver,
        options,
        None,
        &|| false,
    );
    assert!(run.failure.is_none(), "{:?}", run.failure);
    run
}

/// A strip pulled to the right, and then torn: the second run of the same piece.
fn twice(theta: &[f64], seeds: &[usize]) -> Run {
    let problem = fading();
    let mut before = Group::new(&problem, theta, seeds);
    let first = run(theta, None, &mut before, &pull(1.0)).last.unwrap();
    let mut state = State::virgin(&problem);
    state.history.bulk = first.history.bulk;
    state.time = first.time;
    let mut group = Group::new(&problem, theta, seeds);
    group.carry_bulk_from(&before);
    run(theta, Some(state), &mut group, &pull(2.4))
}

fn column(run: &Run, c: usize) -> Vec<f64> {
    run.steps.iter().map(|s| s.derivatives.force[c]).collect()
}

#[test]
fn columns_of_the_path_need_no_column_of_the_bulk_beside_them() {
    let (t, problem) = (theta(), fading());
    let all: Vec<usize> = (0..t.len()).collect();
    let whole = run(&t, None, &mut Group::new(&problem, &t, &all), &pull(2.4));
    let alone = run(&t, None, &mut Group::new(&problem, &t, &[GC, GC + 1]), &pull(2.4));
    for c in 0..2 {
        let (a, b) = (column(&whole, GC + c), column(&alone, c));
        assert!(b.iter().any(|x| x.abs() > 1e-3), "felt: {b:?}");
        assert!(worst(&a, &b) < 1e-9, "parameter {c} of the path: {:e}", worst(&a, &b));
    }
}

#[test]
fn a_second_test_of_a_piece_remembers_the_first() {
    let (t, seeds) = (theta(), [0, 1, GC, G, TAU]);
    let exact = twice(&t, &seeds);
    for (c, &k) in seeds.iter().enumerate() {
        let h = 2e-5 * t[k];
        let at = |by: f64| -> Vec<f64> {
            let mut t = t.clone();
            t[k] += by;
            twice(&t, &[]).steps.iter().map(|s| s.force).collect()
        };
        let (up, down) = (at(h), at(-h));
        let differences: Vec<f64> = up.iter().zip(&down).map(|(a, b)| (a - b) / (2.0 * h)).collect();
        let error = worst(&differences, &column(&exact, c));
        println!("parameter {k}: {error:.1e}");
        assert!(error < 1e-5, "parameter {k}: {error:e}");
    }
}
