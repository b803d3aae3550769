//! Progress on stderr: a bar on a terminal, plain lines elsewhere.

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::IsTerminal;
use std::sync::Mutex;
use std::time::{Duration, Instant};

/// Least time between two plain lines.
const QUIET_TIME: Duration = Duration::from_secs(2);

/// A command's progress.
pub struct Progress {
    bar: Option<ProgressBar>,
    plain: bool,
    title: String,
    state: Mutex<State>,
}

struct State {
    begun: Instant,
    said: Option<Instant>,
    stage: String,
    stage_begun: Instant,
    objective: Option<f64>,
    falls: Vec<f64>,
}

impl Progress {
    /// Progress of `title`; silent when `quiet`.
    pub fn new(title: &str, quiet: bool) -> Self {
        let terminal = std::io::stderr().is_terminal() && !quiet;
        let bar = terminal.then(|| {
            let bar = ProgressBar::with_draw_target(None, ProgressDrawTarget::stderr_with_hz(8));
            bar.set_style(style("{spinner} {prefix} {elapsed} {wide_msg}"));
            bar.set_prefix(title.to_owned());
            bar.enable_steady_tick(Duration::from_millis(200));
            bar
        });
        let now = Instant::now();
        let state = State {
            begun: now,
            said: None,
            stage: String::new(),
            stage_begun: now,
            objective: None,
            falls: Vec::new(),
        };
        Self { bar, plain: !terminal && !quiet, title: title.to_owned(), state: Mutex::new(state) }
    }

    /// A remark on what is being done.
    pub fn note(&self, text: &str) {
        if let Some(bar) = &self.bar {
            bar.set_message(text.to_owned());
        } else if self.plain && self.due() {
            eprintln!("{}: {text}", self.title);
        }
    }

    /// Steps of a simulation.
    pub fn steps(&self, done: usize, total: usize) {
        if let Some(bar) = &self.bar {
            if bar.length().is_none() {
                bar.set_style(style("{prefix} {wide_bar} {pos}/{len} steps, {per_sec}, {eta} left"));
                bar.set_length(total as u64);
            }
            bar.set_position(done as u64);
        } else if self.plain && self.due() {
            eprintln!("{}: step {done} of {total}", self.title);
        }
    }

    /// A model run of a search.
    pub fn search(&self, p: &analysis::Progress) {
        let Some(line) = self.search_line(p) else { return };
        if let Some(bar) = &self.bar {
            bar.set_message(line);
        } else if self.plain && (p.iterate.iteration == 0 || self.due()) {
            eprintln!("{}: {line}", self.title);
        }
    }

    /// Stage, iteration, objective, pace, and what may be left of the stage.
    fn search_line(&self, p: &analysis::Progress) -> Option<String> {
        let mut s = self.state.lock().ok()?;
        let stage = format!("{}{}", p.stage.word(), if p.coarse { " (coarse mesh)" } else { "" });
        if s.stage != stage {
            (s.stage, s.stage_begun, s.objective) = (stage.clone(), Instant::now(), None);
            s.falls.clear();
        }
        if let (Some(f), true) = (p.iterate.f, p.iterate.accepted)
            && let Some(before) = s.objective.replace(f)
        {
            s.falls.push(((before - f) / before).max(1e-12));
        }
        let f = s.objective.map_or("–".into(), |f| format!("{f:.4e}"));
        let n = p.iterate.iteration;
        let pace = s.stage_begun.elapsed().as_secs_f64() / n.max(1) as f64;
        let left =
            iterations_left(&s.falls).map_or(String::new(), |k| format!(", about {:.0} s left", k * pace));
        Some(format!(
            "{stage}: iteration {n}, objective {f}, {pace:.1} s each{left} ({:.0} s so far)",
            s.begun.elapsed().as_secs_f64()
        ))
    }

    /// Whether enough time has passed for another plain line.
    fn due(&self) -> bool {
        let Ok(mut s) = self.state.lock() else { return false };
        let due = s.said.is_none_or(|t| t.elapsed() >= QUIET_TIME);
        if due {
            s.said = Some(Instant::now());
        }
        due
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}

fn style(template: &str) -> ProgressStyle {
    ProgressStyle::with_template(template).unwrap_or_else(|_| ProgressStyle::default_bar())
}

/// Iterations until the relative fall is below the usual tolerance, were it to shrink as it does.
fn iterations_left(falls: &[f64]) -> Option<f64> {
    let [.., a, b] = falls else { return None };
    let ratio = (b / a).clamp(1e-3, 0.7);
    Some(((1e-6 / b).ln() / ratio.ln()).clamp(1.0, 12.0))
}
