//! Whether the model is good enough, and where it is off.

use super::{Card, PLACES, explained, mean_off, practice, words};
use crate::html::escape;
use crate::html::place::{cameras, described, places};
use crate::html::view::View;
use crate::terminal::significant;

pub(super) fn good_enough(v: &View) -> Card {
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

pub(super) fn place(v: &View) -> Card {
    let question = "Where is it off?";
    let all = places(v);
    let fine = explained(v)
        && v.fitted_models.first().is_none_or(|base| v.fitted_models.len() < 2 || base.answer.explained);
    let Some(first) = all.first().filter(|_| !fine) else {
        let (head, body) = match (mean_off(v), practice(v)) {
            (Some(_), _) => {
                ("Nowhere beyond the mesh's error", "What is left may be the mesh: see the misfit strips.")
            }
            (None, Some(_)) => {
                ("Nowhere beyond practice", "What is left is as large as in a complete model of such a test.")
            }
            (None, None) => ("Nowhere beyond the noise", "What is left looks like the noise of the record."),
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
