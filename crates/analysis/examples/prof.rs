//! Times a forward run and a Gauss-Newton iteration at given values.
use std::sync::Arc;
fn main() {
    let path = std::env::args().nth(1).unwrap();
    let cat = model::Catalogue::default();
    let mut case = input::read_case(std::path::Path::new(&path), &cat).unwrap_or_else(|e| panic!("{e}"));
    case.bulk.mu = input::Value::new(0.0051); case.bulk.k1 = input::Value::new(0.9388); case.bulk.k2 = input::Value::new(20.09);
    case.bulk.gamma = input::Value::new(38.53f64.to_radians()); case.bulk.kappa = input::Value::new(0.23);
    case.interface.gc = [0.089,0.090,0.110,0.123,0.085,0.125].map(input::Value::new).to_vec();
    case.interface.sigma_c = [0.029,0.042,0.051,0.067,0.093,0.120].map(input::Value::new).to_vec();
    let m = model::Model::new(Arc::new(case), &cat, model::Discretisation::default()).unwrap();
    let theta = m.theta();
    let wanted = vec![true; m.tests.len()];
    let meas = analysis::Measured::of(&m, &wanted).unwrap();
    for kind in [0, 1] {
        for rep in 0..2 {
        let free: Vec<usize> = if kind == 0 { vec![] } else { m.free() };
        let t = std::time::Instant::now();
        let p = analysis::FeProblem::new(&m, theta.clone(), free.clone(), &meas.slots, Default::default(), &|| false);
        let runs = p.run(&theta, &free).unwrap();
        let el = t.elapsed().as_secs_f64();
        let g = p.gather(&runs, &theta, false).unwrap();
        let r = meas.data.misfit(&g.values);
        println!("free {} rep {rep}: {el:.2}s chi2/n {:.3}", free.len(), r.iter().zip(meas.data.blocks.iter().flat_map(|b| std::iter::repeat_n(b.noise.sd, b.range.len()))).map(|(r, s)| (r / s).powi(2)).sum::<f64>() / r.len() as f64);
        for r in runs.iter().flatten() { println!("   test {} steps {} revisited {} it {} jumps {} unknowns {}", r.test, r.run.steps.len(), r.run.steps.iter().filter(|s| s.revisited).count(), r.run.iterations, r.run.jumps.len(), m.tests[r.test].unknowns()); }
        let t = std::time::Instant::now();
        let _ = p.run(&theta, &free).unwrap();
        println!("   warm {:.2}s", t.elapsed().as_secs_f64());
        }
    }
}
