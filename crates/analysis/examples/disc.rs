//! The search for what is missing, with every model that it weighed: `cargo run --release -p analysis --example disc -- FILE…`
//! (`V=1`: what it does, as it does it).

use analysis::{FeLadder, LadderSettings, Meter, Metered, NoJournal, Weighed};
use std::path::Path;
use std::sync::Arc;
use std::time::Instant;

fn main() {
    let catalogue = effects::catalogue();
    let verbose = std::env::var("V").is_ok();
    for path in std::env::args().skip(1) {
        let case = match input::read_case(Path::new(&path), &catalogue) {
            Ok(case) => case,
            Err(why) => {
                println!("{path}: {why}");
                continue;
            }
        };
        let begun = Instant::now();
        let progress = |s: &str| {
            if verbose {
                eprintln!("{:7.2} s {s}", begun.elapsed().as_secs_f64());
            }
        };
        let (meter, go) = (Meter::new(true), || false);
        let metered = Metered::new(&go, &meter);
        let how = LadderSettings {
            catalogue: &catalogue,
            policy: diagnose::Policy::default(),
            progress: &progress,
            cancelled: &metered,
            journal: &NoJournal,
        };
        match FeLadder::search(Arc::new(case), how) {
            Ok(s) => {
                show(&path, &s.weighed, &s.ladder);
                s.left_out.iter().for_each(|l| println!("   without {l:?}"));
            }
            Err(why) => println!("== {path}: {why}"),
        }
        for p in meter.spent() {
            println!(
                "   {:?}: {} runs, {} steps, {} iterations, {:.1} CPU s",
                p.phase,
                p.runs,
                p.load_steps,
                p.newton_iterations,
                p.cpu_seconds.unwrap_or_default()
            );
        }
    }
}

fn show(path: &str, weighed: &Weighed, ladder: &FeLadder) {
    let Weighed { discovery: d, probable: p, averaged } = weighed;
    println!("== {path}: {:?} {:?} groups {:?}", d.verdict, d.found, d.groups);
    println!("   {} ({:?}, not fitted {:.3})", p.sentence(), p.left.explained_to, p.posterior.not_fitted);
    for (asked, brief) in &p.posterior.sensitivity {
        let top = brief.effects.iter().max_by(|a, b| a.1.total_cmp(b.1));
        println!("   {asked}: {top:?}, nothing {:.3}, else {:.3}", brief.nothing, brief.something_else);
    }
    for s in p.posterior.sets.iter().take(8) {
        println!("   {:.3} {:.3} {:?}", s.probability, s.with_something_else, s.effects);
    }
    for (path, v) in averaged.iter().flat_map(|a| a.path_means.iter().chain(&a.parameters)) {
        println!("   {path} {:.4} ({:.4} to {:.4}) {}", v.value, v.interval_95[0], v.interval_95[1], v.unit);
    }
    for (set, f) in &ladder.fitted_models {
        let settled = if f.settled { "on the file's mesh" } else { "" };
        println!("      {set:?} χ² {:.1} {settled}", f.fit.f);
    }
}
