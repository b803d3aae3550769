//! What tests of the ladder share.

use crate::LadderSettings;
use input::Case;
use model::Catalogue;
use std::fmt::Write as _;

/// A search that nobody hears of, stops or keeps.
pub(super) fn unheard(catalogue: &Catalogue) -> LadderSettings<'_> {
    LadderSettings {
        catalogue,
        policy: diagnose::Policy::default(),
        progress: &|_| (),
        cancelled: &|| false,
        journal: &crate::NoJournal,
    }
}

/// A tear whose unloading follows a curve of its own: no base model explains it.
pub(super) fn unexplained(folder: &std::path::Path) -> Case {
    let mut rows = String::from("time_s,displacement_mm,force_N\n");
    for k in 0..60 {
        let t = f64::from(k);
        let back = (20..30).contains(&k);
        let u = 0.02 * if back { 40.0 - t } else { t - if k < 20 { 0.0 } else { 20.0 } };
        let force = 0.5 * u * (-u).exp() * if back { 0.3 } else { 1.0 };
        let _ = writeln!(rows, "{t},{u},{force}");
    }
    let text = "name = \"loop\"\n[geometry]\nlength_mm = 4.0\nwidth_mm = 3.0\nthickness_mm = 0.8\ncut_mm = 1.0\n\
                [[tests]]\nkind = \"tearing\"\ndata = \"tearing.csv\"\nforce_sd_N = 0.002\n[mesh]\ndivisions = [4, 4, 1]\n\
                [bulk]\nmu_kPa = 6.0\nk2 = 8.0\ngamma_deg = 42.0\nkappa = 0.2\n";
    std::fs::write(folder.join("tearing.csv"), rows).expect("a record");
    std::fs::write(folder.join("c.toml"), text).expect("a config");
    input::read_case(&folder.join("c.toml"), &effects::catalogue()).unwrap_or_else(|e| panic!("{e}"))
}
