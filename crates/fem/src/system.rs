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

/// Marks a constrained degree of freedom, and a matrix entry outside the free block.
pub const NONE: usize = usize::MAX;
const SKIP: u32 = u32::MAX;

/// Elements evaluated together by one task.
const GRAIN: usize = 16;

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

    /// Residual and tangent at `u`; the new history goes to `new`.
    ///
    /// # Errors
    /// The first fault in element order.
    pub fn assemble(
        &mut self,
        problem: &Problem,
        local: &LocalParams<f64>,
        ctx: &Context,
        u: &[f64],
        old: &History,
        new: &mut History,
    ) -> Result<(), ElementFault> {
        self.evaluate_bricks(problem, local, ctx, u, old, new)?;
        self.values.fill(0.0);
        self.residual.fill(0.0);
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
                    eq => self.residual[eq] += r,
                }
            }
        }
        for g in 0..self.grip_hexes.len() {
            let e = self.grip_hexes[g];
            self.add_grip_coupling(&problem.body.hexes[e], e);
        }
        self.add_path(problem, local, ctx, u, old, new)
    }

    fn evaluate_bricks(
        &mut self,
        problem: &Problem,
        local: &LocalParams<f64>,
        ctx: &Context,
        u: &[f64],
        old: &History,
        new: &mut History,
    ) -> Result<(), ElementFault> {
        let nh = problem.bulk_history() * hex8::POINTS;
        let geometry = &self.geometry;
        let one = |e: usize, scratch: &mut hex8::Scratch, out: &mut hex8::Tangent, new: &mut [f64]| {
            let nodes = gather8(u, &problem.body.hexes[e]);
            hex8::tangent(
                e,
                &*problem.bulk,
                ctx,
                &local.bulk,
                &geometry[e],
                &nodes,
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
                eq => self.residual[eq] += r[i],
            }
        }
    }

    /// Largest out-of-balance force over the yardstick.
    pub fn imbalance(&self) -> f64 {
        self.residual.iter().fold(0.0f64, |m, r| if r.is_nan() { f64::INFINITY } else { m.max(r.abs()) })
    }
}

/// Entries of the lower triangle of a brick's tangent, row by row.
fn lower_triangle() -> impl Iterator<Item = (usize, usize)> {
    (0..hex8::DOFS).flat_map(|i| (0..=i).map(move |j| (i, j)))
}

fn path_dofs(el: &crate::problem::CohesiveElement) -> Vec<usize> {
    match &el.upper {
        None => el.lower.iter().map(|n| 3 * n + 1).collect(),
        Some(upper) => el.lower.iter().chain(upper).flat_map(|n| [3 * n, 3 * n + 1, 3 * n + 2]).collect(),
    }
}

/// Lower-triangle pattern in compressed columns, held by sprs while it is built.
fn pattern(
    n: usize,
    equation: &[usize],
    elements: impl Iterator<Item = Vec<usize>>,
) -> (Vec<usize>, Vec<usize>) {
    let mut entries = sprs::TriMat::<u8>::new((n, n));
    for i in 0..n {
        entries.add_triplet(i, i, 1);
    }
    // Node pairs repeat between neighbouring elements: keep each once.
    let mut seen = std::collections::HashSet::new();
    for dofs in elements {
        for &i in &dofs {
            for &j in &dofs {
                let (ei, ej) = (equation[i], equation[j]);
                if ei != NONE && ej != NONE && ei > ej && seen.insert((ei, ej)) {
                    entries.add_triplet(ei, ej, 1);
                }
            }
        }
    }
    let csc: sprs::CsMat<u8> = entries.to_csc();
    let (ptr, mut rows, _) = csc.into_raw_storage();
    for j in 0..n {
        rows[ptr[j]..ptr[j + 1]].sort_unstable();
    }
    (ptr, rows)
}

/// Weights of the mean normal opening in the reference direction y.
fn mean_opening(problem: &Problem, equation: &[usize]) -> Vec<(usize, f64)> {
    let body = &problem.body;
    let mut weights = std::collections::BTreeMap::new();
    let mut total = 0.0;
    for el in &body.cohesive {
        let x = el.lower.map(|n| body.nodes[n]);
        let zero = [[0.0; 3]; 4];
        let area: f64 =
            interface::openings(&x, &zero, &zero, interface::Integration::Gauss).iter().map(|o| o.1).sum();
        total += area;
        for a in 0..4 {
            match &el.upper {
                None => *weights.entry(3 * el.lower[a] + 1).or_insert(0.0) += 2.0 * 0.25 * area,
                Some(upper) => {
                    *weights.entry(3 * el.lower[a] + 1).or_insert(0.0) -= 0.25 * area;
                    *weights.entry(3 * upper[a] + 1).or_insert(0.0) += 0.25 * area;
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
