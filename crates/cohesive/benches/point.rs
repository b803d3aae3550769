//! Cost of one point of the law: traction, analytic tangent, tangent by jets.

use cohesive::Cohesive;
use constitutive::{Context, Describe, Law, tangent_by_jets_3};
use criterion::{Criterion, criterion_group, criterion_main};
use std::hint::black_box;

const PARAMS: [f64; cohesive::PARAMETERS] = [0.23, 0.2, 1.0, 10.0];
const OPENING: [f64; 3] = [0.3, 0.05, -0.02];

fn point(c: &mut Criterion) {
    let ctx = Context::default();
    for (name, delta_max) in [("loading", 0.1), ("unloading", 0.8)] {
        let (old, mut new) = ([delta_max], [0.0]);
        let mut group = c.benchmark_group(name);
        group.bench_function("traction", |b| {
            b.iter(|| {
                Cohesive.respond(
                    &ctx,
                    black_box(&OPENING),
                    black_box(&PARAMS[..]),
                    black_box(&old[..]),
                    &mut new,
                )
            })
        });
        group.bench_function("analytic tangent", |b| {
            b.iter(|| {
                let (o, p) = (black_box(&OPENING), black_box(&PARAMS[..]));
                Cohesive.analytic_tangent(&ctx, o, p, black_box(&old[..]), &mut new)
            })
        });
        group.bench_function("jet tangent", |b| {
            b.iter(|| {
                let (o, p) = (black_box(&OPENING), black_box(&PARAMS[..]));
                tangent_by_jets_3(&Cohesive, &ctx, o, p, black_box(&old[..]), &mut new)
            })
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
