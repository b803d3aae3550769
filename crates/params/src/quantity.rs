//! What a number measures, in which unit it is kept, and which units a file may use.

use serde::{Deserialize, Serialize};

/// A unit that may stand at the end of a key: `mu_kPa` has the suffix `kPa`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Suffix {
    /// The unit as it is written in a key, without the leading underscore.
    pub name: &'static str,
    /// Multiply a number in this unit by `factor` to get the internal unit.
    pub factor: f64,
}

const fn suffix(name: &'static str, factor: f64) -> Suffix {
    Suffix { name, factor }
}

/// The physical kind of a number; fixes the internal unit (mm, s, N, MPa, rad).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Quantity {
    /// A pure number.
    Dimensionless,
    /// Length, mm.
    Length,
    /// Force, N.
    Force,
    /// Time, s.
    Time,
    /// Stress, MPa = N/mm².
    Stress,
    /// Inverse stress, 1/MPa (the paper's D).
    InverseStress,
    /// Angle, rad.
    Angle,
    /// Energy per area, N/mm (fracture energy Gc).
    FractureEnergy,
    /// Energy per volume, MPa (= N·mm/mm³).
    EnergyDensity,
    /// Traction per opening, N/mm³.
    InterfaceStiffness,
    /// Speed, mm/s.
    Speed,
    /// Rate, 1/s.
    Rate,
    /// Force per time, N/s.
    ForceRate,
    /// Compliance, mm/N.
    Compliance,
    /// Mass density, g/cm³ (kept in g/cm³: 1 g/cm³ = 1e-9 t/mm³ in the mm, s, N system).
    Density,
}

impl Quantity {
    /// All of them.
    pub const ALL: [Self; 15] = [
        Self::Dimensionless,
        Self::Length,
        Self::Force,
        Self::Time,
        Self::Stress,
        Self::InverseStress,
        Self::Angle,
        Self::FractureEnergy,
        Self::EnergyDensity,
        Self::InterfaceStiffness,
        Self::Speed,
        Self::Rate,
        Self::ForceRate,
        Self::Compliance,
        Self::Density,
    ];

    /// The internal unit, as written in answers; empty for a pure number.
    pub const fn unit(self) -> &'static str {
        match self {
            Self::Dimensionless => "",
            Self::Length => "mm",
            Self::Force => "N",
            Self::Time => "s",
            Self::Stress => "MPa",
            Self::InverseStress => "1/MPa",
            Self::Angle => "rad",
            Self::FractureEnergy => "N/mm",
            Self::EnergyDensity => "MPa",
            Self::InterfaceStiffness => "N/mm3",
            Self::Speed => "mm/s",
            Self::Rate => "1/s",
            Self::ForceRate => "N/s",
            Self::Compliance => "mm/N",
            Self::Density => "g/cm3",
        }
    }

    /// Accepted key suffixes, the preferred one (used when a file is written) first.
    /// Empty for a pure number, whose key carries no suffix.
    pub const fn suffixes(self) -> &'static [Suffix] {
        const LENGTH: [Suffix; 4] =
            [suffix("mm", 1.0), suffix("um", 1e-3), suffix("cm", 10.0), suffix("m", 1e3)];
        const FORCE: [Suffix; 4] =
            [suffix("N", 1.0), suffix("mN", 1e-3), suffix("uN", 1e-6), suffix("kN", 1e3)];
        const TIME: [Suffix; 4] =
            [suffix("s", 1.0), suffix("ms", 1e-3), suffix("min", 60.0), suffix("h", 3600.0)];
        const STRESS: [Suffix; 4] =
            [suffix("kPa", 1e-3), suffix("MPa", 1.0), suffix("Pa", 1e-6), suffix("GPa", 1e3)];
        const INVERSE_STRESS: [Suffix; 3] =
            [suffix("per_MPa", 1.0), suffix("per_kPa", 1e3), suffix("per_Pa", 1e6)];
        const ANGLE: [Suffix; 2] = [suffix("deg", std::f64::consts::PI / 180.0), suffix("rad", 1.0)];
        const FRACTURE: [Suffix; 3] =
            [suffix("N_per_mm", 1.0), suffix("J_per_m2", 1e-3), suffix("mJ_per_mm2", 1.0)];
        const STIFFNESS: [Suffix; 2] = [suffix("N_per_mm3", 1.0), suffix("MPa_per_mm", 1.0)];
        const SPEED: [Suffix; 3] =
            [suffix("mm_per_s", 1.0), suffix("um_per_s", 1e-3), suffix("mm_per_min", 1.0 / 60.0)];
        const RATE: [Suffix; 2] = [suffix("per_s", 1.0), suffix("per_min", 1.0 / 60.0)];
        const FORCE_RATE: [Suffix; 2] = [suffix("N_per_s", 1.0), suffix("mN_per_s", 1e-3)];
        const COMPLIANCE: [Suffix; 2] = [suffix("mm_per_N", 1.0), suffix("um_per_N", 1e-3)];
        const DENSITY: [Suffix; 2] = [suffix("g_per_cm3", 1.0), suffix("kg_per_m3", 1e-3)];
        match self {
            Self::Dimensionless => &[],
            Self::Length => &LENGTH,
            Self::Force => &FORCE,
            Self::Time => &TIME,
            Self::Stress | Self::EnergyDensity => &STRESS,
            Self::InverseStress => &INVERSE_STRESS,
            Self::Angle => &ANGLE,
            Self::FractureEnergy => &FRACTURE,
            Self::InterfaceStiffness => &STIFFNESS,
            Self::Speed => &SPEED,
            Self::Rate => &RATE,
            Self::ForceRate => &FORCE_RATE,
            Self::Compliance => &COMPLIANCE,
            Self::Density => &DENSITY,
        }
    }

    /// `name` with the preferred suffix: `mu` → `mu_kPa`, `k2` → `k2`.
    pub fn key(self, name: &str) -> String {
        match self.suffixes().first() {
            Some(s) => format!("{name}_{}", s.name),
            None => name.to_owned(),
        }
    }

    /// If `key` is `name` with one of the accepted suffixes, that suffix.
    /// A pure number matches its bare name with factor 1.
    pub fn parse_key(self, name: &str, key: &str) -> Option<Suffix> {
        if self.suffixes().is_empty() {
            return (key == name).then_some(suffix("", 1.0));
        }
        let unit = key.strip_prefix(name)?.strip_prefix('_')?;
        self.suffixes().iter().copied().find(|s| s.name == unit)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn preferred_suffix_round_trips() {
        for q in [Quantity::Stress, Quantity::Angle, Quantity::Dimensionless, Quantity::FractureEnergy] {
            let key = q.key("x");
            assert!(q.parse_key("x", &key).is_some(), "{key}");
        }
    }

    #[test]
    fn factors_bring_file_units_to_internal_units() {
        assert_eq!(Quantity::Stress.parse_key("mu", "mu_kPa").unwrap().factor, 1e-3);
        assert_eq!(Quantity::FractureEnergy.parse_key("gc", "gc_J_per_m2").unwrap().factor, 1e-3);
        assert!(Quantity::Stress.parse_key("mu", "mu_mm").is_none());
        assert!(Quantity::Stress.parse_key("mu", "mu").is_none());
    }
}
