//! The overview page of a batch: specimens side by side, as the paper's Table 2.

use super::{Cell, document, escape, table};
use crate::answer::{IdentifyAnswer, ParameterAnswer};
use crate::terminal::{BatchRow, batch_rows, mean_in_words, mean_sd, pair, significant};
use serde_json::{Value, json};

/// A specimen: its answer, and where its own page is, relative to this one.
pub type Specimen = (IdentifyAnswer, String);

/// The page. `failed`: file and reason.
pub fn page(specimens: &[Specimen], failed: &[(String, String)]) -> String {
    let answers: Vec<IdentifyAnswer> = specimens.iter().map(|s| s.0.clone()).collect();
    let rows = batch_rows(&answers);
    let explained = rows.iter().filter(|r| r.explained).count();
    let synthetic = answers.iter().filter(|a| a.provenance.to_lowercase().starts_with("synthetic")).count();
    let badge = match synthetic {
        0 => String::new(),
        n if n == answers.len() => "<span class=\"badge\">synthetic records</span>".into(),
        n => format!("<span class=\"badge\">{n} of {} synthetic</span>", answers.len()),
    };
    let printed = if rows.iter().any(|r| r.published_gc_N_per_mm.or(r.published_sigma_c_MPa).is_some()) {
        "<p class=\"muted\">Published: mean ± SD of the printed areas.</p>\n"
    } else {
        ""
    };
    let body = format!(
        "<h1>{} specimens{badge}</h1>\n<p class=\"verdict\">{explained} of {} explained by their model{}</p>\n\
         <section id=\"table\"><h2>Mean along the tear path of each specimen, ± its standard error</h2>\n\
         {printed}{}{}</section>\n\
         {}<section><h2>Bulk</h2>\n{}</section>\n{}",
        rows.len(),
        rows.len(),
        if failed.is_empty() { String::new() } else { format!(", {} failed", failed.len()) },
        overview(specimens, &rows),
        over_all(&rows),
        along(&rows),
        bulk(&answers),
        failures(failed)
    );
    document("fct batch", &body, &data(&answers))
}

fn overview(specimens: &[Specimen], rows: &[BatchRow]) -> String {
    let body: String = specimens
        .iter()
        .zip(rows)
        .map(|((_, link), r)| {
            let word = if r.explained { "<td class=\"good\">yes</td>" } else { "<td class=\"bad\">no</td>" };
            let cells: String = [
                r.areas.to_string(),
                pair(r.gc_along_path_N_per_mm),
                pair(r.published_gc_N_per_mm),
                pair(r.sigma_c_along_path_MPa),
                pair(r.published_sigma_c_MPa),
                r.left_out.len().to_string(),
                significant(r.reduced_chi2_total, 3),
            ]
            .iter()
            .map(|c| format!("<td class=\"n\">{}</td>", escape(c)))
            .collect();
            format!(
                "<tr><td><a href=\"{}\">{}</a></td>{cells}{word}</tr>\n",
                escape(link),
                escape(&r.specimen)
            )
        })
        .collect();
    let head: String = ["areas", "Gc (N/mm)", "published", "σc (MPa)", "published", "left out", "reduced χ²"]
        .iter()
        .map(|h| format!("<th class=\"n\">{h}</th>"))
        .collect();
    format!(
        "<div class=\"scroll\"><table><thead><tr><th>specimen</th>{head}<th>explained</th></tr></thead><tbody>\n{body}</tbody></table></div>\n"
    )
}

/// Values along the path; of one area each there is nothing to draw.
fn along(rows: &[BatchRow]) -> String {
    if rows.iter().all(|r| r.areas < 2) {
        return String::new();
    }
    format!(
        "<section><h2>Along the tear path</h2>\n<div class=\"charts\">{}{}</div></section>\n",
        super::chart(
            "batch",
            "gc",
            "fracture energy Gc (N/mm) along the path, where the records fix it; a line per specimen"
        ),
        super::chart(
            "batch",
            "sigma_c",
            "strength σc (MPa) along the path, where the records fix it; a line per specimen"
        )
    )
}

/// Mean ± SD of the means of the specimens that are explained, and what is not in it.
fn over_all(rows: &[BatchRow]) -> String {
    let (mean, left_out) = mean_in_words(rows);
    let left_out: String = left_out.iter().map(|l| format!("<li>{}</li>\n", escape(l))).collect();
    let left_out =
        if left_out.is_empty() { left_out } else { format!("<ul class=\"muted\">\n{left_out}</ul>\n") };
    format!("<p><b>{}</b></p>\n{left_out}", escape(&mean))
}

/// One column per parameter of the bulk that some specimen identifies, in the unit of its key.
fn bulk(answers: &[IdentifyAnswer]) -> String {
    let mut columns: Vec<(&str, Column)> = Vec::new();
    for p in answers.iter().flat_map(|a| &a.parameters).filter(|p| p.path.starts_with("bulk.")) {
        if !columns.iter().any(|c| c.0 == p.path) {
            columns.push((&p.path, Column::of(p)));
        }
    }
    let value = |a: &IdentifyAnswer, path: &str, by: f64| {
        a.parameters.iter().find(|p| p.path == path).map(|p| p.value * by)
    };
    let rows = answers.iter().map(|a| {
        let cells = columns.iter().map(|(path, c)| {
            Cell::number(value(a, path, c.factor).map_or("fixed".into(), |v| significant(v, 4)))
        });
        std::iter::once(Cell::left(&a.specimen)).chain(cells).collect()
    });
    let mean = std::iter::once(Cell::left("mean ± SD")).chain(columns.iter().map(|(path, c)| {
        let all: Vec<f64> = answers.iter().filter_map(|a| value(a, path, c.factor)).collect();
        Cell::number(
            mean_sd(&all)
                .map_or("–".into(), |[m, s]| format!("{} ± {}", significant(m, 4), significant(s, 2))),
        )
    }));
    let head: Vec<&str> =
        std::iter::once("specimen").chain(columns.iter().map(|(_, c)| c.title.as_str())).collect();
    table(&head, rows.chain([mean.collect()]))
}

/// How a parameter is shown: kPa for stresses, degrees for angles.
struct Column {
    title: String,
    factor: f64,
}

impl Column {
    fn of(p: &ParameterAnswer) -> Self {
        let name = super::tables::short(&p.path);
        match p.unit.as_str() {
            "MPa" => Self { title: format!("{name} (kPa)"), factor: 1e3 },
            "rad" => Self { title: format!("{name} (°)"), factor: 180.0 / std::f64::consts::PI },
            "" => Self { title: name, factor: 1.0 },
            unit => Self { title: format!("{name} ({unit})"), factor: 1.0 },
        }
    }
}

fn failures(failed: &[(String, String)]) -> String {
    if failed.is_empty() {
        return String::new();
    }
    let rows = failed.iter().map(|(file, why)| vec![Cell::left(file), Cell::remark(why)]);
    format!("<section><h2>Failed</h2>\n{}</section>\n", table(&["file", "reason"], rows))
}

fn data(answers: &[IdentifyAnswer]) -> Value {
    // What the records do not fix, or a bound holds, is no value to draw.
    let value = |p: &ParameterAnswer| (p.identifiable && !p.at_bound).then_some(p.value);
    let of = |a: &IdentifyAnswer, end: &str| -> Vec<Option<f64>> {
        let areas = a.parameters.iter().filter(|p| p.path.starts_with("interface.area["));
        areas.filter(|p| p.path.ends_with(end)).map(value).collect()
    };
    let lines: Vec<Value> = answers
        .iter()
        .map(|a| json!({ "name": a.specimen, "gc": of(a, "].gc"), "sigma_c": of(a, "].sigma_c") }))
        .collect();
    json!({ "tests": [], "rungs": [], "shown": 0, "convergence": null, "batch": lines })
}
