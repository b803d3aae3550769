//! Assembly: element residuals and tangents into the sparse lower triangle.
//!
//! Elements are evaluated in parallel, each into its own buffer, and scattered one after the other
//! through a precomputed map: the same bits on any number of threads.

use crate::error::{ElementFault, FemError};
use crate::factor::Factor;
use crate::hex8;
use crate::interface;
use crate::problem::{LocalParams, Problem};
use crate::state::{History, gather4, gather8};
use constitutive::Context;
use rayon::prelude::*;

mod pattern;

use pattern::{lower_triangle, mean_opening, path_dofs, pattern};

/// Marks a constrained degree of freedom, and a matrix entry outside the free block.
pub const NONE: usize = usize::MAX;
const SKIP: u32 = u32::MAX;

/// Elements evaluated together by one task.
const GRAIN: usize = 16;

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
    /// Mean-opening functional: (equation, weight), weights of a unit mean opening.
    pub mean_opening: Vec<(usize, f64)>,
}

impl System {
    /// Numbers the unknowns, analyses the pattern.
    ///
    /// # Errors
    /// [`FemError::Setup`] when the problem does not fit together.
    pub fn new(problem: &Problem) -> Result<Self, FemError> {
        problem.check()?;
        let body = &problem.body;
        let mut equation = vec![NONE; 3 * body.nodes.len()];
        let mut unknowns = 0;
        for &node in &body.order {
            for c in 0..3 {
                if problem.supports[3 * node + c].is_none() {
                    equation[3 * node + c] = unknowns;
                    unknowns += 1;
                }
            }
        }
        let path_dofs: Vec<Vec<usize>> = body.cohesive.iter().map(path_dofs).collect();
        let hex_dofs =
            |h: &[usize; 8]| -> [usize; hex8::DOFS] { std::array::from_fn(|i| 3 * h[i / 3] + i % 3) };
        let (col_ptr, row_idx) = pattern(
            unknowns,
            &equation,
            body.hexes.iter().map(|h| hex_dofs(h).to_vec()).chain(path_dofs.iter().cloned()),
        );
        let locate = |i: usize, j: usize| -> u32 {
            let (ei, ej) = (equation[i], equation[j]);
            if ei == NONE || ej == NONE {
                return SKIP;
            }
            let (row, col) = (ei.max(ej), ei.min(ej));
            let rows = &row_idx[col_ptr[col]..col_ptr[col + 1]];
            rows.binary_search(&row).map_or(SKIP, |k| (col_ptr[col] + k) as u32)
        };
        let hex_map = body
            .hexes
            .iter()
            .map(|h| {
                let dofs = hex_dofs(h);
                let mut map = [SKIP; hex8::PACKED];
                for (at, (i, j)) in map.iter_mut().zip(lower_triangle()) {
                    *at = locate(dofs[i], dofs[j]);
                }
                map
            })
            .collect();
        let path_map = path_dofs
            .iter()
            .map(|dofs| {
                let mut map = Vec::with_capacity(dofs.len() * (dofs.len() + 1) / 2);
                for i in 0..dofs.len() {
                    for j in 0..=i {
                        map.push(locate(dofs[i], dofs[j]));
                    }
                }
                map
            })
            .collect();
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
            mean_opening: Vec::new(),
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
        self.mean_opening = mean_opening(problem, &self.equation);
    }

    /// Geometry of the bricks.
    pub fn geometry(&self) -> &[hex8::Geometry<f64>] {
        &self.geometry
    }

    /// Degrees of freedom of an interface element in the order of its residual.
    pub fn path_dofs(&self, e: usize) -> &[usize] {
        &self.path_dofs[e]
    }

    /// Residual and tangent at `u`, with the tangent's pressures as said; the new history goes to `new`.
    ///
    /// # Errors
    /// The first fault in element order.
    #[allow(clippy::too_many_arguments)]
    pub fn assemble(
        &mut self,
        problem: &Problem,
        local: &LocalParams<f64>,
        ctx: &Context,
        u: &[f64],
        pressures: Pressures<'_>,
        old: &History,
        new: &mut History,
    ) -> Result<(), ElementFault> {
        self.evaluate_bricks(problem, local, ctx, u, pressures, old, new)?;
        self.values.fill(0.0);
        self.residual.fill(0.0);
        self.mixed.fill(0.0);
        self.grip_column.fill(0.0);
        (self.grip_stiffness, self.grip_force) = (0.0, 0.0);
        (self.force_scale, self.stiffness_scale) = (0.0, 0.0);
        for (e, h) in problem.body.hexes.iter().enumerate() {
            let el = &self.elements[e];
            for (i, row) in el.rows.iter().enumerate() {
                let map = &self.hex_map[e][i * (i + 1) / 2..][..=i];
                for (j, &at) in map.iter().enumerate() {
                    if at != SKIP {
                        self.values[at as usize] += row[j % 3][j / 3];
                    }
                }
            }
            for i in 0..hex8::DOFS {
                let dof = 3 * h[i / 3] + i % 3;
                let r = el.residual[i];
                self.force_scale = self.force_scale.max(r.abs());
                self.stiffness_scale = self.stiffness_scale.max(el.entry(i, i));
                match self.equation[dof] {
                    NONE => self.grip_force += self.grip_share[dof] * r,
                    eq => {
                        self.residual[eq] += r;
                        self.mixed[eq] += r - el.volume.excess_force(i);
                    }
                }
            }
        }
        for g in 0..self.grip_hexes.len() {
            let e = self.grip_hexes[g];
            self.add_grip_coupling(&problem.body.hexes[e], e);
        }
        self.add_path(problem, local, ctx, u, old, new)
    }

    #[allow(clippy::too_many_arguments)]
    fn evaluate_bricks(
        &mut self,
        problem: &Problem,
        local: &LocalParams<f64>,
        ctx: &Context,
        u: &[f64],
        pressures: Pressures<'_>,
        old: &History,
        new: &mut History,
    ) -> Result<(), ElementFault> {
        let nh = problem.bulk_history() * hex8::POINTS;
        let (geometry, left) = (&self.geometry, &self.left);
        let one = |e: usize, scratch: &mut hex8::Scratch, out: &mut hex8::Tangent, new: &mut [f64]| {
            let nodes = gather8(u, &problem.body.hexes[e]);
            hex8::tangent(
                e,
                &*problem.bulk,
                ctx,
                &local.bulk,
                &geometry[e],
                &nodes,
                match pressures {
                    Pressures::Own => hex8::Pressure::Own,
                    Pressures::Guessed(all) => hex8::Pressure::Guessed(all[e]),
                    Pressures::Linearised { share } => hex8::Pressure::Linearised { from: &left[e], share },
                },
                &old.bulk[e * nh..(e + 1) * nh],
                new,
                scratch,
                out,
            )
        };
        let faults: Vec<Result<(), ElementFault>> = if nh == 0 {
            self.elements
                .par_chunks_mut(GRAIN)
                .enumerate()
                .map(|(c, outs)| {
                    let mut scratch = hex8::Scratch::default();
                    let mut bricks = outs.iter_mut().enumerate();
                    bricks.try_for_each(|(k, out)| one(c * GRAIN + k, &mut scratch, out, &mut []))
                })
                .collect()
        } else {
            self.elements
                .par_chunks_mut(GRAIN)
                .zip(new.bulk.par_chunks_mut(GRAIN * nh))
                .enumerate()
                .map(|(c, (outs, hs))| {
                    let mut scratch = hex8::Scratch::default();
                    let mut bricks = outs.iter_mut().zip(hs.chunks_mut(nh)).enumerate();
                    bricks.try_for_each(|(k, (out, h))| one(c * GRAIN + k, &mut scratch, out, h))
                })
                .collect()
        };
        faults.into_iter().collect()
    }

    fn add_grip_coupling(&mut self, nodes: &[usize; 8], e: usize) {
        let el = &self.elements[e];
        for i in 0..hex8::DOFS {
            let di = 3 * nodes[i / 3] + i % 3;
            for j in 0..hex8::DOFS {
                let dj = 3 * nodes[j / 3] + j % 3;
                let share = self.grip_share[dj];
                if share == 0.0 {
                    continue;
                }
                let k = el.entry(i, j) * share;
                match self.equation[di] {
                    NONE => self.grip_stiffness += self.grip_share[di] * k,
                    eq => self.grip_column[eq] += k,
                }
            }
        }
    }

    fn add_path(
        &mut self,
        problem: &Problem,
        local: &LocalParams<f64>,
        ctx: &Context,
        u: &[f64],
        old: &History,
        new: &mut History,
    ) -> Result<(), ElementFault> {
        let Some(path) = &problem.path else { return Ok(()) };
        let nh = problem.path_history() * interface::POINTS;
        for (e, el) in problem.body.cohesive.iter().enumerate() {
            let ctx = problem.path_context(ctx, e);
            let x = el.lower.map(|n| problem.body.nodes[n]);
            let (o, n) = (&old.path[e * nh..(e + 1) * nh], &mut new.path[e * nh..(e + 1) * nh]);
            let lower = gather4(u, &el.lower);
            match &el.upper {
                None => {
                    let uy = lower.map(|v| v[1]);
                    let (r, k) = interface::mirrored_tangent(
                        e,
                        &*path.law,
                        &ctx,
                        &local.path[e],
                        &x,
                        &uy,
                        path.rule,
                        o,
                        n,
                    )?;
                    self.scatter_path(e, &r, |i, j| k[i][j]);
                }
                Some(upper) => {
                    let up = gather4(u, upper);
                    let all: [[f64; 3]; 8] =
                        std::array::from_fn(|a| if a < 4 { lower[a] } else { up[a - 4] });
                    let (r, k) =
                        interface::tangent(e, &*path.law, &ctx, &local.path[e], &x, &all, path.rule, o, n)?;
                    self.scatter_path(e, &r, |i, j| 0.5 * (k[i][j] + k[j][i]));
                }
            }
        }
        Ok(())
    }

    fn scatter_path(&mut self, e: usize, r: &[f64], k: impl Fn(usize, usize) -> f64) {
        let mut entry = 0;
        for i in 0..r.len() {
            for j in 0..=i {
                let at = self.path_map[e][entry];
                entry += 1;
                if at != SKIP {
                    self.values[at as usize] += k(i, j);
                }
            }
            self.force_scale = self.force_scale.max(r[i].abs());
            // A node of the tear path may be held (mouth grips reach the path in thin arms).
            let dof = self.path_dofs[e][i];
            match self.equation[dof] {
                NONE => self.grip_force += self.grip_share[dof] * r[i],
                eq => {
                    self.residual[eq] += r[i];
                    self.mixed[eq] += r[i];
                }
            }
        }
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
