//! Lets the search loose on the cases: a few at a time, one result file each, skipped where it is there.

use crate::GenerateError;
use crate::files::{self, Truth};
use crate::imitate;
use crate::outcome::{End, Outcome, ScreenRow, Stated, Step};
use analysis::{FeLadder, Probable};
use diagnose::{Discovery, FittedModel, Policy, Verdict};
use input::Case;
use model::Catalogue;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

/// What a search may draw on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Drawn {
    /// The whole catalogue.
    All,
    /// The catalogue without what is hidden.
    LeftOut,
}

impl Drawn {
    /// File name of a result.
    pub(crate) const fn file(self) -> &'static str {
        match self {
            Self::All => "result.json",
            Self::LeftOut => "left-out.json",
        }
    }

    fn catalogue(self, truth: &Truth) -> Catalogue {
        match self {
            Self::All => effects::catalogue(),
            Self::LeftOut => truth.effects.iter().fold(effects::catalogue(), |c, e| c.without(e)),
        }
    }
}

/// Calls `work` on every item, `jobs` at a time, each in a pool of one thread (the answer does not depend on threads,
/// and cases are independent).
pub fn each<T: Sync>(items: &[T], jobs: usize, work: impl Fn(&T) + Sync) {
    let next = AtomicUsize::new(0);
    std::thread::scope(|scope| {
        for _ in 0..jobs.max(1) {
            scope.spawn(|| {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build();
                while let Some(item) = items.get(next.fetch_add(1, Ordering::Relaxed)) {
                    match &pool {
                        Ok(p) => p.install(|| work(item)),
                        Err(_) => work(item),
                    }
                }
            });
        }
    });
}

/// Folders of complete cases under `root`, sorted.
///
/// # Errors
/// When the folder cannot be read.
pub fn folders(root: &Path) -> Result<Vec<PathBuf>, GenerateError> {
    let name = root.display().to_string();
    let entries = std::fs::read_dir(root).map_err(|e| GenerateError::file(&name, &e))?;
    let mut list: Vec<PathBuf> =
        entries.flatten().map(|e| e.path()).filter(|p| p.join("truth.json").is_file()).collect();
    list.sort();
    Ok(list)
}

/// The stored result of a case, with what the base can imitate of its truth.
pub fn stored(folder: &Path, drawn: Drawn) -> Option<Outcome> {
    let mut outcome: Outcome =
        serde_json::from_str(&std::fs::read_to_string(folder.join(drawn.file())).ok()?).ok()?;
    outcome.imitated = imitate::stored(folder);
    Some(outcome)
}

/// Diagnoses a case and stores the answer beside it.
///
/// # Errors
/// When the truth cannot be read or the result not be written; a diagnosis that fails is a result.
pub fn run_case(
    folder: &Path,
    drawn: Drawn,
    limit: Duration,
    progress: &(dyn Fn(&str) + Sync),
) -> Result<Outcome, GenerateError> {
    let truth = files::truth(folder)?;
    let start = Instant::now();
    let last = Mutex::new(String::new());
    let told = |s: &str| {
        if let Ok(mut l) = last.lock() {
            s.clone_into(&mut l);
        }
        progress(s);
    };
    // A panic of the product is a result too: one case must not end the study.
    let tried = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| {
        search(folder, &truth, drawn, start + limit, &told)
    }));
    let at = last.into_inner().unwrap_or_default();
    let mut outcome = match tried {
        Ok(Ok(o)) => o,
        Ok(Err(_)) if Instant::now() >= start + limit => empty(truth, End::TimeLimit),
        Ok(Err(why)) => empty(truth, End::Failed(format!("{why}; last said: {at}"))),
        Err(_) => empty(truth, End::Failed(format!("panic; last said: {at}"))),
    };
    outcome.seconds = start.elapsed().as_secs_f64();
    let path = folder.join(drawn.file());
    let fault = |e: &dyn std::fmt::Display| GenerateError::file(&path.display().to_string(), e);
    let json = serde_json::to_string_pretty(&outcome).map_err(|e| fault(&e))?;
    let new = path.with_extension("json.new");
    std::fs::write(&new, json).and_then(|()| std::fs::rename(&new, &path)).map_err(|e| fault(&e))?;
    Ok(outcome)
}

/// The search itself. It is given the records, the config and a catalogue, never the truth.
fn search(
    folder: &Path,
    truth: &Truth,
    drawn: Drawn,
    deadline: Instant,
    progress: &(dyn Fn(&str) + Sync),
) -> Result<Outcome, String> {
    let catalogue = drawn.catalogue(truth);
    let case = input::read_case(&folder.join("config.toml"), &catalogue).map_err(|e| e.to_string())?;
    let policy = Policy::default();
    let late = || Instant::now() >= deadline;
    let how = analysis::LadderSettings {
        catalogue: &catalogue,
        policy: policy.clone(),
        progress,
        cancelled: &late,
        journal: &analysis::NoJournal,
    };
    let analysis::SearchOutcome { weighed: found, ladder, case, .. } =
        FeLadder::search(Arc::new(case), how).map_err(|e| e.to_string())?;
    let averaged_gc = found.averaged.as_ref().and_then(|a| a.path_means.get("gc"));
    let stated = Stated {
        base_gc: base_gc(&case, &ladder, &late),
        averaged_gc: averaged_gc.map(|g| [g.value, g.interval_95[0], g.interval_95[1]]),
        ..stated(&found.probable)
    };
    Ok(Outcome { stated: Some(stated), ..answer(truth.clone(), &ladder, &found.discovery, &policy) })
}

fn stated(p: &Probable) -> Stated {
    Stated {
        effects: p.posterior.effects.clone(),
        nothing: p.posterior.nothing,
        something_else: p.posterior.something_else,
        rest: p.left.rest.all.share_of_peak,
        base_gc: None,
        averaged_gc: None,
    }
}

/// The base model's mean Gc with its interval, as `fct identify` of the same file states them.
fn base_gc(case: &Case, ladder: &FeLadder, late: &(dyn Fn() -> bool + Sync)) -> Option<[f64; 3]> {
    let base = ladder.shown(&[])?;
    let mut fitted = case.clone();
    let values = base.model.parameters.iter().zip(&base.theta).map(|(p, v)| (p.path.as_str(), *v));
    analysis::start_at(&mut fitted, values);
    fitted.identify.priors.around.clear();
    fitted.identify.mode = input::Mode::Joint;
    let evaluator = report::answer::Evaluator {
        published: None,
        catalogue: ladder.catalogue(),
        journal: &analysis::NoJournal,
    };
    let done = evaluator.evaluate(&fitted, "base", &late).ok()?;
    let mean = done.answer.path_means.get("gc")?;
    Some([mean.value, mean.interval_95[0], mean.interval_95[1]])
}

fn answer(truth: Truth, ladder: &FeLadder, d: &Discovery, policy: &Policy) -> Outcome {
    let step = |r: &FittedModel| step(ladder, r, policy);
    Outcome {
        end: if d.interrupted || ladder.interrupted() { End::TimeLimit } else { End::Answered },
        verdict: match d.verdict {
            Verdict::NothingMissing => "nothing_missing",
            Verdict::Explained => "explained",
            Verdict::Ambiguous => "ambiguous",
            Verdict::Unexplained => "unexplained",
        }
        .to_owned(),
        found: d.found.clone(),
        groups: d.groups.clone(),
        screen: d
            .screen
            .findings
            .iter()
            .map(|f| ScreenRow {
                effect: f.effect.clone(),
                fall: f.fall,
                q_value: f.q_value,
                snr: f.snr,
                significant: f.significant,
                refit_only: f.refit_only,
                look_alikes: f.look_alikes.clone(),
            })
            .collect(),
        ladder: d.ladder.iter().map(step).collect(),
        tried: d.tried.iter().map(step).collect(),
        failed: d.failed.clone(),
        forward_runs: ladder.runs(),
        ..empty(truth, End::Answered)
    }
}

fn step(ladder: &FeLadder, r: &FittedModel, policy: &Policy) -> Step {
    let fitted = ladder.fitted_models.get(&FeLadder::key(&r.effects));
    let mean_gc = fitted.map_or(0.0, |f| {
        let gc: Vec<f64> = f
            .model
            .parameters
            .iter()
            .zip(&f.theta)
            .filter(|(p, _)| p.path.starts_with("interface.area[") && p.path.ends_with("].gc"))
            .map(|(_, v)| *v)
            .collect();
        gc.iter().sum::<f64>() / gc.len().max(1) as f64
    });
    Step {
        effects: r.effects.clone(),
        objective: fitted.map_or(r.chi2_total, |f| f.fit.f),
        reduced_chi2_total: r.reduced_chi2_total(),
        bic: r.bic,
        rms_n: r.rms,
        held_out_chi2: r.held_out_chi2,
        structure_p: r.structure_p,
        gc: mean_gc,
        values: fitted.map(values).unwrap_or_default(),
        explained: r.explained(policy),
    }
}

/// Values of what was free.
fn values(fitted: &analysis::Fitted) -> BTreeMap<String, f64> {
    let all = fitted.model.parameters.iter().zip(&fitted.theta);
    all.filter(|(p, _)| p.free).map(|(p, v)| (p.path.clone(), *v)).collect()
}

fn empty(truth: Truth, end: End) -> Outcome {
    Outcome {
        truth,
        end,
        verdict: String::new(),
        found: Vec::new(),
        groups: Vec::new(),
        screen: Vec::new(),
        ladder: Vec::new(),
        tried: Vec::new(),
        failed: Vec::new(),
        stated: None,
        forward_runs: 0,
        seconds: 0.0,
        imitated: None,
    }
}
