//! What all commands share: flags, threads, Ctrl-C, reading of cases, places of run directories.

use crate::cli::Common;
use crate::outcome::{Failure, say};
use crate::place::{Job, nameable};
use crate::progress::Progress;
use input::Case;
use model::Catalogue;
use report::terminal::Style;
use report::{Begin, RunInfo, StoredRun};
use std::collections::HashSet;
use std::io::IsTerminal;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use workbench::Listener;

/// A running `fct`.
pub struct Session {
    /// Flags.
    pub common: Common,
    /// Every effect.
    pub catalogue: Catalogue,
    cancelled: Arc<AtomicBool>,
    /// Nothing is being done but waiting for an answer.
    waiting: Arc<AtomicBool>,
    /// The command line, as it stands in the run's record.
    arguments: Vec<String>,
    /// Who hears what is otherwise said on stderr.
    listener: Option<Arc<dyn Listener>>,
}

impl Session {
    /// Sets up threads and signals: Ctrl-C, SIGTERM and SIGHUP stop after the step that is being done.
    ///
    /// # Errors
    /// If the system refuses threads or the signal handler.
    pub fn new(common: &Common) -> Result<Self, Failure> {
        if let Some(n) = common.threads {
            let built = rayon::ThreadPoolBuilder::new().num_threads(usize::from(n)).build_global();
            built.map_err(|e| Failure::compute(format!("fct: cannot start {n} threads: {e}")))?;
        }
        if let Some(out) = &common.out {
            nameable(&std::path::absolute(out).unwrap_or_else(|_| out.clone()))?;
        }
        let cancelled = Arc::new(AtomicBool::new(false));
        let waiting = Arc::new(AtomicBool::new(false));
        let (flag, idle) = (cancelled.clone(), waiting.clone());
        let handled = ctrlc::set_handler(move || {
            // The second time the user means it; at a question no step is being done.
            if flag.swap(true, Ordering::SeqCst) || idle.load(Ordering::SeqCst) {
                std::process::exit(130);
            }
            say("\nfct: stopping after this step; press Ctrl-C again to stop at once");
        });
        handled.map_err(|e| Failure::compute(format!("fct: cannot listen for Ctrl-C: {e}")))?;
        let arguments = std::env::args_os().map(|a| a.to_string_lossy().into_owned()).collect();
        let (common, catalogue) = (common.clone(), effects::catalogue());
        Ok(Self { common, catalogue, cancelled, waiting, arguments, listener: None })
    }

    /// A session within this one, for a command of the workbench: stops when `cancelled`, says everything to `listener`.
    pub fn within(
        common: &Common,
        arguments: Vec<String>,
        cancelled: Arc<AtomicBool>,
        listener: Arc<dyn Listener>,
    ) -> Self {
        Self {
            common: common.clone(),
            catalogue: effects::catalogue(),
            cancelled,
            waiting: Arc::default(),
            arguments,
            listener: Some(listener),
        }
    }

    /// Waits for the user: Ctrl-C ends the program at once.
    pub fn waiting<T>(&self, wait: impl FnOnce() -> T) -> T {
        self.waiting.store(true, Ordering::SeqCst);
        let out = wait();
        self.waiting.store(false, Ordering::SeqCst);
        out
    }

    /// Whether the user wants to stop.
    pub fn cancelled(&self) -> bool {
        self.cancelled.load(Ordering::SeqCst)
    }

    /// Reads a specimen or config (or the `run.toml` of a run directory); warnings go to stderr.
    ///
    /// # Errors
    /// Everything that is wrong with the files.
    pub fn case(&self, file: &Path) -> Result<Arc<Case>, Failure> {
        nameable(&std::path::absolute(file).unwrap_or_else(|_| file.to_owned()))?;
        let run = file.join("run.toml");
        let file = if run.is_file() { &run } else { file };
        let mut case = input::read_case(file, &self.catalogue)?;
        if let Some(formats) = &self.common.figures {
            case.output.figures = formats.iter().map(|f| (*f).into()).collect();
        }
        // Before anything is computed.
        case.output.figures.iter().try_for_each(|f| unoffered(*f))?;
        for warning in &case.warnings {
            self.say(&warning.to_string());
        }
        Ok(Arc::new(case))
    }

    /// A case that is to be fitted: its records must hold what its effects need.
    ///
    /// # Errors
    /// Everything that is wrong with the files; an effect that these records cannot show.
    pub fn fitted_case(&self, file: &Path) -> Result<Arc<Case>, Failure> {
        let case = self.case(file)?;
        let (faults, remarks) = analysis::needs(&case, &self.catalogue);
        for (place, remark) in remarks {
            self.say(&format!("{place}: remark: {remark}"));
        }
        if faults.is_empty() {
            let case = analysis::condensed(&case);
            for (t, r) in case.tests.iter().filter_map(|t| t.record.as_ref().map(|r| (t, r))) {
                if r.averaged.is_some() {
                    let (rows, points) = (r.measured_rows(), r.len());
                    self.say(&format!("{}: {rows} rows, averaged to {points} points", t.name));
                }
            }
            return Ok(case);
        }
        let faults: Vec<String> = faults.iter().map(|(place, f)| format!("{place}: error: {f}")).collect();
        Err(Failure::usage(faults.join("\n")))
    }

    /// The case of a finished identification, with the identified values as its start: what `diagnose` continues from.
    ///
    /// # Errors
    /// Everything that is wrong with the files.
    pub fn identified_case(&self, run: &Path) -> Result<Arc<Case>, Failure> {
        if !run.is_dir() {
            return self.fitted_case(run);
        }
        let stored = StoredRun::read(run)?;
        let case = self.fitted_case(run)?;
        if let Some(file) = case.inputs.iter().find(|i| changed(i, &stored)) {
            return Err(Failure::usage(format!(
                "fct: {}: this file has changed since {} was made from it; identify again",
                file.file.display(),
                run.display()
            )));
        }
        let Some(answer) = stored.identify() else { return Ok(case) };
        let mut case = (*case).clone();
        let values = answer.parameters.iter().map(|p| (p.path.as_str(), p.value));
        analysis::stay_at(&mut case, values);
        Ok(Arc::new(case))
    }

    /// A remark on stderr, unless `--quiet`, or for whoever listens.
    pub fn say(&self, text: &str) {
        match &self.listener {
            Some(listener) => listener.note(text),
            None if !self.common.quiet => say(text),
            None => {}
        }
    }

    /// Progress on stderr, or for whoever listens.
    pub fn progress(&self, title: &str) -> Progress {
        match &self.listener {
            Some(listener) => Progress::told_to(title, listener.clone()),
            None => Progress::new(title, self.common.quiet),
        }
    }

    /// Colours on stdout?
    pub fn style(&self) -> Style {
        let plain = std::env::var_os("NO_COLOR").is_some_and(|v| !v.is_empty());
        let colour = std::io::stdout().is_terminal() && !plain && !self.common.json;
        Style::new(colour, crate::progress::columns())
    }

    /// The run directory of a job: `--out`, or one under `runs` that holds nothing else.
    pub fn place(&self, command: &str, case: &Case) -> PathBuf {
        let own = || Job { command, case }.place_under(Path::new("runs"), &mut HashSet::new());
        self.common.out.clone().unwrap_or_else(own)
    }

    /// How a run directory is begun.
    pub fn how(&self) -> Begin {
        Begin { resume: self.common.resume, force: self.common.force }
    }

    /// How this run is made.
    pub fn info(&self, command: &str, case: &Case, complete: bool) -> RunInfo {
        RunInfo {
            command: command.to_owned(),
            arguments: self.arguments.clone(),
            version: env!("CARGO_PKG_VERSION").to_owned(),
            inputs: case.inputs.clone(),
            complete,
        }
    }

    /// With `--resume`: a finished run of the same command on the same input at the same place.
    pub fn finished(&self, command: &str, case: &Case, place: &Path) -> Option<StoredRun> {
        if !self.common.resume {
            return None;
        }
        let run = StoredRun::read(place).ok()?;
        (run.info.complete && Job { command, case }.is_of(&run)).then_some(run)
    }

    /// A stored run that an answer is made of; says which of the files that it was made from are others now.
    ///
    /// # Errors
    /// If it is no run directory, or is damaged.
    pub fn stored(&self, place: &Path) -> Result<StoredRun, Failure> {
        let run = StoredRun::read(place)?;
        for file in run.changed_inputs() {
            self.say(&format!(
                "{}: remark: this run was made from {}, which has changed or gone since",
                place.display(),
                file.display()
            ));
        }
        Ok(run)
    }
}

/// Whether a run was made from another content of a file.
fn changed(file: &input::InputFile, run: &StoredRun) -> bool {
    run.info.inputs.iter().any(|i| i.file == file.file && i.sha256 != file.sha256)
}

/// A name that every file system takes.
pub fn file_name(name: &str) -> String {
    let safe: String = name
        .chars()
        .map(|c| if c.is_alphanumeric() || "-_.+ ".contains(c) { c } else { '_' })
        .take(100)
        .collect();
    let safe = safe.trim_matches(['.', ' ']).to_owned();
    if safe.is_empty() { "run".into() } else { safe }
}

/// A format that this build cannot write is a fault of the call.
///
/// # Errors
/// What can be done.
pub fn unoffered(format: input::Figure) -> Result<(), Failure> {
    report::figures::offered(format).map_err(|e| Failure::usage(format!("fct: {e}")))
}
