//! How a forward run and its factorisation grow with the unknowns, and how far the factorisation is from what dense
//! products reach on this machine: `cargo run --release -p fem --example scaling`. One thread.

#[path = "../tests/all/common/mod.rs"]
mod common;

use common::*;
use constitutive::Context;
use faer::linalg::matmul::matmul;
use faer::{Accum, Mat, Par};
use fem::{History, System};
use std::time::Instant;

/// Seconds of the quickest of some calls.
fn quickest(times: usize, mut f: impl FnMut()) -> f64 {
    let one = |_| {
        let begun = Instant::now();
        f();
        begun.elapsed().as_secs_f64()
    };
    (0..times).map(one).fold(f64::INFINITY, f64::min)
}

/// Floating-point operations per second of a dense product.
fn dense() -> f64 {
    let n = 1000;
    let a = Mat::from_fn(n, n, |i, j| 1.0 / (1.0 + (i + j) as f64));
    let mut c = Mat::<f64>::zeros(n, n);
    2.0 * (n as f64).powi(3)
        / quickest(5, || matmul(c.as_mut(), Accum::Replace, a.as_ref(), a.as_ref(), 1.0, Par::Seq))
}

fn main() {
    let peak = dense();
    println!("dense product: {:.1} GF/s", peak / 1e9);
    println!(
        "unknowns  run of 2 steps (s)  assembly (ms)  factorisation (ms)    GF  of dense  solution (ms)"
    );
    let mut ends: Vec<(f64, f64)> = Vec::new();
    for n in [10, 15, 20, 30, 40, 47] {
        let problem = problem(&peer_strip([2 * n, 5 * n, 2], true, false), Ends::Clamped, 1);
        let theta = Tissue::peers(1.0, 0.1).theta(1);
        let begun = Instant::now();
        let state = complete(&problem, &theta, &plan(ramp(0.0, 0.5, 2)), shipped()).last.expect("converged");
        let run = begun.elapsed().as_secs_f64();
        let mut system = System::new(&problem).expect("system");
        let (local, old) = (problem.local(&theta), state.history.clone());
        let mut new = History::virgin(&problem);
        let assembly = quickest(3, || {
            let _ = system.assemble(
                &problem,
                &local,
                &Context::default(),
                &state.u,
                fem::Pressures::Own,
                &old,
                &mut new,
            );
        });
        let values = system.values.clone();
        let factorisation = quickest(3, || system.factor.factorise(&values));
        let rhs = vec![1.0; system.unknowns];
        let solution = quickest(3, || {
            let _ = system.factor.solve(&mut rhs.clone(), 1);
        });
        let flops = system.factor.flops();
        println!(
            "{:8}  {run:18.2}  {:13.1}  {:18.1}  {:4.1}  {:6.0} %  {:13.1}",
            system.unknowns,
            1e3 * assembly,
            1e3 * factorisation,
            flops / 1e9,
            100.0 * flops / factorisation / peak,
            1e3 * solution
        );
        ends.push((system.unknowns as f64, run));
    }
    if let (Some(a), Some(b)) = (ends.first(), ends.last()) {
        println!("exponent of the run over the whole range: {:.2}", (b.1 / a.1).ln() / (b.0 / a.0).ln());
    }
}
