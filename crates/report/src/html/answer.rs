//! The first screen: is the model good enough, where not, what is missing, how sure, what next.

use super::place::{cameras, described, places};
use super::probable::bars;
use super::view::{FittedModel, View};
use super::{code, escape};
use crate::answer::ParameterAnswer;
use crate::peek::{groups, list, number, rows, text, yes};
use crate::shell::{quoted, quoted_path};
use crate::terminal::{called as called_words, chance, interval, p_value, readable_unit, significant};
use serde_json::Value;

/// Segments that are named.
const PLACES: usize = 3;

/// What is said of probabilities without a fit.
const BY_DERIVATIVES: &str =
    "<p class=\"muted\">By the derivatives at this model; <code>fct discover</code> fits the effects.</p>";

/// A question with its answer as HTML; `good`: whether it is good news, if it is news at all.
struct Card {
    question: &'static str,
    good: Option<bool>,
    head: String,
    body: String,
}

/// The five answers.
pub fn section(v: &View) -> String {
    let cards = [good_enough(v), place(v), missing(v), how_sure(v), next(v)];
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

fn good_enough(v: &View) -> Card {
    let question = "Is the model good enough?";
    let good = explained(v);
    let Some(now) = v.current() else {
        return Card { question, good: Some(good), head: words(v), body: String::new() };
    };
    let base = v.fitted_models.first().filter(|_| v.fitted_models.len() > 1);
    let head = match (good, base) {
        (true, None) if now.explained_with_mesh_error().is_some() => {
            "Yes, within the mesh's error".to_owned()
        }
        (true, None) => "Yes".to_owned(),
        (true, Some(b)) if b.answer.explained && v.run.info.command != "discover" => {
            "Yes, and the base model was".to_owned()
        }
        (true, Some(_)) => format!("Yes, with {}", escape(&now.name())),
        (false, None) => "No".to_owned(),
        (false, Some(_)) => format!("No, not even with {}", escape(&now.name())),
    };
    let mut body = format!(
        "<p>Reduced χ² <b>{}</b> (1: at the noise), rms misfit <b>{} N</b> at a noise of {} N.</p>",
        significant(now.chi2(), 3),
        significant(now.rms(), 3),
        significant(now.noise(), 3)
    );
    if let Some(left) = &now.answer.left {
        body.push_str(&format!("<p>{}</p>", escape(&left.sentence())));
    }
    if let Some(own) = now.on_the_file_s_mesh() {
        body.push_str(&format!(
            "<p>As the search judged it. The curves and tables below are one run at its values on the file's mesh, where they \
             were not refitted: χ² {}.</p>",
            significant(own, 3)
        ));
    }
    if let Some(base) = base {
        body.push_str(&format!(
            "<p>The base model alone: χ² {}, rms {} N.</p>",
            significant(base.chi2(), 3),
            significant(base.rms(), 3)
        ));
    }
    if let Some(chi2) = now.explained_with_mesh_error().filter(|_| good) {
        body.push_str(&format!(
            "<p>With the record's noise alone it is <b>{}</b>: what is left is as large as the error of the mesh, and a finer one \
             may show more.</p>",
            significant(chi2, 3)
        ));
    }
    if now.answer.stages.iter().any(|s| !s.converged) {
        body.push_str("<p class=\"bad\">The search had not settled when it ended.</p>");
    }
    Card { question, good: Some(good), head, body }
}

fn place(v: &View) -> Card {
    let question = "Where is it off?";
    let all = places(v);
    let fine = explained(v)
        && v.fitted_models.first().is_none_or(|base| v.fitted_models.len() < 2 || base.answer.explained);
    let Some(first) = all.first().filter(|_| !fine) else {
        let (head, body) = match v.current().and_then(FittedModel::explained_with_mesh_error) {
            None => ("Nowhere beyond the noise", "What is left looks like the noise of the record."),
            Some(_) => {
                ("Nowhere beyond the mesh's error", "What is left may be the mesh: see the misfit strips.")
            }
        };
        return Card { question, good: Some(true), head: head.into(), body: format!("<p>{body}</p>") };
    };
    let items: String = all
        .iter()
        .take(PLACES)
        .map(|(test, segment, share, sign)| {
            let side = match sign {
                '+' => ", record above model",
                '-' => ", record below model",
                _ => "",
            };
            let (test, segment) = (escape(test), escape(segment));
            format!("<li>{test}, {segment}: <b>{:.0} %</b> of χ²{side}</li>", 100.0 * share)
        })
        .collect();
    let whose = match described(v).filter(|_| v.fitted_models.len() > 1) {
        Some(r) => format!("<p class=\"muted\">Of {}:</p>", escape(&r.name())),
        None => String::new(),
    };
    let (camera, worse) = cameras(v);
    let head = worse.unwrap_or_else(|| format!("{}, {}", escape(&first.0), escape(&first.1)));
    let items = items + &camera;
    Card { question, good: None, head, body: format!("{whose}<ul>{items}</ul>") }
}

fn words(v: &View) -> String {
    escape(&v.diagnosis.as_ref().map(|d| list(d, "words").join(" ")).unwrap_or_default())
}

fn missing(v: &View) -> Card {
    let question = "What is missing?";
    let Some(d) = &v.diagnosis else {
        let added =
            v.current().filter(|r| explained(v) && !r.answer.effects.is_empty() && v.fitted_models.len() > 1);
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
        _ if is_screen(v) && v.fitted_models.len() < 2 => {
            format!("The screen points to {}", escape(&groups(d).join(", and ")))
        }
        "unexplained" if found.is_empty() => "Something the catalogue does not hold".to_owned(),
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

/// Whether the diagnosis is a screen, which refits nothing.
fn is_screen(v: &View) -> bool {
    v.diagnosis.as_ref().is_some_and(|d| rows(d, "ladder").is_empty())
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

/// Reduced χ² with the record's noise alone, where what is called explained needs the mesh's error.
pub fn mean_off(v: &View) -> Option<f64> {
    v.current().and_then(FittedModel::explained_with_mesh_error)
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

fn how_sure(v: &View) -> Card {
    let question = "How sure?";
    let mut facts = Vec::new();
    let mut head = String::new();
    if let Some(d) = &v.diagnosis {
        let rivals: Vec<String> = groups(d).into_iter().filter(|g| g.contains(" or ")).collect();
        head = match (verdict(v), rivals.is_empty()) {
            _ if is_screen(v) && list(d, "found").is_empty() => {
                "No effect of the catalogue is called for".into()
            }
            _ if is_screen(v) && v.fitted_models.len() < 2 => "A screen: nothing was refitted yet".into(),
            _ if is_screen(v) => "One model was refitted, its rivals were not".into(),
            ("ambiguous", _) | (_, false) => "These records cannot tell rivals apart".into(),
            ("unexplained", _) => "Sure that something is missing".into(),
            ("nothing_missing", _) => "Nothing in the catalogue would help".into(),
            _ => "No rival explains it as well".into(),
        };
        facts.extend(rivals.iter().map(|r| format!("cannot be told apart here: <b>{}</b>", escape(r))));
        for name in list(d, "found") {
            if let Some(p) = rows(d, "screen")
                .iter()
                .find(|r| text(r, "effect") == name)
                .and_then(|r| number(r, "p_value"))
            {
                let p = p_value(p);
                let p = if p.starts_with('<') { format!("p {p}") } else { format!("p = {p}") };
                facts.push(format!("{}: {} in the score test", escape(&name), escape(&p)));
            }
        }
    }
    facts.extend(falls(v));
    if let Some(r) = v.current() {
        let a = &r.answer;
        let fixed = a.parameters.iter().filter(|p| p.identifiable).count();
        let line = format!("{fixed} of {} parameters fixed by the records", a.parameters.len());
        if head.is_empty() {
            head = line;
        } else {
            facts.push(line);
        }
    }
    let mut body: String = facts.iter().map(|f| format!("<li>{f}</li>")).collect();
    for told in v.current().iter().filter_map(|r| r.answer.starts.as_ref()) {
        body.push_str(&format!("<li>{}</li>", escape(told)));
    }
    for remark in v.current().iter().flat_map(|r| &r.answer.remarks) {
        body.push_str(&format!("<li class=\"bad\">{}</li>", escape(remark)));
    }
    Card { question, good: None, head, body: format!("<ul>{body}</ul>") }
}

/// What the ladder gained in BIC and on data that the fit did not see.
fn falls(v: &View) -> Vec<String> {
    let (Some(base), Some(now)) =
        (v.fitted_models.first(), v.current().filter(|_| v.fitted_models.len() > 1))
    else {
        return Vec::new();
    };
    let mut out = Vec::new();
    if let (Some(a), Some(b)) = (base.bic(), now.bic()) {
        out.push(format!("BIC {} → {} (lower is better)", significant(a, 4), significant(b, 4)));
    }
    if let (Some(a), Some(b)) = (base.held_out(), now.held_out()) {
        out.push(format!("held-out misfit {} → {} N rms", significant(a, 3), significant(b, 3)));
    }
    out
}

fn run(v: &View) -> String {
    quoted_path(&v.run.path)
}

fn next(v: &View) -> Card {
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

/// Whether a screen row was called for by the test.
pub fn called(row: &Value) -> bool {
    yes(row, "significant")
}
