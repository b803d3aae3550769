//! A strip is torn, with the derivative of the force with respect to every parameter.
//!
//! `cargo run --release -p fem --example tear`

use fem::sensitivity::Group;
use fem::{
    Blend, Body, NoObserver, Path, Prescribed, Problem, SteppingOptions, System, Target, interface, run_steps,
};
use mesh::{Sizing, Strip};
use std::sync::Arc;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // A quarter of a strip of 10 × 4 × 1 mm with a cut of 1 mm: mirrored at mid-height and mid-thickness.
    let strip = Strip {
        cut: 1.0,
        tear: true,
        sizing: Sizing::Divisions([8, 20, 2]),
        half_height: true,
        half_thickness: true,
        ..Strip::new(10.0, 4.0, 1.0)
    };
    let mesh = mesh::strip(&strip)?;
    let body = Body::of(&mesh);

    // The end face moves along y by half the grip displacement (the mirror does the other half).
    let mut supports = vec![None; 3 * body.nodes.len()];
    for &n in mesh.set("top").unwrap_or_default() {
        for (c, grip) in [(0, 0.0), (1, 0.5), (2, 0.0)] {
            supports[3 * n + c] = Some(Prescribed { grip, mount: 0.0 });
        }
    }
    for &n in mesh.set("mid_thickness").unwrap_or_default() {
        supports[3 * n + 2] = Some(Prescribed::default());
    }

    // θ: seven of the bulk law, then Gc, σc, λ, K of the tear path.
    let names =
        ["mu", "k1", "k2", "gamma", "kappa", "d", "fibre_onset", "gc", "sigma_c", "lambda", "penalty"];
    let theta = [0.0051, 0.9388, 20.09, 38.53f64.to_radians(), 0.23, 2.0, 0.0, 0.23, 0.1, 1.0, 10.0];
    let point = || (7..11).map(Blend::one).collect::<Vec<_>>();
    let path = Path {
        law: Arc::new(cohesive::Cohesive),
        rule: interface::Integration::Gauss.into(),
        params: body.cohesive.iter().map(|_| std::array::from_fn(|_| point())).collect(),
        position: vec![[0.5; 4]; body.cohesive.len()],
    };
    let problem = Arc::new(Problem {
        body: Arc::new(body),
        supports: Arc::new(supports),
        waypoints: Arc::default(),
        reactions: Arc::default(),
        multiplicity: 4.0,
        bulk: Arc::new(hgo::Hgo::default()),
        bulk_params: (0..7).collect(),
        path: Some(path),
        train: vec![],
        takeup: vec![],
        shape: vec![],
        mount: vec![],
    });

    let mut group = Group::new(&problem, &theta, &(0..11).collect::<Vec<_>>());
    let mut columns = group.columns();
    let mut system = System::new(&problem)?;
    let plan: Vec<Target> = (0..=20).map(|i| Target::new(0.25 * f64::from(i), 1.0)).collect();
    let options = SteppingOptions { ledger: true, ..SteppingOptions::default() };
    let run = run_steps(
        &problem,
        &theta,
        &mut system,
        None,
        &plan,
        &mut columns,
        &NoObserver,
        options,
        None,
        &|| false,
    );

    println!("u mm   F N       dF/dGc    dF/dσc");
    for s in &run.steps {
        println!(
            "{:.2}  {:8.5}  {:8.4}  {:8.4}",
            s.actuator, s.force, s.derivatives.force[7], s.derivatives.force[8]
        );
    }
    if let Some(s) = run.steps.last() {
        println!("work {:.5} N·mm, unaccounted {:.1e}", s.ledger.external_work, s.ledger.gap());
        println!("parameters: {names:?}");
    }
    run.failure.map_or(Ok(()), |e| Err(e.into()))
}
