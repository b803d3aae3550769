//! Time of one model's evidence: points, tests, parameters as given (default 800 1 10). `cargo run --release -p evidence --example timing`.

use evidence::{Belief, Evidence, Kernel, Linear, Parameter, Place, Record, RestPrior};
use inverse::{Data, NoiseModel, Random};
use nalgebra::{DMatrix, DVector};
use std::time::Instant;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let numbers: Vec<usize> = std::env::args().skip(1).filter_map(|a| a.parse().ok()).collect();
    let [n, tests, p] = [0, 1, 2].map(|k| numbers.get(k).copied().unwrap_or([800, 1, 10][k]));
    let pull = |i: usize| (3.0 * (i % n) as f64 / n as f64).sin();
    let mut random = Random::new(1);
    let mut parts = Vec::new();
    for t in 0..tests {
        let noise = random.normals(n) * 0.007;
        let wave = |i: usize| 0.01 * (0.02 * i as f64).sin();
        parts.push((
            format!("test {t}"),
            (0..n).map(|i| pull(i) + wave(i) + noise[i]).collect(),
            NoiseModel::ar1(0.007, 0.3),
        ));
    }
    let data = Data::from_parts(parts)?;
    let s: Vec<f64> = (0..n).map(|i| i as f64 / n as f64).collect();
    let places: Vec<Place> = (0..tests)
        .map(|t| Place {
            test: format!("test {t}"),
            s: s.clone(),
            leg: (0..n).map(|i| 12 * i / n).collect(),
            peak: 1.0,
        })
        .collect();
    let record = Record::new(&data, &places, 0.015)?;
    let jacobian = DMatrix::from_fn(n * tests, p, |i, k| (1e-3 * (i * (k + 1)) as f64).cos());
    let one =
        |k| Parameter { path: format!("p{k}"), at: 0.0, belief: Belief::normal(0.0, 0.3), amplitude: false };
    let linear = Linear {
        misfit: data.measured() - DVector::from_fn(n * tests, |i, _| pull(i)),
        jacobian,
        parameters: (0..p).map(one).collect(),
        jumps: Vec::new(),
    };
    for kernel in [Kernel::Plain, Kernel::Orthogonal] {
        let start = Instant::now();
        let e = Evidence::of(&record, &linear, &RestPrior::default(), kernel)?;
        println!(
            "{kernel:?}: {:.3} s, {} sizes of the rest, ln Z {:.3}",
            start.elapsed().as_secs_f64(),
            e.sizes(),
            e.ln_z
        );
    }
    Ok(())
}
