//! The page of an identification, a diagnosis or a search.

use super::view::{FittedModel, View};
use super::{answer, chart, escape, first, ladder, per_model, sliders, strip, tables};
use crate::published::area;

/// The first screen, then everything it rests on.
pub fn body(v: &View) -> String {
    let shown = v.current().map_or_else(String::new, |r| format!(", shown: {}", shown_name(&r.name())));
    [
        format!("<p class=\"muted\">fct {}{shown}</p>\n", escape(&v.run.info.command)),
        first::section(v),
        answer::section(v),
        ladder::staircase(v),
        curves(v),
        sliders::section(v),
        ladder::effects(v),
        ladder::residuals(v),
        path(v),
        parameters(v),
        convergence(v),
        energies(v),
        pictures(v),
    ]
    .concat()
}

/// The name of the rung shown; the page's script keeps it right.
fn shown_name(name: &str) -> String {
    format!("<span data-shown>{}</span>", escape(name))
}

fn curves(v: &View) -> String {
    let Some(r) = v.current().filter(|r| !r.curves.is_empty()) else { return String::new() };
    let channels = r.curves.iter().flat_map(|c| {
        let names = c.columns.iter().filter_map(|(n, _)| n.strip_suffix("_measured_mm"));
        names.map(|n| {
            let caption = format!("{}, camera: {} (mm), record and model", c.test, n.replace('_', " "));
            chart("channel", &format!("{}.{n}", c.test), &caption)
        })
    });
    let charts: String = r
        .curves
        .iter()
        .map(|c| {
            chart(
                "test",
                &c.test,
                &format!(
                    "{}: force (N) with ± 2 sd of the noise about the model; below, record − model",
                    c.test
                ),
            )
        })
        .chain(channels)
        .collect();
    let torn = r.curves.iter().any(|c| !c.residuals().tear_front.is_empty());
    let front = if torn {
        "<button type=\"button\" data-axis=\"front\" aria-pressed=\"false\">tear front</button>"
    } else {
        ""
    };
    format!(
        "<section id=\"curves\"><h2>Record and model: {}</h2>\n<div class=\"tools\"><span>against</span>\
         <button type=\"button\" data-axis=\"u\" aria-pressed=\"true\">displacement</button>\
         <button type=\"button\" data-axis=\"t\" aria-pressed=\"false\">time</button>\
         {front}<span class=\"muted\">drag to zoom, double click to see all</span></div>\n\
         <div class=\"charts\">\n{charts}</div>\n{}</section>\n",
        shown_name(&r.name()),
        per_model(v, |r| tables::fits(&r.answer))
    )
}

fn path(v: &View) -> String {
    // One area is one value: it stands on the first screen, and a chart of one dot says no more.
    let has = |r: &FittedModel| r.answer.parameters.iter().any(|p| area(&p.path).is_some_and(|at| at > 0));
    if !v.fitted_models.iter().any(has) {
        return String::new();
    }
    let published = v.current().is_some_and(|r| r.answer.published.is_some());
    let averaged = v.current().is_some_and(|r| r.answer.parameters.iter().any(|p| p.published_averaged));
    let note = match (published, averaged) {
        (true, true) => "; diamonds: mean of the published values over the area",
        (true, false) => "; diamonds: published",
        _ => "",
    };
    let caption = |what: &str| {
        format!("{what} in each area with 95 % interval (hollow: not fixed by the records{note})")
    };
    format!(
        "<section id=\"path\"><h2>Along the tear path</h2>\n<div class=\"charts\">\n{}{}</div></section>\n",
        chart("path", "gc", &caption("fracture energy Gc (N/mm)")),
        chart("path", "sigma_c", &caption("strength σc (MPa)"))
    )
}

fn parameters(v: &View) -> String {
    let Some(r) = v.current() else { return String::new() };
    let correlations = per_model(v, |r| tables::correlations(&r.answer));
    format!(
        "<section id=\"parameters\"><h2>Parameters: {}</h2>\n{}<details class=\"correlated\"><summary>Correlations of the \
         parameters</summary>\n<p class=\"muted\">Near ±1: the records fix a combination of the two, not each of them. Hover for \
         the pair.</p>\n{correlations}</details>\n{}</section>\n",
        shown_name(&r.name()),
        per_model(v, |r| tables::parameters(&r.answer)),
        tables::published(&r.answer)
    )
}

fn convergence(v: &View) -> String {
    let Some(a) =
        v.current().map(|r| &r.answer).filter(|a| a.history.iter().map(|h| h.runs.len()).sum::<usize>() > 4)
    else {
        return String::new();
    };
    format!(
        "<section id=\"convergence\"><h2>Convergence</h2>\n<div class=\"charts\">\n{}{}</div>\n<p class=\"muted\">{}</p></section>\n",
        chart(
            "values",
            "values",
            "parameters over their final values, accepted steps (first, middle and last area)"
        ),
        chart("objective", "objective", "objective over its start in each stage, accepted steps"),
        escape(&a.stopped_because)
    )
}

fn energies(v: &View) -> String {
    if v.fitted_models.iter().all(|r| r.answer.tests.values().all(|t| t.energy.is_none())) {
        return String::new();
    }
    format!(
        "<section id=\"energies\"><h2>Energies at the end of each test</h2>\n{}</section>\n",
        per_model(v, |r| tables::energies(&r.answer))
    )
}

fn pictures(v: &View) -> String {
    let Some(r) = v.current().filter(|r| !r.pictures.is_empty()) else { return String::new() };
    let all: String = r.pictures.iter().map(|(test, svg)| strip(test, svg)).collect();
    format!("<section id=\"fields\"><h2>The strip: {}</h2>\n{all}</section>\n", escape(&r.name()))
}
