//! `hidden`: makes the cases, diagnoses them, writes docs/hidden.md. `just hidden` does it all.

use clap::{Parser, ValueEnum};
use hidden_suite::forward::Fineness;
use hidden_suite::report::{Beside, Study};
use hidden_suite::run::Drawn;
use hidden_suite::spec::{Spec, spread, suite};
use hidden_suite::{GenerateError, archive, files, generate::generate, imitate, report, run};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

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

/// How large the cases are.
#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Size {
    /// Four areas, elements of 0.9 mm: some minutes each.
    Study,
    /// Two areas, elements of 1.4 mm: many records.
    Small,
}

impl Size {
    const fn fineness(self) -> Fineness {
        match self {
            Self::Study => Fineness::STUDY,
            Self::Small => Fineness::SMALL,
        }
    }
}

/// The hidden-effect study.
#[derive(Parser)]
struct Args {
    /// What to do.
    what: What,
    /// Where the cases live (runs/hidden, or runs/hidden-small).
    #[arg(long)]
    dir: Option<PathBuf>,
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
    /// Starts no further case after so many minutes.
    #[arg(long)]
    minutes: Option<u64>,
    /// Results in one file, one case a line: what it holds is not asked again, what is found goes into it.
    #[arg(long)]
    results: Option<PathBuf>,
    /// The document.
    #[arg(long, default_value = "docs/hidden.md")]
    doc: PathBuf,
    /// Another program's results of the same cases (folders with a `result.json` each), to stand beside on the page.
    #[arg(long)]
    beside: Option<PathBuf>,
    /// What the page calls that program.
    #[arg(long, default_value = "beside")]
    beside_name: String,
    /// Commit of the program that answers, for the page and the results.
    #[arg(long)]
    commit: Option<String>,
    /// Meshes of the records and of the fit.
    #[arg(long, value_enum, default_value_t = Size::Study)]
    size: Size,
    /// Print every step of the search.
    #[arg(long)]
    verbose: bool,
}

impl Args {
    fn dir(&self) -> PathBuf {
        self.dir.clone().unwrap_or_else(|| match self.size {
            Size::Study => "runs/hidden".into(),
            Size::Small => "runs/hidden-small".into(),
        })
    }
}

fn main() -> ExitCode {
    let args = Args::parse();
    let specs: Vec<Spec> = suite(&effects::catalogue(), args.seed)
        .into_iter()
        .step_by(args.every.max(1))
        .filter(|s| args.only.is_empty() || args.only.contains(&s.name))
        .collect();
    let results = args.results.as_ref();
    let ready = results.is_none_or(|path| told(path, archive::unpack(path, &args.dir())));
    // Not over what could not be read, or is of another study.
    let good = ready && are_of_this_study(&args, &specs) && {
        let answered = study(&args, &specs);
        let program = args.commit.as_deref();
        let kept = results.is_none_or(|path| told(path, archive::pack(&args.dir(), path, program)));
        let wanted = matches!(args.what, What::Report | What::All);
        answered & kept & (!wanted || document(&args, &specs))
    };
    if good { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}

fn told(path: &Path, done: Result<usize, GenerateError>) -> bool {
    match &done {
        Ok(cases) => eprintln!("{cases} cases in {}", path.display()),
        Err(e) => eprintln!("{e}"),
    }
    done.is_ok()
}

/// Whether the cases that are there are those of the seed that was asked for: their names are the same for every seed.
fn are_of_this_study(args: &Args, specs: &[Spec]) -> bool {
    let other = specs.iter().find_map(|s| {
        let truth = files::truth(&args.dir().join(&s.name)).ok()?;
        (truth.seed != s.seed).then(|| format!("{} is of seed {}, expected {}", s.name, truth.seed, s.seed))
    });
    if let Some(other) = &other {
        eprintln!("{}: {other}; give another --dir, --results or --seed", args.dir().display());
    }
    other.is_none()
}

/// Every case from its records to its answers, a few at a time; each is kept as soon as it is there.
fn study(args: &Args, specs: &[Spec]) -> bool {
    let (failed, begun, keeping) = (AtomicBool::new(false), Instant::now(), Mutex::new(()));
    let late = || args.minutes.is_some_and(|m| begun.elapsed() > Duration::from_secs(60 * m));
    run::each(&spread(specs), args.jobs, |spec| {
        if late() {
            return;
        }
        let answered = one(args, spec);
        let _alone = keeping.lock();
        if !(answered & keep(args)) {
            failed.store(true, Ordering::Relaxed);
        }
    });
    !failed.into_inner()
}

/// Writes what is answered to the file of the results, where one is asked for.
fn keep(args: &Args) -> bool {
    let Some(path) = &args.results else { return true };
    let kept = archive::pack(&args.dir(), path, args.commit.as_deref());
    if let Err(e) = &kept {
        eprintln!("{e}");
    }
    kept.is_ok()
}

/// What is asked for and not there yet of one case.
fn one(args: &Args, spec: &Spec) -> bool {
    let folder = args.dir().join(&spec.name);
    let wanted = |what: What| args.what == what || args.what == What::All;
    let there = || folder.join("truth.json").is_file();
    let mut good = true;
    if wanted(What::Generate) && !there() {
        good &= make(spec, &args.size.fineness(), &folder);
    }
    if wanted(What::Run) && there() && run::stored(&folder, Drawn::All).is_none() {
        good &= ask(args, &folder, Drawn::All);
    }
    // What an answer fitted is a start of the imitation.
    if wanted(What::Imitate) && there() && imitate::stored(&folder).is_none() && imitate::worth(&folder) {
        good &= measure(&folder);
    }
    let visible = || run::stored(&folder, Drawn::All).is_some_and(|o| o.is_visible_single());
    if wanted(What::LeaveOut) && run::stored(&folder, Drawn::LeftOut).is_none() && visible() {
        good &= ask(args, &folder, Drawn::LeftOut);
    }
    good
}

fn make(spec: &Spec, fineness: &Fineness, folder: &Path) -> bool {
    let start = Instant::now();
    match generate(spec, fineness, folder) {
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
            eprintln!("{} {:?}: {e}", spec.name, spec.hidden);
            return false;
        }
    }
    true
}

fn measure(folder: &Path) -> bool {
    let start = Instant::now();
    let left = match imitate::measure(folder) {
        Ok(left) => left,
        Err(e) => {
            eprintln!("{}: {e}", name(folder));
            return false;
        }
    };
    for (effect, l) in &left {
        let moved = l.moved.as_ref().map_or(String::new(), |(p, by)| format!(", {p} {:+.0} %", 100.0 * by));
        let seconds = start.elapsed().as_secs_f64();
        eprintln!(
            "{} {effect}: {:.1} → {:.1}{moved} ({}, {seconds:.0} s)",
            name(folder),
            l.before,
            l.after,
            l.stop
        );
    }
    true
}

fn ask(args: &Args, folder: &Path, drawn: Drawn) -> bool {
    let say = |s: &str| {
        if args.verbose {
            eprintln!("  {}: {s}", name(folder));
        }
    };
    let without = if drawn == Drawn::LeftOut { ", left out" } else { "" };
    match run::run_case(folder, drawn, Duration::from_secs(args.limit_s), &say) {
        Ok(o) => eprintln!(
            "{} {:?}{without} signal {:.1} → {} {:?} {:?} ({:?}, {:.0} s)",
            o.truth.name,
            o.truth.effects,
            o.truth.what_no_base_parameter_imitates_over_noise,
            o.verdict,
            o.groups,
            o.grade(),
            o.end,
            o.seconds
        ),
        Err(e) => {
            eprintln!("{}: {e}", name(folder));
            return false;
        }
    }
    true
}

fn short(by_test: &BTreeMap<String, f64>) -> String {
    by_test.iter().map(|(t, v)| format!("{t} {v:.2}")).collect::<Vec<_>>().join(" ")
}

fn name(folder: &Path) -> String {
    folder.file_name().map_or(String::new(), |n| n.to_string_lossy().into_owned())
}

/// What makes and answers these cases, and goes on where they stop.
fn command(args: &Args) -> String {
    let results = args.results.as_ref().map_or(String::new(), |r| format!(" --results {}", r.display()));
    let size = if args.size == Size::Small { " --size small" } else { "" };
    format!("-- all --seed {} --every {} --limit-s {}{size}{results}", args.seed, args.every, args.limit_s)
}

/// The commits that answered, as far as they are known.
fn programs(args: &Args) -> Option<String> {
    let Some(path) = &args.results else { return args.commit.clone() };
    let all: Vec<String> = archive::programs(path).ok()?.into_iter().collect();
    (!all.is_empty()).then(|| all.join(" and "))
}

fn document(args: &Args, specs: &[Spec]) -> bool {
    let stored = |drawn: Drawn| -> Vec<_> {
        specs.iter().filter_map(|s| run::stored(&args.dir().join(&s.name), drawn)).collect()
    };
    let outcomes = stored(Drawn::All);
    let beside = args.beside.as_ref().map(|dir| Beside::new(&args.beside_name, &outcomes, dir));
    let study = Study {
        command: command(args),
        commit: programs(args),
        planned: specs.len(),
        fineness: args.size.fineness(),
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
