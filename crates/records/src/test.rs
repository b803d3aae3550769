//! A test of the rows between two starts of the clock.

use crate::choices::Choices;
use crate::error::Fault;
use crate::import::Test;
use crate::inspect::inspect;
use crate::layout::FEWEST;
use crate::rows::Rows;
use crate::settle::{Settled, settle};
use crate::{noise, physics, reduce};

/// Less than this share of the largest force is rounding, no noise: none is declared then.
const NO_NOISE: f64 = 1e-5;

/// Inspects, settles and reduces the rows.
///
/// # Errors
/// If too few rows are left, or nothing moves in them.
pub(crate) fn test(mut rows: Rows, choices: &Choices) -> Result<Test, Vec<Fault>> {
    let fault = |row: Option<u32>, message: String, remedy: &str| {
        vec![Fault { row: row.map(|r| r as usize), column: None, message, remedy: remedy.into() }]
    };
    let mut found = Vec::new();
    inspect(&mut rows, choices, &mut found);
    let first = rows.row.first().copied();
    if rows.len() < FEWEST {
        let message = format!("{} rows are left; expected at least {FEWEST}", rows.len());
        return Err(fault(
            first,
            message,
            "look at the faults of the rows before; --skip-rows and --restart say what belongs together",
        ));
    }
    let still = |u: &[f64]| physics::range(u) <= 0.0;
    if still(&rows.displacement) && rows.across[0].as_deref().is_none_or(still) {
        let message = "the displacement is the same in every row; expected a test that moves".to_owned();
        return Err(fault(first, message, "name the column of the actuator: --displacement N"));
    }
    let noise = noise::sd(&rows.force);
    let Settled { done, proposals } = settle(&mut rows, choices, noise);
    if rows.label.windows(2).all(|w| w[0] == w[1]) {
        rows.label.clear();
    }
    let mut segments: Vec<String> = Vec::new();
    for l in rows.label.chunk_by(|a, b| a == b).filter_map(|c| rows.labels.get(c[0] as usize)) {
        if !segments.contains(l) {
            segments.push(l.clone());
        }
    }
    // One standard deviation for all points is made for one force.
    let points = choices.points.filter(|_| !choices.two_axes);
    let reduced = points.and_then(|points| reduce::reduce(&rows, points));
    let size = reduced.as_ref().map_or(1, |r| r.1.rows_per_point);
    let (of_rows, of_points) = reduce::deviations(&rows, size);
    let last = rows.row.last().copied();
    let peak = rows.force.iter().fold(0.0_f64, |m, f| m.max(f.abs()));
    Ok(Test {
        name: String::new(),
        kind: String::new(),
        file_rows: (first.unwrap_or(0), last.unwrap_or(0)),
        force_sd_of_rows: of_rows,
        force_sd_of_points: reduced.as_ref().map(|_| of_points).filter(|sd| *sd > NO_NOISE * peak),
        segments,
        done,
        proposals,
        faults: found,
        reduction: reduced.as_ref().map(|r| r.1.clone()),
        reduced: reduced.map(|r| r.0),
        full: rows,
    })
}
