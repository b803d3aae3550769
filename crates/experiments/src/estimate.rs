//! What a record of a tear tells of toughness and strength without finite elements.

use input::{Balance, Geometry, Record};

/// Nothing tears, nothing is told.
pub fn nothing(_: &Geometry, _: &Record) -> (f64, f64) {
    (0.0, 0.0)
}

/// The test can be done on any piece.
pub fn any_piece(_: &Geometry) -> Option<(&'static str, String)> {
    None
}

/// The record tells no toughness.
pub fn no_balance(_: &Geometry, _: &Record) -> Option<Balance> {
    None
}

/// Larger force at the end of a record, as a share of its peak: it is not torn through.
const TORN: f64 = 0.1;

/// ∮F du over the torn area, of a record that ends torn through: unloaded ligaments give back what they stored.
pub fn over_the_torn_area(g: &Geometry, record: &Record) -> Option<Balance> {
    let (u, f) = (&record.displacement, &record.force);
    let peak = f.iter().fold(0.0f64, |m, x| m.max(*x));
    let tail = f.last().copied().unwrap_or_default();
    let work: f64 = (1..f.len()).map(|i| 0.5 * (f[i] + f[i - 1]) * (u[i] - u[i - 1])).sum();
    let gc = work / ((g.width - g.cut) * g.thickness);
    let how = "by the area under the record, loops subtracted, over the torn area";
    (tail < TORN * peak && gc > 0.0).then_some(Balance { gc, how })
}

/// Work of the record over the torn area (N/mm), and its peak over that area (MPa), for a sheet whose ligament is torn
/// through.
pub fn from_area(g: &Geometry, record: &Record) -> (f64, f64) {
    let area = (g.width - g.cut) * g.thickness;
    let (u, f) = (&record.displacement, &record.force);
    // Work on the envelope: only where the displacement is the largest so far.
    let (mut work, mut most, mut force) = (0.0, u[0], f[0]);
    for (&u, &f) in u.iter().zip(f) {
        if u > most {
            work += 0.5 * (f + force) * (u - most);
            (most, force) = (u, f);
        }
    }
    let peak = f.iter().fold(0.0f64, |m, x| m.max(*x));
    let tail = force.max(0.0) / peak.max(f64::MIN_POSITIVE);
    (work / area * (1.0 + tail), peak / area)
}
