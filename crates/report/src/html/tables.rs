//! Tables of one rung: fit, parameters, correlations, energies, published values.

use super::{Cell, escape, share_class, table};
use crate::answer::{IdentifyAnswer, ParameterAnswer, TestFit};
use crate::terminal::{
    SLOPPY_SHOWN, interval, path_means, published_value, readable_unit, remark, significant,
};
use std::fmt::Write;

/// Fit of each test and channel.
pub fn fits(a: &IdentifyAnswer) -> String {
    let row = |name: &str, unit: &str, t: &TestFit| {
        vec![
            Cell::left(name),
            Cell::number(t.points.to_string()),
            Cell::number(format!("{} {unit}", significant(t.rms_N, 3))),
            Cell::number(format!("{} {unit}", significant(t.noise_N, 3))),
            Cell::number(format!("{} {unit}", significant(t.numerical_error_N, 3))),
            Cell::number(format!("{:.2} %", 100.0 * t.rms_N / t.peak_N.max(f64::MIN_POSITIVE))),
            Cell::number(significant(t.reduced_chi2, 3)),
            Cell::number(significant(t.reduced_chi2_total, 3)),
            Cell::number(significant(t.objective, 3)),
        ]
    };
    let header = [
        "test",
        "points",
        "rms misfit",
        "noise",
        "numerical error",
        "rms of peak",
        "reduced χ²",
        "with numerical error",
        "f = Σ misfit²",
    ];
    let forces = a.tests.iter().map(|(n, t)| row(n, "N", t));
    table(&header, forces.chain(a.channels.iter().map(|(n, t)| row(n, "mm", t))))
}

/// Values with intervals.
pub fn parameters(a: &IdentifyAnswer) -> String {
    let published = a.parameters.iter().any(|p| p.published.is_some());
    let mut header = vec!["parameter", "value", "unit", "95 % interval"];
    if published {
        header.push("published");
    }
    header.extend(["identifiable", "remark"]);
    let rows = table(&header, a.parameters.iter().map(|p| row(p, published)));
    let means = path_means(a).map_or_else(String::new, |m| {
        format!("<p>{}. Areas that trade off against their neighbours are known better together than apart.</p>\n", escape(&m))
    });
    format!("{rows}{means}{}", unknown(a))
}

fn row(p: &ParameterAnswer, published: bool) -> Vec<Cell> {
    let (unit, factor) = readable_unit(&p.path, &p.unit);
    let show = |x: Option<f64>| x.map_or("…".into(), |x| significant(x * factor, 4));
    let mut cells = vec![
        Cell::left(&p.path),
        Cell::number(show(Some(p.value))),
        Cell::left(unit),
        Cell::number(interval(p, factor)),
    ];
    if published {
        cells.push(Cell::number(published_value(p, factor)));
    }
    cells.push(Cell::left(if p.identifiable { "yes" } else { "no" }));
    cells.push(Cell::remark(remark(p)));
    cells
}

fn unknown(a: &IdentifyAnswer) -> String {
    if a.sloppy.is_empty() {
        return String::new();
    }
    let list =
        |part: &[String]| -> String { part.iter().map(|s| format!("<li>{}</li>\n", escape(s))).collect() };
    let (first, rest) = a.sloppy.split_at(a.sloppy.len().min(SLOPPY_SHOWN));
    let more = if rest.is_empty() {
        String::new()
    } else {
        let n = rest.len();
        format!("<details><summary>{n} more combinations</summary>\n<ul>\n{}</ul></details>\n", list(rest))
    };
    format!("<h3>What the records do not fix</h3>\n<ul>\n{}</ul>\n{more}", list(first))
}

/// Correlations as a coloured triangle: blue falls, orange rises together.
pub fn correlations(a: &IdentifyAnswer) -> String {
    let n = a.parameters.len();
    if n < 2 || a.correlations.len() < n {
        return String::new();
    }
    let mut body = String::new();
    for (i, p) in a.parameters.iter().enumerate().skip(1) {
        // Writing to a String cannot fail.
        let _ = write!(body, "<tr><th scope=\"row\">{}</th>", escape(&short(&p.path)));
        for j in 0..i {
            let Some(r) = a.correlations[i].get(j).copied().flatten() else {
                body.push_str("<td>–</td>");
                continue;
            };
            let side = if r < 0.0 { "neg" } else { "pos" };
            let tip = format!("{} / {}: {r:.2}", escape(&p.path), escape(&a.parameters[j].path));
            let text = format!("{r:.1}").replace("0.", ".").replace("-.0", "0").replace("1.0", "1");
            let _ = write!(body, "<td class=\"{side} {}\" title=\"{tip}\">{text}</td>", share_class(r.abs()));
        }
        body.push_str("</tr>\n");
    }
    let head: String = a.parameters[..n - 1]
        .iter()
        .map(|p| format!("<th scope=\"col\"><span>{}</span></th>", escape(&short(&p.path))))
        .collect();
    format!(
        "<div class=\"scroll\"><table class=\"correlations\"><tbody>\n{body}<tr class=\"foot\"><th></th>{head}</tr></tbody></table></div>\n"
    )
}

/// `interface.area[3].sigma_c` → `σc 3`, `bulk.k1` → `k1`.
pub fn short(path: &str) -> String {
    if let Some((area, what)) = path.strip_prefix("interface.area[").and_then(|r| r.split_once("].")) {
        return format!("{} {area}", if what == "gc" { "Gc" } else { "σc" });
    }
    path.strip_prefix("bulk.").or_else(|| path.strip_prefix("effects.")).unwrap_or(path).to_owned()
}

/// Where the published values come from.
pub fn published(a: &IdentifyAnswer) -> String {
    let Some(p) = &a.published else { return String::new() };
    let notes: String = p.notes.iter().map(|n| format!("<li>{}</li>\n", escape(n))).collect();
    format!(
        "<h3>Against published values</h3>\n<p>{}</p>\n<p>{}</p>\n<ul>\n{notes}</ul>\n",
        escape(&p.source),
        escape(&p.words())
    )
}

/// The energy ledger.
pub fn energies(a: &IdentifyAnswer) -> String {
    let header = [
        "test (N·mm)",
        "external work",
        "stored",
        "tear, recoverable",
        "tear, lost",
        "bulk, lost",
        "rig",
        "set free in jumps",
        "gap of the ledger",
    ];
    let rows = a.tests.iter().filter_map(|(name, t)| {
        let e = t.energy.as_ref()?;
        let n = |x: f64| Cell::number(significant(x, 4));
        Some(vec![
            Cell::left(name),
            n(e.external_work_Nmm),
            n(e.stored_Nmm),
            n(e.cohesive_recoverable_Nmm),
            n(e.cohesive_dissipated_Nmm),
            n(e.dissipated_bulk_Nmm),
            n(e.rig_Nmm),
            n(e.released_in_jumps_Nmm),
            Cell::number(format!("{:.3} %", 100.0 * e.closure)),
        ])
    });
    table(&header, rows)
}
