//! How far off a fitted model is, and where.

use diagnose::{RecordKind, Segment};
use input::{Record, Test, TestKind};

/// The segments of a test's record: the user's own names where the record has them.
pub fn segments(test: &Test, record: &Record) -> Vec<Segment> {
    let kind = match test.kind {
        TestKind::Uniaxial => RecordKind::Intact,
        TestKind::Tearing => RecordKind::Tearing,
    };
    diagnose::segments::cut(&record.time, &record.displacement, &record.force, kind)
}
