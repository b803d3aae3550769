//! Homogeneous tension against the law without finite elements, and the incompressible limit.
use crate::common;

use common::*;
use hgo::{Hgo, uniaxial};
use mesh::{Sizing, Strip};

fn strip(n: [usize; 3]) -> Strip {
    Strip { sizing: Sizing::Divisions(n), ..Strip::new(10.0, 4.0, 1.0) }
}

#[test]
fn uniaxial_hgo_between_sliding_ends() {
    for (name, bulk) in [("K0 = 1", Tissue::peers(1.0, 0.1).bulk), ("K0 = 20", Tissue::peers(20.0, 0.1).bulk)]
    {
        for (quarter, n) in [(false, [2, 4, 2]), (true, [1, 2, 2])] {
            let strip = Strip { half_height: quarter, half_thickness: quarter, ..strip(n) };
            let problem = problem(&strip, Ends::Sliding, 1);
            let run = complete(&problem, &bulk, &plan(ramp(0.0, 2.5, 10)), tight());
            let stretches: Vec<f64> = at_targets(&run).skip(1).map(|s| 1.0 + s.actuator / 10.0).collect();
            let exact: Vec<f64> = uniaxial::curve(&Hgo::default(), &bulk, &stretches)
                .unwrap()
                .iter()
                .map(|s| 4.0 * s.nominal_stress)
                .collect();
            let forces = &forces(&run)[1..];
            let error = forces.iter().zip(&exact).fold(0.0f64, |m, (a, b)| m.max((a / b - 1.0).abs()));
            let u = &run.last.as_ref().unwrap().u;
            let sides = uniaxial::at(&Hgo::default(), &bulk, 1.25).unwrap().lateral;
            let wide = problem.body.nodes.iter().enumerate().filter(|(_, x)| x[0] == 4.0);
            let side = wide.fold(0.0f64, |m, (k, _)| m.max((1.0 + u[3 * k] / 4.0 - sides[0]).abs()));
            println!("uniaxial HGO, {name}, quarter {quarter}: force {error:.1e}, width {side:.1e}");
            assert!(error < 1e-9 && side < 1e-9);
        }
    }
}

/// P = μ (λ − λ⁻²) of an incompressible neo-Hookean: the departure falls like μ/K0.
#[test]
fn incompressible_limit_of_uniaxial_tension() {
    let (mu, stretch) = (0.005, 1.3f64);
    let exact = 4.0 * mu * (stretch - stretch.powi(-2));
    let mut errors = Vec::new();
    for ratio in [1e1, 1e2, 1e3, 1e4, 1e5] {
        let problem = problem(&strip([1, 2, 1]), Ends::Sliding, 1);
        let run = complete(&problem, &Tissue::neo_hookean(mu, ratio * mu), &plan(ramp(0.0, 3.0, 6)), tight());
        errors.push((forces(&run)[6] / exact - 1.0).abs());
    }
    println!("incompressible limit, K0/mu = 1e1 … 1e5: relative error {}", sci(&errors));
    for w in errors.windows(2) {
        let rate = w[0] / w[1];
        assert!((8.0..12.5).contains(&rate), "{errors:?}");
    }
}

/// A strip mounted so far pulled apart that Newton's method does not find it in one step: the force is the law's at that
/// stretch, as if the grip had gone there, and the history none of the parts.
#[test]
fn a_mounting_too_large_for_one_step() {
    let bulk = Tissue::peers(1.0, 0.1).bulk;
    let mut problem = problem(&strip([2, 4, 2]), Ends::Sliding, 1);
    for apart in [2.0, 4.0, 6.0] {
        let mut supports = (*problem.supports).clone();
        for s in supports.iter_mut().flatten() {
            s.mount = apart * s.grip;
        }
        problem.supports = supports.into();
        let run = complete(&problem, &bulk, &plan(vec![0.1]), tight());
        for (s, force) in at_targets(&run).zip(forces(&run)) {
            let stretch = 1.0 + (apart + s.actuator) / 10.0;
            let exact = 4.0 * uniaxial::at(&Hgo::default(), &bulk, stretch).unwrap().nominal_stress;
            println!("mounted at {apart} mm, {}: {force} N, exact {exact}", s.actuator);
            assert!((force / exact - 1.0).abs() < 1e-8, "{apart} mm: {force} {exact}");
        }
    }
}
