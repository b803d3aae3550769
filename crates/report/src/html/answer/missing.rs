//! What is missing: names, groups, how much of each.

use super::{Card, PLACES, called, explained, is_screen, run, something_else, verdict, words};
use crate::answer::ParameterAnswer;
use crate::html::probable::bars;
use crate::html::view::View;
use crate::html::{code, escape};
use crate::peek::{groups, list, number, rows, text};
use crate::terminal::{called as called_words, interval, readable_unit, significant};
use serde_json::Value;

/// What is said of probabilities without a fit.
const BY_DERIVATIVES: &str =
    "<p class=\"muted\">By the derivatives at this model; <code>fct discover</code> fits the effects.</p>";

pub(super) fn card(v: &View) -> Card {
    let question = "What is missing?";
    let Some(d) = &v.diagnosis else {
        let added = v.current().filter(|r| explained(v) && !r.parts.is_empty() && v.fitted_models.len() > 1);
        let head = match added {
            Some(r) if v.fitted_models.first().is_some_and(|b| !b.answer.explained) => {
                format!("{}, which was added", escape(&r.name()))
            }
            _ if explained(v) => "Nothing that shows".to_owned(),
            _ => "Not asked yet".to_owned(),
        };
        let body = format!(
            "<p>{} screens the catalogue at this model.</p>",
            code(&format!("fct diagnose {}", run(v)))
        );
        return Card { question, good: explained(v).then_some(true), head, body };
    };
    let found = list(d, "found");
    let head = match verdict(v) {
        "nothing_missing" if explained(v) => "Nothing that shows".to_owned(),
        "nothing_missing" => "Nothing that the screen calls for".to_owned(),
        _ if is_screen(v) && v.fitted_models.len() < 2 && !found.is_empty() => {
            format!("The screen points to {}", escape(&groups(d).join(", and ")))
        }
        "ambiguous" if found.is_empty() => "These records cannot tell".to_owned(),
        "unexplained" if found.is_empty() && something_else(v) => {
            "Something the catalogue does not hold".to_owned()
        }
        "unexplained" if found.is_empty() => "No effect that could be named".to_owned(),
        "unexplained" => format!("More than {}", escape(&groups(d).join(", and "))),
        _ => escape(&groups(d).join(", and ")),
    };
    let good = (verdict(v) == "nothing_missing" && explained(v)).then_some(true);
    let values = amounts(v, &found);
    // The sentences of a screen alone speak of its own fit of the base model, not of the one on this page.
    let body = match (is_screen(v), d.get("posterior").is_some()) {
        (true, false) => screened(d),
        (true, true) => BY_DERIVATIVES.to_owned(),
        (false, _) => format!("<p>{}</p>", words(v)),
    };
    Card { question, good, head, body: bars(d) + &body + &values }
}

/// What a screen says of the effects that it calls for.
fn screened(d: &Value) -> String {
    let called: String = rows(d, "screen")
        .iter()
        .filter(|r| called(r))
        .take(PLACES)
        .map(|r| {
            let fall = 100.0 * number(r, "expected_fall").unwrap_or(0.0);
            let how = match called_words(r) {
                "called for" => "",
                _ => ", but in more than a plausible amount",
            };
            format!("<li>{}: expected to take away {fall:.0} % of χ²{how}</li>", escape(text(r, "effect")))
        })
        .collect();
    let called = if called.is_empty() { "<li>no effect is called for</li>".into() } else { called };
    format!(
        "<ul>{called}</ul><p class=\"muted\">By a linear screen at its own joint fit of the base model.</p>"
    )
}

/// How much of each found effect: its parameters at the rung shown.
fn amounts(v: &View, found: &[String]) -> String {
    let Some(r) = v.current() else { return String::new() };
    let of = |p: &&ParameterAnswer| {
        p.path
            .strip_prefix("effects.")
            .and_then(|n| n.split_once('.'))
            .is_some_and(|(e, _)| found.iter().any(|f| f == e))
    };
    let line = |p: &ParameterAnswer| {
        let (unit, factor) = readable_unit(&p.path, &p.unit);
        let name = escape(p.path.trim_start_matches("effects."));
        let value = significant(p.value * factor, 3);
        format!("<li>{name} = <b>{value} {unit}</b> (95 %: {})</li>", interval(p, factor))
    };
    let all: String = r.answer.parameters.iter().filter(of).map(line).collect();
    if all.is_empty() { all } else { format!("<ul>{all}</ul>") }
}
