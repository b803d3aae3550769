//! Strain, stretch and stress to displacement and force, a rate to a time: only what a flag or a column's name says.

use crate::choices::Choices;
use crate::columns::Column;
use crate::error::{Fault, short};
use crate::geometry::Geometry;
use crate::rows::Rows;
use crate::words::{Role, fold};

/// Converts the channels; says what was done.
///
/// # Errors
/// The dimension that is missing, and where to give it.
pub(crate) fn convert(
    rows: &mut Rows,
    columns: &[Column],
    geometry: &Geometry,
    choices: &Choices,
) -> Result<Vec<String>, Vec<Fault>> {
    let mut work = Conversion { geometry, choices, done: Vec::new(), faults: Vec::new() };
    let of = |roles: &[Role]| columns.iter().find(|c| roles.contains(&c.role));
    let strain = of(&[Role::Strain, Role::Stretch]);
    let stretch = strain.and_then(|c| work.strain(c, &mut rows.displacement));
    if let Some(c) = of(&[Role::Stress]) {
        work.stress(c, strain.is_some(), stretch, rows);
    }
    if work.faults.is_empty() { Ok(work.done) } else { Err(work.faults) }
}

/// Names of measures that refer to the strip as it is, not as it was.
const TRUE_MEASURES: [&str; 5] = [" true ", " logarithmic ", " hencky ", " cauchy ", " wahre "];

/// What converts, and what was said of it.
struct Conversion<'c> {
    geometry: &'c Geometry,
    choices: &'c Choices,
    done: Vec<String>,
    faults: Vec<Fault>,
}

impl Conversion<'_> {
    fn is_true(&self, c: &Column) -> bool {
        let name = format!(" {} ", fold(&c.name));
        self.choices.true_measures || TRUE_MEASURES.iter().any(|w| name.contains(w))
    }

    /// A dimension that is needed; a fault where nothing gives it.
    fn needed(&mut self, value: Option<f64>, what: &str, why: &str) -> Option<f64> {
        if value.is_none() {
            self.faults.push(Fault {
                row: None,
                column: None,
                message: format!(
                    "{why} needs the {what} of the specimen, and neither a file nor the header gives it"
                ),
                remedy: format!("say --geometry strip.toml with {what}_mm in its [geometry]"),
            });
        }
        value
    }

    /// A strain or stretch to a displacement; returns the stretch of every row, for true stress.
    fn strain(&mut self, c: &Column, displacement: &mut [f64]) -> Option<Vec<f64>> {
        let (kind, of_one): (_, fn(f64) -> f64) = match (c.role, self.is_true(c)) {
            (Role::Stretch, _) => ("stretch", |x| x),
            (_, true) => ("true (logarithmic) strain", f64::exp),
            (_, false) => ("engineering strain", |x| 1.0 + x),
        };
        let length = self.needed(self.geometry.length, "length", "a strain instead of a displacement")?;
        let stretch: Vec<f64> = displacement.iter().map(|x| of_one(*x)).collect();
        for (u, l) in displacement.iter_mut().zip(&stretch) {
            *u = (l - 1.0) * length;
        }
        self.done.push(format!("displacement from {kind} `{}` with length {} mm", c.name, short(length)));
        Some(stretch)
    }

    /// A stress to a force. True stress needs the stretch: of a strain, else of the displacement and the length.
    fn stress(&mut self, c: &Column, strained: bool, stretch: Option<Vec<f64>>, rows: &mut Rows) {
        let (geometry, is_true) = (self.geometry, self.is_true(c));
        let width = self.needed(geometry.width, "width", "a stress instead of a force");
        let thickness = self.needed(geometry.thickness, "thickness", "a stress instead of a force");
        let length = if is_true && !strained {
            self.needed(geometry.length, "length", "a true stress instead of a force")
        } else {
            geometry.length
        };
        let (Some(width), Some(thickness)) = (width, thickness) else { return };
        let area = width * thickness;
        if is_true {
            let stretch = stretch.unwrap_or_else(|| {
                let length = length.unwrap_or(f64::NAN);
                rows.displacement.iter().map(|u| 1.0 + u / length).collect()
            });
            rows.force.iter_mut().zip(&stretch).for_each(|(f, l)| *f *= area / l);
        } else {
            rows.force.iter_mut().for_each(|f| *f *= area);
        }
        let kind = if is_true { "true (Cauchy) stress of an incompressible strip" } else { "nominal stress" };
        self.done.push(format!(
            "force from {kind} `{}` with width {} mm and thickness {} mm",
            c.name,
            short(width),
            short(thickness)
        ));
    }
}

/// Makes the time of rows that have none.
///
/// # Errors
/// If the actuator stands, which a rate cannot tell.
pub(crate) fn time(rows: &mut Rows, choices: &Choices) -> Result<Option<String>, Fault> {
    if rows.time.iter().any(|t| t.is_finite()) {
        return Ok(None);
    }
    if let Some(frequency) = choices.frequency {
        rows.time = (0..rows.len()).map(|i| i as f64 / frequency).collect();
        return Ok(Some(format!("time from the rows, {} of them a second", short(frequency))));
    }
    let Some(rate) = choices.rate else { return Ok(None) };
    let u = &rows.displacement;
    let path: f64 = u.windows(2).map(|w| (w[1] - w[0]).abs()).sum();
    let at_rest = u.windows(2).position(|w| (w[1] - w[0]).abs() < 1e-9 * path);
    if let Some(at) = at_rest {
        return Err(Fault {
            row: rows.row.get(at + 1).map(|r| *r as usize),
            column: None,
            message: "the displacement is that of the row before: a rate gives no time where the actuator stands".into(),
            remedy: "say --frequency HZ (rows per second) instead of --rate, or name the column of the time: --time N".into(),
        });
    }
    let mut t = 0.0;
    let mut time = vec![0.0];
    for w in u.windows(2) {
        t += (w[1] - w[0]).abs() / rate;
        time.push(t);
    }
    rows.time = time;
    Ok(Some(format!("time from the displacement at {} mm/s", short(rate))))
}

/// Greatest minus least.
pub(crate) fn range(x: &[f64]) -> f64 {
    let (low, high) = x.iter().fold((f64::MAX, f64::MIN), |(l, h), v| (l.min(*v), h.max(*v)));
    (high - low).max(0.0)
}
