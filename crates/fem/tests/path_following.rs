//! `control = "path"` on long compliant strips with brittle tears: snap-backs, once and element by element, to the end.
mod common;

use common::*;
use fem::{MarchOptions, Run, Target};
use mesh::{Sizing, Strip};

/// A strip 4 mm wide with a cut of 1 mm, followed along its path.
struct Case {
    length: f64,
    divisions: [usize; 3],
    sigma_c: f64,
    gc: f64,
    to: f64,
    step: f64,
}

fn followed(c: &Case) -> Run {
    let strip = Strip {
        sizing: Sizing::Divisions(c.divisions),
        ..Strip { length: c.length, ..peer_strip(c.divisions, true, true) }
    };
    let problem = problem(&strip, Ends::Clamped, 1);
    let tissue = Tissue { gc: c.gc, penalty: 10.0, ..Tissue::peers(1.0, c.sigma_c) };
    let options = MarchOptions { follow_path: true, arc_step: c.step, ..shipped() };
    run(&problem, &tissue.theta(1), &[Target::new(0.0, 0.0), Target::new(c.to, c.to)], options)
}

#[test]
fn explore() {
    let only = std::env::var("ONLY").unwrap_or_default();
    let text = std::fs::read_to_string(std::env::var("CASES").unwrap()).unwrap();
    let cases = text.lines().map(|l| {
        let w: Vec<&str> = l.split_whitespace().collect();
        let f = |i: usize| -> f64 { w[i].parse().unwrap() };
        (
            w[0].to_owned(),
            Case {
                length: f(1),
                divisions: [f(2) as usize, f(3) as usize, 2],
                sigma_c: f(4),
                gc: f(5),
                to: f(6),
                step: f(7),
            },
        )
    });
    for (name, case) in cases {
        if !only.is_empty() && !only.split(',').any(|o| o == name) {
            continue;
        }
        let begun = std::time::Instant::now();
        let run = followed(&case);
        let u: Vec<f64> = run.steps.iter().map(|s| s.actuator).collect();
        let turns: Vec<f64> =
            (1..u.len() - 1).filter(|&i| (u[i] - u[i - 1]) * (u[i + 1] - u[i]) < 0.0).map(|i| u[i]).collect();
        let last = run.steps.last().unwrap();
        println!(
            "{name}: {} steps, {} it, ends {:.4} F {:.2e}, turns {turns:.3?}, work {:.5} dissipated {:.5} of {:.5}, closure {:.1e}, {:.1?}; {:?}",
            run.steps.len(),
            run.iterations,
            last.actuator,
            last.force,
            last.ledger.external_work,
            last.ledger.cohesive_dissipated,
            3.0 * case.gc,
            worst_closure(&run),
            begun.elapsed(),
            run.failure
        );
        if std::env::var_os("V").is_some() {
            for w in run.steps.windows(2) {
                let (a, s) = (&w[0], &w[1]);
                let g = s.ledger.gap() - a.ledger.gap();
                if g.abs() > 1e-5 * last.ledger.external_work {
                    println!(
                        "   {:.5} -> {:.5} F {:.6} -> {:.6} slope {:.3e} -> {:.3e} it {} neg {} -> {} D {:.6} -> {:.6} gap {:.2e}",
                        a.actuator,
                        s.actuator,
                        a.force,
                        s.force,
                        a.slope,
                        s.slope,
                        s.iterations,
                        a.negative_pivots,
                        s.negative_pivots,
                        a.ledger.cohesive_dissipated,
                        s.ledger.cohesive_dissipated,
                        g
                    );
                }
            }
        }
    }
}
