//! `hidden`: makes the cases, diagnoses them, writes docs/hidden.md. `just hidden` does it all.

use clap::{Parser, ValueEnum};
use hidden_suite::forward::Fineness;
use hidden_suite::report::{Beside, Study};
use hidden_suite::run::Drawn;
use hidden_suite::spec::{Spec, suite};
use hidden_suite::{generate::generate, imitate, report, run};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Duration;

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum What {
    /// Make the cases that are not there yet.
    Generate,
    /// Measure what the base model can imitate, where that is not done yet.
    Imitate,
    /// Diagnose the cases that have no result yet.
    Run,
    /// Diagnose once more the cases with one effect that the record can see, that effect taken from the catalogue.
    LeaveOut,
    /// Write the document from the results that are there.
    Report,
    /// All of this.
    All,
}

/// The hidden-effect study.
#[derive(Parser)]
struct Args {
    /// What to do.
    what: What,
    /// Where the cases live.
    #[arg(long, default_value = "runs/hidden")]
    dir: PathBuf,
    /// Seed of the first case; the others follow it.
    #[arg(long, default_value_t = 31_000)]
    seed: u64,
    /// Takes every n-th case of the suite.
    #[arg(long, default_value_t = 1)]
    every: usize,
    /// Only these cases (`case-017`).
    #[arg(long)]
    only: Vec<String>,
    /// Cases at a time.
    #[arg(long, default_value_t = 2)]
    jobs: usize,
    /// Longest diagnosis of one case, s.
    #[arg(long, default_value_t = 900)]
    limit_s: u64,
    /// The document.
    #[arg(long, default_value = "docs/hidden.md")]
    doc: PathBuf,
    /// Another program's results of the same cases (folders with a `result.json` each), to stand beside on the page.
    #[arg(long)]
    beside: Option<PathBuf>,
    /// What the page calls that program.
    #[arg(long, default_value = "beside")]
    beside_name: String,
    /// Commit of the program that answered, for the page.
    #[arg(long)]
    commit: Option<String>,
    /// Print every step of the search.
    #[arg(long)]
    verbose: bool,
}

fn main() -> ExitCode {
    let args = Args::parse();
    let specs: Vec<Spec> = suite(&effects::catalogue(), args.seed)
        .into_iter()
        .step_by(args.every.max(1))
        .filter(|s| args.only.is_empty() || args.only.contains(&s.name))
        .collect();
    let mut good = true;
    if matches!(args.what, What::Generate | What::All) {
        good &= make(&args, &specs);
    }
    if matches!(args.what, What::Imitate | What::All) {
        good &= measure(&args, &specs);
    }
    if matches!(args.what, What::Run | What::All) {
        good &= diagnose(&args, &specs);
    }
    if matches!(args.what, What::LeaveOut | What::All) {
        good &= leave_out(&args, &specs);
    }
    if matches!(args.what, What::Report | What::All) {
        good &= document(&args, &specs);
    }
    if good { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}

fn folder(args: &Args, spec: &Spec) -> PathBuf {
    args.dir.join(&spec.name)
}

fn make(args: &Args, specs: &[Spec]) -> bool {
    let missing: Vec<&Spec> =
        specs.iter().filter(|s| !folder(args, s).join("truth.json").is_file()).collect();
    eprintln!("{} of {} cases to make", missing.len(), specs.len());
    let failed = std::sync::atomic::AtomicBool::new(false);
    run::each(&missing, args.jobs, |spec| {
        let start = std::time::Instant::now();
        match generate(spec, &Fineness::STUDY, &folder(args, spec)) {
            Ok(t) => eprintln!(
                "{} {:?} {:?} {:?}: rms/noise {}, beyond the base {:.1}, mesh {}, σc × {:.2}, {:.1} s",
                t.name,
                t.protocol,
                t.effects,
                t.strengths,
                short(&t.effect_rms_over_noise),
                t.what_no_base_parameter_imitates_over_noise,
                short(&t.mesh_error_rms_over_noise),
                t.tissue.shrunk,
                start.elapsed().as_secs_f64()
            ),
            Err(e) => {
                failed.store(true, std::sync::atomic::Ordering::Relaxed);
                eprintln!("{} {:?}: {e}", spec.name, spec.hidden);
            }
        }
    });
    !failed.into_inner()
}

/// Folders of complete cases for which something is still to be done.
fn open(args: &Args, specs: &[Spec], done: impl Fn(&Path) -> bool) -> Vec<PathBuf> {
    let all = specs.iter().map(|s| folder(args, s));
    all.filter(|f| f.join("truth.json").is_file() && !done(f)).collect()
}

fn measure(args: &Args, specs: &[Spec]) -> bool {
    let open = open(args, specs, |f| imitate::stored(f).is_some() || !imitate::worth(f));
    eprintln!("{} cases to imitate", open.len());
    let failed = std::sync::atomic::AtomicBool::new(false);
    run::each(&open, args.jobs, |f| {
        let start = std::time::Instant::now();
        match imitate::measure(f) {
            Ok(left) => {
                for (effect, l) in &left {
                    let moved = l
                        .moved
                        .as_ref()
                        .map_or(String::new(), |(p, by)| format!(", {p} {:+.0} %", 100.0 * by));
                    let seconds = start.elapsed().as_secs_f64();
                    eprintln!(
                        "{} {effect}: {:.1} → {:.1}{moved} ({}, {seconds:.0} s)",
                        name(f),
                        l.before,
                        l.after,
                        l.stop
                    );
                }
            }
            Err(e) => {
                failed.store(true, std::sync::atomic::Ordering::Relaxed);
                eprintln!("{}: {e}", name(f));
            }
        }
    });
    !failed.into_inner()
}

fn diagnose(args: &Args, specs: &[Spec]) -> bool {
    let open = open(args, specs, |f| run::stored(f, Drawn::All).is_some());
    eprintln!("{} cases to diagnose", open.len());
    ask(args, &open, Drawn::All);
    true
}

fn leave_out(args: &Args, specs: &[Spec]) -> bool {
    let worth = |f: &Path| run::stored(f, Drawn::All).is_some_and(|o| o.is_visible_single());
    let open = open(args, specs, |f| run::stored(f, Drawn::LeftOut).is_some() || !worth(f));
    eprintln!("{} cases to diagnose without their effect", open.len());
    ask(args, &open, Drawn::LeftOut);
    true
}

fn ask(args: &Args, open: &[PathBuf], drawn: Drawn) {
    run::each(open, args.jobs, |f| {
        let say = |s: &str| {
            if args.verbose {
                eprintln!("  {}: {s}", name(f));
            }
        };
        match run::run_case(f, drawn, Duration::from_secs(args.limit_s), &say) {
            Ok(o) => eprintln!(
                "{} {:?} signal {:.1} → {} {:?} {:?} ({:?}, {:.0} s)",
                o.truth.name,
                o.truth.effects,
                o.truth.what_no_base_parameter_imitates_over_noise,
                o.verdict,
                o.groups,
                o.grade(),
                o.end,
                o.seconds
            ),
            Err(e) => eprintln!("{}: {e}", name(f)),
        }
    });
}

fn short(by_test: &BTreeMap<String, f64>) -> String {
    by_test.iter().map(|(t, v)| format!("{t} {v:.2}")).collect::<Vec<_>>().join(" ")
}

fn name(folder: &Path) -> String {
    folder.file_name().map_or(String::new(), |n| n.to_string_lossy().into_owned())
}

fn document(args: &Args, specs: &[Spec]) -> bool {
    let stored = |drawn: Drawn| -> Vec<_> {
        specs.iter().filter_map(|s| run::stored(&folder(args, s), drawn)).collect()
    };
    let outcomes = stored(Drawn::All);
    let beside = args.beside.as_ref().map(|dir| Beside::new(&args.beside_name, &outcomes, dir));
    let study = Study {
        command: format!("-- all --seed {} --every {} --limit-s {}", args.seed, args.every, args.limit_s),
        commit: args.commit.clone(),
        planned: specs.len(),
        left_out: stored(Drawn::LeftOut),
    };
    let text = report::page(&outcomes, &study, beside.as_ref());
    match std::fs::write(&args.doc, text) {
        Ok(()) => {
            eprintln!("{} results → {}", outcomes.len(), args.doc.display());
            true
        }
        Err(e) => {
            eprintln!("{}: {e}", args.doc.display());
            false
        }
    }
}
