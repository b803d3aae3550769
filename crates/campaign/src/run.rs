//! A worker: takes tasks one after the other until none of its share is left that it could do.

use crate::claim::{self, Claim, ClaimState};
use crate::error::CampaignError;
use crate::files::{Folder, Outcome, TaskResult};
use crate::plan::{Plan, Task, VERSION};
use crate::work::{Tools, do_task};
use report::answer::SCHEMA;
use std::panic::{AssertUnwindSafe, catch_unwind};

/// Which share of a study a process does: tasks of every `of`-th fit, beginning with the `index`-th.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shard {
    /// From 1.
    pub index: usize,
    /// How many shares there are.
    pub of: usize,
}

impl Default for Shard {
    fn default() -> Self {
        Self { index: 1, of: 1 }
    }
}

impl std::str::FromStr for Shard {
    type Err = CampaignError;

    fn from_str(text: &str) -> Result<Self, CampaignError> {
        let fault = || CampaignError::Shard(text.to_owned());
        let (index, of) = text.split_once('/').ok_or_else(fault)?;
        let number = |s: &str| s.parse::<usize>().map_err(|_| fault());
        let shard = Self { index: number(index)?, of: number(of)? };
        if (1..=shard.of).contains(&shard.index) { Ok(shard) } else { Err(fault()) }
    }
}

impl Shard {
    /// Tasks of the share. Repeats go with the fit they repeat, which they wait for.
    pub fn tasks(self, plan: &Plan) -> Vec<&Task> {
        let mut fit = 0;
        let mut of = Vec::with_capacity(plan.tasks.len());
        for task in &plan.tasks {
            fit += usize::from(task.base.is_none());
            of.push(fit);
        }
        let mine = |f: &usize| (f - 1) % self.of == self.index - 1;
        plan.tasks.iter().zip(&of).filter(|(_, f)| mine(f)).map(|(t, _)| t).collect()
    }
}

/// How a worker works.
#[derive(Clone, Copy)]
pub struct Worker<'a> {
    /// Its share.
    pub shard: Shard,
    /// Effects, who may stop it, who hears.
    pub tools: Tools<'a>,
}

/// What a worker did.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Ran {
    /// Tasks done now.
    pub done: usize,
    /// Tasks that failed now.
    pub failed: usize,
    /// Tasks of the share that had a result already.
    pub before: usize,
    /// Tasks that others work on.
    pub elsewhere: usize,
    /// Tasks that took three workers with them.
    pub set_aside: usize,
    /// Tasks whose files have changed since the plan was made, and why; each reason once.
    pub changed: Vec<String>,
    /// Whether it was stopped.
    pub stopped: bool,
}

/// What became of trying one task.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Went {
    /// It was done now, with an answer (`true`) or a failure.
    Did(bool),
    /// It had a result.
    Before,
    /// Somebody works on it.
    Elsewhere,
    /// It took three workers with it.
    SetAside,
    /// The fit that it repeats has no result yet.
    Waits,
    /// Its files have changed since the plan was made.
    Changed(String),
    /// It was stopped.
    Stopped,
}

impl Went {
    /// A word for it.
    pub const fn word(&self) -> &'static str {
        match self {
            Self::Did(true) => "done",
            Self::Did(false) => "failed",
            Self::Before => "before",
            Self::Elsewhere => "elsewhere",
            Self::SetAside => "set_aside",
            Self::Waits => "waits",
            Self::Changed(_) => "changed",
            Self::Stopped => "stopped",
        }
    }
}

/// Works on a study until nothing of the share is left that this process could do, or it is stopped.
///
/// # Errors
/// If the folder cannot be written.
pub fn run(plan: &Plan, folder: &Folder, worker: Worker<'_>) -> Result<Ran, CampaignError> {
    let mut ran = Ran::default();
    let mut left = worker.shard.tasks(plan);
    // Two listings, instead of asking for each of thousands.
    let (done, failed) = (folder.done(), folder.failed());
    claim::tidy(folder, &done);
    let share = left.len();
    left.retain(|t| !done.contains(&t.key) && !failed.contains(&t.key));
    ran.before = share - left.len();
    // Tasks that wait for another one's result come again, as long as results come.
    while !left.is_empty() {
        let before = left.len();
        let mut waiting = Vec::new();
        for task in left {
            match attempt(plan, folder, task, worker.tools)? {
                Went::Did(true) => ran.done += 1,
                Went::Did(false) => ran.failed += 1,
                Went::Before => ran.before += 1,
                Went::Elsewhere => ran.elsewhere += 1,
                Went::SetAside => ran.set_aside += 1,
                Went::Waits => waiting.push(task),
                Went::Changed(why) if ran.changed.contains(&why) => {}
                Went::Changed(why) => ran.changed.push(why),
                Went::Stopped => {
                    ran.stopped = true;
                    return Ok(ran);
                }
            }
        }
        if waiting.len() == before {
            ran.elsewhere += waiting.len();
            break;
        }
        left = waiting;
    }
    Ok(ran)
}

/// Forgets failures and lost claims of a share, so that these tasks are tried again. For one process, before others start.
///
/// # Errors
/// If the disk refuses.
pub fn forget_failures(plan: &Plan, folder: &Folder, shard: Shard) -> Result<(), CampaignError> {
    for task in shard.tasks(plan) {
        if folder.failure(&task.key).is_file() {
            folder.remove(&task.key)?;
        }
        if claim::state(folder, &task.key) == ClaimState::SetAside {
            claim::clear(folder, &task.key);
        }
    }
    Ok(())
}

/// Tries one task: claims it, does it, stores its result.
///
/// # Errors
/// If the folder cannot be written.
pub fn attempt(plan: &Plan, folder: &Folder, task: &Task, tools: Tools<'_>) -> Result<Went, CampaignError> {
    let key = &task.key;
    if tools.watch.stops() {
        return Ok(Went::Stopped);
    }
    if folder.has(key) {
        return Ok(Went::Before);
    }
    if task.base.as_ref().is_some_and(|base| !folder.has(base)) {
        return Ok(Went::Waits);
    }
    let lost = match claim::state(folder, key) {
        ClaimState::Held => return Ok(Went::Elsewhere),
        ClaimState::SetAside => return Ok(Went::SetAside),
        ClaimState::Free(lost) => lost,
    };
    let Some(claim) = Claim::take(folder, key, lost)? else { return Ok(Went::Elsewhere) };
    // Another may have finished it, and let go, since it was looked for.
    if folder.has(key) {
        claim.done(folder, key);
        return Ok(Went::Before);
    }
    let specimen = &plan.specimens[task.specimen].name;
    (tools.note)(&format!("{specimen}, {}, repeat {}", plan.models[task.model].name, task.repeat));
    match guarded(plan, folder, task, tools) {
        Err(why) => Ok(Went::Changed(why)),
        Ok(None) => Ok(Went::Stopped),
        Ok(Some(result)) => {
            folder.store(&result)?;
            claim.done(folder, key);
            folder.forget(key);
            Ok(Went::Did(matches!(result.outcome, Outcome::Done { .. })))
        }
    }
}

/// A panic is a fault of this program: told as a failed task, and the others go on.
fn guarded(
    plan: &Plan,
    folder: &Folder,
    task: &Task,
    tools: Tools<'_>,
) -> Result<Option<TaskResult>, String> {
    catch_unwind(AssertUnwindSafe(|| do_task(plan, folder, task, tools))).unwrap_or_else(|said| {
        let said =
            said.downcast_ref::<&str>().map(|s| (*s).to_owned()).or(said.downcast_ref::<String>().cloned());
        let said = said.unwrap_or_else(|| "no reason given".into());
        Ok(Some(TaskResult {
            schema: SCHEMA,
            key: task.key.clone(),
            version: VERSION.to_owned(),
            specimen: plan.specimens[task.specimen].name.clone(),
            repeat: task.repeat,
            outcome: Outcome::Failed { reason: format!("a fault of fct itself: {said}") },
            seconds: 0.0,
        }))
    })
}
