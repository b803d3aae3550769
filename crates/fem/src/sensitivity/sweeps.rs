//! Sweeps over the elements: residual jets and new history of all bricks and of the tear path.

use super::{Chunk, Stage};
use crate::hex8;
use crate::interface;
use constitutive::{Jet, Law, PointLaw};
use rayon::prelude::*;
use std::collections::HashMap;

fn gather<const N: usize, const W: usize>(u: &[Jet<W>], nodes: &[usize; N]) -> [[Jet<W>; 3]; N] {
    nodes.map(|n| [u[3 * n], u[3 * n + 1], u[3 * n + 2]])
}

fn array<const N: usize, const W: usize>(v: &[[Jet<W>; 3]]) -> [[Jet<W>; 3]; N] {
    std::array::from_fn(|i| v[i])
}

type BrickForces<const W: usize> = (Vec<[[Jet<W>; 3]; 8]>, Vec<Jet<W>>);

fn lift_geometry<const W: usize>(g: &hex8::Geometry<f64>) -> hex8::Geometry<Jet<W>> {
    hex8::Geometry {
        gradients: g.gradients.map(|p| p.map(|a| a.map(Jet::constant))),
        volumes: g.volumes.map(Jet::constant),
    }
}

impl<const W: usize> Chunk<W> {
    fn node_positions(&self, nodes: &[usize]) -> Vec<[Jet<W>; 3]> {
        nodes
            .iter()
            .map(|&n| {
                let mut x = self.problem.body.nodes[n].map(Jet::<W>::constant);
                for f in &self.problem.shape {
                    if let Some(c) = self.seeds.iter().position(|&s| s == f.param) {
                        for i in 0..3 {
                            x[i].eps[c] += f.field[n][i];
                        }
                    }
                }
                x
            })
            .collect()
    }

    /// Derivatives of the prescribed displacements at a held grip.
    pub(super) fn mount_jets(&self, u: &[f64]) -> Vec<Jet<W>> {
        let mut out: Vec<Jet<W>> = u.iter().map(|&x| Jet::constant(x)).collect();
        for f in &self.problem.mount {
            if let Some(c) = self.seeds.iter().position(|&s| s == f.param) {
                for &(dof, d) in &f.field {
                    out[dof].eps[c] += d;
                }
            }
        }
        out
    }
}

impl<const W: usize> Chunk<W>
where
    dyn PointLaw<9>: Law<Jet<W>, 9>,
    dyn PointLaw<3>: Law<Jet<W>, 3>,
    dyn PointLaw<1>: Law<Jet<W>, 1>,
{
    /// Residual jets of all bricks and their new history; `element` answers for one brick.
    fn bricks(
        &self,
        element: impl Fn(usize, &[usize; 8], &[Jet<W>], &mut [Jet<W>]) -> [[Jet<W>; 3]; 8] + Sync,
    ) -> BrickForces<W> {
        let nh = self.bulk.len() / self.problem.body.hexes.len().max(1);
        let hexes = &self.problem.body.hexes;
        if nh == 0 {
            let of = |(e, h)| element(e, h, &[], &mut []);
            return (hexes.par_iter().enumerate().map(of).collect(), Vec::new());
        }
        let mut history = self.bulk.clone();
        let each = hexes.par_iter().zip(history.par_chunks_mut(nh)).enumerate();
        let forces = each.map(|(e, (h, new))| element(e, h, &self.bulk[e * nh..(e + 1) * nh], new)).collect();
        (forces, history)
    }

    /// Residual jets of all bricks and their new history, with displacements `u`.
    pub(super) fn bricks_total(&self, stage: &Stage, u: &[Jet<W>]) -> BrickForces<W> {
        self.bricks(|e, h, old, new| self.brick_total(stage, u, e, h, old, new))
    }

    /// The same of one brick.
    fn brick_total(
        &self,
        stage: &Stage,
        u: &[Jet<W>],
        e: usize,
        nodes: &[usize; 8],
        old: &[Jet<W>],
        new: &mut [Jet<W>],
    ) -> [[Jet<W>; 3]; 8] {
        let geo = if self.in_shape {
            hex8::geometry(&array::<8, W>(&self.node_positions(nodes)))
        } else {
            lift_geometry(&stage.system.geometry()[e])
        };
        let (bulk, at) = (&*self.problem.bulk, gather(u, nodes));
        hex8::residual::<Jet<W>, Jet<W>>(bulk, &stage.ctx, &self.local.bulk, &geo, &at, old, new)
    }

    /// The same with constant displacements and positions: kinematics in plain numbers.
    pub(super) fn bricks_partial(&self, stage: &Stage) -> BrickForces<W> {
        self.bricks(|e, h, old, new| {
            hex8::residual::<f64, Jet<W>>(
                &*self.problem.bulk,
                &stage.ctx,
                &self.local.bulk,
                &stage.system.geometry()[e],
                &crate::state::gather8(&stage.state.u, h),
                old,
                new,
            )
        })
    }

    /// Derivatives of the measured forces, of the whole specimen, with displacements `u` and the history before the step.
    pub(super) fn reactions(&self, stage: &Stage, u: &[Jet<W>]) -> Vec<[f64; W]> {
        let reactions = &self.problem.reactions;
        if reactions.is_empty() {
            return Vec::new();
        }
        let nh = self.bulk.len() / self.problem.body.hexes.len().max(1);
        let weights: Vec<HashMap<usize, f64>> =
            reactions.iter().map(|r| r.iter().copied().collect()).collect();
        let mut out = vec![[0.0; W]; reactions.len()];
        for (e, h) in self.problem.body.hexes.iter().enumerate() {
            let held =
                |w: &HashMap<usize, f64>| h.iter().any(|n| (0..3).any(|i| w.contains_key(&(3 * n + i))));
            if !weights.iter().any(held) {
                continue;
            }
            let old = &self.bulk[e * nh..(e + 1) * nh];
            let forces = self.brick_total(stage, u, e, h, old, &mut old.to_vec());
            for (w, out) in weights.iter().zip(&mut out) {
                for (a, n) in h.iter().enumerate() {
                    for (i, force) in forces[a].iter().enumerate() {
                        let share = self.problem.multiplicity * w.get(&(3 * n + i)).copied().unwrap_or(0.0);
                        out.iter_mut().zip(&force.eps).for_each(|(d, f)| *d += share * f);
                    }
                }
            }
        }
        out
    }

    /// New history of all bricks with displacements `u` and constant positions.
    pub(super) fn history_total(&self, stage: &Stage, u: &[Jet<W>]) -> Vec<Jet<W>> {
        let nh = self.bulk.len() / self.problem.body.hexes.len().max(1);
        let mut history = self.bulk.clone();
        let law = &*self.problem.bulk;
        history.par_chunks_mut(nh).zip(self.problem.body.hexes.par_iter()).enumerate().for_each(
            |(e, (new, h))| {
                let (old, geo) = (&self.bulk[e * nh..(e + 1) * nh], &stage.system.geometry()[e]);
                let nodes = gather(u, h);
                hex8::update_history(law, &stage.ctx, &self.local.bulk, geo, &nodes, old, new);
            },
        );
        history
    }

    /// Residual jets of the interface elements (in the order of `System::path_dofs`) and history.
    pub(super) fn path_forces(&self, stage: &Stage, u: &[Jet<W>]) -> (Vec<Vec<Jet<W>>>, Vec<Jet<W>>) {
        let Some(path) = &self.problem.path else { return (Vec::new(), Vec::new()) };
        let nh = self.path.len() / self.problem.body.cohesive.len().max(1);
        let mut history = self.path.clone();
        let mut forces = Vec::with_capacity(self.problem.body.cohesive.len());
        for (e, el) in self.problem.body.cohesive.iter().enumerate() {
            let ctx = self.problem.path_context(&stage.ctx, e);
            let x = array::<4, W>(&self.node_positions(&el.lower));
            let old = &self.path[e * nh..(e + 1) * nh];
            let new = &mut history[e * nh..(e + 1) * nh];
            let lower = gather(u, &el.lower);
            let r: Vec<Jet<W>> = match &el.upper {
                None => interface::mirrored_residual::<Jet<W>, Jet<W>>(
                    &*path.law,
                    &ctx,
                    &self.local.path[e],
                    &x,
                    &lower.map(|v| v[1]),
                    path.rule,
                    old,
                    new,
                )
                .to_vec(),
                Some(upper) => interface::residual::<Jet<W>, Jet<W>>(
                    &*path.law,
                    &ctx,
                    &self.local.path[e],
                    &x,
                    &lower,
                    &gather(u, upper),
                    path.rule,
                    old,
                    new,
                )
                .as_flattened()
                .to_vec(),
            };
            forces.push(r);
        }
        (forces, history)
    }
}
