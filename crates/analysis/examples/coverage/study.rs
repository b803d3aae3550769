//! What is studied: a strip with two areas, its records and what the file of a fit says of it.

use input::{Case, Prior};
use inverse::Random;
use params::Quantity;
use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::Path;

const CONFIG: &str = r#"
name = "coverage"
provenance = "synthetic"
[geometry]
length_mm = 8.0
width_mm = 6.0
thickness_mm = 0.8
cut_mm = 1.5
[[tests]]
kind = "uniaxial"
data = "uniaxial.csv"
[[tests]]
kind = "tearing"
data = "tearing.csv"
[mesh]
divisions = [DIVISIONS, DIVISIONS, 1]
[bulk]
mu_kPa = { start = 6.0, fixed = true }
k1_kPa = 700.0
k2 = 15.0
gamma_deg = { start = 42.0, fixed = true }
kappa = { start = 0.22, fixed = true }
[interface]
areas = 2
gc_N_per_mm = 0.15
sigma_c_MPa = STRENGTH
[identify]
mode = "joint"
"#;

/// Of the tear the file of a fit gives this share of the truth.
pub const START: f64 = 0.8;
/// What it gives of the tissue is drawn around the truth, with the spread of a screen's priors.
const TISSUE: [(&str, f64); 2] = [("k1_kPa", 700.0), ("k2", 15.0)];
const SPREAD: f64 = 0.5;

/// Displacement corners of the intact strip, and of the tear before its last; points of each leg.
const UNIAXIAL: [f64; 4] = [0.0, 1.0, 0.2, 2.0];
const TEARING: [f64; 5] = [0.0, 2.0, 1.0, 3.5, 1.5];
const POINTS: usize = 60;

/// What the command line says.
pub struct Study {
    /// Records of each kind of noise.
    pub repeats: u64,
    /// Noise of each record as a share of its peak.
    pub noise: f64,
    /// Elements along and across the strip.
    pub divisions: usize,
    /// Strength, MPa.
    pub strength: f64,
    /// Displacement that the tear is pulled to, mm.
    pub end: f64,
    /// Correlations of the noise.
    pub ar1: Vec<f64>,
}

impl Study {
    /// The numbers of the command line, in this order.
    pub fn of_command_line() -> Self {
        let number = |n: usize, otherwise: f64| {
            std::env::args().nth(n).map_or(otherwise, |a| a.parse().expect("a number"))
        };
        Self {
            repeats: number(1, 200.0) as u64,
            noise: number(2, 0.01),
            divisions: number(3, 12.0) as usize,
            strength: number(4, 0.08),
            end: number(5, 5.0),
            ar1: std::env::args().nth(6).map_or(vec![0.0, 0.5], |a| vec![a.parse().expect("a number")]),
        }
    }

    /// Displacements of the two protocols.
    pub fn schedules(&self) -> [Vec<f64>; 2] {
        let leg = |w: &[f64]| {
            (0..POINTS).map(|i| w[0] + (w[1] - w[0]) * i as f64 / POINTS as f64).collect::<Vec<_>>()
        };
        let tearing: Vec<f64> = TEARING.into_iter().chain([self.end]).collect();
        [UNIAXIAL.to_vec(), tearing]
            .map(|corners| corners.windows(2).flat_map(leg).chain(corners.last().copied()).collect())
    }

    /// Where the points of each record stand among those of all.
    pub fn ranges(&self) -> [std::ops::Range<usize>; 2] {
        let [n, m] = self.schedules().map(|u| u.len());
        [0..n, n..n + m]
    }

    /// The case with these forces, tests one after the other, and with the tear at a share of the truth and the tissue
    /// so many standard deviations from it.
    pub fn case(&self, folder: &Path, forces: &[f64], tear: f64, off: [f64; 2]) -> Case {
        for ((name, u), range) in
            ["uniaxial.csv", "tearing.csv"].iter().zip(self.schedules()).zip(self.ranges())
        {
            let mut text = String::from("time_s,displacement_mm,force_N\n");
            let mut clock = 0.0;
            for (i, (x, force)) in u.iter().zip(&forces[range]).enumerate() {
                clock += if i > 0 { (x - u[i - 1]).abs() / 0.05 } else { 0.0 };
                let _ = writeln!(text, "{clock},{x},{force:.17e}");
            }
            std::fs::write(folder.join(name), text).expect("a record");
        }
        let file = folder.join("case.toml");
        std::fs::write(&file, self.config(tear, off)).expect("a config");
        input::read_case(&file, &effects::catalogue()).unwrap_or_else(|e| panic!("{e}"))
    }

    fn config(&self, tear: f64, off: [f64; 2]) -> String {
        let text = CONFIG
            .replace("DIVISIONS", &self.divisions.to_string())
            .replace("STRENGTH", &(self.strength * tear).to_string())
            .replace("gc_N_per_mm = 0.15", &format!("gc_N_per_mm = {}", 0.15 * tear));
        TISSUE.iter().zip(off).fold(text, |text, ((key, truth), z)| {
            text.replace(&format!("{key} = {truth:.1}"), &format!("{key} = {}", truth * (SPREAD * z).exp()))
        })
    }
}

/// Gives each area of a tear priors, drawn as they assume.
pub fn draw_priors(case: &mut Case, truth: &BTreeMap<String, f64>, random: &mut Random) {
    for (path, truth) in truth.iter().filter(|(path, _)| path.starts_with("interface.")) {
        let mean = truth * (SPREAD * random.normal()).exp();
        let relative_sd = (SPREAD * SPREAD).exp_m1().sqrt();
        let quantity = if path.ends_with("gc") { Quantity::FractureEnergy } else { Quantity::Stress };
        case.identify.priors.given.insert(path.clone(), Prior { mean, relative_sd, quantity });
    }
}
