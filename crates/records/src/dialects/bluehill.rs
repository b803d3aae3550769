//! Instron Bluehill, raw data as CSV: `Group : Key,"value",unit` lines, a blank line, names, units in brackets. Cyclic
//! tests have `Segment ID` and `Total Cycle Count`. `Extension` is the crosshead's; `Tensile extension` the same from
//! the start of the test.

use super::{Dialect, Hints, a_line_holds};
use crate::words::Role;

pub(super) const DIALECT: Dialect = Dialect {
    name: "Bluehill",
    wrote: |head| {
        let groups =
            ["General :", "Text Inputs :", "Dimension :", "Dimensions :", "Number Inputs :", "Results Table"];
        let quoted = |l: &str| l.trim_start_matches('"').to_owned();
        head.iter().any(|l| groups.iter().any(|g| quoted(l).starts_with(g)))
            || head
                .windows(2)
                .any(|w| a_line_holds(&w[..1], &["time"]) && w[1].to_lowercase().starts_with("(s"))
    },
    hints: |_| Hints {
        columns: &[(Role::Displacement, "extension"), (Role::Force, "load"), (Role::Time, "time")],
        ..Hints::default()
    },
};
