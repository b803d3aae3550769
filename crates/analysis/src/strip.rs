//! Tissues that explain a uniaxial record roughly, found without finite elements.
//!
//! A free strip of incompressible tissue under tension is one equation (the width's stretch) in one
//! unknown: thousands of tissues are tried in the time of one finite-element run. The clamps, which
//! stiffen a short strip, and whatever effect the tissue hides are left out: the answers are starts.

use crate::priors::{self, Belief};
use constitutive::{Context, Law, PointLaw, StartGrid};
use input::Case;
use inverse::Free;
use model::Model;
use rayon::prelude::*;

/// Points of the record that are compared.
const POINTS: usize = 30;
/// Noise of the comparison, as a share of the largest force.
const NOISE: f64 = 0.05;
/// Starts handed on.
const STARTS: usize = 3;

/// Parameters of the bulk law, by index as in θ: those of the grid that its law offers.
struct Grid<'a> {
    law: &'a dyn PointLaw<9>,
    offered: &'a StartGrid,
    /// What is free, with priors, by index of the parameter: the grid's range.
    free: Vec<Option<Free>>,
    /// The same as the search has it: what scaling may reach.
    limits: Vec<Option<Free>>,
}

/// θ at the best few tissues of the grid that the bulk law offers, the best first, apart from each other where the law
/// says that one curve has several optima. Parameters that `free_parameters` does not hold keep their value in `theta`. Empty
/// without a uniaxial record.
pub(crate) fn tissues(
    model: &Model,
    (case, belief): (&Case, Belief),
    free_parameters: &[Free],
    theta: &[f64],
) -> Vec<Vec<f64>> {
    let record = points(case);
    let Some(offered) = model.starts().filter(|_| !record.is_empty()) else { return Vec::new() };
    let by = |belief: Belief| {
        let mut list = free_parameters.to_vec();
        priors::add(&mut list, case, belief);
        let of = |i: usize| list.iter().find(|f| f.path == model.parameters[i].path).cloned();
        (0..offered.template.len()).map(of).collect()
    };
    let range = if belief == Belief::Start { Belief::Literature } else { belief };
    let grid = Grid { law: &**model.bulk_law(), offered: &offered, free: by(range), limits: by(belief) };
    let mut found: Vec<(f64, Vec<f64>)> =
        grid.points(theta).into_par_iter().filter_map(|tissue| grid.rate(tissue, &record)).collect();
    found.sort_by(|a, b| a.0.total_cmp(&b.0));
    let apart = |k: &Vec<f64>, t: &Vec<f64>| offered.apart.is_some_and(|(i, by)| (k[i] - t[i]).abs() > by);
    let mut kept: Vec<Vec<f64>> = Vec::new();
    for (_, tissue) in found {
        if kept.len() < STARTS && kept.iter().all(|k| apart(k, &tissue)) {
            kept.push(tissue);
        }
    }
    let in_theta = |tissue: Vec<f64>| {
        let mut all = theta.to_vec();
        offered.axes.iter().for_each(|&(i, _)| all[i] = tissue[i]);
        all
    };
    kept.into_iter().map(in_theta).collect()
}

/// (stretch, nominal stress in MPa) of the first uniaxial record, thinned.
fn points(case: &Case) -> Vec<(f64, f64)> {
    let g = &case.geometry;
    let uniaxial = |t: &&input::Test| t.kind.free_strip;
    let Some((test, record)) = case.tests.iter().filter(uniaxial).find_map(|t| Some((t, t.record.as_ref()?)))
    else {
        return Vec::new();
    };
    let n = record.force.len();
    let (u0, every) = (record.displacement[0], n.div_ceil(POINTS).max(1));
    (0..n)
        .step_by(every)
        .filter(|&i| test.weight_at(record.time[i]) > 0.0)
        .map(|i| (1.0 + (record.displacement[i] - u0) / g.length, record.force[i] / (g.width * g.thickness)))
        .filter(|p| p.0 > 1.0)
        .collect()
}

impl Grid<'_> {
    /// Every tissue of the grid; what is scaled to the record runs in proportion.
    fn points(&self, theta: &[f64]) -> Vec<Vec<f64>> {
        let mut all = vec![self.offered.template.clone()];
        for &(at, count) in &self.offered.axes {
            let axis: Vec<f64> = match &self.free[at] {
                None => vec![theta[at]],
                Some(f) => {
                    let (lo, hi) = f.bounds_z();
                    let inside = |k: usize| lo + (hi - lo) * (k as f64 + 0.5) / count as f64;
                    (0..count).map(|k| f.backward(inside(k))).collect()
                }
            };
            let with = |t: &Vec<f64>, v: f64| {
                let mut t = t.clone();
                t[at] = v;
                t
            };
            all = all.iter().flat_map(|t| axis.iter().map(|&v| with(t, v)).collect::<Vec<_>>()).collect();
        }
        all
    }

    /// Misfit of a tissue, after its stiffness was scaled as well as the bounds allow, with the priors.
    fn rate(&self, mut tissue: Vec<f64>, record: &[(f64, f64)]) -> Option<(f64, Vec<f64>)> {
        let model: Vec<f64> = record.iter().map(|p| nominal_stress(self.law, &tissue, p.0)).collect();
        let (mut up, mut down, mut largest) = (0.0, 0.0, 0.0f64);
        for (m, (_, s)) in model.iter().zip(record) {
            (up, down, largest) = (up + m * s, down + m * m, largest.max(s.abs()));
        }
        let mut scale = if up > 0.0 && down > 0.0 { up / down } else { return None };
        for &at in &self.offered.scaled {
            match &self.limits[at] {
                Some(f) => scale = scale.clamp(f.lower / tissue[at], f.upper / tissue[at]),
                None => scale = 1.0,
            }
        }
        self.offered.scaled.iter().for_each(|&at| tissue[at] *= scale);
        let sd = NOISE * largest;
        let misfit: f64 = model.iter().zip(record).map(|(m, (_, s))| ((scale * m - s) / sd).powi(2)).sum();
        let priors: f64 = self
            .offered
            .axes
            .iter()
            .filter_map(|&(at, _)| {
                let f = self.free[at].as_ref()?;
                let prior = f.prior?;
                Some(((f.transform.forward(tissue[at]) - prior.mean) / prior.sd).powi(2))
            })
            .sum();
        let total = misfit + priors;
        total.is_finite().then_some((total, tissue))
    }
}

/// First Piola stress along the load of a free incompressible strip, MPa.
fn nominal_stress(law: &dyn PointLaw<9>, tissue: &[f64], stretch: f64) -> f64 {
    // d(energy)/d(width stretch) and the stress along the load at constant volume.
    let at = |x: f64| {
        let z = 1.0 / (x * stretch);
        let f = [x, 0.0, 0.0, 0.0, stretch, 0.0, 0.0, 0.0, z];
        let s = Law::<f64, 9>::respond(law, &Context::default(), &f, tissue, &[], &mut []).force;
        (s[0] - s[8] * z / x, s[4] - s[8] * z / stretch)
    };
    let (mut low, mut high) = (0.2 / stretch, 2.0);
    for _ in 0..22 {
        let middle = 0.5 * (low + high);
        if at(middle).0 > 0.0 { high = middle } else { low = middle }
    }
    at(0.5 * (low + high)).1
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ladder::tests::unloaded;
    use model::Discretisation;
    use std::sync::Arc;

    /// Start values are no part of the grid: those that are wrong by any factor lead to the tissues that none lead to.
    #[test]
    fn tissues_owe_nothing_to_what_the_file_gives() {
        let catalogue = effects::catalogue();
        let mut case = unloaded(&catalogue);
        case.tests[0].kind =
            input::TestKind::new(catalogue.experiments().get("uniaxial").expect("one").card());
        // As soft as the literature's tissues are: no bound hinders scaling.
        if let Some(r) = &mut case.tests[0].record {
            r.force.iter_mut().for_each(|f| *f *= 0.05);
        }
        let given = |values: &[(&str, f64)]| {
            let mut case = case.clone();
            ["mu", "k1", "k2", "gamma", "kappa"]
                .iter()
                .for_each(|n| case.bulk.parameters.entry((*n).into()).or_default().value = None);
            values.iter().for_each(|(name, v)| case.bulk.start(name, *v));
            let model =
                Model::new(Arc::new(case.clone()), &catalogue, Discretisation::default()).expect("a model");
            let bulk = model.free_on(model::Site::Bulk);
            let free = crate::identify::free_parameters(&model, &model.theta(), &bulk);
            let found = tissues(&model, (&case, Belief::Start), &free, &model.theta());
            assert!(!found.is_empty());
            found.into_iter().map(|t| bulk.iter().map(|&i| t[i]).collect()).collect::<Vec<Vec<f64>>>()
        };
        let none = given(&[]);
        for times in [30.0, 1.0 / 30.0] {
            assert_eq!(given(&[("mu", 0.01 * times), ("k1", 0.5 * times), ("k2", 5.0 * times)]), none);
        }
    }
}
