//! Stress and stretch of the strip at converged steps.

use super::vtu::{Cells, Grid};
use constitutive::{Context, Law};
use fem::hex8::{self, Geometry};
use fem::{Problem, StepRecord, gather8};
use mesh::Mesh;
use nalgebra::{Matrix3, SymmetricEigen};

/// Means over one brick.
#[derive(Clone, Copy, Debug, Default)]
pub struct CellState {
    /// Cauchy stress xx, yy, zz, xy, yz, xz (VTK's order), MPa.
    pub stress: [f64; 6],
    /// Largest principal stretch.
    pub stretch: f64,
    /// Volume ratio.
    pub jacobian: f64,
}

/// The strip's memory while a run is gone through again.
pub struct Strip<'a> {
    problem: &'a Problem,
    params: Vec<f64>,
    geometry: Vec<Geometry<f64>>,
    history: Vec<f64>,
    time: Option<f64>,
    rest: Option<f64>,
}

impl<'a> Strip<'a> {
    /// At the start of a test; `rest`: time since the test before, s.
    pub fn new(problem: &'a Problem, theta: &[f64], history: Vec<f64>, rest: Option<f64>) -> Self {
        let nodes = &problem.body.nodes;
        let geometry = problem.body.hexes.iter().map(|h| hex8::geometry(&h.map(|n| nodes[n]))).collect();
        Self { problem, params: problem.local(theta).bulk, geometry, history, time: None, rest }
    }

    /// Goes on to a converged step; gives its fields where `wanted`. A law without memory is only
    /// asked then.
    pub fn advance(&mut self, step: &StepRecord, u: &[f64], wanted: bool) -> Option<Vec<CellState>> {
        let dt = match self.time {
            Some(before) => step.time - before,
            None => self.rest.unwrap_or(0.0),
        };
        self.time = Some(step.time);
        let entries = self.problem.bulk_history();
        if entries == 0 && !wanted {
            return None;
        }
        let ctx = Context { dt, time: step.time, ..Context::default() };
        let mut out = Vec::new();
        let mut fresh = self.history.clone();
        for (e, (hex, geometry)) in self.problem.body.hexes.iter().zip(&self.geometry).enumerate() {
            let gradients = hex8::mean_dilatation_gradients(geometry, &gather8(u, hex));
            let mut mean = Mean::default();
            for (q, f) in gradients.iter().enumerate() {
                let at = (e * hex8::POINTS + q) * entries;
                let (old, new) = (&self.history[at..at + entries], &mut fresh[at..at + entries]);
                let force =
                    Law::<f64, 9>::respond(&*self.problem.bulk, &ctx, f, &self.params, old, new).force;
                if wanted {
                    mean.add(geometry.volumes[q], f, &force);
                }
            }
            if wanted {
                out.push(mean.state());
            }
        }
        if !step.revisited {
            self.history = fresh;
        }
        wanted.then_some(out)
    }
}

/// Volume-weighted sums over the points of a brick.
#[derive(Default)]
struct Mean {
    volume: f64,
    stress: Matrix3<f64>,
    stretch: f64,
    jacobian: f64,
}

impl Mean {
    /// σ = P Fᵀ/J.
    fn add(&mut self, volume: f64, f: &[f64; 9], p: &[f64; 9]) {
        let (f, p) = (Matrix3::from_row_slice(f), Matrix3::from_row_slice(p));
        let j = f.determinant();
        let largest = SymmetricEigen::new(f.transpose() * f).eigenvalues.max().max(0.0).sqrt();
        self.volume += volume;
        self.stress += p * f.transpose() * (volume / j);
        self.stretch += volume * largest;
        self.jacobian += volume * j;
    }

    fn state(&self) -> CellState {
        let s = self.stress / self.volume;
        CellState {
            stress: [s[(0, 0)], s[(1, 1)], s[(2, 2)], s[(0, 1)], s[(1, 2)], s[(0, 2)]],
            stretch: self.stretch / self.volume,
            jacobian: self.jacobian / self.volume,
        }
    }
}

/// The strip with its fields; of a half-height model both halves.
pub fn grid(problem: &Problem, mesh: &Mesh, u: &[f64], cells: &[CellState]) -> Grid {
    let body = &problem.body;
    let halves: &[f64] = if mesh.half_height { &[1.0, -1.0] } else { &[1.0] };
    let mut grid = Grid { shape: Cells::Hexahedra, ..Grid::default() };
    let mid = mesh.path_y;
    let mut s22 = vec![(0.0f64, 0.0f64); body.nodes.len()];
    for (hex, c) in body.hexes.iter().zip(cells) {
        for &n in hex {
            s22[n].0 += c.stress[1];
            s22[n].1 += 1.0;
        }
    }
    let (mut displacement, mut nodal) = (Vec::new(), Vec::new());
    let (mut stress, mut axial, mut stretch, mut jacobian) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    for &sign in halves {
        let base = grid.points.len();
        for (n, x) in body.nodes.iter().enumerate() {
            grid.points.push(if sign < 0.0 { [x[0], 2.0 * mid - x[1], x[2]] } else { *x });
            displacement.extend([u[3 * n], sign * u[3 * n + 1], u[3 * n + 2]]);
            nodal.push(s22[n].0 / s22[n].1.max(1.0));
        }
        for (hex, c) in body.hexes.iter().zip(cells) {
            let mut cell = hex.map(|n| base + n);
            if sign < 0.0 {
                // A mirrored brick is inside out: its two faces along y change places.
                cell = [cell[4], cell[5], cell[6], cell[7], cell[0], cell[1], cell[2], cell[3]];
            }
            grid.cells.push(cell.to_vec());
            let [xx, yy, zz, xy, yz, xz] = c.stress;
            stress.extend([xx, yy, zz, sign * xy, sign * yz, xz]);
            axial.push(yy);
            stretch.push(c.stretch);
            jacobian.push(c.jacobian);
        }
    }
    grid.point_data = vec![("displacement", 3, displacement), ("S22", 1, nodal)];
    grid.cell_data =
        vec![("CauchyStress", 6, stress), ("S22", 1, axial), ("stretch", 1, stretch), ("J", 1, jacobian)];
    grid
}
