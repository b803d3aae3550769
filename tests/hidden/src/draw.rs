//! Tissue and geometry of a case, drawn around the published specimens.

use crate::GenerateError;
use input::{Case, Geometry, Value};
use inverse::Random;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Relative spread of every bulk and interface parameter.
const SPREAD: f64 = 0.15;

/// Relative spread of one area's toughness and strength about the specimen's.
const AREA_SPREAD: f64 = 0.05;

#[derive(Deserialize)]
struct Published {
    bulk: PublishedBulk,
    interface: PublishedInterface,
}

#[derive(Deserialize)]
#[allow(non_snake_case)]
struct PublishedBulk {
    mu_kPa: f64,
    k1_kPa: f64,
    k2: f64,
    gamma_deg: f64,
    kappa: f64,
}

#[derive(Deserialize)]
#[allow(non_snake_case)]
struct PublishedInterface {
    gc_N_per_mm: Vec<f64>,
    sigma_c_MPa: Vec<f64>,
}

/// The tissue of a case, internal units.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Tissue {
    /// Published specimen it was drawn around.
    pub around: String,
    /// μ, MPa.
    pub mu: f64,
    /// k1, MPa.
    pub k1: f64,
    /// k2.
    pub k2: f64,
    /// γ, rad.
    pub gamma: f64,
    /// κ.
    pub kappa: f64,
    /// Gc of the areas, N/mm.
    pub gc: Vec<f64>,
    /// σc of the areas, MPa.
    pub sigma_c: Vec<f64>,
    /// σc was multiplied by this, lest the tear jump.
    pub shrunk: f64,
}

fn published() -> Result<BTreeMap<String, Published>, GenerateError> {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../specimens/published.toml");
    let text = std::fs::read_to_string(path).map_err(|e| GenerateError::file(path, &e))?;
    let table: toml::Table = toml::from_str(&text).map_err(|e| GenerateError::file(path, &e))?;
    let specimens = table.into_iter().filter(|(_, v)| v.is_table());
    specimens
        .map(|(name, v)| {
            Ok((name, v.try_into().map_err(|e: toml::de::Error| GenerateError::file(path, &e))?))
        })
        .collect()
}

/// A factor within ± `spread` of 1.
pub fn about_one(random: &mut Random, spread: f64) -> f64 {
    between(random, 1.0 - spread, 1.0 + spread)
}

/// Uniform between two numbers.
pub fn between(random: &mut Random, low: f64, high: f64) -> f64 {
    low + (high - low) * random.uniform()
}

/// Draws a tissue with `areas` areas along the tear path.
///
/// # Errors
/// When the published values cannot be read.
pub fn tissue(random: &mut Random, areas: usize) -> Result<Tissue, GenerateError> {
    let all = published()?;
    let pick = ((random.uniform() * all.len() as f64) as usize).min(all.len() - 1);
    let Some((name, p)) = all.iter().nth(pick) else {
        return Err(GenerateError::Model("published.toml names no specimen".into()));
    };
    let mean = |v: &[f64]| v.iter().sum::<f64>() / v.len() as f64;
    let gc = mean(&p.interface.gc_N_per_mm) * about_one(random, SPREAD);
    let sigma_c = mean(&p.interface.sigma_c_MPa) * about_one(random, SPREAD);
    let mut each = |m: f64| (0..areas).map(|_| m * about_one(random, AREA_SPREAD)).collect::<Vec<f64>>();
    let (gc, sigma_c) = (each(gc), each(sigma_c));
    Ok(Tissue {
        around: name.clone(),
        mu: 1e-3 * p.bulk.mu_kPa * about_one(random, SPREAD),
        k1: 1e-3 * p.bulk.k1_kPa * about_one(random, SPREAD),
        k2: p.bulk.k2 * about_one(random, SPREAD),
        gamma: (p.bulk.gamma_deg * about_one(random, SPREAD)).min(80.0).to_radians(),
        kappa: (p.bulk.kappa * about_one(random, SPREAD)).min(0.31),
        gc,
        sigma_c,
        shrunk: 1.0,
    })
}

/// Draws a rectangle. Dimensions are rounded as a calliper would.
pub fn geometry(random: &mut Random) -> Geometry {
    let mut round = |low: f64, high: f64, to: f64| (between(random, low, high) / to).round() * to;
    Geometry {
        length: round(6.5, 11.0, 0.1),
        width: round(5.0, 7.6, 0.1),
        thickness: round(0.55, 1.1, 0.01),
        cut: round(0.8, 1.5, 0.01),
        path_y: None,
        outline: None,
        thickness_profile: None,
    }
}

impl Tissue {
    /// Writes the values into a case.
    pub fn put(&self, case: &mut Case) {
        for (name, v) in
            [("mu", self.mu), ("k1", self.k1), ("k2", self.k2), ("gamma", self.gamma), ("kappa", self.kappa)]
        {
            case.bulk.parameters.insert(name.to_owned(), Value::new(v));
        }
        case.interface.areas = self.gc.len();
        case.interface.gc = self.gc.iter().map(|&v| Value::new(v)).collect();
        case.interface.sigma_c = self.sigma_c.iter().map(|&v| Value::new(v)).collect();
    }

    /// Lowers every strength.
    pub fn shrink(&mut self, factor: f64) {
        self.sigma_c.iter_mut().for_each(|s| *s *= factor);
        self.shrunk *= factor;
    }

    /// Opening at peak traction of the specimen's mean, mm.
    pub fn delta_c(&self) -> f64 {
        let (g, s): (f64, f64) = (self.gc.iter().sum(), self.sigma_c.iter().sum());
        g / (std::f64::consts::E * s)
    }

    /// Mean strength, MPa.
    pub fn mean_sigma_c(&self) -> f64 {
        self.sigma_c.iter().sum::<f64>() / self.sigma_c.len() as f64
    }

    /// Strain that the fibres feel when the strip is stretched by λ, and one family's energy there, MPa.
    pub fn fibre(&self, stretch: f64) -> (f64, f64) {
        let (along, across) = (stretch * stretch, 1.0 / stretch);
        let i4 = along * self.gamma.cos().powi(2) + across * self.gamma.sin().powi(2);
        let i1 = along + 2.0 * across;
        let e = (self.kappa * (i1 - 3.0) + (1.0 - 3.0 * self.kappa) * (i4 - 1.0)).max(0.0);
        (e, self.k1 / (2.0 * self.k2) * (self.k2 * e * e).exp_m1())
    }
}
