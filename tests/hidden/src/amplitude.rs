//! How strong a hidden effect is. Strength 1 is what a laboratory would call ordinary; the sizes of the case give
//! the units. These numbers are the suite's own: they do not ask the product what it finds plausible.

use crate::draw::{Tissue, about_one, between};
use input::Geometry;
use inverse::Random;

/// Sizes of a case without the effect.
#[derive(Clone, Debug)]
pub struct Sizes {
    /// Dimensions.
    pub geometry: Geometry,
    /// Tissue.
    pub tissue: Tissue,
    /// Largest displacement and force of the intact strip.
    pub uniaxial: (f64, f64),
    /// Largest displacement and force of the tear.
    pub tearing: (f64, f64),
    /// Duration of the two tests, s.
    pub duration: (f64, f64),
}

/// Parameters by name, internal units.
pub type Parameters = Vec<(&'static str, f64)>;

/// Parameters of an effect; amplitude first. `None`: the suite has no such effect.
pub fn parameters(effect: &str, strength: f64, sizes: &Sizes, random: &mut Random) -> Option<Parameters> {
    let sign = if random.uniform() < 0.5 { -1.0 } else { 1.0 };
    let a = strength * about_one(random, 0.15);
    bulk(effect, a, sign, sizes, random)
        .or_else(|| interface(effect, a, sign, sizes, random))
        .or_else(|| rig(effect, a, sign, sizes, random))
}

fn bulk(effect: &str, a: f64, sign: f64, s: &Sizes, random: &mut Random) -> Option<Parameters> {
    let stretch = 1.0 + s.uniaxial.0 / s.geometry.length;
    let (strain, energy) = s.tissue.fibre(stretch);
    let volume = s.geometry.length * s.geometry.width * s.geometry.thickness;
    let density = 0.3 * s.uniaxial.0 * s.uniaxial.1 / volume;
    Some(match effect {
        "viscoelastic" => vec![("g", 0.15 * a), ("tau", between(random, 4.0, 25.0))],
        "mullins" => {
            vec![("a", (0.2 * a).min(0.6)), ("m", 0.15 * density), ("beta", between(random, 0.1, 0.3))]
        }
        "permanent_set" => vec![("a", 0.05 * a)],
        "fiber_recruitment" => vec![("onset", 0.12 * a * strain.max(0.005))],
        "fiber_damage" => {
            vec![
                ("a", (0.2 * a).min(0.6)),
                ("psi0", 0.15 * energy),
                ("scale", between(random, 0.3, 0.8) * energy),
            ]
        }
        "stiffness_drift" => vec![("c", sign * 0.06 * a / (s.duration.0 + s.duration.1))],
        _ => return None,
    })
}

fn interface(effect: &str, a: f64, sign: f64, s: &Sizes, random: &mut Random) -> Option<Parameters> {
    let (delta_c, sigma_c) = (s.tissue.delta_c(), s.tissue.mean_sigma_c());
    Some(match effect {
        "law_shape" => vec![("n", (sign * 0.15 * a).exp())],
        "bridging" => {
            vec![("sigma_b", 0.08 * a * sigma_c), ("delta_b", between(random, 2.5, 5.0) * delta_c)]
        }
        "rate_dependent_strength" => vec![("c", 0.03 * a), ("rate0", between(random, 1e-3, 4e-3))],
        "fatigue" => vec![("a", 0.2 * a)],
        "residual_opening" => vec![("a", (0.12 * a).min(0.6))],
        "heterogeneity" => vec![("a", sign * 0.15 * a), ("gc_share", 1.0)],
        _ => return None,
    })
}

fn rig(effect: &str, a: f64, sign: f64, s: &Sizes, random: &mut Random) -> Option<Parameters> {
    let low = s.uniaxial.1.min(s.tearing.1);
    Some(match effect {
        "compliance" => vec![("c", 0.06 * a * s.uniaxial.0 / s.uniaxial.1)],
        "grip_slip" => {
            let from = between(random, 0.3, 0.5) * low;
            vec![("a", 0.06 * a * s.uniaxial.0 / (s.tearing.1 - from)), ("fs", from)]
        }
        "slack" => vec![("u0", 0.05 * a * s.uniaxial.0), ("toe", between(random, 0.2, 0.5))],
        "misalignment" => vec![("theta", sign * (0.8 * a).to_radians())],
        "thickness_taper" => vec![("a", sign * 0.08 * a)],
        "cut_length" => vec![("da", sign * 0.1 * a)],
        "prestretch" => vec![("lambda0", 1.0 + 0.08 * a * s.uniaxial.0 / s.geometry.length)],
        "drift" => vec![("c", sign * 0.04 * a * s.uniaxial.1 / s.duration.0), ("b", 0.0)],
        "gain" => vec![("g", sign * 0.04 * a)],
        "lag" => vec![("tau", 0.5 * a)],
        "backlash" => vec![("b", 0.01 * a * s.tearing.0)],
        _ => return None,
    })
}
