//! Opening, damage and strength along the tear path at converged steps.

use super::vtu::{Cells, Grid};
use fem::{Problem, gather4, interface};

/// The tear path's two faces with what the interface elements say; `None` for an intact strip.
pub fn grid(problem: &Problem, theta: &[f64], u: &[f64], history: &[f64]) -> Option<Grid> {
    let path = problem.path.as_ref()?;
    let params = problem.local(theta).path;
    let entries = problem.path_history();
    let cohesion = path.law.offers().cohesion;
    let body = &problem.body;
    let mut grid = Grid { shape: Cells::Quads, ..Grid::default() };
    let (mut displacement, mut opening, mut damage, mut strength, mut x) =
        (Vec::new(), Vec::new(), Vec::new(), Vec::new(), Vec::new());
    for (e, element) in body.cohesive.iter().enumerate() {
        let nodes = element.lower.map(|n| body.nodes[n]);
        let near = gather4(u, &element.lower);
        let mirrored = near.map(|v| [v[0], -v[1], v[2]]);
        let (lower, upper) = match &element.upper {
            Some(upper) => (near, gather4(u, upper)),
            None => (mirrored, near),
        };
        let at_points = interface::openings(&nodes, &lower, &upper, path.rule);
        let area: f64 = at_points.iter().map(|p| p.1).sum();
        let mean =
            |value: &dyn Fn(usize) -> f64| (0..4).map(|q| at_points[q].1 * value(q)).sum::<f64>() / area;
        // The base law's memory comes first whatever decorates it: δ_max.
        let d = |q: usize| {
            let largest = history.get((e * interface::POINTS + q) * entries + cohesive::DELTA_MAX).copied();
            cohesion.as_ref().map_or(0.0, |c| c.damage(largest.unwrap_or(0.0), &params[e][q]))
        };
        let local = |q: usize| {
            let o = at_points[q].0;
            [o[0], o[1], o[2]]
        };
        for face in [&lower, &upper] {
            let base = grid.points.len();
            grid.points.extend(nodes);
            displacement.extend(face.iter().flatten());
            grid.cells.push((base..base + 4).collect());
            for c in 0..3 {
                opening.push(mean(&|q| local(q)[c]));
            }
            damage.push(mean(&d));
            strength.push(mean(&|q| params[e][q][cohesive::SIGMA_C]));
            x.push(0.25 * nodes.iter().map(|n| n[0]).sum::<f64>());
        }
    }
    grid.point_data = vec![("displacement", 3, displacement)];
    grid.cell_data = vec![("opening", 3, opening), ("d", 1, damage), ("sigma_c", 1, strength), ("x", 1, x)];
    Some(grid)
}
