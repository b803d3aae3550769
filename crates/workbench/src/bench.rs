//! The workbench itself: what was done, what is being done, and doing it.

use crate::action::{Action, ImportRequest};
use crate::events::Hub;
use crate::opened::{First, Opened, file_name};
use crate::queue::{Job, Queue};
use crate::steps::{Fit, Step, Steps};
use crate::tried::Teller;
use crate::{BenchError, Commands, Listener, Told};
use model::Catalogue;
use report::StoredRun;
use serde_json::{Value, json};
use std::fs::{self, File};
use std::path::PathBuf;
use std::sync::atomic::Ordering;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// A workbench on an opened folder.
pub struct Bench {
    pub(crate) opened: Opened,
    pub(crate) catalogue: Catalogue,
    pub(crate) hub: Arc<Hub>,
    pub(crate) queue: Queue<Action>,
    commands: Arc<dyn Commands>,
    steps: Mutex<Steps>,
    /// Held as long as the workbench is open; the system lets it go with the process.
    _lock: File,
}

/// Why something that was asked for was not done.
pub(crate) struct Failed {
    pub message: String,
    pub json: Value,
}

impl From<BenchError> for Failed {
    fn from(e: BenchError) -> Self {
        Self { message: e.to_string(), json: Value::Null }
    }
}

pub(crate) type Done = Result<(), Failed>;

impl Bench {
    /// Opens a folder: takes up what was done in it before, or begins with what was named.
    ///
    /// # Errors
    /// If another workbench has the folder, what it left is damaged, or the disk refuses.
    pub fn open(
        opened: Opened,
        commands: Arc<dyn Commands>,
        catalogue: Catalogue,
    ) -> Result<Self, BenchError> {
        let own = opened.own();
        let raw = own.join("raw");
        fs::create_dir_all(&raw).map_err(BenchError::io(&raw, "create the folder"))?;
        let real = raw.canonicalize().map_err(BenchError::io(&raw, "open"))?;
        if real != raw {
            return Err(BenchError::Asked(format!("{}: this leads out of the opened folder", raw.display())));
        }
        let lock = own.join(".lock");
        let file = File::create(&lock).map_err(BenchError::io(&lock, "create"))?;
        file.try_lock().map_err(|_| {
            BenchError::Asked(format!("{}: another workbench is open on this", own.display()))
        })?;
        let mut steps = Steps::read(&own)?;
        if steps.steps.is_empty() {
            begin(&mut steps, &opened);
        }
        steps.write(&own)?;
        let (hub, queue) = (Arc::default(), Queue::default());
        Ok(Self { opened, catalogue, hub, queue, commands, steps: Mutex::new(steps), _lock: file })
    }

    pub(crate) fn steps(&self) -> MutexGuard<'_, Steps> {
        self.steps.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Asks for something; what takes no time is done at once.
    ///
    /// # Errors
    /// If there is no such step, or the disk refuses.
    pub(crate) fn ask(&self, action: Action) -> Result<(), BenchError> {
        match action {
            Action::Stop => self.queue.stop(),
            Action::Go { step } => {
                self.queue.forget();
                let mut steps = self.steps();
                if step >= steps.steps.len() {
                    return Err(BenchError::Asked(format!("there is no step {step}")));
                }
                steps.cursor = step;
                steps.write(&self.opened.own())?;
                drop(steps);
                self.hub.tell("state", &Value::Null);
            }
            other => self.queue.ask(other),
        }
        Ok(())
    }

    /// Keeps a dropped file; returns its path in the opened folder. The same content under the same name is one file.
    ///
    /// # Errors
    /// If the disk refuses.
    pub(crate) fn keep(&self, name: &str, content: &[u8]) -> Result<String, BenchError> {
        let name = file_name(name);
        let raw = self.opened.own().join("raw");
        let names = (1..).map(|k| if k == 1 { name.clone() } else { format!("{k}-{name}") });
        for name in names.take(10_000) {
            let path = raw.join(&name);
            // A link is no file of ours.
            let there = path.symlink_metadata().is_ok();
            if !there {
                report::write_atomic(&path, content).map_err(|e| BenchError::Asked(e.to_string()))?;
            } else if path.is_symlink() || fs::read(&path).is_ok_and(|old| old != content) {
                continue;
            }
            return Ok(self.name(&format!("raw/{name}")));
        }
        Err(BenchError::Asked(format!("{name}: too many files of this name")))
    }

    /// A name in the workbench's own folder, relative to the opened one.
    pub(crate) fn name(&self, inner: &str) -> String {
        format!("{}/{inner}", self.opened.home.display())
    }

    pub(crate) fn path(&self, relative: &str) -> PathBuf {
        self.opened.root.join(relative)
    }

    /// Does what is asked for, one after the other, until the queue is closed.
    pub(crate) fn work(&self) {
        let perform = |action: Action, job: &Job| {
            self.hub.tell("begun", &json!({ "what": action.words() }));
            let done = self.perform(&action, job);
            if let (Err(failed), false) = (done, job.is_superseded()) {
                let stopped = job.cancelled.load(Ordering::SeqCst);
                self.hub.tell(
                    "failed",
                    &json!({ "message": failed.message, "answer": failed.json, "stopped": stopped }),
                );
            }
        };
        self.queue.work(perform, || self.hub.tell("ended", &Value::Null));
    }

    /// Runs a command.
    pub(crate) fn fct(&self, words: &[String], job: &Job) -> Result<Value, Failed> {
        let listener: Arc<dyn Listener> = Arc::new(Teller::new(self.hub.clone()));
        let Told { code, json, message } = self.commands.run(words, &job.cancelled, &listener);
        if code == 0 { Ok(json) } else { Err(Failed { message, json }) }
    }

    /// A new step, unless nobody wants it any more.
    pub(crate) fn push(&self, step: Step, instead: bool, job: &Job) -> Done {
        let mut steps = self.steps();
        if job.is_superseded() {
            return Ok(());
        }
        steps.push(step, instead);
        Ok(steps.write(&self.opened.own())?)
    }

    pub(crate) fn number(&self) -> u32 {
        self.steps().number()
    }

    pub(crate) fn write(&self, relative: &str, text: &str) -> Done {
        report::write_atomic(&self.path(relative), text.as_bytes()).map_err(|e| asked(&e.to_string()))
    }
}

pub(crate) fn asked(why: &str) -> Failed {
    Failed { message: why.to_owned(), json: Value::Null }
}

/// The first step.
fn begin(steps: &mut Steps, opened: &Opened) {
    let (config, run) = match &opened.first {
        First::Run(run) => (format!("{run}/run.toml"), Some(run.clone())),
        First::Config(file) => (file.clone(), None),
        First::Raw(files) => {
            let request = ImportRequest { files: files.clone(), ..ImportRequest::default() };
            steps.import = Some(json!({ "request": request, "answer": null, "failed": null }));
            return;
        }
        First::Nothing => return,
    };
    let stored = run.as_ref().and_then(|r| StoredRun::read(&opened.root.join(r)).ok());
    let fit = stored.and_then(|r| r.identify()).as_ref().map(Fit::from);
    let step = Step {
        kind: "open".into(),
        title: "Opened".into(),
        config: Some(config),
        run,
        fit,
        ..Step::default()
    };
    steps.push(step, false);
}
