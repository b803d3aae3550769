//! The page of a simulation.

use super::{Cell, chart, escape, strip, table};
use crate::Curve;
use crate::answer::SimulateAnswer;
use crate::terminal::significant;

/// Curves, jumps, energies, pictures.
pub fn body(a: &SimulateAnswer, curves: &[Curve], pictures: &[(String, String)]) -> String {
    let effects = if a.effects.is_empty() {
        "base model, no effects".to_owned()
    } else {
        format!("with {}", a.effects.join(", "))
    };
    let early = a
        .stopped_because
        .as_ref()
        .map_or(String::new(), |w| format!("<p class=\"verdict bad\">Ended early: {}</p>\n", escape(w)));
    let charts: String = curves
        .iter()
        .filter(|c| c.time.len() > 1)
        .map(|c| chart("test", &c.test, &format!("{}: computed force (N)", c.test)))
        .collect();
    let strips: String = pictures.iter().map(|(test, svg)| strip(test, svg)).collect();
    format!(
        "<p class=\"muted\">Simulation, {}</p>\n{early}<section id=\"curves\"><h2>Curves</h2>\n<div class=\"tools\">\
         <span>against</span><button type=\"button\" data-axis=\"u\" aria-pressed=\"true\">displacement</button>\
         <button type=\"button\" data-axis=\"t\" aria-pressed=\"false\">time</button></div>\n\
         <div class=\"charts\">{charts}</div>\n{}</section>\n{strips}",
        escape(&effects),
        tests(a)
    )
}

fn tests(a: &SimulateAnswer) -> String {
    let header = [
        "test",
        "steps",
        "jumps",
        "external work (N·mm)",
        "stored",
        "tear, lost",
        "set free in jumps",
        "gap",
    ];
    let rows = a.tests.iter().map(|(name, t)| {
        let n = |x: f64| Cell::number(significant(x, 4));
        vec![
            Cell::left(name),
            Cell::number(t.force_N.len().to_string()),
            Cell::number(t.jumps.len().to_string()),
            n(t.energy.external_work_Nmm),
            n(t.energy.stored_Nmm),
            n(t.energy.cohesive_dissipated_Nmm),
            n(t.energy.released_in_jumps_Nmm),
            Cell::number(format!("{:.3} %", 100.0 * t.energy.closure)),
        ]
    });
    table(&header, rows)
}
