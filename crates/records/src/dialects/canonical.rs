//! The form that every other command takes: `time_s,displacement_mm,force_N`.

use super::{Dialect, Hints};

pub(super) const DIALECT: Dialect = Dialect {
    name: "fct",
    wrote: |head| {
        let header = head.iter().find(|l| !l.trim().is_empty() && !l.trim_start().starts_with('#'));
        header
            .is_some_and(|l| l.starts_with("time_") && l.contains(",displacement_") && l.contains(",force_"))
    },
    hints: |_| Hints { delimiter: Some(','), decimal: Some('.'), ..Hints::default() },
};
