//! One self-contained HTML page per run: no network, light and dark, prints well.

mod identify;
mod simulate;

use crate::figures::{Figure, for_html};
use crate::runs::StoredRun;
use crate::{Curve, ReportError};
use serde_json::Value;

const CSS: &str = include_str!("style.css");

/// The page of a run.
///
/// # Errors
/// If a figure cannot be drawn.
pub fn page(run: &StoredRun, curves: &[Curve]) -> Result<String, ReportError> {
    let body = match (run.identify(), run.simulate()) {
        (Some(answer), _) => identify::body(&answer, curves)?,
        (_, Some(answer)) => simulate::body(&answer, curves)?,
        _ => unfinished(run),
    };
    let name = text(run, "specimen");
    let provenance = text(run, "provenance");
    let synthetic = provenance.to_lowercase().starts_with("synthetic");
    let badge = if synthetic { "<span class=\"badge\">synthetic records</span>" } else { "" };
    Ok(format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <title>{name} – fct {command}</title>\n<style>\n{CSS}</style>\n</head>\n<body>\n<main>\n\
         <h1>{name}{badge}</h1>\n{body}{origin}</main>\n</body>\n</html>\n",
        name = escape(&name),
        command = escape(&run.info.command),
        origin = origin(run, &provenance),
    ))
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
        let hash = f.sha256.as_deref().map_or("–".to_owned(), |h| h.chars().take(16).collect());
        vec![Cell::left(f.file.display().to_string()), Cell::left(hash)]
    });
    let provenance = if provenance.is_empty() { "not stated in the specimen file" } else { provenance };
    let input = std::path::absolute(&run.path).unwrap_or_else(|_| run.path.clone()).join("run.toml");
    format!(
        "<h2>Where this comes from</h2>\n<p>{}</p>\n{}<p>fct {}. To reproduce:</p>\n<pre>fct {} {}</pre>\n",
        escape(provenance),
        table(&["file", "SHA-256 (first 16)"], files),
        escape(&run.info.version),
        escape(&run.info.command),
        escape(&quoted(&input.display().to_string())),
    )
}

/// A path as a shell takes it.
fn quoted(path: &str) -> String {
    let plain = path.chars().all(|c| c.is_alphanumeric() || "/._-+".contains(c));
    if plain { path.to_owned() } else { format!("'{}'", path.replace('\'', "'\\''")) }
}

/// Text that is no markup.
fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

/// A cell of a table.
struct Cell {
    text: String,
    class: &'static str,
}

impl Cell {
    fn left(text: impl Into<String>) -> Self {
        Self { text: text.into(), class: "" }
    }
    fn number(text: impl Into<String>) -> Self {
        Self { text: text.into(), class: "n" }
    }
    fn remark(text: impl Into<String>) -> Self {
        Self { text: text.into(), class: "remark" }
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
        .map(|row| {
            let cells: String =
                row.iter().map(|c| format!("<td class=\"{}\">{}</td>", c.class, escape(&c.text))).collect();
            format!("<tr>{cells}</tr>\n")
        })
        .collect();
    format!(
        "<div class=\"scroll\"><table>\n<thead><tr>{head}</tr></thead>\n<tbody>\n{body}</tbody>\n</table></div>\n"
    )
}

/// Figures side by side where there is room.
fn figures(list: &[Figure]) -> String {
    let all: String = list
        .iter()
        .map(|f| {
            format!("<figure>{}<figcaption>{}</figcaption></figure>\n", for_html(&f.svg), escape(&f.caption))
        })
        .collect();
    format!("<div class=\"figures\">\n{all}</div>\n")
}

/// Numbers in boxes: (number, what it is).
fn numbers(list: &[(String, &str)]) -> String {
    let all: String = list
        .iter()
        .map(|(n, what)| format!("<div><b>{}</b><span>{}</span></div>\n", escape(n), escape(what)))
        .collect();
    format!("<div class=\"numbers\">\n{all}</div>\n")
}
