//! Cost of the evidence of one model: two tests of three legs, twelve parameters, half of them with a bound.

use criterion::{Criterion, criterion_group, criterion_main};
use evidence::{Belief, Evidence, Judged, Kernel, Linear, Parameter, Place, Record, RestPrior, SetPrior};
use inverse::{Data, NoiseModel, Random};
use nalgebra::{DMatrix, DVector};
use std::hint::black_box;

/// Points of the two tests.
const POINTS: [usize; 2] = [120, 180];
/// Standard deviation of the noise, share of the peak (1 N).
const NOISE: f64 = 0.008;

/// Records that lie within noise of the model, or `wrong` times the peak beside it along a wave.
fn problem(wrong: f64) -> (Record, Linear) {
    let n = POINTS[0] + POINTS[1];
    let s: Vec<f64> = POINTS.iter().flat_map(|&m| (0..m).map(move |i| i as f64 / (m - 1) as f64)).collect();
    let wave = DVector::from_fn(n, |i, _| wrong * (25.0 * s[i]).sin());
    let misfit = Random::new(5).normals(n) * NOISE + wave;
    let predicted = DVector::from_fn(n, |i, _| (3.0 * s[i]).sin());
    let measured = &predicted + &misfit;
    let noise = NoiseModel { freedom: 60.0, ..NoiseModel::white(NOISE) };
    let part = |name: &str, from: usize, m: usize| {
        (name.to_owned(), measured.rows(from, m).iter().copied().collect(), noise.clone())
    };
    let parts = [part("uniaxial", 0, POINTS[0]), part("tearing", POINTS[0], POINTS[1])];
    let data = Data::from_parts(parts).expect("good data");
    let place = |test: &str, from: usize, m: usize| Place {
        test: test.into(),
        s: s[from..from + m].to_vec(),
        leg: (0..m).map(|i| 3 * i / m).collect(),
        peak: 1.0,
    };
    let places = [place("uniaxial", 0, POINTS[0]), place("tearing", POINTS[0], POINTS[1])];
    let record = Record::new(&data, &places, 0.015).expect("a good record");
    let jacobian = DMatrix::from_fn(n, 12, |i, k| 0.5 * ((k as f64 + 1.0) * 1.3 * s[i]).cos());
    let belief =
        |k: usize| if k.is_multiple_of(2) { Belief::normal(0.0, 1.5) } else { Belief::above(-0.005, 0.1) };
    let parameter = |k: usize| Parameter {
        path: format!("p{k}"),
        at: 0.0,
        belief: belief(k),
        amplitude: !k.is_multiple_of(2),
    };
    (record, Linear { misfit, jacobian, parameters: (0..12).map(parameter).collect(), jumps: Vec::new() })
}

fn evidence(c: &mut Criterion) {
    let (rest, sets) = (RestPrior::default(), SetPrior::of_catalogue(22));
    for (name, wrong) in [("noise alone is left", 0.0), ("a rest is left", 0.03)] {
        let (record, linear) = problem(wrong);
        let of = |linear: &Linear| Evidence::of(&record, linear, &rest, Kernel::Plain).expect("an evidence");
        let known = of(&linear);
        let mut group = c.benchmark_group(name);
        group.bench_function("one model", |b| b.iter(|| of(black_box(&linear))));
        group.bench_function("on a few sizes", |b| {
            b.iter(|| Evidence::quick(&record, black_box(&linear), (&rest, &sets), Kernel::Plain))
        });
        group.bench_function("other priors", |b| {
            b.iter(|| Judged::new(&[], black_box(&known), &rest, 1.0, &sets))
        });
        group.finish();
    }
}

criterion_group! {
    name = benches;
    config = Criterion::default().sample_size(10).warm_up_time(std::time::Duration::from_millis(500))
        .measurement_time(std::time::Duration::from_secs(3));
    targets = evidence
}
criterion_main!(benches);
