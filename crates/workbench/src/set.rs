//! Configs with values of the user's choice.

use crate::BenchError;
use input::{Case, Mode};
use params::{Owner, ParamPath};
use serde::Deserialize;
use std::collections::BTreeMap;

/// What is changed of a model; paths as in answers, values in internal units (mm, N, s, MPa, rad).
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Change {
    /// Start values.
    pub values: BTreeMap<String, f64>,
    /// Whether parameters are held.
    pub fixed: BTreeMap<String, bool>,
    /// Elements along x, y, z.
    pub divisions: Option<[usize; 3]>,
    /// Number of areas along the path.
    pub areas: Option<usize>,
}

impl Change {
    /// The case with the change.
    ///
    /// # Errors
    /// If a path is none of the model's, or a number is none.
    pub fn on(&self, case: &Case) -> Result<Case, BenchError> {
        let mut out = case.clone();
        if let Some(areas) = self.areas {
            if !(1..=200).contains(&areas) {
                return Err(BenchError::Asked(format!("{areas} areas; expected 1 to 200")));
            }
            out.interface.areas = areas;
            out.interface.gc.truncate(1);
            out.interface.sigma_c.truncate(1);
        }
        if let Some(divisions) = self.divisions {
            if divisions.iter().any(|d| !(1..=400).contains(d)) {
                return Err(BenchError::Asked("divisions of the mesh: expected 1 to 400 each".into()));
            }
            out.mesh.divisions = Some(divisions);
        }
        for (path, value) in &self.values {
            if !value.is_finite() {
                return Err(BenchError::Asked(format!("{path}: {value} is no value")));
            }
        }
        analysis::start_at(&mut out, self.values.iter().map(|(p, v)| (p.as_str(), *v)));
        self.fixed.iter().try_for_each(|(path, fixed)| hold(&mut out, path, *fixed))?;
        Ok(out)
    }
}

/// Holds a parameter at its value, or frees it.
fn hold(case: &mut Case, path: &str, fixed: bool) -> Result<(), BenchError> {
    let unknown = || BenchError::Asked(format!("{}: no parameter of this model", input::visible(path)));
    let parsed: ParamPath = path.parse().map_err(|_| unknown())?;
    let areas = case.interface.areas;
    let value = match &parsed.owner {
        Owner::Bulk => case.bulk.parameters.entry(parsed.name).or_default(),
        Owner::Interface => case.interface.parameters.entry(parsed.name).or_default(),
        Owner::Area(at) => {
            let list = if parsed.name == "gc" { &mut case.interface.gc } else { &mut case.interface.sigma_c };
            let common = list.first().copied().unwrap_or_default();
            list.resize(areas.max(1), common);
            list.get_mut(at.wrapping_sub(1)).ok_or_else(unknown)?
        }
        Owner::Effect(effect) => {
            let effect = case.effects.iter_mut().find(|e| e.name == *effect).ok_or_else(unknown)?;
            effect.parameters.entry(parsed.name).or_default()
        }
    };
    value.fixed = Some(fixed);
    Ok(())
}

/// The case of one run at its start values, with derivatives: an identification that takes no step.
pub fn still(case: &Case) -> Case {
    let mut out = case.clone();
    (out.identify.max_iterations, out.identify.multi_start) = (0, 0);
    (out.identify.coarse_first, out.identify.mode) = (false, Mode::Joint);
    // Pictures of the strip are for runs that stay.
    out.output.fields = 0;
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "[geometry]\nlength_mm = 8.0\nwidth_mm = 6.0\nthickness_mm = 0.8\ncut_mm = 1.0\n[[tests]]\nkind = \"tearing\"\n\
        protocol = [{ to_mm = 1.0, rate_mm_per_s = 0.1 }]\n[interface]\nareas = 2\ngc_N_per_mm = 0.1\n[effects.viscoelastic]\ng = 0.1\n";

    #[test]
    fn a_change_is_what_the_written_file_says() -> Result<(), Box<dyn std::error::Error>> {
        let folder = tempfile::tempdir()?;
        let file = folder.path().join("a.toml");
        std::fs::write(&file, TEXT)?;
        let catalogue = effects::catalogue();
        let case = input::read_case(&file, &catalogue)?;
        let change: Change = serde_json::from_str(
            r#"{ "values": { "bulk.mu": 0.007, "interface.area[2].gc": 0.3, "effects.viscoelastic.g": 0.25 },
                 "fixed": { "bulk.mu": true, "interface.area[1].gc": true } }"#,
        )?;
        let back = folder.path().join("b.toml");
        std::fs::write(&back, input::resolved_toml(&still(&change.on(&case)?)))?;
        let read = input::read_case(&back, &catalogue)?;
        assert_eq!((read.bulk.value("mu").value, read.bulk.value("mu").fixed), (Some(0.007), Some(true)));
        assert_eq!([0, 1].map(|i| read.interface.gc_of(i).value), [Some(0.1), Some(0.3)]);
        assert_eq!([0, 1].map(|i| read.interface.gc_of(i).fixed == Some(true)), [true, false]);
        assert_eq!(read.effects[0].parameters["g"].value, Some(0.25));
        assert_eq!(read.identify.max_iterations, 0);
        let bad = Change { fixed: [("bulk".into(), true)].into(), ..Change::default() };
        assert!(bad.on(&case).is_err());
        let bad = Change { fixed: [("interface.area[9].gc".into(), true)].into(), ..Change::default() };
        assert!(bad.on(&case).is_err());
        assert!(Change { areas: Some(0), ..Change::default() }.on(&case).is_err());
        Ok(())
    }
}
