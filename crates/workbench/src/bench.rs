//! The workbench itself: what was done, what is being done, and doing it.

use crate::action::{Action, ImportRequest};
use crate::events::Hub;
use crate::opened::{First, Opened, file_name};
use crate::queue::{Job, Queue};
use crate::set::Change;
use crate::shell::{line, written};
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

type Done = Result<(), Failed>;

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
    fn name(&self, inner: &str) -> String {
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

    fn perform(&self, action: &Action, job: &Job) -> Done {
        let present = self.steps().present().cloned().unwrap_or_default();
        let from = present.source().map(str::to_owned);
        let none = || asked("no specimen yet: drop a record and give its dimensions");
        let config = || present.config.clone().ok_or_else(none);
        let from = || from.clone().ok_or_else(none);
        match action {
            Action::Import(request) => self.import(request, job),
            Action::Set(change) => self.set(&from()?, change, "", job),
            Action::Fit => self.fit(&config()?, "fit", "Fit", Vec::new(), job),
            Action::Check => self.check(&config()?, job),
            Action::Diagnose => self.diagnose(&present.run.clone().ok_or_else(|| asked("fit first"))?, job),
            Action::Discover => self.discover(&config()?, job),
            Action::Add { effect } => self.edit("add", effect, &from()?, job),
            Action::Drop { effect } => self.edit("drop", effect, &from()?, job),
            Action::Go { .. } | Action::Stop => Ok(()),
        }
    }

    /// Runs a command.
    fn fct(&self, words: &[String], job: &Job) -> Result<Value, Failed> {
        let listener: Arc<dyn Listener> = Arc::new(Teller::new(self.hub.clone()));
        let Told { code, json, message } = self.commands.run(words, &job.cancelled, &listener);
        if code == 0 { Ok(json) } else { Err(Failed { message, json }) }
    }

    /// A new step, unless nobody wants it any more.
    fn push(&self, step: Step, instead: bool, job: &Job) -> Done {
        let mut steps = self.steps();
        if job.is_superseded() {
            return Ok(());
        }
        steps.push(step, instead);
        Ok(steps.write(&self.opened.own())?)
    }

    fn number(&self) -> u32 {
        self.steps().number()
    }

    fn write(&self, relative: &str, text: &str) -> Done {
        report::write_atomic(&self.path(relative), text.as_bytes()).map_err(|e| asked(&e.to_string()))
    }

    fn import(&self, request: &ImportRequest, job: &Job) -> Done {
        for file in &request.files {
            self.opened.inside(file)?;
        }
        let n = self.number();
        let mut words = vec!["import".to_owned()];
        words.extend(request.words()?);
        let mut lines = Vec::new();
        if let Some(text) = request.geometry_toml()? {
            let file = self.name(&format!("{n:02}-geometry.toml"));
            self.write(&file, &text)?;
            lines.push(written(&text, &file));
            words.push(format!("--geometry={file}"));
        }
        let out = self.name(&format!("imported/{n:02}"));
        words.extend(["--out".to_owned(), out.clone()]);
        let answered = self.fct(&words, job);
        let answer = match &answered {
            Ok(json) => json!({ "request": request, "answer": json, "failed": null }),
            Err(f) => {
                json!({ "request": request, "answer": null, "failed": { "message": f.message, "json": f.json } })
            }
        };
        {
            let mut steps = self.steps();
            steps.import = Some(answer);
            steps.write(&self.opened.own())?;
        }
        let whole = answered?["geometry_complete"] == true;
        lines.push(line(&words));
        let config = whole.then(|| format!("{out}/specimen.toml"));
        let step = Step {
            kind: "import".into(),
            title: "Import".into(),
            commands: lines,
            config,
            ..Step::default()
        };
        self.push(step, true, job)
    }

    /// Fits a config: a step of that kind, with the lines that made the config before.
    fn fit(&self, config: &str, kind: &str, title: &str, mut lines: Vec<String>, job: &Job) -> Done {
        let run = self.name(&format!("runs/{:02}-{kind}", self.number()));
        let words = ["identify", config, "--out", &run].map(str::to_owned);
        lines.push(line(&words));
        match self.fct(&words, job) {
            Ok(_) => self.fitted(kind, title, lines, config, &run, false, job),
            Err(f) if job.cancelled.load(Ordering::SeqCst) && f.json["parameters"].is_object() => {
                self.keep_best(&f.json["parameters"], config, job)
            }
            Err(f) => Err(f),
        }
    }

    /// The step of a finished run.
    #[allow(clippy::too_many_arguments)]
    fn fitted(
        &self,
        kind: &str,
        title: &str,
        commands: Vec<String>,
        config: &str,
        run: &str,
        instead: bool,
        job: &Job,
    ) -> Done {
        let stored = StoredRun::read(&self.path(run)).map_err(|e| asked(&e.to_string()))?;
        let fit = stored.identify().as_ref().map(Fit::from);
        let step = Step {
            kind: kind.into(),
            title: title.into(),
            commands,
            config: Some(config.into()),
            run: Some(run.into()),
            fit,
        };
        self.push(step, instead, job)
    }

    /// The best values of a search that was stopped become the present ones.
    fn keep_best(&self, values: &Value, config: &str, job: &Job) -> Done {
        if job.is_superseded() {
            return Ok(());
        }
        // What was to be stopped has stopped; keeping its best may be stopped again.
        job.cancelled.store(false, Ordering::SeqCst);
        let values = serde_json::from_value(values.clone()).unwrap_or_default();
        self.set(config, &Change { values, ..Change::default() }, "Stopped: the best so far", job)
    }

    /// Other values, and the model there.
    fn set(&self, from: &str, change: &Change, title: &str, job: &Job) -> Done {
        let n = self.number();
        let file = self.name(&format!("{n:02}-set.toml"));
        let mut words = vec!["set".to_owned(), from.to_owned()];
        words.extend(change.words()?);
        words.extend(["--out".to_owned(), file.clone()]);
        self.fct(&words, job)?;
        let mut lines = vec![line(&words)];
        if change.is_of_the_mesh() {
            let step = Step {
                kind: "model".into(),
                title: "Model".into(),
                commands: lines,
                config: Some(file),
                ..Step::default()
            };
            return self.push(step, true, job);
        }
        let run = self.name(&format!("runs/{n:02}-set"));
        let words = ["identify", &file, "--at-start", "--out", &run].map(str::to_owned);
        self.fct(&words, job)?;
        lines.push(line(&words));
        let title = match title {
            "" if change.weighs() => "Records weighed",
            "" => "Values set",
            given => given,
        };
        self.fitted("set", title, lines, &file, &run, !change.weighs(), job)
    }

    fn diagnose(&self, run: &str, job: &Job) -> Done {
        let words = ["diagnose", run].map(str::to_owned);
        self.fct(&words, job)?;
        let mut steps = self.steps();
        let line = line(&words);
        for step in steps.steps.iter_mut().filter(|s| s.run.as_deref() == Some(run)) {
            if !step.commands.contains(&line) {
                step.commands.push(line.clone());
            }
        }
        Ok(steps.write(&self.opened.own())?)
    }

    /// Asks what the records are good for.
    fn check(&self, config: &str, job: &Job) -> Done {
        let answer = self.fct(&["check", config].map(str::to_owned), job)?;
        let mut steps = self.steps();
        steps.checked = Some(json!({ "config": config, "doctor": answer["doctor"] }));
        Ok(steps.write(&self.opened.own())?)
    }

    /// Adds or drops an effect, and fits.
    fn edit(&self, command: &str, effect: &str, from: &str, job: &Job) -> Done {
        if self.catalogue.get(effect).is_none() {
            return Err(asked(&format!("{}: no effect of the catalogue", input::visible(effect))));
        }
        let sign = if command == "add" { "+" } else { "−" };
        let file = self.name(&format!("{:02}-{command}-{effect}.toml", self.number()));
        let words = [command, effect, from, "--out", &file].map(str::to_owned);
        self.fct(&words, job)?;
        self.fit(&file, command, &format!("{sign} {effect}"), vec![line(&words)], job)
    }

    /// The whole loop: one step per rung.
    fn discover(&self, config: &str, job: &Job) -> Done {
        let out = self.name(&format!("runs/{:02}-discover", self.number()));
        let words = ["discover", config, "--out", &out].map(str::to_owned);
        let answer = self.fct(&words, job)?;
        let fitted_models = answer["ladder"].as_array().map_or(0, Vec::len);
        let mut lines = vec![line(&words)];
        for fitted_model in
            (0..fitted_models).map(|k| format!("{out}/rungs/{k}")).filter(|r| self.path(r).is_dir())
        {
            let title =
                StoredRun::read(&self.path(&fitted_model)).ok().and_then(|r| r.identify()).map(|a| a.effects);
            let title = title
                .filter(|e| !e.is_empty())
                .map_or("Found: base model".to_owned(), |e| format!("Found: {}", e.join(" + ")));
            let config = format!("{fitted_model}/run.toml");
            self.fitted("discover", &title, std::mem::take(&mut lines), &config, &fitted_model, false, job)?;
        }
        Ok(())
    }
}

fn asked(why: &str) -> Failed {
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
