//! What a reader should know about the numbers: meshes too coarse, intervals that are mostly their error, steps too large.

use super::PathMean;
use super::TestFit;
use crate::terminal::significant;
use analysis::SimulatedTest;
use indexmap::IndexMap;
use input::{Case, Record, Test, Weight};
use params::Parameter;

/// Fewer elements than this in the softening zone make a force that wavers with the mesh (three at least: Turon et al.
/// 2007, 10.1016/j.engfracmech.2006.08.025).
const LEAST_ELEMENTS: f64 = 3.0;
/// Parameters that a remark names; the rest is counted.
const PARAMETERS_SHOWN: usize = 4;
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

/// What the mesh's own error does to intervals that are mostly made of it: they count it, to first order, and were seen
/// to hold the truth in 85 to 98 % of repeats (docs/reliability.md). `dominated`: the parameters.
pub fn mesh_dominated(dominated: &[String], tests: &IndexMap<String, TestFit>) -> Option<String> {
    if dominated.is_empty() {
        return None;
    }
    let (shown, rest) = dominated.split_at(dominated.len().min(PARAMETERS_SHOWN));
    let more = if rest.is_empty() { String::new() } else { format!(" and {} more", rest.len()) };
    let errors: Vec<String> = tests
        .iter()
        .map(|(name, t)| {
            let times = significant(t.numerical_error_N / t.noise_N, 2);
            format!("{name} {} N, {times} times the noise", significant(t.numerical_error_N, 2))
        })
        .collect();
    Some(format!(
        "The mesh's own error ({}) makes up most of the intervals of {}{more}. They count it to first order and may be too \
         narrow for that; a finer mesh makes it smaller.",
        errors.join("; "),
        shown.join(", ")
    ))
}

/// The toughness that each record of a tear shows by its energy alone, beside the mean of the identified ones.
pub fn by_energy(tests: &IndexMap<String, TestFit>, identified: Option<&PathMean>) -> Vec<String> {
    let beside = identified.map_or(String::new(), |gc| {
        format!(
            "; identified {} ± {} N/mm{}",
            significant(gc.value, 3),
            significant(gc.std_error, 2),
            if gc.areas > 1 { ", the mean over the areas" } else { "" }
        )
    });
    let told = |(name, t): (&String, &TestFit)| {
        let b = t.gc_by_energy.as_ref()?;
        let gc = significant(b.gc_N_per_mm, 3);
        Some(format!(
            "{name}: energy balance of the record, without finite elements: Gc = {gc} N/mm {}{beside}.",
            b.how
        ))
    };
    tests.iter().filter_map(told).collect()
}

/// What of the records counts less, more or not at all.
pub fn weighed(case: &Case) -> Vec<String> {
    let of = |t: &Test| -> Vec<String> {
        let rows = |w: &Weight| {
            let times = t.record.iter().flat_map(|r| &r.time);
            times.filter(|at| (w.from_s..=w.to_s).contains(*at)).count()
        };
        let all = t.record.as_ref().map_or(0, Record::len);
        let told = |w: &Weight| match w.weight {
            0.0 => "left out of the fit".to_owned(),
            by => format!("counted {} times", significant(by, 3)),
        };
        let line = |w: &Weight| {
            let [from, to] = [w.from_s, w.to_s].map(|s| significant(s, 4));
            format!("{}: {from} s to {to} s {} ({} of {all} points).", t.name, told(w), rows(w))
        };
        t.weights.iter().map(line).collect()
    };
    case.tests.iter().flat_map(of).collect()
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
    fn intervals_that_are_mostly_the_mesh_s_error_are_told() {
        let fit = TestFit {
            rms_N: 0.01,
            noise_N: 0.01,
            reduced_chi2: 1.0,
            reduced_chi2_total: 1.0,
            objective: 0.0,
            points: 100,
            numerical_error_N: 0.022,
            peak_N: 1.0,
            energy: None,
            gc_by_energy: None,
        };
        let tests = IndexMap::from([("tearing".into(), fit)]);
        assert_eq!(mesh_dominated(&[], &tests), None);
        let dominated: Vec<String> = (1..=6).map(|i| format!("interface.area[{i}].gc")).collect();
        let told = mesh_dominated(&dominated, &tests).expect("a remark");
        assert!(told.contains("(tearing 0.022 N, 2.2 times the noise)"), "{told}");
        assert!(told.contains("interface.area[4].gc and 2 more. "), "{told}");
        assert!(
            mesh_dominated(&dominated[..1], &tests).expect("a remark").contains("of interface.area[1].gc. ")
        );
    }
}
