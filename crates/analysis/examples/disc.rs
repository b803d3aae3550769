//! Runs discover on a case: `cargo run --release -p analysis --example disc -- FILE`.
use std::sync::Arc;
fn main() {
    let cat = effects::catalogue();
    for path in std::env::args().skip(1) {
        let case = input::read_case(std::path::Path::new(&path), &cat).unwrap_or_else(|e| panic!("{e}"));
        let t = std::time::Instant::now();
        let verbose = std::env::var("V").is_ok();
        let progress = |s: &str| {
            if verbose {
                eprintln!("{:6.2}s {s}", t.elapsed().as_secs_f64())
            }
        };
        let policy = diagnose::Policy::default();
        let meter = analysis::Meter::new(true);
        let go = || false;
        let metered = analysis::Metered::new(&go, &meter);
        let how = analysis::How {
            catalogue: &cat,
            policy: policy.clone(),
            progress: &progress,
            cancelled: &metered,
            journal: &analysis::NoJournal,
        };
        if std::env::var("WEIGH").is_ok() {
            weigh(&path, case, how, &meter);
            continue;
        }
        let mut l = match analysis::FeLadder::new(Arc::new(case), how) {
            Ok(l) => l,
            Err(e) => {
                println!("{path}: {e}");
                continue;
            }
        };
        println!("== {path} base {:.2}s", t.elapsed().as_secs_f64());
        match l.search() {
            Err(e) => println!("   error {e}"),
            Ok(d) => {
                println!(
                    "   {:?} found {:?} groups {:?}  {:.1}s runs {}",
                    d.verdict,
                    d.found,
                    d.groups,
                    t.elapsed().as_secs_f64(),
                    l.runs()
                );
                for p in meter.spent() {
                    println!(
                        "      {:?}: {} runs, {} steps, {} iterations, {:.1} CPU s",
                        p.phase,
                        p.runs,
                        p.load_steps,
                        p.newton_iterations,
                        p.cpu_seconds.unwrap_or_default()
                    );
                }
                match l.probable() {
                    Ok(p) => {
                        println!("   {}", p.sentence());
                        println!("   {:?} not fitted {:.3}", p.left.explained_to, p.posterior.not_fitted);
                        for s in p.posterior.sets.iter().take(6) {
                            println!(
                                "      {:.3} {:.3} {:?}",
                                s.probability, s.with_something_else, s.effects
                            );
                        }
                    }
                    Err(e) => println!("   no probabilities: {e}"),
                }
                let tried = d.tried.iter().filter(|r| !d.ladder.contains(r));
                for r in d.ladder.iter().chain(tried) {
                    println!(
                        "   {:?} p {} rms {:.5} chi2 {:.2} tot {:.2} bic {:.0} held {:?} struct {:.1e}",
                        r.effects,
                        r.parameters,
                        r.rms,
                        r.reduced_chi2,
                        r.reduced_chi2_total(),
                        r.bic,
                        r.held_out_chi2,
                        r.structure_p
                    );
                }
                for f in d.screen.findings.iter().take(30) {
                    println!(
                        "      {:24} fall {:8.1} p {:.1e} q {:.1e} vis {:.3} snr {:.1} {} {:?} {:?} alike {:?}",
                        f.effect,
                        f.fall,
                        f.p_value,
                        f.q_value,
                        f.visibility,
                        f.snr,
                        if f.significant { "SIG" } else { "" },
                        f.amplitudes,
                        f.shape,
                        f.look_alikes
                    );
                }
            }
        }
    }
}

/// Probabilities from real fits of every effect.
fn weigh(path: &str, case: input::Case, how: analysis::How, meter: &analysis::Meter) {
    let found = analysis::FeLadder::weighing(Arc::new(case), how).and_then(|mut l| {
        let p = l.weigh_catalogue()?;
        Ok((p, l))
    });
    match found {
        Err(e) => println!("{path}: {e}"),
        Ok((p, l)) => {
            println!("== {path}: {}", p.sentence());
            for s in p.posterior.sets.iter().take(8) {
                let fit = l.rungs.get(&s.effects).map(|f| (f.settled, f.fit.f));
                println!("   {:.3} {:.3} {:?} {fit:?}", s.probability, s.with_something_else, s.effects);
            }
            for (set, f) in &l.rungs {
                println!("      {set:?} χ² {:.1} settled {}", f.fit.f, f.settled);
            }
            for c in meter.spent() {
                println!("   {c:?}");
            }
        }
    }
}
