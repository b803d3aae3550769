//! The page of an identification.

use super::{Cell, escape, figures, numbers, table};
use crate::answer::{IdentifyAnswer, ParameterAnswer, TestFit};
use crate::figures::of_identify;
use crate::terminal::{SLOPPY_SHOWN, interval, readable_unit, remark, significant};
use crate::{Curve, ReportError};

/// Verdict, curves, parameters, what is not known.
pub fn body(a: &IdentifyAnswer, curves: &[Curve]) -> Result<String, ReportError> {
    let all = of_identify(a, curves)?;
    let (tests, more): (Vec<_>, Vec<_>) = all.into_iter().partition(|f| a.tests.contains_key(&f.name));
    Ok([
        verdict(a),
        "<h2>Model and record</h2>\n".into(),
        figures(&tests),
        fits(a),
        "<h2>Tear path and search</h2>\n".into(),
        figures(&more),
        format!("<p class=\"muted\">{}</p>\n", escape(&a.stopped_because)),
        "<h2>Parameters</h2>\n".into(),
        parameters(a),
        unknown(a),
        published(a),
        energies(a),
    ]
    .concat())
}

fn verdict(a: &IdentifyAnswer) -> String {
    let (class, word) = if a.explained {
        ("good", "The model explains the records.")
    } else if a.stages.iter().any(|s| !s.converged) {
        ("bad", "The search did not settle, and what it found does not explain the records.")
    } else {
        ("bad", "The model does not explain the records: an effect is missing, or the noise is understated.")
    };
    let effects = if a.effects.is_empty() {
        "base model, no effects".to_owned()
    } else {
        format!("with {}", a.effects.join(", "))
    };
    let loose = a.parameters.iter().filter(|p| !p.identifiable).count();
    let boxes = [
        (significant(a.reduced_chi2_total, 3), "reduced χ², numerical error included (1: at the noise)"),
        (format!("{} N", significant(a.rms_N, 3)), "rms misfit of the force"),
        (format!("{} of {}", a.parameters.len() - loose, a.parameters.len()), "parameters identifiable"),
        (format!("{:.1} s", a.seconds), "computing time"),
    ];
    format!(
        "<p class=\"muted\">{}</p>\n<p class=\"verdict {class}\">{word}</p>\n{}",
        escape(&effects),
        numbers(&boxes)
    )
}

fn fits(a: &IdentifyAnswer) -> String {
    let row = |name: &str, unit: &str, t: &TestFit| {
        vec![
            Cell::left(name),
            Cell::number(t.points.to_string()),
            Cell::number(format!("{} {unit}", significant(t.rms_N, 3))),
            Cell::number(format!("{} {unit}", significant(t.noise_N, 3))),
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
        "rms of peak",
        "reduced χ²",
        "with numerical error",
        "f = Σ misfit²",
    ];
    let forces = a.tests.iter().map(|(n, t)| row(n, "N", t));
    table(&header, forces.chain(a.channels.iter().map(|(n, t)| row(n, "mm", t))))
}

fn parameters(a: &IdentifyAnswer) -> String {
    let published = a.parameters.iter().any(|p| p.published.is_some());
    let mut header = vec!["parameter", "value", "unit", "95 % interval"];
    if published {
        header.push("published");
    }
    header.push("remark");
    table(&header, a.parameters.iter().map(|p| row(p, published)))
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
        cells.push(Cell::number(p.published.map_or(String::new(), |v| significant(v * factor, 4))));
    }
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
    format!("<h2>What the records do not fix</h2>\n<ul>\n{}</ul>\n{more}", list(first))
}

fn published(a: &IdentifyAnswer) -> String {
    let Some(p) = &a.published else { return String::new() };
    let notes: String = p.notes.iter().map(|n| format!("<li>{}</li>\n", escape(n))).collect();
    format!(
        "<h2>Against published values</h2>\n<p>{}</p>\n<p>{} of {} identifiable parameters have the published value in \
         their 95 % interval.</p>\n<ul>\n{notes}</ul>\n",
        escape(&p.source),
        p.inside,
        p.compared
    )
}

fn energies(a: &IdentifyAnswer) -> String {
    let header = [
        "test",
        "external work",
        "stored",
        "tear, recoverable",
        "tear, lost",
        "bulk, lost",
        "rig",
        "set free in jumps",
        "gap",
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
    format!("<h2>Energies at the end of each test (N·mm)</h2>\n{}", table(&header, rows))
}
