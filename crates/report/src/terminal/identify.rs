//! The answer of an identification on a terminal.

use super::plot::range;
use super::{Style, readable_unit, significant, sparkline, table, wrap};
use crate::answer::{IdentifyAnswer, ParameterAnswer};
use crate::curves::Curve;
use std::fmt::Write;

/// Columns beside a small plot: its name and its peak.
const BESIDE: usize = 28;
/// Where a terminal has fewer columns, the table of the tests leaves the last two away: they stand on the page.
const ALL_COLUMNS: usize = 96;
/// Combinations of parameters that are told in words; the rest is counted.
pub(crate) const SLOPPY_SHOWN: usize = 3;

/// Verdict, parameters, fit of each test, what is not known, comparison with published values.
pub fn identify(a: &IdentifyAnswer, curves: &[Curve], style: Style) -> String {
    let mut out = String::new();
    // Writing to a String cannot fail.
    let _ = writeln!(out, "{}", verdict(a, style));
    if a.provenance.to_lowercase().starts_with("synthetic") {
        let _ = writeln!(out, "{}", style.notice("The records are synthetic, not measured."));
    }
    let _ = writeln!(out, "\n{}", parameter_table(a, style));
    if let Some(means) = path_means(a) {
        let _ = writeln!(out, "{}", wrap(&means, style.width, 2));
    }
    let _ = writeln!(out, "\n{}", test_table(a, style));
    for curve in curves.iter().filter(|c| !c.measured.is_empty()) {
        let _ = writeln!(out, "\n{}", small_plot(curve, style));
    }
    for line in &a.remarks {
        let _ = writeln!(out, "{}", style.marked(&style.bad("!"), line));
    }
    for line in a.sloppy.iter().take(SLOPPY_SHOWN) {
        let _ = writeln!(out, "{}", style.marked(&style.notice("!"), line));
    }
    if a.sloppy.len() > SLOPPY_SHOWN {
        let more = a.sloppy.len() - SLOPPY_SHOWN;
        let _ = writeln!(out, "  … and {more} more combinations, in summary.json under `sloppy`");
    }
    if let Some(p) = &a.published {
        let _ = writeln!(out, "\n{}", style.after("Published: ", &p.source));
        let _ = writeln!(out, "{}", wrap(&p.words(), style.width, 0));
        for note in &p.notes {
            let _ = writeln!(out, "  {}", wrap(note, style.width, 2));
        }
    }
    let _ = writeln!(
        out,
        "\n{}",
        wrap(
            &format!(
                "{} iterations, {} model runs, {:.1} s. {} {}",
                a.iterations,
                a.forward_runs,
                a.seconds,
                a.stopped_because,
                a.starts.as_deref().unwrap_or_default()
            ),
            style.width,
            0
        )
    );
    out
}

/// One line: is the model good enough?
pub(super) fn verdict(a: &IdentifyAnswer, style: Style) -> String {
    let effects =
        if a.effects.is_empty() { "base model".to_owned() } else { format!("with {}", a.effects.join(", ")) };
    let head = format!("{} ({effects})", a.specimen);
    let chi2 = format!(
        "reduced χ² {} ({} with numerical error)",
        significant(a.reduced_chi2, 3),
        significant(a.reduced_chi2_total, 3)
    );
    let word = if a.explained {
        style.good("the model explains the records")
    } else if a.stages.iter().any(|s| !s.converged) {
        style.bad("the search did not settle, and the records are not explained")
    } else {
        style.bad("the model does not explain the records")
    };
    let left =
        a.left.as_ref().map_or_else(String::new, |l| format!("\n{}", wrap(&l.sentence(), style.width, 0)));
    format!("{}: {word}\n{chi2}{left}", style.bold(&head))
}

/// Means along the tear path, where there are areas to average.
pub(crate) fn path_means(a: &IdentifyAnswer) -> Option<String> {
    let several = a.path_means.iter().filter(|(_, m)| m.areas > 1);
    let told: Vec<String> = several
        .map(|(name, m)| {
            let (unit, factor) = readable_unit(&format!("interface.{name}"), &m.unit);
            let of = if m.counted < m.areas {
                format!(", {} of {} areas", m.counted, m.areas)
            } else {
                String::new()
            };
            format!(
                "{name} {} ± {} {unit} ({} – {}{of})",
                significant(m.value * factor, 3),
                significant(m.std_error * factor, 2),
                significant(m.interval_95[0] * factor, 3),
                significant(m.interval_95[1] * factor, 3),
            )
        })
        .collect();
    (!told.is_empty()).then(|| format!("Mean along the tear path: {}", told.join(", ")))
}

fn parameter_table(a: &IdentifyAnswer, style: Style) -> String {
    let published = a.parameters.iter().any(|p| p.published.is_some());
    let mut header = vec!["parameter", "value", "unit", "95 % interval"];
    if published {
        header.push("published");
    }
    header.push("remark");
    let rows = a.parameters.iter().map(|p| parameter_row(p, published)).collect();
    let last = header.len() - 1;
    table(style, &header, &[0, 2, last], rows)
}

fn parameter_row(p: &ParameterAnswer, published: bool) -> Vec<String> {
    let (unit, factor) = readable_unit(&p.path, &p.unit);
    let show = |x: Option<f64>| x.map_or("…".into(), |x| significant(x * factor, 4));
    let mut row = vec![p.path.clone(), show(Some(p.value)), unit.to_owned(), interval(p, factor)];
    if published {
        row.push(published_value(p, factor));
    }
    row.push(remark(p));
    row
}

/// The 95 % interval; where it spans more than three decades, that it says nothing.
pub(crate) fn interval(p: &ParameterAnswer, factor: f64) -> String {
    let [Some(low), Some(high)] = p.interval_95 else { return "not fixed".into() };
    if low > 0.0 && high > 1e3 * low {
        return "over 1000-fold".into();
    }
    format!("{} – {}", significant(low * factor, 4), significant(high * factor, 4))
}

/// The published value; `≈` before a mean over the area's part of the path.
pub(crate) fn published_value(p: &ParameterAnswer, factor: f64) -> String {
    let about = if p.published_averaged { "≈ " } else { "" };
    p.published.map_or(String::new(), |v| format!("{about}{}", significant(v * factor, 4)))
}

/// Flags of a parameter in words.
pub(crate) fn remark(p: &ParameterAnswer) -> String {
    let mut words = Vec::new();
    if p.at_bound {
        words.push("at bound");
    }
    if !p.identifiable {
        words.push("not identifiable");
    } else if p.published_in_interval == Some(false) {
        words.push("published outside");
    }
    words.join(", ")
}

pub(super) fn test_table(a: &IdentifyAnswer, style: Style) -> String {
    let header = [
        "test",
        "points",
        "rms misfit",
        "noise",
        "of peak",
        "reduced χ²",
        "with num. error",
        "f = Σr²",
        "energy gap",
    ];
    let columns = if style.width < ALL_COLUMNS { header.len() - 2 } else { header.len() };
    let row = |unit: &str, name: &String, t: &crate::answer::TestFit| {
        let mut row = vec![
            name.clone(),
            t.points.to_string(),
            format!("{} {unit}", significant(t.rms_N, 3)),
            format!("{} {unit}", significant(t.noise_N, 3)),
            format!("{:.2} %", 100.0 * t.rms_N / t.peak_N.max(f64::MIN_POSITIVE)),
            significant(t.reduced_chi2, 3),
            significant(t.reduced_chi2_total, 3),
            significant(t.objective, 3),
            t.energy.as_ref().map_or(String::new(), |e| format!("{:.3} %", 100.0 * e.closure)),
        ];
        row.truncate(columns);
        row
    };
    let rows =
        a.tests.iter().map(|(n, t)| row("N", n, t)).chain(a.channels.iter().map(|(n, t)| row("mm", n, t)));
    table(style, &header[..columns], &[0], rows.collect())
}

/// Measured force, model and misfit over time as three lines.
pub(super) fn small_plot(c: &Curve, style: Style) -> String {
    let plot = style.width.saturating_sub(BESIDE);
    let (low, high) = range(c.measured.iter().chain(&c.model));
    let residual = c.residual();
    let most = residual.iter().fold(3.0 * c.noise, |m, r| m.max(r.abs()));
    let lines = [
        ("measured", sparkline(&c.measured, plot, low, high), format!("peak {} N", significant(high, 3))),
        ("model", sparkline(&c.model, plot, low, high), String::new()),
        ("misfit", sparkline(&residual, plot, -most, most), format!("± {} N", significant(most, 2))),
    ];
    let body: Vec<String> = lines
        .iter()
        .map(|(name, line, note)| format!("  {name:<9}{line}  {note}").trim_end().to_owned())
        .collect();
    format!("{}\n{}", style.bold(&c.test), body.join("\n"))
}
