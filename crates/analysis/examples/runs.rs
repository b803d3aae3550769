//! Cost of runs of a case: `cargo run --release -p analysis --example runs -- FILE`; with `SEARCH=1` on the mesh
//! and with the steps of a search.
use inverse::Problem as _;
use std::sync::Arc;
use std::time::Instant;
fn main() {
    let cat = effects::catalogue();
    for path in std::env::args().skip(1) {
        let case = input::read_case(std::path::Path::new(&path), &cat).unwrap_or_else(|e| panic!("{e}"));
        let search = std::env::var("SEARCH").is_ok();
        {
            let coarsen = if search { 3.0 } else { 1.0 };
            let how = model::Discretisation { coarsen, ..model::Discretisation::default() };
            let mut options = analysis::run_options(&case);
            if search {
                (options.tearing_steps, options.uniaxial_steps) = (30, 14);
                options.stepping.newton.tolerance = 1e-7;
            }
            let m = model::Model::new(Arc::new(case.clone()), &cat, how).unwrap();
            let wanted = m.recorded();
            let measured = analysis::Measured::of(&m, &wanted).unwrap();
            let theta = m.theta();
            let free = m.free();
            let p =
                analysis::FeProblem::new(&m, theta.clone(), free.clone(), &measured.slots, options, &|| {
                    false
                });
            let mut values: Vec<f64> = free.iter().map(|&i| theta[i]).collect();
            for (name, jac, change) in [
                ("cold", false, 0.0),
                ("warm same", false, 0.0),
                ("warm +2%", false, 0.02),
                ("warm +2% jac", true, 0.02),
                ("warm jac", true, 0.0),
                ("first order +2%", false, 0.02),
                ("first order -0.5%", false, -0.005),
                ("first order 0.2% jac", true, 0.002),
                ("first order 0.2% jac", true, 0.002),
            ] {
                for v in &mut values {
                    *v *= 1.0 + change;
                }
                let t = Instant::now();
                let th = p.full(&values);
                let runs = p.run(&th, if jac { &free } else { &[] }).unwrap();
                let s = t.elapsed().as_secs_f64();
                print!("{path} x{coarsen} {name:14} {s:6.3}s");
                for r in runs.iter().flatten() {
                    let unk = r.run.last.as_ref().map_or(0, |s| s.u.len());
                    let fresh = r.run.steps.iter().filter(|s| !s.revisited).count();
                    print!(
                        " | dofs {unk} targets {} steps {} fresh {fresh} its {} jumps {} fail {:?}",
                        r.plan.targets.len(),
                        r.run.steps.len(),
                        r.run.iterations,
                        r.run.jumps.len(),
                        r.run.failure
                    );
                }
                println!();
            }
            let _ = p.predict(&values, false);
        }
    }
}
