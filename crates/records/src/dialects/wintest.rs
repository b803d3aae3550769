//! Bose/TA ElectroForce WinTest: quoted names in a line that ends with a comma, units in the next, a NUL at the end
//! of the first line, the number of the point before the clock.

use super::{Dialect, Hints, a_line_holds};
use crate::words::Role;

pub(super) const DIALECT: Dialect = Dialect {
    name: "WinTest",
    wrote: |head| {
        head.iter().take(4).any(|l| l.contains("WinTest"))
            || a_line_holds(head, &["points", "elapsed time", "disp", "load"])
    },
    hints: |_| Hints { columns: &[(Role::Time, "elapsed time")], ..Hints::default() },
};
