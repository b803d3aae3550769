//! How a study stands, at any moment, while others work on it.

use crate::claim::{self, ClaimState};
use crate::files::{Folder, Outcome};
use crate::plan::{Plan, WrongRow};
use serde::Serialize;
use std::collections::{HashMap, HashSet};

/// How a task stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum State {
    /// It has an answer.
    Done,
    /// It cannot be computed; its result says why.
    Failed,
    /// Somebody works on it.
    Running,
    /// It took three workers with it, and is not tried again by itself.
    SetAside,
    /// Nobody works on it.
    Waiting,
}

/// A task that needs a look.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct TaskState {
    /// Specimen.
    pub specimen: String,
    /// Row of the study's table.
    pub row: usize,
    /// Model.
    pub model: String,
    /// Repeat.
    pub repeat: usize,
    /// How it stands.
    pub state: State,
    /// Why.
    pub reason: String,
}

/// How a study stands.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Status {
    /// Name.
    pub study: String,
    /// All tasks.
    pub tasks: usize,
    /// Tasks with an answer.
    pub done: usize,
    /// Tasks that cannot be computed.
    pub failed: usize,
    /// Tasks that somebody works on.
    pub running: usize,
    /// Tasks that took three workers with them.
    pub set_aside: usize,
    /// Tasks that wait for a worker.
    pub waiting: usize,
    /// Failed tasks and those set aside, with the reason.
    pub look_at: Vec<TaskState>,
    /// Rows of the table that are left out.
    pub wrong_rows: Vec<WrongRow>,
}

/// Looks at every task.
pub fn status(plan: &Plan, folder: &Folder) -> Status {
    let claims = claims(folder);
    // Claims first: a task that ends in between is then done, not lost.
    let held: HashMap<&str, ClaimState> = plan
        .tasks
        .iter()
        .filter(|t| claims.contains(&t.key))
        .map(|t| (t.key.as_str(), claim::state(folder, &t.key)))
        .collect();
    let (done, failed) = (folder.done(), folder.failed());
    let mut out = Status {
        study: plan.study.clone(),
        tasks: plan.tasks.len(),
        done: 0,
        failed: 0,
        running: 0,
        set_aside: 0,
        waiting: 0,
        look_at: Vec::new(),
        wrong_rows: plan.wrong.clone(),
    };
    for task in &plan.tasks {
        let claim = held.get(task.key.as_str());
        let (state, reason) = match (done.contains(&task.key), failed.contains(&task.key), claim) {
            (true, ..) => (State::Done, String::new()),
            (_, true, _) => (State::Failed, reason(folder, &task.key)),
            (.., Some(ClaimState::Held)) => (State::Running, String::new()),
            (.., Some(ClaimState::SetAside)) => {
                (State::SetAside, format!("{} workers ended while they worked on it", claim::ATTEMPTS))
            }
            _ => (State::Waiting, String::new()),
        };
        *match state {
            State::Done => &mut out.done,
            State::Failed => &mut out.failed,
            State::Running => &mut out.running,
            State::SetAside => &mut out.set_aside,
            State::Waiting => &mut out.waiting,
        } += 1;
        if !reason.is_empty() {
            let specimen = &plan.specimens[task.specimen];
            let (row, model) = (specimen.row, plan.models[task.model].name.clone());
            let specimen = specimen.name.clone();
            out.look_at.push(TaskState { specimen, row, model, repeat: task.repeat, state, reason });
        }
    }
    out
}

/// Why a task failed.
fn reason(folder: &Folder, key: &str) -> String {
    match folder.read(key).map(|r| r.outcome) {
        Some(Outcome::Failed { reason }) => reason,
        _ => format!("{}: this file cannot be read", folder.failure(key).display()),
    }
}

/// Keys that somebody has, or had, a claim on.
fn claims(folder: &Folder) -> HashSet<String> {
    let entries = std::fs::read_dir(folder.claims()).into_iter().flatten().flatten();
    entries.filter_map(|e| Some(e.file_name().to_str()?.split_once('.')?.0.to_owned())).collect()
}
