//! Zwick/Roell testXpert: German or English names, units in brackets or in a line of their own, decimal comma as the
//! system has it. `Traversenweg` is the actuator's; what `Standardweg` is, the test program decides.

use super::{Dialect, Hints, a_line_holds};

pub(super) const DIALECT: Dialect = Dialect {
    name: "testXpert",
    wrote: |head| {
        head.iter().any(|l| l.contains("testXpert"))
            || a_line_holds(head, &["prufzeit"])
            || a_line_holds(head, &["standardkraft"])
            || a_line_holds(head, &["test time", "standard force"])
    },
    hints: |_| Hints::default(),
};
