//! What a record of a tear tells of toughness and strength without finite elements.

use input::{Geometry, Record};

/// Nothing tears, nothing is told.
pub fn nothing(_: &Geometry, _: &Record) -> (f64, f64) {
    (0.0, 0.0)
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
