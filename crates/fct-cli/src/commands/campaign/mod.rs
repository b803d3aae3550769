//! `fct campaign`: a study as tasks that any number of processes do.

mod arguments;
mod workers;

pub use arguments::{Arguments, What};

use crate::outcome::{Failure, Outcome};
use crate::session::Session;
use ::campaign::{
    CampaignError, Folder, Job, Plan, Ran, Status, Tools, Worker, csv_files, forget_failures, methods, page,
    read_or_plan, slurm, status, summary,
};
use ::report::answer::SCHEMA;
use ::report::{html, quoted_path, write_atomic, write_named};
use serde_json::json;
use std::path::Path;

impl From<CampaignError> for Failure {
    fn from(e: CampaignError) -> Self {
        match e {
            CampaignError::Study(faults) => faults.into(),
            CampaignError::Files(fault) => fault.into(),
            other => Self::usage(format!("fct: {other}")),
        }
    }
}

/// Runs one of the commands.
///
/// # Errors
/// Why it gave no answer.
pub fn run(what: &What, session: &Session) -> Result<Outcome, Failure> {
    match what {
        What::Plan(a) => plan(&a.own.study, session),
        What::Run(a) => work(&a.own, session),
        What::Status(a) => tell_status(&a.own.study, session),
        What::Report(a) => report(&a.own.study, session),
        What::Slurm(a) => script(&a.own, session),
    }
}

/// `1 task`, `2 tasks`.
fn many(n: usize, what: &str) -> String {
    format!("{n} {what}{}", if n == 1 { "" } else { "s" })
}

fn plan(study: &Path, session: &Session) -> Result<Outcome, Failure> {
    let (plan, folder) = Plan::of(study, &session.catalogue)?;
    plan.store(&folder)?;
    let json = json!({ "schema": SCHEMA, "folder": folder.path(), "plan": plan });
    let mut text = format!(
        "{}: {}, {}, {}, planned in {}\n",
        plan.study,
        many(plan.specimens.len(), "specimen"),
        many(plan.models.len(), "model"),
        many(plan.tasks.len(), "task"),
        folder.path().display()
    );
    for specimen in &plan.specimens {
        let of = |t: &&::campaign::Task| plan.specimens[t.specimen].row == specimen.row;
        let count = plan.tasks.iter().filter(of).count();
        text.push_str(&format!(
            "  row {}: {}, {} ({})\n",
            specimen.row,
            specimen.name,
            group(&specimen.group),
            many(count, "task")
        ));
    }
    wrong_rows(&mut text, &plan);
    text.push_str(&format!("next: fct campaign run {}\n", quoted_path(study)));
    let mut outcome = Outcome::new(&json, text)?;
    outcome.partial = some_wrong(&plan);
    Ok(outcome)
}

fn group(name: &str) -> String {
    if name.is_empty() { "no group".into() } else { format!("group {name}") }
}

fn wrong_rows(text: &mut String, plan: &Plan) {
    for wrong in &plan.wrong {
        text.push_str(&format!("row {} is left out:\n{}\n", wrong.row, wrong.reason));
    }
}

/// The rest was done: said, and told by the exit code.
fn some_wrong(plan: &Plan) -> Option<String> {
    match plan.wrong.len() {
        0 => None,
        1 => Some("1 row of the table cannot be used".into()),
        n => Some(format!("{n} rows of the table cannot be used")),
    }
}

fn work(arguments: &arguments::Run, session: &Session) -> Result<Outcome, Failure> {
    let (plan, folder) = read_or_plan(&arguments.study, &session.catalogue)?;
    if arguments.retry {
        forget_failures(&plan, &folder, arguments.shard)?;
    }
    let ran = match arguments.workers {
        0 | 1 => alone(&plan, &folder, arguments, session)?,
        many => workers::run(many.into(), &plan, &folder, arguments, session)?,
    };
    let now = status(&plan, &folder);
    let mut text = format!(
        "{} done, {} failed now; {} had a result, {} are done elsewhere, {} are set aside\n{}",
        ran.done,
        ran.failed,
        ran.before,
        ran.elsewhere,
        ran.set_aside,
        status_in_words(&now)
    );
    wrong_rows(&mut text, &plan);
    for why in &ran.changed {
        text.push_str(&format!("not done: {why}\n"));
    }
    let ran_json = json!({
        "done": ran.done, "failed": ran.failed, "before": ran.before, "elsewhere": ran.elsewhere,
        "set_aside": ran.set_aside, "changed": ran.changed, "stopped": ran.stopped,
    });
    let mut outcome = Outcome::new(&json!({ "schema": SCHEMA, "ran": ran_json, "status": now }), text)?;
    outcome.partial = match &ran {
        Ran { stopped: true, .. } => Some("stopped by the user; the same command goes on".into()),
        Ran { changed, .. } if !changed.is_empty() => {
            Some("files have changed since the study was planned".into())
        }
        Ran { failed, set_aside, .. } if failed + set_aside > 0 => {
            let tasks = if *failed == 1 { "task" } else { "tasks" };
            Some(format!("{failed} {tasks} failed, {set_aside} set aside; `fct campaign status` says why"))
        }
        _ => some_wrong(&plan),
    };
    Ok(outcome)
}

/// This process is the worker.
fn alone(plan: &Plan, folder: &Folder, a: &arguments::Run, session: &Session) -> Result<Ran, Failure> {
    let progress = session.progress(&plan.study);
    let (note, stops) = (|s: &str| progress.note(s), || session.cancelled());
    let tools = Tools { catalogue: &session.catalogue, watch: &stops, note: &note };
    Ok(::campaign::run(plan, folder, Worker { shard: a.shard, tools })?)
}

fn status_in_words(s: &Status) -> String {
    let mut text = format!(
        "{}: {} tasks: {} done, {} failed, {} running, {} waiting, {} set aside\n",
        s.study, s.tasks, s.done, s.failed, s.running, s.waiting, s.set_aside
    );
    for t in &s.look_at {
        let repeat = if t.repeat > 0 { format!(", repeat {}", t.repeat) } else { String::new() };
        text.push_str(&format!("  row {}, {}, {}{repeat}: {}\n", t.row, t.specimen, t.model, t.reason));
    }
    text
}

fn tell_status(study: &Path, session: &Session) -> Result<Outcome, Failure> {
    let (plan, folder) = read_or_plan(study, &session.catalogue)?;
    let now = status(&plan, &folder);
    let mut text = status_in_words(&now);
    wrong_rows(&mut text, &plan);
    let mut json = serde_json::to_value(&now).unwrap_or_default();
    json["schema"] = SCHEMA.into();
    Outcome::new(&json, text)
}

fn report(study: &Path, session: &Session) -> Result<Outcome, Failure> {
    let (plan, folder) = read_or_plan(study, &session.catalogue)?;
    let all = summary(&plan, &folder);
    let place = session.common.out.clone().unwrap_or_else(|| folder.path().join("study.html"));
    write_named(&place, page(&all).as_bytes(), session.common.force, html::is_page)?;
    let mut files = vec![place.clone()];
    let text = methods(&all);
    let tables = csv_files(&all)?.into_iter().chain([("methods.txt", text.clone().into_bytes())]);
    for (name, content) in tables {
        let path = folder.path().join(name);
        write_atomic(&path, &content)?;
        files.push(path);
    }
    let mut json = serde_json::to_value(&all).unwrap_or_default();
    json["methods"] = text.into();
    json["files"] = json!(files);
    let mut words = status_in_words(&all.status);
    for m in &all.models {
        for g in &m.groups {
            words.push_str(&mean_in_words(&m.model, g));
        }
        for r in m.specimens.iter().filter_map(|r| Some((r, r.left_out.as_ref()?))) {
            words.push_str(&format!(
                "  {}: row {}, {}, is in no mean: {}\n",
                m.model, r.0.row, r.0.specimen, r.1
            ));
        }
    }
    wrong_rows(&mut words, &plan);
    words.push_str(&format!("Page: {}\n", place.display()));
    Outcome::new(&json, words)
}

fn mean_in_words(model: &str, g: &::campaign::GroupSummary) -> String {
    let number = |x: f64| ::report::terminal::significant(x, 3);
    let p = &g.pooled;
    let interval =
        p.interval_95.map_or(String::new(), |[a, b]| format!(" (95 %: {} – {})", number(a), number(b)));
    let group = if g.group.is_empty() { "all" } else { g.group.as_str() };
    let of = match p.between() {
        None => "of one specimen".to_owned(),
        Some((sd, _)) => format!("of {} specimens, sd between them {}", p.specimens, number(sd)),
    };
    format!(
        "  {model}, {group}: {} {} {}{interval} {of}, own {}\n",
        g.quantity.path,
        number(p.mean),
        g.quantity.unit,
        number(p.within_sd)
    )
}

fn script(a: &arguments::Slurm, session: &Session) -> Result<Outcome, Failure> {
    let (plan, _) = read_or_plan(&a.study, &session.catalogue)?;
    let program = std::env::current_exe().map_or("fct".into(), |p| p.display().to_string());
    let study = std::path::absolute(&a.study).unwrap_or_else(|_| a.study.clone());
    let fits = plan.tasks.iter().filter(|t| t.base.is_none()).count().max(1);
    let array = a.array.map_or(fits.min(100), usize::from);
    let job = Job { array, cores: a.cores.into(), time: a.time.clone(), memory: a.memory.clone() };
    let script = slurm(&study, &plan.study, &program, &job);
    Outcome::new(&json!({ "schema": SCHEMA, "script": script }), script.clone())
}
