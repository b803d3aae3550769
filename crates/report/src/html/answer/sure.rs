//! How sure the answer is.

use super::{Card, is_screen, verdict};
use crate::html::escape;
use crate::html::view::View;
use crate::peek::{groups, list, number, rows, text};
use crate::terminal::{p_value, significant};

pub(super) fn card(v: &View) -> Card {
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
            ("ambiguous", true) if list(d, "found").is_empty() => {
                "Neither that an effect is missing, nor that none is".into()
            }
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
    for answer in v.current().iter().map(|r| &r.answer) {
        // What stands beside the answer is no fault of it.
        let beside = answer.beside();
        for remark in &answer.remarks {
            let class = if beside.contains(remark) { "" } else { " class=\"bad\"" };
            body.push_str(&format!("<li{class}>{}</li>", escape(remark)));
        }
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
