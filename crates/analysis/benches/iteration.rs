//! What a search pays: a forward run, a Gauss–Newton iteration (the run with every derivative), a screen of the catalogue.
//! FCT1 on the mesh of a search, from the start values of its file; every run is at values that no run whose states are
//! kept was at, a quarter to a whole percent away.

use analysis::{Base, FeProblem, Measured};
use criterion::{Criterion, criterion_group, criterion_main};
use inverse::Problem as _;
use model::{Discretisation, Model};
use std::path::Path;
use std::sync::Arc;

fn search(c: &mut Criterion) {
    let catalogue = effects::catalogue();
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../configs/FCT1.toml");
    let case = input::read_case(&file, &catalogue).expect("the shipped file is read");
    let how = Discretisation { coarsen: 2.0, ..Discretisation::default() };
    let mut options = analysis::run_options(&case);
    options.stepping.newton.tolerance = 1e-7;
    let model = Model::new(Arc::new(case), &catalogue, how).expect("a model");
    let measured = Measured::of(&model, &model.recorded()).expect("records");
    let (theta, free) = (model.theta(), model.free());
    let start: Vec<f64> = free.iter().map(|&i| theta[i]).collect();
    let problem = FeProblem::new(&model, theta.clone(), free.clone(), &measured.slots, options, &|| false);
    let mut group = c.benchmark_group(format!("FCT1, search mesh, {} free parameters", free.len()));
    for (name, derivatives) in [("forward run", false), ("Gauss-Newton iteration", true)] {
        let mut ways = [-0.005, 0.0, 0.005, -0.0025, 0.0025].into_iter().cycle();
        group.bench_function(name, |b| {
            b.iter(|| {
                let way = ways.next().expect("endless");
                let near: Vec<f64> = start.iter().map(|v| v * (1.0 + way)).collect();
                problem.predict(&near, derivatives).expect("a run")
            })
        });
    }
    let warm = problem.warm();
    let base = Base {
        model: &model,
        theta: &theta,
        free: &free,
        catalogue: &catalogue,
        how,
        options,
        slots: &measured.slots,
        warm: &warm,
        cancelled: &|| false,
    };
    group.bench_function("screen of the catalogue", |b| {
        b.iter(|| base.screen().expect("a screen").secant_runs)
    });
    group.finish();
}

criterion_group! {
    name = benches;
    config = Criterion::default().sample_size(10).warm_up_time(std::time::Duration::from_millis(300))
        .measurement_time(std::time::Duration::from_secs(5));
    targets = search
}
criterion_main!(benches);
