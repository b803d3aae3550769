//! One self-contained HTML page per run: no network, light and dark, prints well.
//!
//! Words and tables are plain HTML; charts are drawn by uPlot (MIT, `assets/uPlot.LICENSE`) from the
//! JSON that `data` puts into the page.

mod answer;
mod batch;
mod data;
mod document;
mod first;
mod identify;
mod ladder;
mod place;
mod probable;
mod simulate;
mod sliders;
mod study;
mod tables;
mod view;

pub use batch::page as batch_page;
pub use document::is_page;
pub use study::{StudyHead, StudySection, StudyTable, page as study_page};
pub use view::{FittedModel, View};

use document::{document, picture, share_class};

use crate::runs::StoredRun;
use crate::shell::quoted_path;
use crate::{Curve, ReportError};
use serde_json::Value;
use std::path::Path;

/// The page of a run whose files lie in `files` (its own directory, or where it is being written).
///
/// # Errors
/// If what was stored cannot be shown.
pub fn page(run: &StoredRun, files: &Path) -> Result<String, ReportError> {
    if let Some(answer) = run.simulate() {
        let at = run.in_folder(files);
        let curves: Vec<Curve> = at.curves()?;
        let pictures = view::pictures(&at, answer.tests.keys())?;
        return Ok(shell(run, &simulate::body(&answer, &curves, &pictures), &data::of_curves(&curves)));
    }
    view_page(&View::of(run, files)?)
}

/// One page over several runs of a specimen: their ladder.
///
/// # Errors
/// If one of them is no identification of the same specimen.
pub fn runs_page(runs: &[StoredRun]) -> Result<String, ReportError> {
    view_page(&View::of_runs(runs)?)
}

fn view_page(v: &View) -> Result<String, ReportError> {
    let body = if v.fitted_models.is_empty() && v.diagnosis.is_none() {
        unfinished(&v.run)
    } else {
        identify::body(v)
    };
    Ok(shell(&v.run, &body, &data::of(v)))
}

fn shell(run: &StoredRun, body: &str, data: &Value) -> String {
    let name = text(run, "specimen");
    let provenance = text(run, "provenance");
    let synthetic = provenance.to_lowercase().starts_with("synthetic");
    let badge = if synthetic { "<span class=\"badge\">synthetic records</span>" } else { "" };
    let title = format!("{name} – fct {}", run.info.command);
    let head = format!("<h1>{}{badge}</h1>\n", escape(&name));
    document(&title, &format!("{head}{body}{}", origin(run, &provenance)), data)
}

fn text(run: &StoredRun, key: &str) -> String {
    run.answer.get(key).and_then(Value::as_str).unwrap_or_default().to_owned()
}

/// A run that did not come to its end.
fn unfinished(run: &StoredRun) -> String {
    let why = text(run, "stopped_because");
    format!("<p class=\"verdict bad\">Not finished</p>\n<p>{}</p>\n", escape(&why))
}

/// Where everything comes from, and how to make it again.
fn origin(run: &StoredRun, provenance: &str) -> String {
    let files = run.info.inputs.iter().map(|f| {
        vec![
            Cell::left(f.file.display().to_string()),
            Cell::left(f.sha256.chars().take(16).collect::<String>()),
        ]
    });
    let provenance = if provenance.is_empty() { "not stated in the specimen file" } else { provenance };
    let input = std::path::absolute(&run.path).unwrap_or_else(|_| run.path.clone()).join("run.toml");
    let seconds = run.answer.get("seconds").and_then(Value::as_f64);
    let runs = run.answer.get("forward_runs").and_then(Value::as_u64);
    let cost = match (seconds, runs) {
        (Some(s), Some(n)) => format!(" {n} model runs, {s:.0} s."),
        (Some(s), None) => format!(" {s:.1} s."),
        _ => String::new(),
    };
    format!(
        "<section id=\"origin\"><h2>Where this comes from</h2>\n<p>{}</p>\n{}<p>fct {}.{cost} To reproduce:</p>\n\
         <pre>fct {} {}</pre>\n<p class=\"muted\">Charts: uPlot 1.6.32, © Leon Sorokin, MIT licence.</p></section>\n",
        escape(provenance),
        table(&["file", "SHA-256 (first 16)"], files),
        escape(&run.info.version),
        escape(&run.info.command),
        escape(&quoted_path(&input)),
    )
}

/// Text that is no markup, and that turns nothing around.
fn escape(text: &str) -> String {
    // Line ends and tabs are blanks in HTML.
    let text = input::visible(&text.replace(['\n', '\r'], " "));
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
        .replace('"', "&quot;")
        .replace('\'', "&#39;")
}

/// A command line.
fn code(text: &str) -> String {
    format!("<code>{}</code>", escape(text))
}

/// A part that every rung has for itself; the page shows the chosen one.
fn per_model(v: &View, part: impl Fn(&FittedModel) -> String) -> String {
    let one = |(k, r): (usize, &FittedModel)| {
        let hidden = if k == v.shown { "" } else { " hidden" };
        format!("<div data-of=\"{k}\"{hidden}>\n{}</div>\n", part(r))
    };
    v.fitted_models.iter().enumerate().map(one).collect()
}

/// A cell of a table.
struct Cell {
    text: String,
    class: &'static str,
    share: Option<f64>,
}

impl Cell {
    fn left(text: impl Into<String>) -> Self {
        Self { text: text.into(), class: "", share: None }
    }
    fn number(text: impl Into<String>) -> Self {
        Self { text: text.into(), class: "n", share: None }
    }
    fn remark(text: impl Into<String>) -> Self {
        Self { text: text.into(), class: "remark", share: None }
    }
    /// A share with a bar.
    fn share(x: f64) -> Self {
        Self { text: format!("{:.0} %", 100.0 * x), class: "", share: Some(x) }
    }
    fn html(&self) -> String {
        let bar = self.share.map_or(String::new(), |x| {
            format!("<span class=\"fall\"><span class=\"{}\"></span></span> ", share_class(x))
        });
        format!("<td class=\"{}\">{bar}{}</td>", self.class, escape(&self.text))
    }
}

/// A table; a column is aligned as its first cell.
fn table(header: &[&str], rows: impl Iterator<Item = Vec<Cell>>) -> String {
    let rows: Vec<Vec<Cell>> = rows.collect();
    let class = |i: usize| rows.first().and_then(|r| r.get(i)).map_or("", |c| c.class);
    let head: String = header
        .iter()
        .enumerate()
        .map(|(i, h)| format!("<th class=\"{}\">{}</th>", class(i), escape(h)))
        .collect();
    let body: String = rows
        .iter()
        .map(|row| format!("<tr>{}</tr>\n", row.iter().map(Cell::html).collect::<String>()))
        .collect();
    format!(
        "<div class=\"scroll\"><table>\n<thead><tr>{head}</tr></thead>\n<tbody>\n{body}</tbody>\n</table></div>\n"
    )
}

/// The strip at typical points of a test.
fn strip(test: &str, svg: &str) -> String {
    let caption = format!("{test}: the deformed strip at typical points, true scale");
    format!(
        "<figure class=\"strip\"><div class=\"scroll\">{}</div><figcaption>{}</figcaption></figure>\n",
        picture(svg, &caption),
        escape(&caption)
    )
}

/// Where a chart is drawn.
fn chart(kind: &str, name: &str, caption: &str) -> String {
    format!(
        "<figure class=\"chart\" data-chart=\"{kind}\" data-name=\"{}\"><figcaption>{}</figcaption></figure>\n",
        escape(name),
        escape(caption)
    )
}
