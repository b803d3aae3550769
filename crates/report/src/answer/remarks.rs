//! What a reader should know about the numbers: meshes too coarse, their error above the noise, steps too large.

use super::identify::TestFit;
use crate::terminal::significant;
use analysis::SimulatedTest;
use indexmap::IndexMap;
use params::Parameter;

/// Fewer elements than this in the softening zone make a force that wavers with the mesh (three at least: Turon et al.
/// 2007, 10.1016/j.engfracmech.2006.08.025).
const LEAST_ELEMENTS: f64 = 3.0;
/// A larger gap of the energy ledger, as a share of the external work, is too large.
const LARGEST_GAP: f64 = 1e-3;

/// What is held because its given value is a limit at which no search can start; `None`: nothing.
pub fn held_at_limits(parameters: &[Parameter]) -> Option<String> {
    let held: Vec<String> = parameters
        .iter()
        .filter(|p| p.held_at_limit)
        .map(|p| {
            let unit = p.spec.quantity.suffixes().first().map_or("", |s| s.name);
            format!("{} = {} {unit}", p.path, significant(p.spec.in_file_unit(p.value), 4))
                .trim_end()
                .to_owned()
        })
        .collect();
    (!held.is_empty()).then(|| {
        format!("Held at the limit that the file gives: {}; `fixed = false` frees it.", held.join(", "))
    })
}

/// What the mesh's own error does to a fit, where it is larger than the noise: intervals count it, with one pattern per
/// test, and where it leads they were seen to hold the truth in 85 to 88 % of repeats (docs/reliability.md).
pub fn mesh_errors(tests: &IndexMap<String, TestFit>) -> Vec<String> {
    let large = tests.iter().filter(|(_, t)| t.numerical_error_N > t.noise_N);
    large
        .map(|(name, t)| {
            format!(
                "{name}: the mesh's own error ({} N) is {} times the noise. Intervals count it, but may be too narrow \
                 where it leads; a finer mesh makes it smaller.",
                significant(t.numerical_error_N, 2),
                significant(t.numerical_error_N / t.noise_N, 2)
            )
        })
        .collect()
}

/// Remarks on finished runs.
pub fn remarks(tests: &[SimulatedTest]) -> Vec<String> {
    let mesh = tests.iter().filter_map(|t| {
        let n = t.softening_elements.filter(|n| *n < LEAST_ELEMENTS)?;
        Some(format!(
            "{}: the mesh is too coarse for this tear. Its softening zone spans {} elements of the path where it is \
             shortest, fewer than {LEAST_ELEMENTS:.0}; path elements {} times smaller would resolve it (`path_size_mm`).",
            t.name,
            significant(n, 2),
            significant((LEAST_ELEMENTS / n).min(1e3), 2)
        ))
    });
    let steps = tests.iter().filter(|t| t.closure > LARGEST_GAP).map(|t| {
        format!(
            "{}: the steps are too large. The energies do not close by {:.2} % of the external work; smaller steps would \
             (`step_mm`).",
            t.name,
            100.0 * t.closure
        )
    });
    mesh.chain(steps).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mesh_error_above_the_noise_is_told() {
        let fit = |noise: f64, error: f64| TestFit {
            rms_N: noise,
            noise_N: noise,
            reduced_chi2: 1.0,
            reduced_chi2_total: 1.0,
            objective: 0.0,
            points: 100,
            numerical_error_N: error,
            peak_N: 1.0,
            energy: None,
        };
        let tests =
            IndexMap::from([("uniaxial".into(), fit(0.01, 0.009)), ("tearing".into(), fit(0.01, 0.022))]);
        let told = mesh_errors(&tests);
        assert_eq!(told.len(), 1, "{told:?}");
        assert!(
            told[0].starts_with("tearing: ") && told[0].contains("0.022 N) is 2.2 times the noise"),
            "{told:?}"
        );
    }
}
