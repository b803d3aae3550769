//! What a factor holds and costs is known before there is a mesh (`mesh::count`): memory and time of a run hang on it.
use crate::common;

use common::*;
use fem::System;

#[test]
fn the_fill_counted_ahead_is_the_factors() {
    for (divisions, quarter) in
        [([8, 20, 2], true), ([8, 20, 2], false), ([20, 50, 4], false), ([12, 12, 8], false)]
    {
        let strip = peer_strip(divisions, true, quarter);
        let ahead = mesh::count(&strip).unwrap();
        let system = System::new(&problem(&strip, Ends::Clamped, 1)).unwrap();
        let (entries, flops) = (system.factor.fill() as f64, system.factor.flops());
        println!(
            "{divisions:?}, quarter {quarter}: {} unknowns, entries {:.2} and flops {:.2} of what is there",
            system.unknowns,
            ahead.fill.entries / entries,
            ahead.fill.flops / flops
        );
        assert!((0.8..1.7).contains(&(ahead.fill.entries / entries)));
        assert!((0.7..2.2).contains(&(ahead.fill.flops / flops)));
        assert!(3 * ahead.nodes >= system.unknowns && 3 * ahead.nodes < 2 * system.unknowns);
    }
}
