//! Cost of the parts of a forward run: element tangent, assembly, factorisation, solution, a step.

#[path = "../tests/all/common/mod.rs"]
mod common;

use common::*;
use constitutive::Context;
use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use fem::sensitivity::Group;
use fem::{History, NoObserver, Problem, State, System, hex8, run_steps};
use std::hint::black_box;
use std::sync::Arc;

fn strained(divisions: [usize; 3], tear: bool) -> (Problem, Vec<f64>, State) {
    let problem = problem(&peer_strip(divisions, tear, true), Ends::Clamped, 1);
    let theta = Tissue::peers(1.0, 0.1).theta(1);
    let run = complete(&problem, &theta, &plan(ramp(0.0, 1.5, 3)), shipped());
    let state = run.last.expect("converged");
    (problem, theta, state)
}

fn element(c: &mut Criterion) {
    let (problem, theta, state) = strained([8, 20, 2], true);
    let system = System::new(&problem).expect("system");
    let mut group = c.benchmark_group("brick");
    let nodes = fem::gather8(&state.u, &problem.body.hexes[20]);
    let mut out = hex8::Tangent::default();
    let mut scratch = hex8::Scratch::default();
    group.throughput(Throughput::Elements(1));
    group.bench_function("tangent, HGO analytic", |b| {
        b.iter(|| {
            let geo = black_box(&system.geometry()[20]);
            hex8::tangent(
                20,
                &*problem.bulk,
                &Context::default(),
                &theta[..7],
                geo,
                &nodes,
                hex8::Pressure::Own,
                &[],
                &mut [],
                &mut scratch,
                &mut out,
            )
        })
    });
    group.finish();
}

fn matrix(c: &mut Criterion) {
    for divisions in [[20, 50, 4], [40, 100, 4]] {
        let (problem, theta, state) = strained(divisions, true);
        let mut system = System::new(&problem).expect("system");
        let local = problem.local(&theta);
        let old = state.history.clone();
        let mut new = History::virgin(&problem);
        let n = system.unknowns;
        let mut group = c.benchmark_group(format!("{n} unknowns, {} bricks", problem.body.hexes.len()));
        group.throughput(Throughput::Elements(problem.body.hexes.len() as u64));
        group.bench_function("assembly", |b| {
            b.iter(|| {
                system.assemble(
                    &problem,
                    &local,
                    &Context::default(),
                    &state.u,
                    fem::Pressures::Own,
                    &old,
                    &mut new,
                )
            })
        });
        group.throughput(Throughput::Elements(n as u64));
        let values = system.values.clone();
        group.bench_function("factorisation", |b| b.iter(|| system.factor.factorise(black_box(&values))));
        for columns in [1, 20] {
            let rhs = vec![1.0; n * columns];
            group.bench_with_input(BenchmarkId::new("solution", columns), &columns, |b, &columns| {
                b.iter(|| {
                    let mut x = rhs.clone();
                    system.factor.solve(&mut x, columns)
                })
            });
        }
        group.finish();
    }
}

fn forward(c: &mut Criterion) {
    let problem = Arc::new(problem(&peer_strip([8, 20, 2], true, true), Ends::Clamped, 9));
    let theta = Tissue::peers(1.0, 0.1).theta(9);
    let targets = plan(ramp(0.0, 4.0, 20));
    let mut system = System::new(&problem).expect("system");
    let seeds: Vec<usize> = (0..theta.len()).filter(|k| !(5..GC).contains(k)).take(20).collect();
    let mut group = c.benchmark_group("tear 8x20x2, quarter model, 20 steps");
    group.bench_function("force alone", |b| {
        b.iter(|| {
            run_steps(
                &problem,
                &theta,
                &mut system,
                None,
                &targets,
                &mut [],
                &NoObserver,
                Default::default(),
                None,
                &|| false,
            )
        })
    });
    group.bench_function("force and 20 sensitivities", |b| {
        b.iter(|| {
            let mut group = Group::new(&problem, &theta, &seeds);
            let mut columns = group.columns();
            run_steps(
                &problem,
                &theta,
                &mut system,
                None,
                &targets,
                &mut columns,
                &NoObserver,
                Default::default(),
                None,
                &|| false,
            )
        })
    });
    group.finish();
}

criterion_group! {
    name = benches;
    config = Criterion::default().sample_size(10).warm_up_time(std::time::Duration::from_millis(300))
        .measurement_time(std::time::Duration::from_secs(2));
    targets = element, matrix, forward
}
criterion_main!(benches);
