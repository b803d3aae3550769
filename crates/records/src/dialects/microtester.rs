//! CellScale MicroTester (read by pyphasic): `Set Name,Cycle,Time(ms),Force(uN),Tip Displacement(um),Base
//! Displacement(um)`. The base is the actuator; the tip is behind the beam that bends.

use super::{Dialect, Hints, a_line_holds};
use crate::words::Role;

pub(super) const DIALECT: Dialect = Dialect {
    name: "MicroTester",
    wrote: |head| a_line_holds(head, &["set name", "base displacement"]),
    hints: |_| Hints {
        columns: &[
            (Role::Segment, "set name"),
            (Role::Segment, "cycle"),
            (Role::Displacement, "base displacement"),
        ],
        remarks: &[
            "displacement is the base's (the actuator); the tip's may be given as the clamps': --grip-displacement 'Tip Displacement'",
        ],
        ..Hints::default()
    },
};
