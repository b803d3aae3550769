//! The first screen: is the model good enough, where not, what is missing, how sure, what next.

mod missing;
mod next;
mod quality;
mod sure;

use super::escape;
use super::view::{FittedModel, View};
use crate::peek::{list, rows, text, yes};
use crate::shell::quoted_path;
use serde_json::Value;

/// Segments that are named.
const PLACES: usize = 3;

/// A question with its answer as HTML; `good`: whether it is good news, if it is news at all.
struct Card {
    question: &'static str,
    good: Option<bool>,
    head: String,
    body: String,
}

/// The five answers.
pub fn section(v: &View) -> String {
    let cards = [quality::good_enough(v), quality::place(v), missing::card(v), sure::card(v), next::card(v)];
    let cards: String = cards
        .iter()
        .enumerate()
        .map(|(i, c)| {
            let class = match c.good {
                Some(true) => "good",
                Some(false) => "bad",
                None => "",
            };
            format!(
                "<div class=\"answer a{i}\"><h2>{}</h2><p class=\"verdict {class}\">{}</p>{}</div>\n",
                c.question, c.head, c.body
            )
        })
        .collect();
    format!("<section id=\"answers\" class=\"answers\">\n{cards}</section>\n")
}

pub fn verdict(v: &View) -> &str {
    v.diagnosis.as_ref().map_or("", |d| text(d, "verdict"))
}

/// Whether the model shown explains the records. A search has judged that itself.
pub fn explained(v: &View) -> bool {
    match (v.run.info.command.as_str(), v.current()) {
        ("discover", _) => matches!(verdict(v), "nothing_missing" | "explained" | "ambiguous"),
        (_, Some(r)) => r.answer.explained,
        _ => false,
    }
}

fn words(v: &View) -> String {
    escape(&v.diagnosis.as_ref().map(|d| list(d, "words").join(" ")).unwrap_or_default())
}

/// Whether the diagnosis is a screen, which refits nothing.
fn is_screen(v: &View) -> bool {
    v.diagnosis.as_ref().is_some_and(|d| rows(d, "ladder").is_empty())
}

/// Reduced χ² with the record's noise alone, where what is called explained needs the mesh's error.
pub fn mean_off(v: &View) -> Option<f64> {
    v.current().and_then(FittedModel::explained_with_mesh_error)
}

/// What is left beyond noise, share of the peak in percent, where that is not explained by noise and mesh but no more than a complete
/// model leaves.
pub fn practice(v: &View) -> Option<f64> {
    let shown = v.current().filter(|r| explained(v) && !r.answer.explained)?;
    shown.answer.left.as_ref().map(|left| 100.0 * left.rest.all.share_of_peak)
}

/// Whether a cause outside the catalogue is more probable than none.
pub fn something_else(v: &View) -> bool {
    let posterior = v.diagnosis.as_ref().and_then(|d| d.get("posterior"));
    posterior.and_then(|p| p.get("something_else")?.as_f64()).is_none_or(|p| p > analysis::LIKELY)
}

fn run(v: &View) -> String {
    quoted_path(&v.run.path)
}

/// Whether a screen row was called for by the test.
pub fn called(row: &Value) -> bool {
    yes(row, "significant")
}
