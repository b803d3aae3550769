//! `jacobian.csv` and `history.csv`.

use crate::ReportError;
use crate::answer::StageHistory;
use crate::curves::{number, table};
use analysis::Identified;
use std::collections::BTreeMap;

/// ∂(prediction)/∂θ: one row per point, one column per free parameter (physical units).
///
/// # Errors
/// If a row cannot be written.
pub fn jacobian_csv(done: &Identified) -> Result<Vec<u8>, ReportError> {
    let shown: Vec<usize> = (0..done.free.len()).filter(|&k| !done.model.is_hidden(done.free[k])).collect();
    let mut header = vec!["block".to_owned(), "row".into(), "prediction".into()];
    header.extend(shown.iter().map(|&k| done.free_parameters[k].path.clone()));
    let prediction = &done.fit.prediction;
    let blocks = done.measured.data.blocks.iter().zip(&done.measured.slots);
    let rows = blocks.flat_map(|(block, slot)| {
        let shown = &shown;
        block.range.clone().zip(&slot.rows).map(move |(at, row)| {
            let mut line = vec![block.name.clone(), row.to_string(), number(prediction.values[at])];
            let jacobian = prediction.jacobian.as_ref();
            line.extend(shown.iter().map(|&k| jacobian.map_or(String::new(), |j| number(j[(at, k)]))));
            line
        })
    });
    table(header, rows)
}

/// Parameters and objective of every run of the search.
///
/// # Errors
/// If a row cannot be written.
pub fn history_csv(history: &[StageHistory]) -> Result<Vec<u8>, ReportError> {
    let mut paths: Vec<&String> = Vec::new();
    for p in history.iter().flat_map(|h| &h.paths) {
        if !paths.contains(&p) {
            paths.push(p);
        }
    }
    let mut header: Vec<String> =
        ["stage", "mesh", "iteration", "accepted", "objective"].iter().map(|s| (*s).to_owned()).collect();
    header.extend(paths.iter().map(|p| (*p).clone()));
    let rows = history.iter().flat_map(|h| {
        let paths = &paths;
        h.runs.iter().map(move |r| {
            let at: BTreeMap<&String, f64> = h.paths.iter().zip(r.theta.iter().copied()).collect();
            let mut row = vec![
                h.stage.clone(),
                if h.coarse { "coarse" } else { "full" }.to_owned(),
                r.iteration.to_string(),
                r.accepted.to_string(),
                r.f.map_or(String::new(), number),
            ];
            row.extend(paths.iter().map(|p| at.get(p).map_or(String::new(), |v| number(*v))));
            row
        })
    });
    table(header, rows)
}
