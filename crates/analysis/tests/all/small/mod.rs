//! A small strip with an intact and a tearing test, and records to give it.

use analysis::{DataBlock, FeProblem, run_options};
use input::Case;
use inverse::{Problem as _, Random};
use model::{Catalogue, Channel, Discretisation, Model};
use std::fmt::Write;
use std::path::Path;
use std::sync::Arc;

/// Dimensions and tests; mesh, tissue and path are the caller's.
pub const STRIP: &str = r#"
name = "small"
provenance = "synthetic"
[geometry]
length_mm = 4.0
width_mm = 3.0
thickness_mm = 0.8
cut_mm = 1.0
[[tests]]
kind = "uniaxial"
data = "uniaxial.csv"
force_sd_N = 0.001
[[tests]]
kind = "tearing"
data = "tearing.csv"
force_sd_N = 0.001
"#;

/// A mesh, a tissue and a path to be fitted: k1, k2, Gc and σc are free.
#[allow(dead_code)]
pub const FIT: &str = r#"
[mesh]
divisions = [8, 8, 1]
[bulk]
mu_kPa = { start = 6.0, fixed = true }
k1_kPa = 300.0
k2 = 8.0
gamma_deg = { start = 42.0, fixed = true }
kappa = { start = 0.2, fixed = true }
[interface]
gc_N_per_mm = 0.03
sigma_c_MPa = 0.06
"#;

/// Points of a leg.
pub const LEG: usize = 12;

/// Writes both records: a ramp, an unloading, a fast reloading, a hold (or slowly on), and on. Forces only give sizes.
pub fn write_records(folder: &Path, hold: bool) {
    for (file, end) in [("uniaxial.csv", 0.5), ("tearing.csv", 0.8)] {
        let held = if hold { 1.1 * end } else { 1.3 * end };
        let corners =
            [(0.0, 0.0), (20.0, end), (32.0, 0.4 * end), (34.0, 1.1 * end), (60.0, held), (80.0, 1.5 * end)];
        let mut text = String::from("time_s,displacement_mm,force_N\n");
        for w in corners.windows(2) {
            for i in 0..LEG {
                let s = i as f64 / LEG as f64;
                let (t, u) = (w[0].0 + s * (w[1].0 - w[0].0), w[0].1 + s * (w[1].1 - w[0].1));
                let _ = writeln!(text, "{t},{u},{}", 0.1 * u);
            }
        }
        let _ = writeln!(text, "{},{},{}", corners[5].0, corners[5].1, 0.1 * corners[5].1);
        std::fs::write(folder.join(file), text).expect("a record");
    }
}

/// Forces of a case, tests one after the other.
#[allow(dead_code)]
pub fn forces(case: &Case, catalogue: &Catalogue) -> Vec<Vec<f64>> {
    let model = Model::new(Arc::new(case.clone()), catalogue, Discretisation::default()).expect("a model");
    let rows = |t: &input::Test| (0..t.record.as_ref().map_or(0, input::Record::len)).collect();
    let slots: Vec<DataBlock> = (0..case.tests.len())
        .map(|test| DataBlock { test, channel: Channel::Force, rows: rows(&case.tests[test]) })
        .collect();
    let problem = FeProblem::new(&model, model.theta(), Vec::new(), &slots, run_options(case), &|| false);
    let all = problem.predict(&[], false).unwrap_or_else(|e| panic!("{:?}: {e}", model.effects())).values;
    let mut all = all.iter().copied();
    slots.iter().map(|s| all.by_ref().take(s.rows.len()).collect()).collect()
}

/// Puts forces into the records, with noise of a share of each peak.
#[allow(dead_code)]
pub fn record(case: &mut Case, forces: &[Vec<f64>], noise: f64, random: &mut Random) {
    for (t, f) in case.tests.iter_mut().zip(forces) {
        let sd = noise * f.iter().fold(0.0f64, |m, x| m.max(x.abs()));
        let noise = random.ar1(f.len(), sd, 0.0);
        t.force_sd = Some(sd);
        if let Some(r) = &mut t.record {
            r.force = f.iter().zip(noise.iter()).map(|(f, n)| f + n).collect();
        }
    }
}
