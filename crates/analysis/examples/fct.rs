//! Scratch run.
use std::sync::Arc;
fn main() {
    let path = std::env::args().nth(1).unwrap();
    let joint = std::env::args().nth(2).is_some();
    let cat = model::Catalogue::default();
    let mut case = input::read_case(std::path::Path::new(&path), &cat).unwrap_or_else(|e| panic!("{e}"));
    if joint { case.identify.mode = input::Mode::Joint; }
    let t = std::time::Instant::now();
    let progress = |p: &analysis::Progress| eprintln!("{:6.2}s {} coarse={} it={} f={:?} acc={}", t.elapsed().as_secs_f64(), p.stage.word(), p.coarse, p.iterate.iteration, p.iterate.f, p.iterate.accepted);
    let r = analysis::identify(Arc::new(case), &cat, &analysis::Control { progress: &progress, cancelled: &|| false }).unwrap_or_else(|e| panic!("{e}"));
    println!("unknowns {:?} runs {} it {} {:.1}s", r.model.tests.iter().map(|t| t.unknowns()).collect::<Vec<_>>(), r.forward_runs, r.iterations, t.elapsed().as_secs_f64());
    for e in &r.uncertainty.estimates { println!("{:28} {:12.5} [{:12.5}, {:12.5}] id={} bound={}", e.path, e.value, e.interval_95[0], e.interval_95[1], e.identifiable, e.at_bound); }
    for b in &r.quality.blocks { println!("{:?}", b); }
    println!("{:?} total {:?} stop {:?}", r.quality.reduced_chi2, r.quality.reduced_chi2_total, r.stopped);
    for s in r.uncertainty.sloppy_directions() { println!("  {s}"); }
}
