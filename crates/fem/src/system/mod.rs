//! The equations of one problem: numbering, pattern, buffers and factor. What goes into them is in `assembly`.

use crate::error::FemError;
use crate::factor::Factor;
use crate::hex8;
use crate::opening::{self, Weights};
use crate::problem::Problem;
use rayon::prelude::*;

mod assembly;
mod pattern;

use pattern::{Places, hex_dofs, numbered, path_dofs, pattern};

/// Marks a constrained degree of freedom, and a matrix entry outside the free block.
pub const NONE: usize = usize::MAX;
const SKIP: u32 = u32::MAX;

/// Where the tangents of the bricks take their pressures from ([`hex8::Pressure`]).
#[derive(Clone, Copy, Debug)]
pub enum Pressures<'a> {
    /// The law.
    Own,
    /// A first guess: mean stress times volume of each brick, N·mm.
    Guessed(&'a [f64]),
    /// The iterate that was left ([`System::leave`]), linearised over this share of a Newton step.
    Linearised {
        /// Share of the step.
        share: f64,
    },
}

/// Numbering, pattern, buffers and factor for one problem.
pub struct System {
    /// Equation of each degree of freedom, [`NONE`] if prescribed.
    pub equation: Vec<usize>,
    /// Number of unknowns.
    pub unknowns: usize,
    /// Factor of the free block.
    pub factor: Factor,
    /// Values of the lower triangle of the free block.
    pub values: Vec<f64>,
    /// Out-of-balance forces on the free degrees of freedom, N (internal, to be zero).
    pub residual: Vec<f64>,
    /// The same with the pressures that the tangent uses, N: what a Newton step is judged by.
    pub mixed: Vec<f64>,
    /// ∂residual/∂(grip displacement).
    pub grip_column: Vec<f64>,
    /// ∂(grip force)/∂(grip displacement) with the free unknowns held.
    pub grip_stiffness: f64,
    /// Work-conjugate force of the modelled part, N.
    pub grip_force: f64,
    /// Largest element force, N: the yardstick of the residual.
    pub force_scale: f64,
    /// Largest element stiffness, N/mm.
    pub stiffness_scale: f64,
    hex_map: Vec<[u32; hex8::PACKED]>,
    path_map: Vec<Vec<u32>>,
    path_dofs: Vec<Vec<usize>>,
    /// Share of the grip displacement of each degree of freedom.
    grip_share: Vec<f64>,
    grip_hexes: Vec<usize>,
    geometry: Vec<hex8::Geometry<f64>>,
    elements: Vec<hex8::Tangent>,
    /// Volumes and pressures of the iterate that a Newton step leaves.
    left: Vec<hex8::Volume>,
    /// The opening by which steps along the path are measured: the mean one, where nothing else is said.
    pub opening: Weights,
}

impl System {
    /// Numbers the unknowns, analyses the pattern.
    ///
    /// # Errors
    /// [`FemError::Setup`] when the problem does not fit together.
    pub fn new(problem: &Problem) -> Result<Self, FemError> {
        problem.check()?;
        let body = &problem.body;
        let (equation, unknowns) = numbered(problem);
        let path_dofs: Vec<Vec<usize>> = body.cohesive.iter().map(path_dofs).collect();
        let dofs = body.hexes.iter().map(|h| hex_dofs(h).to_vec()).chain(path_dofs.iter().cloned());
        let (col_ptr, row_idx) = pattern(unknowns, &equation, dofs);
        let places = Places { equation: &equation, col_ptr: &col_ptr, row_idx: &row_idx };
        let hex_map = body.hexes.iter().map(|h| places.of_hex(&hex_dofs(h))).collect();
        let path_map = path_dofs.iter().map(|dofs| places.of_path(dofs)).collect();
        let grip_share: Vec<f64> = problem.supports.iter().map(|s| s.map_or(0.0, |p| p.grip)).collect();
        let grip_hexes = (0..body.hexes.len())
            .filter(|&e| hex_dofs(&body.hexes[e]).iter().any(|&d| grip_share[d] != 0.0))
            .collect();
        let mut system = Self {
            factor: Factor::new(unknowns, col_ptr, row_idx.clone())?,
            values: vec![0.0; row_idx.len()],
            residual: vec![0.0; unknowns],
            mixed: vec![0.0; unknowns],
            grip_column: vec![0.0; unknowns],
            grip_stiffness: 0.0,
            grip_force: 0.0,
            force_scale: 0.0,
            stiffness_scale: 0.0,
            hex_map,
            path_map,
            path_dofs,
            grip_share,
            grip_hexes,
            geometry: Vec::new(),
            elements: vec![hex8::Tangent::default(); body.hexes.len()],
            left: vec![hex8::Volume::default(); body.hexes.len()],
            opening: Weights::new(),
            equation,
            unknowns,
        };
        system.set_geometry(problem);
        Ok(system)
    }

    /// Recomputes shape gradients after the reference positions moved.
    pub fn set_geometry(&mut self, problem: &Problem) {
        let body = &problem.body;
        self.geometry = body.hexes.par_iter().map(|h| hex8::geometry(&h.map(|n| body.nodes[n]))).collect();
        self.opening = opening::mean(problem, &self.equation);
    }

    /// Geometry of the bricks.
    pub fn geometry(&self) -> &[hex8::Geometry<f64>] {
        &self.geometry
    }

    /// Degrees of freedom of an interface element in the order of its residual.
    pub fn path_dofs(&self, e: usize) -> &[usize] {
        &self.path_dofs[e]
    }

    /// A Newton step leaves the iterate of the last assembly: pressures are linearised from here.
    pub fn leave(&mut self) {
        for (left, el) in self.left.iter_mut().zip(&self.elements) {
            *left = el.volume;
        }
    }

    /// Pressures of the last assembly, by the law.
    pub fn pressures(&self) -> impl Iterator<Item = f64> {
        self.elements.iter().map(|el| el.volume.pressure)
    }

    /// Largest out-of-balance force, N: of the residual, and of that with the pressures of the tangent.
    pub fn imbalance(&self) -> [f64; 2] {
        let largest =
            |r: &[f64]| r.iter().fold(0.0f64, |m, r| if r.is_nan() { f64::INFINITY } else { m.max(r.abs()) });
        [largest(&self.residual), largest(&self.mixed)]
    }
}
