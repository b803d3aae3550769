//! Times the stages of an identification: `cargo run --release -p analysis --example ident -- FILE`.
use std::sync::{Arc, Mutex};
use std::time::Instant;
fn main() {
    let cat = effects::catalogue();
    let verbose = std::env::var("V").is_ok();
    for path in std::env::args().skip(1) {
        let case = input::read_case(std::path::Path::new(&path), &cat).unwrap_or_else(|e| panic!("{e}"));
        let t = Instant::now();
        let stages: Mutex<Vec<(String, usize, usize, f64)>> = Mutex::new(Vec::new());
        let last = Mutex::new(0.0);
        let progress = |p: &analysis::Progress| {
            let now = t.elapsed().as_secs_f64();
            let name =
                format!("{} {} p{}", p.stage.word(), if p.coarse { "coarse" } else { "fine" }, p.paths.len());
            let mut s = stages.lock().unwrap();
            let mut l = last.lock().unwrap();
            if p.iterate.iteration == 0 || s.last().is_none_or(|x| x.0 != name) {
                s.push((name.clone(), 0, 0, 0.0));
            }
            let e = s.last_mut().unwrap();
            e.1 += 1;
            e.2 += usize::from(!p.iterate.accepted);
            e.3 += now - *l;
            if verbose {
                eprintln!(
                    "{now:7.2} {:5.2} {name} it {} {} f {:?} damping {:.1e}",
                    now - *l,
                    p.iterate.iteration,
                    if p.iterate.accepted { "ok " } else { "no " },
                    p.iterate.f,
                    p.iterate.damping
                );
            }
            *l = now;
        };
        let (meter, go) = (analysis::Meter::new(true), || false);
        let metered = analysis::Metered::new(&go, &meter);
        let control =
            analysis::Control { progress: &progress, cancelled: &metered, journal: &analysis::NoJournal };
        match analysis::identify(Arc::new(case), &cat, &control) {
            Err(e) => println!("{path}: {e}"),
            Ok(d) => {
                println!(
                    "== {path} {:.1}s runs {} its {} stops {:?}",
                    t.elapsed().as_secs_f64(),
                    d.forward_runs,
                    d.iterations,
                    d.stopped
                );
                for p in meter.spent() {
                    println!("   {p:?}");
                }
                for s in stages.lock().unwrap().iter() {
                    println!("   {:30} runs {:3} rejected {:3} {:7.2}s", s.0, s.1, s.2, s.3);
                }
                for (p, v) in d.model.parameters.iter().zip(&d.theta).filter(|(p, _)| p.free) {
                    println!("   {:32} {v:.5e}", p.path);
                }
                println!(
                    "   quality {:?}",
                    d.quality
                        .blocks
                        .iter()
                        .map(|b| (b.name.clone(), b.reduced_chi2_total))
                        .collect::<Vec<_>>()
                );
            }
        }
    }
}
