//! Cost of one point of the law: stress, analytic tangent, tangent by jets.

use constitutive::{Context, Describe, Law, tangent_by_jets_9};
use criterion::{Criterion, criterion_group, criterion_main};
use hgo::{FibreInvariants, Hgo};
use std::hint::black_box;

const PARAMS: [f64; hgo::PARAMETERS] = [5.1e-3, 0.9388, 20.09, 0.6725, 0.23, 0.1, 0.0];
const BOTH_FAMILIES: [f64; 9] = [0.95, 0.02, 0.01, 0.03, 1.1, -0.02, 0.0, 0.01, 0.96];
const NO_FAMILY: [f64; 9] = [1.0, 0.01, 0.0, 0.0, 0.85, 0.0, 0.0, 0.02, 1.05];

fn point(c: &mut Criterion) {
    let ctx = Context::default();
    let isochoric = Hgo::default();
    let full = Hgo { fibre_invariants: FibreInvariants::Full, ..isochoric };
    let strained = |law: &Hgo, f| (0..2).filter(|&k| hgo::fibre_strain(law, f, &PARAMS, k) > 0.0).count();
    assert_eq!((strained(&isochoric, &BOTH_FAMILIES), strained(&isochoric, &NO_FAMILY)), (2, 0));

    for (name, law, f) in [
        ("isochoric, two families", isochoric, BOTH_FAMILIES),
        ("isochoric, no family", isochoric, NO_FAMILY),
        ("full, two families", full, BOTH_FAMILIES),
    ] {
        let mut group = c.benchmark_group(name);
        group.bench_function("stress", |b| {
            b.iter(|| law.respond(&ctx, black_box(&f), black_box(&PARAMS[..]), &[], &mut []))
        });
        group.bench_function("analytic tangent", |b| {
            b.iter(|| law.analytic_tangent(&ctx, black_box(&f), black_box(&PARAMS[..]), &[], &mut []))
        });
        group.bench_function("jet tangent", |b| {
            b.iter(|| tangent_by_jets_9(&law, &ctx, black_box(&f), black_box(&PARAMS[..]), &[], &mut []))
        });
        group.finish();
    }
}

criterion_group! {
    name = benches;
    config = Criterion::default().sample_size(50).warm_up_time(std::time::Duration::from_millis(500))
        .measurement_time(std::time::Duration::from_secs(2));
    targets = point
}
criterion_main!(benches);
