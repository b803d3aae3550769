//! MTS 793 / MultiPurpose TestWare: the first line declares the locale, `MTS793|MPT|DEU|1|2|,|.|:|49|1|1|A`: decimal
//! mark in the sixth field. Blocks of tab-separated columns follow, each with a line of names and one of units; the
//! clock is in `Laufzeit` or `Running Time`, the set point beside what was measured.

use super::{Dialect, Hints};
use crate::words::Role;

pub(super) const DIALECT: Dialect = Dialect {
    name: "MTS 793",
    wrote: |head| head.first().is_some_and(|l| l.starts_with("MTS793|")),
    hints: |head| {
        let declared = head.first().and_then(|l| l.split('|').nth(5)).and_then(|f| f.chars().next());
        Hints {
            delimiter: Some('\t'),
            decimal: declared.filter(|c| [',', '.'].contains(c)),
            columns: &[(Role::Time, "laufzeit"), (Role::Time, "running time")],
            ..Hints::default()
        }
    },
};
