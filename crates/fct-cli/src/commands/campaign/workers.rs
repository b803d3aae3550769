//! Several workers on this machine: processes, so that one that is lost costs its task only.

use super::arguments;
use crate::outcome::Failure;
use crate::session::Session;
use ::campaign::{Folder, Plan, Ran, Status, status};
use std::process::{Child, Command, Stdio};
use std::time::Duration;

/// Starts the workers and replaces those that are lost, until nothing is left to do.
///
/// # Errors
/// If a worker cannot be started.
pub fn run(
    many: usize,
    plan: &Plan,
    folder: &Folder,
    arguments: &arguments::Run,
    session: &Session,
) -> Result<Ran, Failure> {
    let before = status(plan, folder);
    let mut workers =
        (0..many).map(|_| start(arguments, session)).collect::<Result<Vec<Child>, Failure>>()?;
    // A task may take three workers with it; more losses than that are no task's.
    let mut losses = many + 3 * plan.tasks.len();
    let progress = session.progress(&plan.study);
    while !workers.is_empty() && !session.cancelled() {
        std::thread::sleep(Duration::from_millis(200));
        let mut left = Vec::new();
        for mut worker in workers {
            match worker.try_wait() {
                Ok(None) => left.push(worker),
                // It ended by itself: nothing is left for it to do, or it has said why not.
                Ok(Some(end)) if end.code().is_some() => {}
                _ if losses > 0 => {
                    losses -= 1;
                    session.say("fct: a worker was lost; another takes its place");
                    left.push(start(arguments, session)?);
                }
                _ => {}
            }
        }
        workers = left;
        let done = folder.done().len() + folder.failed().len();
        progress.note(&format!("{done} of {} tasks, {} workers", plan.tasks.len(), workers.len()));
    }
    workers.iter_mut().for_each(stop);
    Ok(since(&before, &status(plan, folder), session.cancelled()))
}

/// A worker of the same study. What it has to say, but for its answer, goes to stderr.
fn start(a: &arguments::Run, session: &Session) -> Result<Child, Failure> {
    let cannot = |e: std::io::Error| Failure::compute(format!("fct: cannot start a worker: {e}"));
    let mut command = Command::new(std::env::current_exe().map_err(cannot)?);
    command.args(["campaign", "run"]).arg(&a.study).args(["--quiet", "--shard"]);
    command.arg(format!("{}/{}", a.shard.index, a.shard.of));
    if let Some(n) = session.common.threads {
        command.args(["--threads", &n.to_string()]);
    }
    command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null()).spawn().map_err(cannot)
}

/// Asks a worker to stop after its step, and waits for it; its task is then free, not lost.
fn stop(worker: &mut Child) {
    let asked = Command::new("kill").args(["-TERM", &worker.id().to_string()]).status();
    if !asked.is_ok_and(|s| s.success()) {
        // Where there is no such command: whose worker is gone, is a task that another takes.
        let _ = worker.kill();
    }
    let _ = worker.wait();
}

/// What was done since.
fn since(before: &Status, now: &Status, stopped: bool) -> Ran {
    Ran {
        done: now.done.saturating_sub(before.done),
        failed: now.failed.saturating_sub(before.failed),
        before: before.done + before.failed,
        elsewhere: now.running,
        set_aside: now.set_aside,
        changed: Vec::new(),
        stopped,
    }
}
