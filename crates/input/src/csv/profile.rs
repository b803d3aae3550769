//! Profiles of a specimen: the outline's left and right edge, or the thickness, against y.

use super::columns::{Column, header, number, right_count};
use super::{Faults, cells, lines, load};
use crate::diagnostics::{Diagnostic, Report, Sink};
use params::Quantity::Length;
use std::path::Path;

/// Names of the columns of a profile with three or two of them.
pub(crate) const fn names(columns: usize) -> [&'static str; 3] {
    if columns == 3 { ["y", "left", "right"] } else { ["y", "thickness", ""] }
}

/// Reads rows of `N` lengths (mm): `y,left,right` or `y,thickness`. Faults go to the sink; `None` if there
/// were any. Whether the rows make sense together is checked by the caller.
pub(crate) fn read_rows<const N: usize>(
    path: &Path,
    sink: &Sink,
) -> Result<Option<Vec<[f64; N]>>, Box<Diagnostic>> {
    let what = match N {
        3 => "an outline, a CSV file with the header `y_mm,left_mm,right_mm`",
        _ => "a thickness profile, a CSV file with the header `y_mm,thickness_mm`",
    };
    let file = load(path, what)?;
    sink.was_read(&file);
    let mut faults = Faults::new(&file, sink);
    let known: Vec<Column> =
        names(N)[..N].iter().map(|&name| Column { name, quantity: Length, required: true }).collect();
    let mut lines = lines(&file);
    let mut out = Vec::new();
    if let Some(first) = lines.next() {
        let found =
            cells(&file, first, &mut faults).and_then(|c| Some((c.len(), header(&c, &known, &mut faults)?)));
        if let Some((count, found)) = found {
            let found: Vec<_> = found.into_iter().flatten().collect();
            for line in lines {
                let Some(row) = cells(&file, line, &mut faults) else { continue };
                if !right_count(&row, count, &mut faults) {
                    continue;
                }
                let mut values = [0.0; N];
                for (value, column) in values.iter_mut().zip(&found) {
                    *value = number(&row[column.index], column, &mut faults).unwrap_or(f64::NAN);
                }
                out.push(values);
            }
        }
    } else {
        faults.add(Report::error(format!("only comments here; expected {what}")), 0..0);
    }
    Ok((!faults.finish()).then_some(out))
}
