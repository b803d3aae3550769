//! What tests of the ladder share.

use super::FeLadder;
use crate::LadderSettings;
use diagnose::{Discovery, Screen, Verdict};
use input::Case;
use model::Catalogue;
use std::fmt::Write as _;
use std::sync::Arc;

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

/// The base model's fit to a tear whose unloading follows a curve of its own, which no base model explains.
pub(crate) fn unexplained(catalogue: &Catalogue) -> FeLadder<'_> {
    FeLadder::weighing(Arc::new(unloaded(catalogue)), unheard(catalogue)).expect("a base fit")
}

/// That tear.
pub(crate) fn unloaded(catalogue: &Catalogue) -> Case {
    let folder = tempfile::tempdir().expect("a folder");
    let folder = folder.path();
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
    input::read_case(&folder.join("c.toml"), catalogue).expect("a case")
}

/// An answer without a name, in which these effects lead.
pub(crate) fn undecided(effects: &[&str]) -> Discovery {
    Discovery {
        ladder: Vec::new(),
        tried: Vec::new(),
        failed: Vec::new(),
        screen: Screen::default(),
        last_screen: Screen::default(),
        found: Vec::new(),
        groups: Vec::new(),
        undecided: effects.iter().map(|e| (*e).to_owned()).collect(),
        verdict: Verdict::Ambiguous,
        interrupted: false,
    }
}
