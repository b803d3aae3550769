//! The answer of a simulation on a terminal.

use super::plot::range;
use super::{Style, significant, sparkline, table, wrap};
use crate::answer::SimulateAnswer;
use input::visible;
use std::fmt::Write;

/// Curves in a table, jumps, reason of an early end.
pub fn simulate(a: &SimulateAnswer, style: Style) -> String {
    let mut out = format!("{}\n\n", style.bold(&a.specimen));
    let header = ["test", "steps", "to", "peak force", "at", "jumps", "external work", "energy gap"];
    let rows = a.tests.iter().map(|(name, t)| {
        let peak = (0..t.force_N.len()).max_by(|&i, &j| t.force_N[i].total_cmp(&t.force_N[j]));
        let at = |v: &[f64], i: Option<usize>| i.map_or("–".into(), |i| significant(v[i], 4));
        vec![
            name.clone(),
            t.force_N.len().to_string(),
            format!("{} mm", t.displacement_mm.last().map_or("–".into(), |u| significant(*u, 4))),
            format!("{} N", at(&t.force_N, peak)),
            format!("{} mm", at(&t.displacement_mm, peak)),
            t.jumps.len().to_string(),
            format!("{} N·mm", significant(t.energy.external_work_Nmm, 4)),
            format!("{:.3} %", 100.0 * t.energy.closure),
        ]
    });
    // Writing to a String cannot fail.
    let _ = writeln!(out, "{}", table(style, &header, &[0], rows.collect()));
    for (name, t) in &a.tests {
        let (low, high) = range(&t.force_N);
        let _ = writeln!(
            out,
            "\n  {:<12}{}",
            visible(name),
            sparkline(&t.force_N, style.width.saturating_sub(16), low, high)
        );
        for j in &t.jumps {
            let _ = writeln!(
                out,
                "  jump at {} mm: {} → {} N, {} N·mm set free",
                significant(j.displacement_mm, 4),
                significant(j.force_before_N, 3),
                significant(j.force_after_N, 3),
                significant(j.released_Nmm, 3)
            );
        }
    }
    let s = &a.solver;
    let _ = writeln!(out, "\n{} steps, {} Newton iterations, {:.1} s", s.steps, s.iterations, s.seconds);
    for line in &a.remarks {
        let _ = writeln!(out, "{}", style.marked(&style.bad("!"), line));
    }
    if let Some(why) = &a.stopped_because {
        let _ = writeln!(out, "{}\n  {}", style.bad("Ended early:"), wrap(why, style.width, 2));
    }
    out
}
