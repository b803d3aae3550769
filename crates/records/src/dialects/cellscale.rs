//! CellScale BioTester and UStretch: `SetName,Cycle,Time_S,XSize_um,XDisplacement_um,XForce_mN`, unit after the
//! underscore; a set has cycles with phases (`1-Stretch`, `1-Hold`). Biaxial files have `Y…` columns too.

use super::{Dialect, Hints, a_line_holds};
use crate::words::Role;

pub(super) const DIALECT: Dialect = Dialect {
    name: "CellScale",
    wrote: |head| a_line_holds(head, &["set name", "cycle", "time s"]),
    hints: |_| Hints {
        columns: &[
            (Role::Segment, "set name"),
            (Role::Segment, "cycle"),
            (Role::Displacement, "x displacement"),
            (Role::Force, "x force"),
        ],
        ..Hints::default()
    },
};
