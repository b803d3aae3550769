//! Full, half and quarter models are one; the same bits on one and two threads.
use crate::common;
use crate::laws;

use common::*;
use fem::sensitivity::Group;
use fem::{Link, NoObserver, Problem, Run, SteppingOptions, System, Warm, run_steps};
use mesh::Strip;
use std::sync::Arc;

fn compare(tear: bool, top: f64) {
    let theta = Tissue::peers(1.0, 0.1).theta(1);
    let up = ramp(0.0, top, 6);
    let targets = plan(up.chain(ramp(top, 0.5 * top, 2)).chain(ramp(0.5 * top, 1.2 * top, 3)));
    let curves: Vec<Vec<f64>> = [(false, false), (false, true), (true, false), (true, true)]
        .map(|(half_height, half_thickness)| {
            let strip = Strip { half_height, half_thickness, ..peer_strip([4, 10, 2], tear, false) };
            forces(&complete(&problem(&strip, Ends::Clamped, 1), &theta, &targets, tight()))
        })
        .into();
    let differences: Vec<f64> = curves[1..].iter().map(|c| worst(c, &curves[0])).collect();
    println!("full against half thickness, half height, quarter (tear {tear}): {}", sci(&differences));
    assert!(differences.iter().all(|&d| d < 1e-8));
}

#[test]
fn full_half_and_quarter_agree_in_tension() {
    compare(false, 1.5);
}

#[test]
fn full_half_and_quarter_agree_in_tearing() {
    compare(true, 3.0);
}

#[test]
fn same_bits_on_one_and_two_threads() {
    let strip = Strip { half_thickness: true, ..peer_strip([8, 20, 2], true, false) };
    let problem = Arc::new(problem(&strip, Ends::Clamped, 3));
    let theta = Tissue::peers(1.0, 0.1).theta(3);
    let targets = plan(ramp(0.0, 2.4, 4).chain([1.2]).chain(ramp(1.2, 3.0, 3)));
    let all = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let seeds: Vec<usize> = (0..theta.len()).collect();
            let mut group = Group::new(&problem, &theta, &seeds);
            let mut columns = group.columns();
            let mut system = System::new(&problem).unwrap();
            run_steps(
                &problem,
                &theta,
                &mut system,
                None,
                &targets,
                &mut columns,
                &NoObserver,
                shipped(),
                None,
                &|| false,
            )
        })
    };
    let (one, two) = (all(1), all(2));
    assert!(one.failure.is_none());
    let bits = |run: &fem::Run| -> Vec<u64> {
        let last = run.last.as_ref().unwrap();
        let steps = run.steps.iter().flat_map(|s| {
            let l = &s.ledger;
            s.derivatives
                .force
                .iter()
                .copied()
                .chain([s.force, s.slope, l.external_work, l.stored, l.cohesive_dissipated])
                .collect::<Vec<_>>()
        });
        steps
            .chain(last.u.iter().copied())
            .chain(last.history.path.iter().copied())
            .map(f64::to_bits)
            .collect()
    };
    let (a, b) = (bits(&one), bits(&two));
    println!(
        "one and two threads: {} numbers, {} differ",
        a.len(),
        a.iter().zip(&b).filter(|(x, y)| x != y).count()
    );
    assert_eq!(a, b);
}

fn warmed(problem: &Problem, theta: &[f64], targets: &[fem::Target], warm: &Warm) -> Run {
    let mut system = System::new(problem).unwrap();
    let never = || false;
    run_steps(problem, theta, &mut system, None, targets, &mut [], &NoObserver, tight(), Some(warm), &never)
}

#[test]
fn guesses_change_the_cost_but_not_the_answer() {
    let strip =
        |half_height| Strip { half_height, half_thickness: true, ..peer_strip([4, 10, 2], true, false) };
    let (half, whole) = [true, false].map(|h| Arc::new(problem(&strip(h), Ends::Clamped, 1))).into();
    let mut theta = Tissue::peers(1.0, 0.1).theta(1);
    let targets = plan(ramp(0.0, 3.0, 10));
    let seeds: Vec<usize> = (0..theta.len()).collect();
    let mut group = Group::new(&half, &theta, &seeds);
    let mut columns = group.columns();
    let mut system = System::new(&half).unwrap();
    let keep = SteppingOptions { keep_states: true, keep_gradients: true, ..tight() };
    let known =
        run_steps(&half, &theta, &mut system, None, &targets, &mut columns, &NoObserver, keep, None, &|| {
            false
        });
    let warm = Warm::first_order(&known, targets.len(), &theta, &seeds);
    theta.iter_mut().for_each(|t| *t *= 1.01);
    let cold = complete(&half, &theta, &targets, tight());
    let plain = warmed(&half, &theta, &targets, &warm.plain());
    let first = warmed(&half, &theta, &targets, &warm);
    println!(
        "iterations: cold {}, states {}, first order {}",
        cold.iterations, plain.iterations, first.iterations
    );
    assert!(worst(&forces(&first), &forces(&cold)) < 1e-8);
    assert!(first.iterations < cold.iterations);
    // Another mesh's states are no guess, and no fault either.
    let other = warmed(&whole, &theta, &targets, &warm);
    assert_eq!(forces(&other), forces(&complete(&whole, &theta, &targets, tight())));
}

/// The grip stands where the guess has the clamped faces, not where the last step left it.
#[test]
fn a_state_known_behind_a_load_train_is_found_at_once() {
    let strip = Strip { half_height: true, half_thickness: true, ..peer_strip([4, 10, 2], true, false) };
    let train = vec![Link { law: Arc::new(laws::Slip), params: vec![11] }];
    let problem = Problem { train, ..problem(&strip, Ends::Clamped, 1) };
    let mut theta = Tissue::peers(1.0, 0.1).theta(1);
    theta.push(3.0);
    let targets = plan(ramp(0.0, 3.0, 10));
    let keep = SteppingOptions { keep_states: true, ..tight() };
    let cold = complete(&problem, &theta, &targets, keep);
    let again = warmed(&problem, &theta, &targets, &Warm::of(&cold, targets.len()));
    println!(
        "behind a load train: {} iterations cold, {} from known states",
        cold.iterations, again.iterations
    );
    assert!(worst(&forces(&again), &forces(&cold)) < 1e-8);
    assert!(again.iterations <= 2, "{}", again.iterations);
}
