//! By what opening of the tear path a step along the equilibrium path is measured.
//!
//! The mean over the whole path serves where a good part of it takes part. In a long arm the front is a
//! short piece of a long path: there the mean says hardly anything, the plane of actuator displacement and opening
//! shrinks to a line, and a sharp limit point looks like a way back. The opening of the zone that softens
//! grows wherever the tear grows, and falls wherever the path is unloaded: local control, May & Duan 1997,
//! doi:10.1016/S0045-7949(96)00178-1; Alfano & Crisfield 2003, doi:10.1002/nme.746.

use crate::interface;
use crate::problem::{LocalParams, Path, Problem};
use crate::state::{State, gather4};
use crate::system::NONE;
use constitutive::Context;

/// Weights of a unit normal opening (reference direction y): (equation, weight).
pub type Weights = Vec<(usize, f64)>;

/// How much further a point is opened to see whether its traction falls.
const FURTHER: f64 = 1e-3;

/// The mean opening of the path.
pub fn mean(problem: &Problem, equation: &[usize]) -> Weights {
    let zero = [[0.0; 3]; 4];
    let weight = |e: usize| {
        let x = problem.body.cohesive[e].lower.map(|n| problem.body.nodes[n]);
        let area: f64 =
            interface::openings(&x, &zero, &zero, interface::Integration::Gauss).iter().map(|o| o.1).sum();
        [0.25 * area; 4]
    };
    weighted(problem, equation, weight)
}

/// The opening of the points that soften at a state; `None` where none does.
///
/// Weighted by the square of the slope: the steep fall at the front outweighs the long wake of a bridged tear, which
/// closes while the front advances.
pub fn of_softening(
    problem: &Problem,
    local: &LocalParams<f64>,
    ctx: &Context,
    state: &State,
    equation: &[usize],
) -> Option<Weights> {
    let path = problem.path.as_ref()?;
    let nodes = |e: usize| {
        let slopes = slopes(problem, path, local, ctx, state, e);
        let mut nodes = [0.0; 4];
        for (q, (slope, area)) in slopes.into_iter().enumerate() {
            for (n, share) in nodes.iter_mut().zip(interface::shares(q, path.rule.sampling)) {
                *n += share * area * slope * slope;
            }
        }
        nodes
    };
    let weights = weighted(problem, equation, nodes);
    (!weights.is_empty()).then_some(weights)
}

/// How steeply the normal traction of each point of an interface element falls as it opens on, MPa/mm, and its area, mm².
fn slopes(
    problem: &Problem,
    path: &Path,
    local: &LocalParams<f64>,
    ctx: &Context,
    state: &State,
    e: usize,
) -> [(f64, f64); interface::POINTS] {
    let el = &problem.body.cohesive[e];
    let x = el.lower.map(|n| problem.body.nodes[n]);
    let lower = gather4(&state.u, &el.lower);
    let upper = match &el.upper {
        Some(upper) => gather4(&state.u, upper),
        None => lower,
    };
    // A mirrored half opens by twice its own displacement, and does not slide.
    let lower = if el.upper.is_some() { lower } else { lower.map(|u| [u[0], -u[1], u[2]]) };
    let openings = interface::openings(&x, &lower, &upper, path.rule);
    let contexts = problem.path_context(ctx, e);
    let nh = problem.path_history();
    std::array::from_fn(|q| {
        let (opening, area) = openings[q];
        let old = &state.history.path[(e * interface::POINTS + q) * nh..][..nh];
        let traction = |times: f64| -> f64 {
            let further = opening.map(|d| times * d);
            path.law.respond(&contexts[q], &further, &local.path[e][q], old, &mut old.to_vec()).force[0]
        };
        let fall = || (traction(1.0) - traction(1.0 + FURTHER)) / (FURTHER * opening[0]);
        (if opening[0] > 0.0 { fall().max(0.0) } else { 0.0 }, area)
    })
}

/// The opening averaged with weights for the nodes of each element.
fn weighted(problem: &Problem, equation: &[usize], weight: impl Fn(usize) -> [f64; 4]) -> Weights {
    let mut weights = std::collections::BTreeMap::new();
    let mut total = 0.0;
    for (e, el) in problem.body.cohesive.iter().enumerate() {
        for (a, w) in weight(e).into_iter().enumerate().filter(|(_, w)| *w != 0.0) {
            total += w;
            match &el.upper {
                None => *weights.entry(3 * el.lower[a] + 1).or_insert(0.0) += 2.0 * w,
                Some(upper) => {
                    *weights.entry(3 * el.lower[a] + 1).or_insert(0.0) -= w;
                    *weights.entry(3 * upper[a] + 1).or_insert(0.0) += w;
                }
            }
        }
    }
    weights
        .into_iter()
        .filter(|&(dof, _)| equation[dof] != NONE)
        .map(|(dof, w): (usize, f64)| (equation[dof], w / total))
        .collect()
}
