//! Instron Bluehill, raw data as CSV: `Group : Key,"value",unit` lines, a blank line, names, units in brackets. Cyclic
//! tests have `Segment ID` and `Total Cycle Count`. `Extension` is the crosshead's; `Tensile extension` the same from
//! the start of the test.

use super::{Dialect, Hints, a_line_holds};
use crate::words::Role;

pub(super) const DIALECT: Dialect = Dialect {
    name: "Bluehill",
    wrote: |head| {
        let groups = [
            "General :",
            "Text Inputs :",
            "Dimension :",
            "Dimensions :",
            "Number Inputs :",
            "Results Table",
            "Allgemein :",
            "Abmessung :",
            "Ergebnistabelle",
            "Général :",
        ];
        let group = |l: &&str| {
            let l = l.trim_start_matches('"');
            groups.iter().any(|g| l.starts_with(g))
        };
        let names = |l: &str| ["time", "zeit", "temps"].iter().any(|t| a_line_holds(&[l], &[t]));
        let units = |l: &str| l.trim_start_matches('"').to_lowercase().starts_with("(s");
        head.iter().any(group) || head.windows(2).any(|w| names(w[0]) && units(w[1]))
    },
    hints: |_| Hints {
        columns: &[(Role::Displacement, "extension"), (Role::Force, "load"), (Role::Time, "time")],
        ..Hints::default()
    },
};
