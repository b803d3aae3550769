//! Work in the background while the interpreter's thread listens: to Ctrl-C, and to what the work has to tell.

use crate::errors::{Fault, Interrupted};
use pyo3::exceptions::PyKeyboardInterrupt;
use pyo3::prelude::*;
use std::collections::BTreeMap;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

/// How often the interpreter is asked for signals.
const LISTEN: Duration = Duration::from_millis(50);
/// How long a stopped work may take to end its step; then it is left to end by itself.
const GRACE: Duration = Duration::from_millis(700);

/// What the work tells of itself, and whether it is to stop.
#[derive(Clone)]
pub struct Wire {
    stop: Arc<AtomicBool>,
    best: Arc<Mutex<BTreeMap<String, f64>>>,
    told: Sender<String>,
}

impl Wire {
    /// Whether to stop.
    pub fn stops(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }

    /// A remark for the progress callback.
    pub fn tell(&self, text: impl Into<String>) {
        // Nobody listens to work that was left to end by itself.
        let _ = self.told.send(text.into());
    }

    /// A run of a search: the best so far is kept, and told.
    pub fn search(&self, p: &analysis::Progress) {
        let Some(f) = p.iterate.f.filter(|_| p.iterate.accepted) else { return };
        let mut best = self.best.lock().unwrap_or_else(PoisonError::into_inner);
        best.extend(p.paths.iter().cloned().zip(p.iterate.theta.iter().copied()));
        drop(best);
        let mesh = if p.coarse { " (coarse mesh)" } else { "" };
        self.tell(format!("{}{mesh}, iteration {}, objective {f:.4e}", p.stage.word(), p.iterate.iteration));
    }
}

/// Does work on so many threads, with the interpreter released; `progress` is called with each remark.
pub fn run<T: Send + 'static>(
    py: Python<'_>,
    threads: Option<usize>,
    progress: Option<Py<PyAny>>,
    work: impl FnOnce(&Wire) -> Result<T, Fault> + Send + 'static,
) -> PyResult<T> {
    let (told, remarks) = channel();
    let (done, ended) = channel();
    let wire = Wire { stop: Arc::default(), best: Arc::default(), told };
    let inner = wire.clone();
    let body = move || {
        let result = catch_unwind(AssertUnwindSafe(|| match pool(threads) {
            Ok(None) => work(&inner),
            Ok(Some(pool)) => pool.install(|| work(&inner)),
            Err(fault) => Err(fault),
        }));
        let result = result.unwrap_or_else(|_| {
            Err(Fault::Compute("this is a fault of fct itself; please report it with the input files".into()))
        });
        let _ = done.send(result);
    };
    std::thread::Builder::new()
        .name("fct".into())
        .stack_size(64 << 20)
        .spawn(body)
        .map_err(|e| Fault::Compute(format!("cannot start a thread: {e}")).raised(py))?;
    let (mut ended, mut remarks) = (ended, remarks);
    loop {
        let (result, more, back) = py.detach(move || {
            let result = ended.recv_timeout(LISTEN);
            let more: Vec<String> = remarks.try_iter().collect();
            (result, more, (ended, remarks))
        });
        (ended, remarks) = back;
        let heard = tell(py, progress.as_ref(), &more).and_then(|()| py.check_signals());
        if let Err(error) = heard {
            wire.stop.store(true, Ordering::Relaxed);
            let begun = Instant::now();
            if result.is_err() {
                py.detach(move || ended.recv_timeout(GRACE.saturating_sub(begun.elapsed())).is_ok());
            }
            return Err(interrupted(py, error, &wire));
        }
        match result {
            Ok(result) => return result.map_err(|fault| fault.raised(py)),
            Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => {
                return Err(Fault::Compute("the work ended without an answer".into()).raised(py));
            }
        }
    }
}

fn pool(threads: Option<usize>) -> Result<Option<rayon::ThreadPool>, Fault> {
    let Some(n) = threads else { return Ok(None) };
    let built = rayon::ThreadPoolBuilder::new().num_threads(n).stack_size(16 << 20).build();
    built.map(Some).map_err(|e| Fault::Compute(format!("cannot start {n} threads: {e}")))
}

fn tell(py: Python<'_>, progress: Option<&Py<PyAny>>, remarks: &[String]) -> PyResult<()> {
    let Some(progress) = progress else { return Ok(()) };
    remarks.iter().try_for_each(|text| progress.call1(py, (text,)).map(drop))
}

/// Ctrl-C with the best so far; an exception of the user's own callback as it is.
fn interrupted(py: Python<'_>, error: PyErr, wire: &Wire) -> PyErr {
    if !error.is_instance_of::<PyKeyboardInterrupt>(py) {
        return error;
    }
    let best = wire.best.lock().unwrap_or_else(PoisonError::into_inner).clone();
    let stopped = Interrupted::new_err("stopped by Ctrl-C; `best` has the best values so far");
    let set = stopped.value(py).setattr("best", best);
    set.map_or_else(|e| e, |()| stopped)
}
