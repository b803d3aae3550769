//! Progress on stderr: on a terminal a line that fits it, what is left to wait first; elsewhere now and then a plain line
//! that can be read by itself.

use crate::outcome::say;
use console::Term;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::IsTerminal;
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};
use workbench::Listener;

/// Least time before the first plain line, and between two: what is done sooner needs none.
const QUIET_TIME: Duration = Duration::from_secs(10);
/// Columns of a specimen's name on a line of progress.
const NAME: usize = 24;
/// Columns that a line of progress has where the terminal does not say.
const COLUMNS: usize = 80;

/// Columns of the terminal that text is read on: stdout's, or stderr's where stdout goes through a pager; `None`: no
/// terminal.
pub fn columns() -> Option<usize> {
    let of = |term: Term| term.size_checked().map(|(_, columns)| usize::from(columns));
    of(Term::stdout()).or_else(|| of(Term::stderr()))
}

/// A command's progress.
pub struct Progress {
    bar: Option<ProgressBar>,
    plain: bool,
    title: String,
    listener: Option<Arc<dyn Listener>>,
    state: Mutex<State>,
}

struct State {
    begun: Instant,
    said: Instant,
    stage: String,
    stage_begun: Instant,
    objective: Option<f64>,
    falls: Vec<f64>,
}

impl Progress {
    /// Progress of `title`; silent when `quiet`.
    pub fn new(title: &str, quiet: bool) -> Self {
        let title = shortened(&input::visible(title), NAME);
        let terminal = std::io::stderr().is_terminal() && !quiet;
        let bar = terminal.then(|| {
            let bar = ProgressBar::with_draw_target(None, ProgressDrawTarget::stderr_with_hz(8));
            bar.set_style(style("{spinner} {prefix}: {wide_msg}"));
            bar.set_prefix(title.clone());
            bar.enable_steady_tick(Duration::from_millis(200));
            bar
        });
        let now = Instant::now();
        let state = State {
            begun: now,
            said: now,
            stage: String::new(),
            stage_begun: now,
            objective: None,
            falls: Vec::new(),
        };
        Self { bar, plain: !terminal && !quiet, title, listener: None, state: Mutex::new(state) }
    }

    /// Progress that somebody else shows.
    pub fn told_to(title: &str, listener: Arc<dyn Listener>) -> Self {
        let mut out = Self::new(title, true);
        out.listener = Some(listener);
        out
    }

    /// A remark on what is being done.
    pub fn note(&self, text: &str) {
        if let Some(listener) = &self.listener {
            listener.note(text);
        }
        if let Some(bar) = &self.bar {
            bar.set_message(fitted(&[self.spent(), input::visible(text)], self.room()));
        } else if self.plain && self.due() {
            say(&format!("{}: {text}, {}", self.title, self.spent()));
        }
    }

    /// Whether anybody sees it.
    pub fn heard(&self) -> bool {
        self.bar.is_some() || self.plain || self.listener.is_some()
    }

    /// What was found on the way: a line that stays, however soon after another.
    pub fn found(&self, text: &str) {
        if let Some(listener) = &self.listener {
            listener.note(text);
        }
        let line = format!("{}: {}, {}", self.title, input::visible(text), self.spent());
        match &self.bar {
            Some(bar) => bar.println(line),
            None if self.plain => say(&line),
            None => {}
        }
    }

    /// Steps of a simulation.
    pub fn steps(&self, done: usize, total: usize) {
        if let Some(bar) = &self.bar {
            if bar.length().is_none() {
                bar.set_style(style("{prefix}: {eta} left {wide_bar} {pos}/{len} steps"));
                bar.set_length(total as u64);
            }
            bar.set_position(done as u64);
        } else if self.plain && self.due() {
            let spent = self.begun().elapsed().as_secs_f64();
            let left = spent / done.max(1) as f64 * total.saturating_sub(done) as f64;
            say(&format!(
                "{}: step {done} of {total}, {spent:.0} s so far, about {left:.0} s left",
                self.title
            ));
        }
    }

    /// A model run of a search.
    pub fn search(&self, p: &analysis::Progress) {
        if let Some(listener) = &self.listener {
            listener.iterate(p);
        }
        let Some(told) = self.told(p) else { return };
        if let Some(bar) = &self.bar {
            bar.set_message(told.short(self.room()));
        } else if self.plain && self.due() {
            say(&told.plain(&self.title));
        }
    }

    /// Stage, iteration, objective, time, and what may be left of the stage.
    fn told(&self, p: &analysis::Progress) -> Option<Told> {
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
        let iteration = p.iterate.iteration;
        let pace = s.stage_begun.elapsed().as_secs_f64() / iteration.max(1) as f64;
        Some(Told {
            stage,
            iteration,
            objective: s.objective,
            spent: s.begun.elapsed().as_secs_f64(),
            left: iterations_left(&s.falls).map(|k| k * pace),
        })
    }

    fn begun(&self) -> Instant {
        self.state.lock().map_or_else(|_| Instant::now(), |s| s.begun)
    }

    fn spent(&self) -> String {
        format!("{:.0} s so far", self.begun().elapsed().as_secs_f64())
    }

    /// Columns that a message has beside the spinner and the name.
    fn room(&self) -> usize {
        let columns = Term::stderr().size_checked().map_or(COLUMNS, |(_, columns)| usize::from(columns));
        columns.saturating_sub(self.title.chars().count() + 5)
    }

    /// Whether enough time has passed for another plain line.
    fn due(&self) -> bool {
        let Ok(mut s) = self.state.lock() else { return false };
        let due = s.said.elapsed() >= QUIET_TIME;
        if due {
            s.said = Instant::now();
        }
        due
    }
}

/// What a search has to tell at one of its runs.
struct Told {
    stage: String,
    iteration: usize,
    objective: Option<f64>,
    /// Time since the command began, s.
    spent: f64,
    /// Time that the stage may still take, s.
    left: Option<f64>,
}

impl Told {
    /// Nothing as long as it is not known.
    fn left(&self) -> Option<String> {
        self.left.map(|s| format!("about {s:.0} s left"))
    }

    fn objective(&self) -> String {
        self.objective.map_or_else(|| "no objective yet".to_owned(), |f| format!("objective {f:.4e}"))
    }

    /// For a line of a terminal: what somebody waits for comes first, and whole pieces go where there is no room.
    fn short(&self, room: usize) -> String {
        let others = [
            self.stage.clone(),
            format!("iteration {}", self.iteration),
            self.objective(),
            format!("{:.0} s so far", self.spent),
        ];
        let pieces: Vec<String> = self.left().into_iter().chain(others).collect();
        fitted(&pieces, room)
    }

    /// For a file: everything.
    fn plain(&self, title: &str) -> String {
        let left = self.left().map_or_else(String::new, |left| format!(", {left} of this stage"));
        format!(
            "{title}: {}, iteration {}, {}, {:.0} s so far{left}",
            self.stage,
            self.iteration,
            self.objective(),
            self.spent
        )
    }
}

/// As many whole pieces as fit, the first in any case.
fn fitted(pieces: &[String], room: usize) -> String {
    let mut out = String::new();
    for piece in pieces {
        let comma = if out.is_empty() { "" } else { ", " };
        if !out.is_empty() && out.chars().count() + comma.len() + piece.chars().count() > room {
            break;
        }
        out.push_str(comma);
        out.push_str(piece);
    }
    out
}

/// A name of at most so many columns.
fn shortened(name: &str, columns: usize) -> String {
    if name.chars().count() <= columns {
        return name.to_owned();
    }
    name.chars().take(columns.saturating_sub(1)).chain(['…']).collect()
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

#[cfg(test)]
mod tests {
    use super::*;

    fn told() -> Told {
        let stage = "interface (coarse mesh)".into();
        Told { stage, iteration: 12, objective: Some(1.234e-3), spent: 75.4, left: Some(41.7) }
    }

    #[test]
    fn what_is_left_is_read_at_any_width() {
        for columns in [20, 40, 60, 80, 120] {
            let line = told().short(columns);
            assert!(
                line.starts_with("about 42 s left") && line.chars().count() <= columns,
                "{columns}: {line}"
            );
        }
        assert_eq!(
            told().short(80),
            "about 42 s left, interface (coarse mesh), iteration 12, objective 1.2340e-3"
        );
    }

    #[test]
    fn a_plain_line_tells_everything_by_itself() {
        assert_eq!(
            told().plain("FCT1"),
            "FCT1: interface (coarse mesh), iteration 12, objective 1.2340e-3, 75 s so far, about 42 s left of this stage"
        );
    }

    #[test]
    fn what_is_not_known_is_not_said() {
        let early = Told { left: None, ..told() };
        assert_eq!(early.short(60), "interface (coarse mesh), iteration 12, objective 1.2340e-3");
        assert!(early.plain("FCT1").ends_with("75 s so far"));
    }

    #[test]
    fn a_long_name_leaves_room() {
        assert_eq!(shortened(&"x".repeat(100), NAME).chars().count(), NAME);
    }
}
