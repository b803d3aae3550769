//! What all commands share: flags, threads, Ctrl-C, reading of cases, places of run directories.

use crate::cli::Common;
use crate::outcome::Failure;
use crate::progress::Progress;
use input::Case;
use model::Catalogue;
use report::terminal::Style;
use report::{RunInfo, StoredRun, inputs_of};
use std::io::IsTerminal;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// A running `fct`.
pub struct Session {
    /// Flags.
    pub common: Common,
    /// Every effect.
    pub catalogue: Catalogue,
    cancelled: Arc<AtomicBool>,
}

impl Session {
    /// Sets up threads and Ctrl-C.
    ///
    /// # Errors
    /// If the system refuses threads or the signal handler.
    pub fn new(common: &Common) -> Result<Self, Failure> {
        if let Some(n) = common.threads {
            let built = rayon::ThreadPoolBuilder::new().num_threads(usize::from(n)).build_global();
            built.map_err(|e| Failure::compute(format!("fct: cannot start {n} threads: {e}")))?;
        }
        let cancelled = Arc::new(AtomicBool::new(false));
        let flag = cancelled.clone();
        let handled = ctrlc::set_handler(move || {
            // The second time the user means it.
            if flag.swap(true, Ordering::SeqCst) {
                std::process::exit(130);
            }
            eprintln!("\nfct: stopping after this step; press Ctrl-C again to stop at once");
        });
        handled.map_err(|e| Failure::compute(format!("fct: cannot listen for Ctrl-C: {e}")))?;
        Ok(Self { common: common.clone(), catalogue: effects::catalogue(), cancelled })
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
        let run = file.join("run.toml");
        let file = if run.is_file() { &run } else { file };
        let mut case = input::read_case(file, &self.catalogue)?;
        if let Some(formats) = &self.common.figures {
            case.output.figures = formats.iter().map(|f| (*f).into()).collect();
        }
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
        let case = self.fitted_case(run)?;
        let Some(answer) = StoredRun::read(run).ok().and_then(|r| r.identify()) else { return Ok(case) };
        let mut case = (*case).clone();
        let values = answer.parameters.iter().map(|p| (p.path.as_str(), p.value));
        analysis::start_at(&mut case, values);
        Ok(Arc::new(case))
    }

    /// A remark on stderr, unless `--quiet`.
    pub fn say(&self, text: &str) {
        if !self.common.quiet {
            eprintln!("{text}");
        }
    }

    /// Progress on stderr.
    pub fn progress(&self, title: &str) -> Progress {
        Progress::new(title, self.common.quiet)
    }

    /// Colours on stdout?
    pub fn style(&self) -> Style {
        let plain = std::env::var_os("NO_COLOR").is_some_and(|v| !v.is_empty());
        Style { colour: std::io::stdout().is_terminal() && !plain && !self.common.json }
    }

    /// The run directory of a case: `--out`, or `runs/<name>`.
    pub fn place(&self, case: &Case) -> PathBuf {
        self.common.out.clone().unwrap_or_else(|| Path::new("runs").join(file_name(&case.name)))
    }

    /// How this run is made.
    pub fn info(&self, command: &str, case: &Case, complete: bool) -> RunInfo {
        RunInfo {
            command: command.to_owned(),
            arguments: std::env::args().collect(),
            version: env!("CARGO_PKG_VERSION").to_owned(),
            inputs: inputs_of(case),
            complete,
        }
    }

    /// With `--resume`: a finished run of the same command on the same input at the same place.
    pub fn finished(&self, command: &str, case: &Case, place: &Path) -> Option<StoredRun> {
        if !self.common.resume {
            return None;
        }
        let run = StoredRun::read(place).ok()?;
        // What was read is compared by content: a file that only moved is the same input.
        let hashes = |files: &[report::InputFile]| files.iter().map(|f| f.sha256.clone()).collect::<Vec<_>>();
        let same =
            run.input == input::resolved_toml(case) && hashes(&run.info.inputs) == hashes(&inputs_of(case));
        (run.info.command == command && run.info.complete && same).then_some(run)
    }
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
