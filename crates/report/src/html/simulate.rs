//! The page of a simulation.

use super::{Cell, escape, figures, table};
use crate::answer::SimulateAnswer;
use crate::figures::of_curves;
use crate::terminal::significant;
use crate::{Curve, ReportError};

/// Curves, jumps, energies.
pub fn body(a: &SimulateAnswer, curves: &[Curve]) -> Result<String, ReportError> {
    let effects = if a.effects.is_empty() {
        "base model, no effects".to_owned()
    } else {
        format!("with {}", a.effects.join(", "))
    };
    let early = a
        .stopped_because
        .as_ref()
        .map_or(String::new(), |w| format!("<p class=\"verdict bad\">Ended early: {}</p>\n", escape(w)));
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
    Ok(format!(
        "<p class=\"muted\">Simulation, {}</p>\n{early}<h2>Curves</h2>\n{}{}",
        escape(&effects),
        figures(&of_curves(curves)?),
        table(&header, rows)
    ))
}
