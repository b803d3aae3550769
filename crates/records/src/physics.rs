//! Strain, stretch and stress to displacement and force, a rate to a time, signs and offsets: only what a flag or a
//! column's name says.

use crate::choices::{Choices, Flip};
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
    let (mut done, mut faults) = (Vec::new(), Vec::new());
    let of = |roles: &[Role]| columns.iter().find(|c| roles.contains(&c.role));
    let is_true = |c: &Column| {
        let name = format!(" {} ", fold(&c.name));
        choices.true_measures
            || [" true ", " logarithmic ", " hencky ", " cauchy ", " wahre "].iter().any(|w| name.contains(w))
    };
    let mut needed = |value: Option<f64>, what: &str, why: &str| {
        if value.is_none() {
            faults.push(Fault {
                row: None,
                column: None,
                message: format!(
                    "{why} needs the {what} of the specimen, and neither a file nor the header gives it"
                ),
                remedy: format!("say --geometry strip.toml with {what}_mm in its [geometry]"),
            });
        }
        value
    };
    let strain = of(&[Role::Strain, Role::Stretch]);
    // Stretch of every row, for true stress.
    let mut stretch: Option<Vec<f64>> = None;
    if let Some(c) = strain {
        let (kind, of_one): (_, fn(f64) -> f64) = match (c.role, is_true(c)) {
            (Role::Stretch, _) => ("stretch", |x| x),
            (_, true) => ("true (logarithmic) strain", f64::exp),
            (_, false) => ("engineering strain", |x| 1.0 + x),
        };
        if let Some(length) = needed(geometry.length, "length", "a strain instead of a displacement") {
            let lambda: Vec<f64> = rows.displacement.iter().map(|x| of_one(*x)).collect();
            for (u, l) in rows.displacement.iter_mut().zip(&lambda) {
                *u = (l - 1.0) * length;
            }
            stretch = Some(lambda);
            done.push(format!("displacement from {kind} `{}` with length {} mm", c.name, short(length)));
        }
    }
    if let Some(c) = of(&[Role::Stress]) {
        let width = needed(geometry.width, "width", "a stress instead of a force");
        let thickness = needed(geometry.thickness, "thickness", "a stress instead of a force");
        let length = if is_true(c) && strain.is_none() {
            needed(geometry.length, "length", "a true stress instead of a force")
        } else {
            geometry.length
        };
        if let (Some(width), Some(thickness)) = (width, thickness) {
            let area = width * thickness;
            if is_true(c) {
                let lambda = stretch.unwrap_or_else(|| {
                    let length = length.unwrap_or(f64::NAN);
                    rows.displacement.iter().map(|u| 1.0 + u / length).collect()
                });
                rows.force.iter_mut().zip(&lambda).for_each(|(f, l)| *f *= area / l);
            } else {
                rows.force.iter_mut().for_each(|f| *f *= area);
            }
            let kind =
                if is_true(c) { "true (Cauchy) stress of an incompressible strip" } else { "nominal stress" };
            done.push(format!(
                "force from {kind} `{}` with width {} mm and thickness {} mm",
                c.name,
                short(width),
                short(thickness)
            ));
        }
    }
    if faults.is_empty() { Ok(done) } else { Err(faults) }
}

/// Makes the time of rows that have none.
///
/// # Errors
/// If the actuator stands, which a rate cannot tell.
pub(crate) fn clock(rows: &mut Rows, choices: &Choices) -> Result<Option<String>, Fault> {
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

/// What may have to be changed, found and not applied.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Proposal {
    /// The flag (and its value) that does it; empty: nothing here can.
    pub flag: String,
    /// What was seen.
    pub why: String,
}

/// Turns signs and takes offsets off, as the flags say; then looks for what they might still do.
pub(crate) fn settle(rows: &mut Rows, choices: &Choices, noise: f64) -> (Vec<String>, Vec<Proposal>) {
    let (mut done, mut proposals) = (Vec::new(), Vec::new());
    if rows.is_empty() {
        return (done, proposals);
    }
    let found = (is_negative(&rows.displacement), is_negative(&rows.force));
    let flips = match choices.flip {
        None => (false, false),
        Some(Flip::Found) => found,
        Some(Flip::Force) => (false, true),
        Some(Flip::Displacement) => (true, false),
        Some(Flip::Both) => (true, true),
    };
    for (channel, flip, word) in
        [(&mut rows.displacement, flips.0, "displacement"), (&mut rows.force, flips.1, "force")]
    {
        if flip {
            channel.iter_mut().for_each(|x| *x = -*x + 0.0);
            done.push(format!("sign of the {word} turned (--flip)"));
        }
    }
    let (u, f) = (&rows.displacement, &rows.force);
    for (found, flipped, word) in [(found.0, flips.0, "displacement"), (found.1, flips.1, "force")] {
        if found && !flipped {
            proposals.push(Proposal {
                flag: format!("--flip {word}"),
                why: format!(
                    "the {word} runs to negative values; expected tension and lengthening to be positive"
                ),
            });
        }
    }
    let (u_range, f_range) = (range(u), range(f));
    let start = u[0];
    let still = u.iter().take_while(|x| (*x - start).abs() <= 2e-3 * u_range).count().max(1);
    let before = f[..still].iter().sum::<f64>() / still as f64;
    if choices.zero {
        rows.displacement.iter_mut().for_each(|x| *x -= start);
        done.push(format!("{} mm taken off the displacement (--zero)", short(start)));
    } else if start.abs() > 1e-3 * u_range {
        proposals.push(Proposal {
            flag: "--zero".into(),
            why: format!("the displacement starts at {} mm; a record starts at 0", short(start)),
        });
    }
    across(rows, choices, still, &mut done, &mut proposals);
    let large = before.abs() > (0.01 * f_range).max(4.0 * noise / (still as f64).sqrt());
    if choices.tare {
        rows.force.iter_mut().for_each(|x| *x -= before);
        done.push(format!("{} N taken off the force (--tare)", short(before)));
    } else if large {
        proposals.push(Proposal {
            flag: "--tare".into(),
            why: format!(
                "the force before the motion is {} N: a pre-load, which is information, or a cell that was not zeroed, \
                 which --tare takes off",
                short(before)
            ),
        });
    }
    let quiet = (0.01 * f_range).max(3.0 * noise);
    let slack = rows
        .force
        .iter()
        .take_while(|x| (*x - if choices.tare { 0.0 } else { before }).abs() < quiet)
        .count();
    if slack < rows.len() && slack > still {
        let moved = (rows.displacement[slack] - rows.displacement[0]).abs();
        if moved > 0.15 * u_range {
            proposals.push(Proposal {
                flag: String::new(),
                why: format!(
                    "no force over the first {} mm: slack, or a soft toe; the effect `slack` has it as a parameter",
                    short(moved)
                ),
            });
        }
    }
    (done, proposals)
}

/// The same for a second axis: `--flip` alone (or for both) turns what runs to negative values there; offsets go with those
/// along y. `still`: rows before the motion.
fn across(
    rows: &mut Rows,
    choices: &Choices,
    still: usize,
    done: &mut Vec<String>,
    proposals: &mut Vec<Proposal>,
) {
    let [Some(displacement), Some(force)] = &mut rows.across else { return };
    let flips = matches!(choices.flip, Some(Flip::Found | Flip::Both));
    for (channel, word) in [(&mut *displacement, "displacement along x"), (&mut *force, "force along x")] {
        if !is_negative(channel) {
            continue;
        }
        if flips {
            channel.iter_mut().for_each(|x| *x = -*x + 0.0);
            done.push(format!("sign of the {word} turned (--flip)"));
        } else {
            proposals.push(Proposal {
                flag: "--flip".into(),
                why: format!(
                    "the {word} runs to negative values; expected tension and lengthening to be positive"
                ),
            });
        }
    }
    let (start, u_range, f_range) = (displacement[0], range(displacement), range(force));
    let still = &force[..still.min(force.len())];
    let before = still.iter().sum::<f64>() / still.len() as f64;
    if choices.zero {
        displacement.iter_mut().for_each(|x| *x -= start);
        done.push(format!("{} mm taken off the displacement along x (--zero)", short(start)));
    } else if start.abs() > 1e-3 * u_range {
        proposals.push(Proposal {
            flag: "--zero".into(),
            why: format!("the displacement along x starts at {} mm; a record starts at 0", short(start)),
        });
    }
    let noise = crate::noise::sd(force) / (still.len() as f64).sqrt();
    if choices.tare {
        force.iter_mut().for_each(|x| *x -= before);
        done.push(format!("{} N taken off the force along x (--tare)", short(before)));
    } else if before.abs() > (0.01 * f_range).max(4.0 * noise) {
        proposals.push(Proposal {
            flag: "--tare".into(),
            why: format!(
                "the force along x before the motion is {} N: a pre-load, which is information, or a cell that was not \
                 zeroed, which --tare takes off",
                short(before)
            ),
        });
    }
}

/// Whether a channel runs from its start mostly to the negative side.
fn is_negative(x: &[f64]) -> bool {
    let first = x.first().copied().unwrap_or(0.0);
    let (low, high) = x.iter().fold((0.0_f64, 0.0_f64), |(l, h), v| (l.min(v - first), h.max(v - first)));
    -low > 1.5 * high
}

/// Greatest minus least.
pub(crate) fn range(x: &[f64]) -> f64 {
    let (low, high) = x.iter().fold((f64::MAX, f64::MIN), |(l, h), v| (l.min(*v), h.max(*v)));
    (high - low).max(0.0)
}
