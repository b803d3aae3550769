//! The folder of a case, in the form of the outside suite: `config.toml`, `specimen.toml`, records, `truth.json`; and
//! `known.toml`, in which the model has what is hidden.

use crate::GenerateError;
use crate::draw::Tissue;
use crate::foreign::Foreign;
use crate::forward::Fit;
use crate::spec::Protocol;
use input::{Geometry, Record};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::Path;

/// What is hidden in a case, and how well its records could show it.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Truth {
    /// Folder.
    pub name: String,
    /// Seed of everything random.
    pub seed: u64,
    /// Protocol.
    pub protocol: Protocol,
    /// Effects; empty for none. `outside:…`: not in the catalogue; `foreign:…`: by another formula than the catalogue's.
    pub effects: Vec<String>,
    /// Strength of each effect, 1 being ordinary.
    pub strengths: Vec<f64>,
    /// Parameters of each effect, internal units (mm, s, N, MPa, rad).
    pub effect_parameters: BTreeMap<String, BTreeMap<String, f64>>,
    /// Base parameters, internal units.
    pub tissue: Tissue,
    /// Noise of each test as a share of its largest force.
    pub noise_fraction: f64,
    /// Correlation of neighbouring noise.
    pub noise_ar1: f64,
    /// Noise of each test, N.
    #[serde(rename = "noise_sd_N")]
    pub noise_sd_n: BTreeMap<String, f64>,
    /// Whether a camera column is there.
    pub camera: bool,
    /// Root mean square of what the effects change, over the noise, per test, before any refit.
    pub effect_rms_over_noise: BTreeMap<String, f64>,
    /// Norm over all force points of what no base parameter can imitate, over the (correlated) noise. What a camera
    /// adds is ignored.
    pub what_no_base_parameter_imitates_over_noise: f64,
    /// The same of each effect in the presence of the other.
    pub each_over_noise: BTreeMap<String, f64>,
    /// Root mean square difference of the base model's forces between the meshes of identification and generator,
    /// at the true values, over the noise, per test. Shrinks where base parameters are refitted.
    pub mesh_error_rms_over_noise: BTreeMap<String, f64>,
    /// Generator's discretisation.
    pub computed_on: String,
}

impl Truth {
    /// Whether the records can see what is hidden: 8 times the noise, every effect of it.
    pub fn visible(&self) -> bool {
        !self.effects.is_empty() && self.each_over_noise.values().all(|s| *s >= VISIBLE)
    }

    /// Whether something is hidden that no catalogue entry describes.
    pub fn is_outside(&self) -> bool {
        self.effects.iter().any(|e| e.starts_with("outside:"))
    }

    /// Whether all that is hidden, if anything, is of the catalogue.
    pub fn is_known(&self) -> bool {
        !self.is_outside() && self.foreign().is_none()
    }

    /// The law of other people that is hidden.
    pub fn foreign(&self) -> Option<Foreign> {
        self.effects.iter().find_map(|e| Foreign::of(e))
    }

    /// Mean fracture energy of the areas, N/mm.
    pub fn gc(&self) -> f64 {
        self.tissue.gc.iter().sum::<f64>() / self.tissue.gc.len() as f64
    }
}

/// Imitation-proof signal from which a case counts as visible (issue 3).
pub const VISIBLE: f64 = 8.0;

/// The config a user would start with: mesh, bulk modulus, number of areas; everything else is to be identified.
fn config(fit: &Fit) -> String {
    format!(
        "specimen = \"specimen.toml\"\n[mesh]\nbulk_size_mm = {:?}\npath_size_mm = {:?}\nlayers = 1\n[bulk]\n\
         bulk_modulus_MPa = 20.0\n[interface]\nareas = {}\n",
        fit.bulk, fit.path, fit.areas
    )
}

/// Writes the folder of a case; `records` are named `uniaxial` and `tearing`.
///
/// # Errors
/// When a file cannot be written.
pub fn write(
    folder: &Path,
    truth: &Truth,
    fit: &Fit,
    geometry: &Geometry,
    records: &[(String, Record)],
) -> Result<(), GenerateError> {
    let put = |name: &str, text: &str| {
        let path = folder.join(name);
        std::fs::write(&path, text).map_err(|e| GenerateError::file(&path.display().to_string(), &e))
    };
    std::fs::create_dir_all(folder).map_err(|e| GenerateError::file(&folder.display().to_string(), &e))?;
    put("config.toml", &config(fit))?;
    put("known.toml", &(config(fit) + &in_the_model(truth)))?;
    put("specimen.toml", &specimen(&truth.name, geometry, records))?;
    for (name, record) in records {
        put(&format!("{name}.csv"), &csv(record))?;
    }
    let json = serde_json::to_string_pretty(truth).map_err(|e| GenerateError::file("truth.json", &e))?;
    // Last: a folder with a truth is complete.
    put("truth.json", &json)
}

/// What is hidden, as effects of the model with the values of their cards; nothing for what no catalogue holds.
fn in_the_model(truth: &Truth) -> String {
    let known = truth.effects.iter().filter(|_| truth.is_known());
    known.map(|e| format!("[effects.{e}]\n")).collect()
}

fn specimen(name: &str, g: &Geometry, records: &[(String, Record)]) -> String {
    let mut text = format!(
        "name = \"{name}\"\nprovenance = \"synthetic: computed by tests/hidden on another mesh; what is hidden is \
         in truth.json\"\n[geometry]\nlength_mm = {}\nwidth_mm = {}\nthickness_mm = {}\ncut_mm = {}\n",
        short(g.length),
        short(g.width),
        short(g.thickness),
        short(g.cut)
    );
    for (name, _) in records {
        let _ = write!(text, "[[tests]]\nkind = \"{name}\"\ndata = \"{name}.csv\"\n");
    }
    text
}

/// A number without the noise of binary fractions, but still a TOML float.
fn short(x: f64) -> String {
    format!("{:?}", (x * 1e6).round() / 1e6)
}

fn csv(r: &Record) -> String {
    let mut text = String::from("time_s,displacement_mm,force_N");
    text.push_str(if r.grip_displacement.is_some() { ",grip_displacement_mm\n" } else { "\n" });
    for i in 0..r.len() {
        let _ = write!(text, "{:.4},{:.6},{:.7}", r.time[i], r.displacement[i], r.force[i]);
        if let Some(g) = r.grip_displacement.as_ref().and_then(|g| g[i]) {
            let _ = write!(text, ",{g:.5}");
        }
        text.push('\n');
    }
    text
}

/// Reads a truth.
///
/// # Errors
/// When the file is missing or broken.
pub fn truth(folder: &Path) -> Result<Truth, GenerateError> {
    let path = folder.join("truth.json");
    let name = path.display().to_string();
    let text = std::fs::read_to_string(&path).map_err(|e| GenerateError::file(&name, &e))?;
    serde_json::from_str(&text).map_err(|e| GenerateError::file(&name, &e))
}
