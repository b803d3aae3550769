//! What to do next.

use super::{Card, explained, run, verdict};
use crate::html::view::View;
use crate::html::{code, escape};
use crate::peek::{list, number, rows, text};
use crate::shell::{quoted, quoted_path};
use crate::terminal::chance;
use serde_json::Value;

pub(super) fn card(v: &View) -> Card {
    let question = "What next?";
    let command = v.run.info.command.as_str();
    if let Some(n) = v.diagnosis.as_ref().and_then(|d| d.get("next_test")).filter(|n| !n.is_null()) {
        let head = format!("Separate {}", escape(&list(n, "separates").join(" from ")));
        let power = number(n, "expected_power")
            .map_or_else(String::new, |p| format!(": told apart with a chance of {}", chance(p)));
        let body = format!(
            "<p>{}{power} <span class=\"muted\">({})</span></p>{}",
            escape(&begun_large(text(n, "proposal"))),
            escape(text(n, "basis")),
            others(n)
        );
        return Card { question, good: None, head, body };
    }
    let (head, body) = match (verdict(v), v.diagnosis.as_ref()) {
        _ if command != "discover" && v.fitted_models.len() > 1 && explained(v) => ("Use the values".to_owned(), loose(v)),
        ("unexplained", Some(_)) => (
            "Look where it is off".to_owned(),
            "<p>The residual strip and the atlas below show when the misfit comes. An effect of your own can be added: see <i>adding an effect</i> in the book.</p>".to_owned(),
        ),
        (_, Some(d)) if command != "discover" && !list(d, "found").is_empty() => {
            // One effect a command; the next adds to the file of the one before.
            let found = list(d, "found");
            let file = |k: usize| if k == found.len() { "more.toml".to_owned() } else { format!("more{k}.toml") };
            let from = |k: usize| if k == 0 { run(v) } else { file(k) };
            let add = |(k, e): (usize, &String)| format!("fct add {} {} --out {}", quoted(e), from(k), file(k + 1));
            let adds = found.iter().enumerate().map(add);
            let fit = "fct identify more.toml --out runs/more".to_owned();
            let lines: Vec<String> = adds.chain([fit]).map(|l| code(&l)).collect();
            ("Add it and refit".to_owned(), format!("<p>{}</p>", lines.join("<br>")))
        }
        (_, Some(_)) if command == "discover" && v.fitted_models.len() > 1 => {
            let last = v.fitted_models.len() - 1;
            ("Refit and report".to_owned(), format!("<p>The found model, ready for a full identification with intervals:<br>{}</p>", code(&format!("fct identify {} --out runs/found", quoted_path(&v.run.path.join(format!("rungs/{last}/run.toml")))))))
        }
        _ if explained(v) => ("Use the values".to_owned(), loose(v)),
        _ => ("Ask what is missing".to_owned(), format!("<p>{}</p>", code(&format!("fct discover {}", run(v))))),
    };
    Card { question, good: None, head, body }
}

fn begun_large(words: &str) -> String {
    let mut letters = words.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}

/// The other additions that were simulated.
fn others(next: &Value) -> String {
    let proposal = text(next, "proposal");
    let line = |t: &&Value| {
        let power = chance(number(t, "expected_power").unwrap_or(0.0));
        format!("<li>{}: {power}</li>", escape(&begun_large(text(t, "proposal"))))
    };
    let tried = rows(next, "tried");
    let lines: String =
        tried.iter().filter(|t| text(t, "proposal") != proposal).take(5).map(|t| line(&t)).collect();
    if lines.is_empty() {
        return String::new();
    }
    format!("<details><summary>Other additions</summary><ul>{lines}</ul></details>")
}

/// What to mind when the values are used.
fn loose(v: &View) -> String {
    let Some(r) = v.current() else { return String::new() };
    let at: Vec<String> = r
        .answer
        .parameters
        .iter()
        .filter(|p| !p.identifiable || p.at_bound)
        .map(|p| escape(&p.path))
        .collect();
    if at.is_empty() {
        return "<p>Every value has its 95 % interval in the table of parameters.</p>".into();
    }
    let more = if at.len() > 4 { format!(" and {} more", at.len() - 4) } else { String::new() };
    format!(
        "<p>but not those the records do not fix: {}{more}.</p>",
        at.iter().take(4).cloned().collect::<Vec<_>>().join(", ")
    )
}
