//! Every usual fault of a record is recognised, and a good record has none.

use analysis::{Doctor, doctor};
use input::Case;
use inverse::Random;
use std::path::Path;
use std::sync::Arc;

/// Rows of a good record of a strip 10 × 6 × 0.8 mm: time, displacement, force. A stiffening pull with an unloading, a hold;
/// torn at the end where `tear`.
fn good(tear: bool) -> Vec<[f64; 3]> {
    let legs = [(0.0, 0.0), (20.0, 2.0), (30.0, 1.0), (40.0, 2.0), (100.0, 2.0), (130.0, 5.0)];
    let mut random = Random::new(2);
    let mut rows = Vec::new();
    for w in legs.windows(2) {
        for k in 0..60 {
            let s = f64::from(k) / 60.0;
            let (t, u) = (w[0].0 + s * (w[1].0 - w[0].0), w[0].1 + s * (w[1].1 - w[0].1));
            let held = if tear && u > 3.0 { (-3.0 * (u - 3.0)).exp() } else { 1.0 };
            let force = held * 0.02 * ((0.8 * u).exp() - 1.0) + 0.0005 * random.normal();
            // Digits as an instrument writes them.
            rows.push([t, u, force].map(|x| (x * 1e6).round() / 1e6));
        }
    }
    rows
}

fn examined(folder: &Path, kind: &str, header: &str, rows: &[[f64; 3]]) -> Doctor {
    let body: String = rows.iter().map(|r| format!("{},{},{}\n", r[0], r[1], r[2])).collect();
    std::fs::write(folder.join("r.csv"), format!("{header}\n{body}")).expect("written");
    let text = format!(
        "name = \"x\"\n[geometry]\nlength_mm = 10.0\nwidth_mm = 6.0\nthickness_mm = 0.8\ncut_mm = 1.0\n\
         [[tests]]\nkind = \"{kind}\"\ndata = \"r.csv\"\n[mesh]\ndivisions = [4, 4, 1]\n"
    );
    std::fs::write(folder.join("c.toml"), text).expect("written");
    let case: Case =
        input::read_case(&folder.join("c.toml"), &effects::catalogue()).expect("a readable file");
    doctor(&Arc::new(case), &effects::catalogue(), false, &|| false)
}

const HEADER: &str = "time_s,displacement_mm,force_N";

/// Faults that are found once rows were spoilt.
fn faults(kind: &str, spoil: impl Fn(usize, [f64; 3]) -> [f64; 3]) -> Vec<&'static str> {
    let folder = tempfile::tempdir().expect("a folder");
    let rows: Vec<[f64; 3]> =
        good(kind == "tearing").into_iter().enumerate().map(|(i, r)| spoil(i, r)).collect();
    let d = examined(folder.path(), kind, HEADER, &rows);
    assert!(d.records[0].advice.iter().all(|a| !a.remedy.is_empty()));
    d.records[0].advice.iter().map(|a| a.fault).collect()
}

#[test]
fn a_good_record_has_no_fault() {
    assert_eq!(faults("uniaxial", |_, r| r), [""; 0]);
    assert_eq!(faults("tearing", |_, r| r), [""; 0]);
}

#[test]
fn its_motion_and_noise_are_told() {
    let folder = tempfile::tempdir().expect("a folder");
    let d = examined(folder.path(), "uniaxial", HEADER, &good(false));
    let r = &d.records[0];
    assert_eq!((r.rows, r.points, r.motion.unloadings), (300, 300, 1));
    assert!(r.motion.holds_s.len() == 1 && (r.motion.holds_s[0] - 60.0).abs() < 2.0, "{:?}", r.motion);
    assert!((r.noise_n.expect("noise") / 0.0005 - 1.0).abs() < 0.2);
    assert!(!r.tears && r.jitter_mm < 1e-5);
}

#[test]
fn signs_are_recognised() {
    assert_eq!(faults("uniaxial", |_, [t, u, f]| [t, u, -f]), ["force_sign"]);
    assert_eq!(faults("uniaxial", |_, [t, u, f]| [t, -u, f]), ["displacement_sign"]);
    assert_eq!(faults("uniaxial", |_, [t, u, f]| [t, -u, -f]), ["displacement_sign", "force_sign"]);
}

#[test]
fn an_untared_load_cell_is_recognised() {
    assert_eq!(faults("uniaxial", |_, [t, u, f]| [t, u, f + 0.15]), ["tare"]);
    assert_eq!(faults("tearing", |_, [t, u, f]| [t, u, f - 0.05]), ["tare"]);
}

#[test]
fn swapped_columns_are_recognised() {
    assert_eq!(faults("uniaxial", |_, [t, u, f]| [t, f, u]), ["swapped"]);
}

#[test]
fn other_units_are_recognised() {
    assert_eq!(faults("uniaxial", |_, [t, u, f]| [t, u, 1e-3 * f]), ["force_unit"]);
    assert_eq!(faults("uniaxial", |_, [t, u, f]| [t, u, 1e4 * f]), ["force_unit"]);
    assert_eq!(faults("uniaxial", |_, [t, u, f]| [t, 1e-3 * u, f]), ["displacement_unit"]);
    assert_eq!(faults("uniaxial", |_, [t, u, f]| [t, 1e3 * u, f]), ["displacement_unit"]);
}

#[test]
fn a_row_number_is_no_clock() {
    assert_eq!(faults("uniaxial", |i, [_, u, f]| [i as f64, u, f]), ["missing_time"]);
}

#[test]
fn a_full_load_cell_is_recognised() {
    assert_eq!(faults("uniaxial", |_, [t, u, f]| [t, u, f.min(0.5)]), ["clipped"]);
}

#[test]
fn a_tear_that_is_not_there_and_one_that_is_are_recognised() {
    let folder = tempfile::tempdir().expect("a folder");
    let of = |kind, tear| examined(folder.path(), kind, HEADER, &good(tear)).records[0].advice.clone();
    assert_eq!(of("tearing", false).iter().map(|a| a.fault).collect::<Vec<_>>(), ["no_tear"]);
    assert_eq!(of("uniaxial", true).iter().map(|a| a.fault).collect::<Vec<_>>(), ["torn_uniaxial"]);
}

#[test]
fn coarse_digits_and_a_shaking_actuator_are_recognised() {
    assert_eq!(faults("uniaxial", |_, [t, u, f]| [t, u, (f * 50.0).round() / 50.0]), ["resolution"]);
    let shaken = |i: usize, [t, u, f]: [f64; 3]| {
        let shake = 0.02 * (((i * 7919) % 101) as f64 / 101.0 - 0.5);
        [t, if i == 0 { 0.0 } else { u + shake }, f]
    };
    assert_eq!(faults("uniaxial", shaken), ["jitter"]);
}

#[test]
fn a_record_that_does_not_start_at_zero_is_an_error_with_its_remedy() {
    let folder = tempfile::tempdir().expect("a folder");
    let body: String = good(false).iter().map(|r| format!("{},{},{}\n", r[0], r[1] + 0.3, r[2])).collect();
    std::fs::write(folder.path().join("r.csv"), format!("{HEADER}\n{body}")).expect("written");
    let text = "name = \"x\"\n[geometry]\nlength_mm = 10.0\nwidth_mm = 6.0\nthickness_mm = 0.8\ncut_mm = 1.0\n\
                [[tests]]\nkind = \"uniaxial\"\ndata = \"r.csv\"\n";
    std::fs::write(folder.path().join("c.toml"), text).expect("written");
    let faults =
        input::read_case(&folder.path().join("c.toml"), &effects::catalogue()).expect_err("an offset");
    let told = faults.to_string();
    assert!(told.contains("starts at 0.3 mm") && told.contains("--zero"), "{told}");
}
