//! Deben Microtest (`.MTR`): quoted `"Key : value"` lines with the system's decimal comma, then columns with decimal
//! points and no zero before them, without units: `Point` is the time in s, `Elongation` mm, `Force` N.

use super::{Dialect, Hints, a_line_holds};
use crate::words::Role;

pub(super) const DIALECT: Dialect = Dialect {
    name: "Deben",
    wrote: |head| a_line_holds(head, &["point", "elongation", "force", "code"]),
    hints: |_| Hints {
        delimiter: Some(','),
        decimal: Some('.'),
        columns: &[(Role::Time, "point"), (Role::Displacement, "elongation"), (Role::Force, "force")],
        units: &[(Role::Time, "s"), (Role::Displacement, "mm"), (Role::Force, "N")],
        remarks: &["Deben writes no units: s, mm and N were taken; --units says otherwise"],
    },
};
