//! The usual faults of records: sign, offset, tare, swapped columns, units, missing time, a clipped load cell.
//!
//! Each is judged by what no torn strip of soft tissue does. Limits are wide: a doubt that is wrong costs a reader trust.

use super::{Advice, RecordFindings};
use input::{Geometry, Grips, Record, Test};

/// Nominal stresses at the peak of soft tissue, MPa: below and above, the force has another unit.
const STRESS: [f64; 2] = [2e-3, 150.0];
/// Stretches by less or more than this share of the length are in another unit.
const STRAIN: [f64; 2] = [3e-3, 20.0];
/// A force at displacement 0 beyond this share of the peak is an offset or a mounting force.
const OFFSET: f64 = 0.03;
/// Rows at exactly the largest force that a load cell reaches only when it is full, and the share of the travel they take.
const CLIPPED_ROWS: usize = 5;
const CLIPPED_TRAVEL: f64 = 5e-3;
/// A tear has happened when the force at the largest displacement is below this share of the peak.
const TORN: f64 = 0.7;
/// Displacement noise beyond this share of the range is worth a word.
const JITTER: f64 = 1e-3;
/// A column bends where its rate changes by more than this share of the usual rate, looked at in so many rows.
const BENT: f64 = 0.1;
const BENT_ROWS: usize = 300;
/// Fewer rows say little of their noise.
const FEW: usize = 60;

/// The middle of some numbers; 0 for none.
pub(super) fn usual(values: impl Iterator<Item = f64>) -> f64 {
    let mut all: Vec<f64> = values.collect();
    if all.is_empty() {
        return 0.0;
    }
    let middle = all.len() / 2;
    *all.select_nth_unstable_by(middle, f64::total_cmp).1
}

/// Smallest difference between two different forces.
pub(super) fn resolution(force: &[f64]) -> f64 {
    let mut sorted = force.to_vec();
    sorted.sort_by(f64::total_cmp);
    let steps = sorted.windows(2).map(|w| w[1] - w[0]).filter(|d| *d > 0.0);
    steps.fold(f64::INFINITY, f64::min).min(sorted.last().map_or(0.0, |f| f.abs()))
}

/// Whether the force falls for good while the displacement goes beyond anything before.
pub(super) fn tears(record: &Record) -> bool {
    // Whichever sign pulling and tension have.
    let upright = |v: &[f64]| {
        let (low, high) = extremes(v);
        let sign = if -low > high { -1.0 } else { 1.0 };
        v.iter().map(|x| sign * x).collect::<Vec<f64>>()
    };
    let (displacement, force) = (upright(&record.displacement), upright(&record.force));
    let (most, peak) = (extremes(&displacement).1, extremes(&force).1);
    let last: Vec<f64> =
        displacement.iter().zip(&force).filter(|(u, _)| **u > 0.99 * most).map(|(_, f)| *f).collect();
    let mean = last.iter().sum::<f64>() / last.len().max(1) as f64;
    peak > 0.0 && mean < TORN * peak
}

/// Doubts about a record.
pub(super) fn advice(test: &Test, r: &Record, g: &Geometry, f: &RecordFindings) -> Vec<Advice> {
    let found = [
        swapped(r),
        missing_time(r),
        displacement_sign(r),
        force_sign(r),
        force_unit(test, g, f),
        displacement_unit(test, r, g),
        offset(r, f),
        clipped(r),
        no_tear(test, f),
        torn_uniaxial(test, f),
        coarse_cell(f),
        jitter(r, f),
        few_rows(f),
    ];
    let mut out: Vec<Advice> = found.into_iter().flatten().collect();
    // Swapped columns explain every other oddity.
    if out.first().is_some_and(|a| a.fault == "swapped") {
        out.truncate(1);
    }
    out
}

fn say(fault: &'static str, found: String, remedy: impl Into<String>) -> Option<Advice> {
    Some(Advice { fault, found, remedy: remedy.into() })
}

/// How far a column is from straight legs in time: the share of rows, of a few hundred, at which its rate changes beyond
/// its rounding.
fn bent(t: &[f64], v: &[f64]) -> f64 {
    let every = v.len().div_ceil(BENT_ROWS);
    let thin = |v: &[f64]| v.iter().copied().step_by(every).collect::<Vec<f64>>();
    let (t, v) = (thin(t), thin(v));
    let (low, high) = v.iter().fold((f64::MAX, f64::MIN), |(l, h), &x| (l.min(x), h.max(x)));
    let rate = |i: usize| (v[i + 1] - v[i]) / (t[i + 1] - t[i]);
    let typical = usual((0..v.len() - 1).map(|i| rate(i).abs()));
    let floor = 1e-5 * (high - low);
    let changes = (1..v.len() - 1).filter(|&i| {
        let miss = (rate(i) - rate(i - 1)).abs();
        miss > BENT * typical && miss * (t[i + 1] - t[i]) > floor
    });
    changes.count() as f64 / v.len() as f64
}

fn swapped(r: &Record) -> Option<Advice> {
    if r.len() < 20 || bent(&r.time, &r.displacement) < 0.5 || bent(&r.time, &r.force) > 0.2 {
        return None;
    }
    say(
        "swapped",
        "force_N moves in straight legs and displacement_mm does not: the two columns look swapped".into(),
        "swap the names in the header, or `fct import FILE --displacement force_N --force displacement_mm`",
    )
}

fn missing_time(r: &Record) -> Option<Advice> {
    let counts = r.len() > 10 && r.time.windows(2).all(|w| w[1] - w[0] == 1.0) && r.time[0].fract() == 0.0;
    if !counts {
        return None;
    }
    say(
        "missing_time",
        "time_s counts the rows (0, 1, 2, …): no clock was recorded".into(),
        "give the rate of the test (`fct import FILE --rate 0.05`), or ignore every effect of time",
    )
}

fn extremes(v: &[f64]) -> (f64, f64) {
    v.iter().fold((0.0, 0.0), |(l, h): (f64, f64), &x| (l.min(x), h.max(x)))
}

fn displacement_sign(r: &Record) -> Option<Advice> {
    let (low, high) = extremes(&r.displacement);
    if -low < 3.0 * high.max(f64::MIN_POSITIVE) {
        return None;
    }
    say(
        "displacement_sign",
        format!("displacement goes to {low:.4} mm: pulling counts as negative here"),
        "`fct import FILE --flip displacement`: pulling is positive",
    )
}

fn force_sign(r: &Record) -> Option<Advice> {
    let (low, high) = extremes(&r.force);
    if -low < 1.5 * high {
        return None;
    }
    say(
        "force_sign",
        format!("force goes to {low:.4} N while the strip is pulled: tension counts as negative here"),
        "`fct import FILE --flip force`: tension is positive",
    )
}

/// Whether force over section is a stress, and travel over length a strain.
fn pulled_whole(test: &Test) -> bool {
    test.kind.whole_section && test.grips == Grips::Ends
}

fn force_unit(test: &Test, g: &Geometry, f: &RecordFindings) -> Option<Advice> {
    let width = if test.kind.tears { g.width - g.cut } else { g.width };
    let stress = f.peak_n / (width * g.thickness);
    let [least, most] = STRESS;
    if !pulled_whole(test) || !stress.is_finite() || (least..=most).contains(&stress) {
        return None;
    }
    let (word, header) = if stress < least { ("small", "force_kN") } else { ("large", "force_mN") };
    say(
        "force_unit",
        format!("a peak of {:.3e} N on this strip is {stress:.1e} MPa: too {word} for soft tissue", f.peak_n),
        format!(
            "if the column is in another unit, name it so (`{header}`); check width_mm and thickness_mm too"
        ),
    )
}

fn displacement_unit(test: &Test, r: &Record, g: &Geometry) -> Option<Advice> {
    let (low, high) = extremes(&r.displacement);
    let strain = high.max(-low) / g.length;
    let [least, most] = STRAIN;
    if !pulled_whole(test) || !strain.is_finite() || (least..=most).contains(&strain) {
        return None;
    }
    let (travel, header) = if strain < least {
        ("next to nothing", "displacement_m")
    } else {
        ("far too much", "displacement_um")
    };
    say(
        "displacement_unit",
        format!("a travel of {:.3e} mm on a length of {} mm is {travel}", high.max(-low), g.length),
        format!("if the column is in another unit, name it so (`{header}`); check length_mm too"),
    )
}

fn offset(r: &Record, f: &RecordFindings) -> Option<Advice> {
    let travel = r.displacement.iter().fold(0.0f64, |m, u| m.max(u.abs()));
    let start = r.displacement.iter().position(|u| u.abs() > 0.01 * travel).unwrap_or(1).clamp(1, 20);
    let mean = r.force[..start].iter().sum::<f64>() / start as f64;
    let sure = 4.0 * f.noise_n.unwrap_or(0.0) / (start as f64).sqrt();
    if mean.abs() <= sure.max(OFFSET * f.peak_n) {
        return None;
    }
    let share = 100.0 * mean / f.peak_n;
    say(
        "tare",
        format!("the load cell reads {mean:.4} N ({share:.0} % of the peak) at displacement 0"),
        "leave it if the strip was mounted under that load; if the cell was not tared, `fct import FILE --tare`",
    )
}

fn clipped(r: &Record) -> Option<Advice> {
    let (low, high) = extremes(&r.displacement);
    let top = r.force.iter().fold(f64::MIN, |m, f| m.max(*f));
    let (mut from, mut most) = (None, 0.0f64);
    for i in 0..r.len() {
        match (r.force[i] == top, from) {
            (true, None) => from = Some(i),
            (true, Some(a)) if i - a + 1 >= CLIPPED_ROWS => {
                most = most.max((r.displacement[i] - r.displacement[a]).abs());
            }
            (false, _) => from = None,
            _ => {}
        }
    }
    if most <= CLIPPED_TRAVEL * (high - low) {
        return None;
    }
    say(
        "clipped",
        format!(
            "the force stands at exactly {top} N over {most:.3} mm of travel: the load cell or its range was full"
        ),
        "take these rows out, or measure again with a larger range: a cut-off peak bends the strength",
    )
}

fn no_tear(test: &Test, f: &RecordFindings) -> Option<Advice> {
    if !test.kind.tears || f.tears {
        return None;
    }
    say(
        "no_tear",
        format!("the {} test ends before the force has fallen", test.kind.word()),
        "pull on until the strip is torn: without the fall toughness and strength are guesses",
    )
}

fn torn_uniaxial(test: &Test, f: &RecordFindings) -> Option<Advice> {
    if test.kind.tears || !f.tears {
        return None;
    }
    say(
        "torn_uniaxial",
        format!(
            "the force of the {} test falls while the pull goes on: the strip tore or slipped in its clamps",
            test.kind.word()
        ),
        "end the record at its peak, or call the test `kind = \"tearing\"` if it has a cut",
    )
}

fn coarse_cell(f: &RecordFindings) -> Option<Advice> {
    if f.resolution_n <= 0.005 * f.peak_n {
        return None;
    }
    say(
        "resolution",
        format!(
            "forces differ by {:.4} N at least, {:.1} % of the peak",
            f.resolution_n,
            100.0 * f.resolution_n / f.peak_n
        ),
        "export more digits, or use a smaller range of the load cell",
    )
}

fn jitter(r: &Record, f: &RecordFindings) -> Option<Advice> {
    let (low, high) = extremes(&r.displacement);
    if f.jitter_mm <= JITTER * (high - low) {
        return None;
    }
    say(
        "jitter",
        format!("the displacement jitters by {:.4} mm: its motion is taken as straight legs", f.jitter_mm),
        "export the encoder's signal instead of the nominal position's error, or a smoothed one",
    )
}

fn few_rows(f: &RecordFindings) -> Option<Advice> {
    if f.rows >= FEW {
        return None;
    }
    say(
        "few_rows",
        format!("{} rows", f.rows),
        "export at least a hundred, and give `force_sd_N` in the specimen file: so few rows hardly tell their noise",
    )
}
