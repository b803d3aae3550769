//! Where an identified model is off, on a terminal.

use super::identify::{small_plot, test_table, verdict};
use super::{Style, significant, table, wrap};
use crate::Curve;
use crate::answer::{CompareAnswer, EnergyAnswer, IdentifyAnswer};
use input::visible;
use std::fmt::Write;

/// Segments that are named.
const PLACES: usize = 6;
/// Columns of a whole bar.
const BAR: f64 = 24.0;

/// Distance of each test, where the misfit sits and on what it depends, energies.
pub fn compare(a: &CompareAnswer, found: &IdentifyAnswer, curves: &[Curve], style: Style) -> String {
    let mut out = format!("{}\n\n{}\n", verdict(found, style), test_table(found, style));
    for curve in curves.iter().filter(|c| !c.measured.is_empty()) {
        let _ = writeln!(out, "\n{}", small_plot(curve, style));
    }
    let _ = writeln!(out, "\n{}", style.bold("Where the model is off"));
    for w in a.r#where.iter().take(PLACES) {
        let _ = writeln!(
            out,
            "  {:<16} {:<18} {}",
            visible(&w.test),
            visible(&w.segment),
            share(w.share, w.mean_n)
        );
    }
    if !a.along_the_tear.is_empty() {
        let _ = writeln!(out, "\n{}", style.bold("The same by the model's tear front"));
    }
    for s in &a.along_the_tear {
        let ends = if s.to_mm > s.from_mm {
            format!("{} – {} mm", significant(s.from_mm, 3), significant(s.to_mm, 3))
        } else {
            format!("at {} mm", significant(s.from_mm, 3))
        };
        let _ = writeln!(out, "  {:<16} {ends:<18} {}", visible(&s.test), share(s.share, s.mean_n));
    }
    out.push('\n');
    for line in &found.remarks {
        let _ = writeln!(out, "{}", style.marked(&style.bad("!"), line));
    }
    for sentence in &a.words {
        let _ = writeln!(out, "{}", wrap(sentence, style.width, 0));
    }
    let _ =
        writeln!(out, "\n{}\n{}", style.bold("Energies at the end of each test (N·mm)"), ledger(a, style));
    out
}

fn share(share: f64, mean: f64) -> String {
    let bar = "█".repeat((share * BAR).round() as usize);
    format!("{:>4.0} % of χ², mean {:>9} N  {bar}", 100.0 * share, significant(mean, 2)).trim_end().to_owned()
}

fn ledger(a: &CompareAnswer, style: Style) -> String {
    let header = ["test", "work", "stored", "tear, lost", "tear, held", "bulk, lost", "rig", "jumps", "gap"];
    let row = |name: &String, e: &EnergyAnswer| {
        let numbers = [
            e.external_work_Nmm,
            e.stored_Nmm,
            e.cohesive_dissipated_Nmm,
            e.cohesive_recoverable_Nmm,
            e.dissipated_bulk_Nmm,
            e.rig_Nmm,
            e.released_in_jumps_Nmm,
        ];
        let shown = numbers.iter().map(|x| significant(*x, 3));
        std::iter::once(name.clone())
            .chain(shown)
            .chain([format!("{:.3} %", 100.0 * e.closure)])
            .collect::<Vec<String>>()
    };
    let rows = a.tests.iter().filter_map(|(n, t)| t.energy.as_ref().map(|e| row(n, e)));
    table(style, &header, &[0], rows.collect())
}
