//! Tissues that explain a uniaxial record roughly, found without finite elements.
//!
//! A free strip of incompressible tissue under tension is one equation (the width's stretch) in one
//! unknown: thousands of tissues are tried in the time of one finite-element run. The clamps, which
//! stiffen a short strip, and whatever effect the tissue hides are left out: the answers are starts.

use crate::priors;
use constitutive::{Context, Law};
use hgo::{GAMMA, Hgo, K1, K2, KAPPA, MU, PARAMETERS};
use input::{Case, TestKind};
use inverse::Free;
use rayon::prelude::*;

/// Points of the record that are compared.
const POINTS: usize = 30;
/// Noise of the comparison, as a share of the largest force.
const NOISE: f64 = 0.05;
/// Starts handed on.
const STARTS: usize = 3;
/// Fibre angles closer than this are the same start, rad.
const APART: f64 = 0.10;

/// Values of (μ, k1, k2, γ, κ): the best few of a grid, the best first, with distinct fibre angles.
/// Parameters that `frees` does not hold keep their value in `given`. Empty without a uniaxial record.
pub(crate) fn tissues(case: &Case, frees: &[Free], given: [f64; 5]) -> Vec<[f64; 5]> {
    let record = points(case);
    if record.is_empty() {
        return Vec::new();
    }
    let law = Hgo {
        tension_only: case.bulk.tension_only,
        fibre_invariants: match case.bulk.fibre_invariants {
            input::FibreInvariants::Isochoric => hgo::FibreInvariants::Isochoric,
            input::FibreInvariants::Full => hgo::FibreInvariants::Full,
        },
    };
    let mut list = frees.to_vec();
    priors::add(&mut list, case, true);
    let axes = axes(&list, given);
    let mut found: Vec<(f64, [f64; 5])> =
        grid(&axes).into_par_iter().filter_map(|tissue| rate(law, tissue, &record, &list)).collect();
    found.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut kept: Vec<[f64; 5]> = Vec::new();
    for (_, tissue) in found {
        if kept.len() < STARTS && kept.iter().all(|k| (k[GAMMA] - tissue[GAMMA]).abs() > APART) {
            kept.push(tissue);
        }
    }
    kept
}

/// (stretch, nominal stress in MPa) of the first uniaxial record, thinned.
fn points(case: &Case) -> Vec<(f64, f64)> {
    let g = &case.geometry;
    let uniaxial = |t: &&input::Test| t.kind == TestKind::Uniaxial;
    let Some(record) = case.tests.iter().filter(uniaxial).find_map(|t| t.record.as_ref()) else {
        return Vec::new();
    };
    let n = record.force.len();
    let (u0, every) = (record.displacement[0], n.div_ceil(POINTS).max(1));
    (0..n)
        .step_by(every)
        .map(|i| (1.0 + (record.displacement[i] - u0) / g.length, record.force[i] / (g.width * g.thickness)))
        .filter(|p| p.0 > 1.0)
        .collect()
}

/// Grid values of each parameter; k1 is scaled afterwards, μ runs in proportion to it.
fn axes(list: &[Free], given: [f64; 5]) -> [Vec<f64>; 5] {
    let axis = |path: &str, at: usize, count: usize| match list.iter().find(|f| f.path == path) {
        None => vec![given[at]],
        Some(f) => {
            let (lo, hi) = f.bounds_z();
            let inside = |k: usize| lo + (hi - lo) * (k as f64 + 0.5) / count as f64;
            (0..count).map(|k| f.backward(inside(k))).collect()
        }
    };
    [
        axis("bulk.mu", MU, 5),
        axis("bulk.k1", K1, 3),
        axis("bulk.k2", K2, 6),
        axis("bulk.gamma", GAMMA, 14),
        axis("bulk.kappa", KAPPA, 6),
    ]
}

fn grid(axes: &[Vec<f64>; 5]) -> Vec<[f64; 5]> {
    let mut all = vec![[0.0; 5]];
    for (at, axis) in axes.iter().enumerate() {
        all = all
            .into_iter()
            .flat_map(|t| {
                axis.iter().map(move |&v| {
                    let mut t = t;
                    t[at] = v;
                    t
                })
            })
            .collect();
    }
    all
}

/// Misfit of a tissue, after its stiffness was scaled as well as the bounds allow, with the priors.
fn rate(law: Hgo, mut tissue: [f64; 5], record: &[(f64, f64)], list: &[Free]) -> Option<(f64, [f64; 5])> {
    let model: Vec<f64> = record.iter().map(|p| nominal_stress(law, &tissue, p.0)).collect();
    let (mut up, mut down, mut largest) = (0.0, 0.0, 0.0f64);
    for (m, (_, s)) in model.iter().zip(record) {
        (up, down, largest) = (up + m * s, down + m * m, largest.max(s.abs()));
    }
    let free = |path: &str| list.iter().find(|f| f.path == path);
    let mut scale = if up > 0.0 && down > 0.0 { up / down } else { return None };
    for (path, at) in [("bulk.mu", MU), ("bulk.k1", K1)] {
        match free(path) {
            Some(f) => scale = scale.clamp(f.lower / tissue[at], f.upper / tissue[at]),
            None => scale = 1.0,
        }
    }
    (tissue[MU], tissue[K1]) = (scale * tissue[MU], scale * tissue[K1]);
    let sd = NOISE * largest;
    let misfit: f64 = model.iter().zip(record).map(|(m, (_, s))| ((scale * m - s) / sd).powi(2)).sum();
    let priors: f64 = list
        .iter()
        .filter_map(|f| {
            let at = ["bulk.mu", "bulk.k1", "bulk.k2", "bulk.gamma", "bulk.kappa"]
                .iter()
                .position(|p| *p == f.path)?;
            let prior = f.prior?;
            Some(((f.transform.forward(tissue[at]) - prior.mean) / prior.sd).powi(2))
        })
        .sum();
    let total = misfit + priors;
    total.is_finite().then_some((total, tissue))
}

/// First Piola stress along the load of a free incompressible strip, MPa.
fn nominal_stress(law: Hgo, tissue: &[f64; 5], stretch: f64) -> f64 {
    let mut p = [0.0; PARAMETERS];
    (p[MU], p[K1], p[K2], p[GAMMA], p[KAPPA]) =
        (tissue[MU], tissue[K1], tissue[K2], tissue[GAMMA], tissue[KAPPA]);
    p[hgo::D] = 1.0;
    // d(energy)/d(width stretch) and the stress along the load at constant volume.
    let at = |x: f64| {
        let z = 1.0 / (x * stretch);
        let f = [x, 0.0, 0.0, 0.0, stretch, 0.0, 0.0, 0.0, z];
        let s = Law::<f64, 9>::respond(&law, &Context::default(), &f, &p, &[], &mut []).force;
        (s[0] - s[8] * z / x, s[4] - s[8] * z / stretch)
    };
    let (mut low, mut high) = (0.2 / stretch, 2.0);
    for _ in 0..22 {
        let middle = 0.5 * (low + high);
        if at(middle).0 > 0.0 { high = middle } else { low = middle }
    }
    at(0.5 * (low + high)).1
}
