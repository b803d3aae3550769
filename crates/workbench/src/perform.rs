//! What every action does: commands of `fct`, and the step that comes of them.

use crate::action::{Action, ImportRequest};
use crate::bench::{Bench, Done, asked};
use crate::queue::Job;
use crate::set::Change;
use crate::shell::{line, written};
use crate::steps::{Fit, Step};
use report::StoredRun;
use serde_json::{Value, json};
use std::sync::atomic::Ordering;

impl Bench {
    /// Does what is asked for.
    pub(crate) fn perform(&self, action: &Action, job: &Job) -> Done {
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
