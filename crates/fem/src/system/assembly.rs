//! Assembly: element residuals and tangents into the sparse lower triangle.
//!
//! Elements are evaluated in parallel, each into its own buffer, and scattered one after the other
//! through a precomputed map: the same bits on any number of threads.

use super::{NONE, Pressures, SKIP, System};
use crate::error::ElementFault;
use crate::hex8;
use crate::interface;
use crate::problem::{LocalParams, Problem, Reaction};
use crate::state::{History, gather4, gather8};
use constitutive::Context;
use rayon::prelude::*;
use std::collections::HashMap;

/// Elements evaluated together by one task.
const GRAIN: usize = 16;

/// What the elements are evaluated for.
#[derive(Clone, Copy)]
struct Instant<'a> {
    problem: &'a Problem,
    local: &'a LocalParams<f64>,
    ctx: &'a Context,
    u: &'a [f64],
    old: &'a History,
}

impl System {
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
        let at = Instant { problem, local, ctx, u, old };
        self.evaluate_bricks(at, Some(pressures), new)?;
        self.values.fill(0.0);
        self.grip_column.fill(0.0);
        (self.grip_stiffness, self.stiffness_scale) = (0.0, 0.0);
        for e in 0..problem.body.hexes.len() {
            self.scatter_stiffness(e);
        }
        for g in 0..self.grip_hexes.len() {
            let e = self.grip_hexes[g];
            self.add_grip_coupling(&problem.body.hexes[e], e);
        }
        self.gather_forces(problem);
        self.add_path(at, true, new)
    }

    /// The residual at `u` alone, with the pressures of the law; everything about the tangent stays that of the last
    /// assembly. The new history goes to `new`.
    ///
    /// # Errors
    /// The first fault in element order.
    pub fn forces(
        &mut self,
        problem: &Problem,
        local: &LocalParams<f64>,
        ctx: &Context,
        u: &[f64],
        old: &History,
        new: &mut History,
    ) -> Result<(), ElementFault> {
        let at = Instant { problem, local, ctx, u, old };
        self.evaluate_bricks(at, None, new)?;
        self.gather_forces(problem);
        self.add_path(at, false, new)
    }

    /// Evaluates the bricks: with tangents, whose pressures are said, or forces alone.
    fn evaluate_bricks(
        &mut self,
        at: Instant<'_>,
        tangents: Option<Pressures<'_>>,
        new: &mut History,
    ) -> Result<(), ElementFault> {
        let nh = at.problem.bulk_history() * hex8::POINTS;
        let (geometry, left, law) = (&self.geometry, &self.left, &*at.problem.bulk);
        let one = |e: usize, scratch: &mut hex8::Scratch, out: &mut hex8::Tangent, new: &mut [f64]| {
            let (nodes, params) = (gather8(at.u, &at.problem.body.hexes[e]), &at.local.bulk);
            let old = &at.old.bulk[e * nh..(e + 1) * nh];
            let pressure = match tangents {
                None => return hex8::forces(e, law, at.ctx, params, &geometry[e], &nodes, old, new, out),
                Some(Pressures::Own) => hex8::Pressure::Own,
                Some(Pressures::Guessed(all)) => hex8::Pressure::Guessed(all[e]),
                Some(Pressures::Linearised { share }) => hex8::Pressure::Linearised { from: &left[e], share },
            };
            hex8::tangent(e, law, at.ctx, params, &geometry[e], &nodes, pressure, old, new, scratch, out)
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

    fn scatter_stiffness(&mut self, e: usize) {
        let el = &self.elements[e];
        for (i, row) in el.rows.iter().enumerate() {
            let map = &self.hex_map[e][i * (i + 1) / 2..][..=i];
            for (j, &at) in map.iter().enumerate() {
                if at != SKIP {
                    self.values[at as usize] += row[j % 3][j / 3];
                }
            }
            self.stiffness_scale = self.stiffness_scale.max(el.entry(i, i));
        }
    }

    /// Residuals of the bricks, from nothing.
    fn gather_forces(&mut self, problem: &Problem) {
        self.residual.fill(0.0);
        self.mixed.fill(0.0);
        (self.grip_force, self.force_scale) = (0.0, 0.0);
        for (el, h) in self.elements.iter().zip(&problem.body.hexes) {
            for (i, &r) in el.residual.iter().enumerate() {
                let dof = 3 * h[i / 3] + i % 3;
                self.force_scale = self.force_scale.max(r.abs());
                match self.equation[dof] {
                    NONE => self.grip_force += self.grip_share[dof] * r,
                    eq => {
                        self.residual[eq] += r;
                        self.mixed[eq] += r - el.volume.excess_force(i);
                    }
                }
            }
        }
    }

    /// The measured forces at the last evaluation, of the modelled part, N.
    pub fn reactions(&self, problem: &Problem) -> Vec<f64> {
        let one = |reaction: &Reaction| {
            let weights: HashMap<usize, f64> = reaction.iter().copied().collect();
            let forces =
                self.elements.iter().zip(&problem.body.hexes).flat_map(|(el, h)| {
                    el.residual.iter().enumerate().map(|(i, r)| (3 * h[i / 3] + i % 3, *r))
                });
            forces.filter_map(|(dof, r)| Some(weights.get(&dof)? * r)).sum()
        };
        problem.reactions.iter().map(one).collect()
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

    /// Adds the tear path, to the tangent too if wanted.
    fn add_path(&mut self, at: Instant<'_>, tangent: bool, new: &mut History) -> Result<(), ElementFault> {
        let Some(path) = &at.problem.path else { return Ok(()) };
        let nh = at.problem.path_history() * interface::POINTS;
        for (e, el) in at.problem.body.cohesive.iter().enumerate() {
            let (ctx, params) = (at.problem.path_context(at.ctx, e), &at.local.path[e]);
            let x = el.lower.map(|n| at.problem.body.nodes[n]);
            let (o, n) = (&at.old.path[e * nh..(e + 1) * nh], &mut new.path[e * nh..(e + 1) * nh]);
            let (lower, law) = (gather4(at.u, &el.lower), &*path.law);
            match &el.upper {
                None => {
                    let uy = lower.map(|v| v[1]);
                    let (r, k) = interface::mirrored_tangent(e, law, &ctx, params, &x, &uy, path.rule, o, n)?;
                    self.scatter_path(e, &r, tangent.then_some(|i: usize, j: usize| k[i][j]));
                }
                Some(upper) => {
                    let up = gather4(at.u, upper);
                    let all: [[f64; 3]; 8] =
                        std::array::from_fn(|a| if a < 4 { lower[a] } else { up[a - 4] });
                    let (r, k) = interface::tangent(e, law, &ctx, params, &x, &all, path.rule, o, n)?;
                    let symmetric = |i: usize, j: usize| 0.5 * (k[i][j] + k[j][i]);
                    self.scatter_path(e, &r, tangent.then_some(symmetric));
                }
            }
        }
        Ok(())
    }

    fn scatter_path(&mut self, e: usize, r: &[f64], k: Option<impl Fn(usize, usize) -> f64>) {
        if let Some(k) = k {
            let pairs = (0..r.len()).flat_map(|i| (0..=i).map(move |j| (i, j)));
            for ((i, j), &at) in pairs.zip(&self.path_map[e]) {
                if at != SKIP {
                    self.values[at as usize] += k(i, j);
                }
            }
        }
        for (&dof, &r) in self.path_dofs[e].iter().zip(r) {
            self.force_scale = self.force_scale.max(r.abs());
            // A node of the tear path may be held (mouth grips reach the path in thin arms).
            match self.equation[dof] {
                NONE => self.grip_force += self.grip_share[dof] * r,
                eq => {
                    self.residual[eq] += r;
                    self.mixed[eq] += r;
                }
            }
        }
    }
}
