//! Sensitivities by direct differentiation through the load-step history.
//!
//! At each converged step: a **partial** sweep (parameters seeded, displacements constant, history
//! seeded with its stored total derivative) gives −∂R/∂θ; the tangent factorised at the converged
//! state solves for all columns at once; a **total** sweep (displacements seeded too) carries the
//! derivative of the history on. No ∂P/∂h matrix is ever formed; step sizes are frozen.
//!
//! A [`Columns`] object owns its own problem: the columns of an effect that is tried at its
//! neutral value use the decorated law on the states of the base model.

use crate::equilibrium::Border;
use crate::hex8;
use crate::interface;
use crate::problem::{LocalParams, Problem};
use crate::state::State;
use crate::system::{NONE, System};
use constitutive::{Context, Jet, Law, PointLaw};
use rayon::prelude::*;
use std::sync::Arc;

/// One step as the columns see it.
pub struct Stage<'a> {
    /// Numbering and geometry.
    pub system: &'a System,
    /// Converged state.
    pub state: &'a State,
    /// Time and increment of the step that led to it.
    pub ctx: Context,
    /// What the step held fixed: (t_u, t_w) of a path step, `None` for a standing actuator.
    pub arc: Option<[f64; 2]>,
}

/// Derivatives of one step, per column.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct StepDerivatives {
    /// dF/dθ, N per unit.
    pub force: Vec<f64>,
    /// du_grip/dθ, mm per unit.
    pub grip: Vec<f64>,
    /// du_actuator/dθ (path steps only; zero at a standing actuator).
    pub actuator: Vec<f64>,
    /// Derivatives of the observer's extra outputs: `extra[output][column]`.
    pub extra: Vec<Vec<f64>>,
}

/// A set of derivative columns carried through a run.
pub trait Columns: Send {
    /// Number of columns.
    fn count(&self) -> usize;
    /// Appends −∂R/∂θ of the free unknowns, column after column, to `rhs`.
    fn partial(&mut self, stage: &Stage, rhs: &mut Vec<f64>);
    /// Takes the solutions K⁻¹(−∂R/∂θ), closes the border, carries the history on.
    /// Returns the displacement derivatives (dof-major: `du[dof * count + c]`) and the step's
    /// derivatives (without extras).
    fn total(&mut self, stage: &Stage, border: &Border, solution: &[f64]) -> (Vec<f64>, StepDerivatives);
    /// Whether derivatives may be taken from an earlier visit of the same state (no law looks at
    /// time).
    fn repeatable(&self) -> bool;
    /// Whether the last step changed the values of any history variable of these columns.
    fn moved(&self) -> bool;
}

/// Columns in chunks of `W` derivatives.
pub struct Chunk<const W: usize> {
    problem: Arc<Problem>,
    seeds: Vec<usize>,
    bulk: Vec<Jet<W>>,
    path: Vec<Jet<W>>,
    train: Vec<Jet<W>>,
    local: LocalParams<Jet<W>>,
    plain: LocalParams<f64>,
    /// Which laws the seeds reach directly.
    in_bulk: bool,
    in_shape: bool,
    force_partial: [f64; W],
    /// Bulk history after the partial sweep, kept when no total sweep is needed.
    pending: Vec<Jet<W>>,
    direct_history: bool,
    repeatable: bool,
    moved: bool,
}

impl<const W: usize> Chunk<W> {
    /// Columns for the parameters `seeds` (at most `W`), from virgin history.
    pub fn new(problem: Arc<Problem>, theta: &[f64], seeds: &[usize]) -> Self {
        let mut jets: Vec<Jet<W>> = theta.iter().map(|&t| Jet::constant(t)).collect();
        for (c, &s) in seeds.iter().take(W).enumerate() {
            jets[s] = Jet::variable(theta[s], c);
        }
        let history = crate::state::History::virgin(&problem);
        let lift = |h: &[f64]| h.iter().map(|&x| Jet::constant(x)).collect::<Vec<Jet<W>>>();
        let moves = |p: usize| {
            problem.shape.iter().any(|f| f.param == p) || problem.mount.iter().any(|f| f.param == p)
        };
        Self {
            bulk: lift(&history.bulk),
            path: lift(&history.path),
            train: lift(&history.train),
            local: problem.local(&jets),
            plain: problem.local(theta),
            in_bulk: seeds.iter().any(|s| problem.bulk_params.contains(s)),
            in_shape: seeds.iter().any(|&s| moves(s)),
            seeds: seeds.iter().take(W).copied().collect(),
            force_partial: [0.0; W],
            pending: Vec::new(),
            direct_history: false,
            moved: false,
            repeatable: !problem.rate_dependent(),
            problem,
        }
    }

    /// Takes the bulk history's derivatives from the partial sweep alone. Exact where the history
    /// acts only through an amplitude that is zero: an effect tried at its neutral value on a base
    /// law without memory. Saves one sweep over the bulk per step.
    pub fn with_direct_history(mut self) -> Self {
        self.direct_history = true;
        self
    }

    /// Continues from the history (values and derivatives) another chunk of the same tissue ended
    /// with: the tests of one piece follow each other.
    pub fn carry_bulk_from(&mut self, other: &Self) {
        if self.bulk.len() == other.bulk.len() {
            self.bulk.clone_from(&other.bulk);
        }
    }

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

    /// Derivatives of the prescribed displacements at a standing grip.
    fn mount_jets(&self, u: &[f64]) -> Vec<Jet<W>> {
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

fn gather<const N: usize, const W: usize>(u: &[Jet<W>], nodes: &[usize; N]) -> [[Jet<W>; 3]; N] {
    nodes.map(|n| [u[3 * n], u[3 * n + 1], u[3 * n + 2]])
}

fn array<const N: usize, const W: usize>(v: &[[Jet<W>; 3]]) -> [[Jet<W>; 3]; N] {
    std::array::from_fn(|i| v[i])
}

type BrickForces<const W: usize> = (Vec<[[Jet<W>; 3]; 8]>, Vec<Jet<W>>);

impl<const W: usize> Chunk<W>
where
    dyn PointLaw<9>: Law<Jet<W>, 9>,
    dyn PointLaw<3>: Law<Jet<W>, 3>,
    dyn PointLaw<1>: Law<Jet<W>, 1>,
{
    /// Residual jets of all bricks and their new history, with displacements `u`.
    fn bricks_total(&self, stage: &Stage, u: &[Jet<W>]) -> BrickForces<W> {
        let nh = self.bulk.len() / self.problem.body.hexes.len().max(1);
        let results: Vec<([[Jet<W>; 3]; 8], Vec<Jet<W>>)> = self
            .problem
            .body
            .hexes
            .par_iter()
            .enumerate()
            .map(|(e, h)| {
                let geo = if self.in_shape {
                    hex8::geometry(&array::<8, W>(&self.node_positions(h)))
                } else {
                    lift_geometry(&stage.system.geometry()[e])
                };
                let old = &self.bulk[e * nh..(e + 1) * nh];
                let mut new = old.to_vec();
                let r = hex8::residual::<Jet<W>, Jet<W>>(
                    &*self.problem.bulk,
                    &stage.ctx,
                    &self.local.bulk,
                    &geo,
                    &gather(u, h),
                    old,
                    &mut new,
                );
                (r, new)
            })
            .collect();
        let mut forces = Vec::with_capacity(results.len());
        let mut history = Vec::with_capacity(self.bulk.len());
        for (r, h) in results {
            forces.push(r);
            history.extend(h);
        }
        (forces, history)
    }

    /// New history of all bricks with displacements `u` and constant positions.
    fn history_total(&self, stage: &Stage, u: &[Jet<W>]) -> Vec<Jet<W>> {
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

    /// The same with constant displacements and positions: kinematics in plain numbers.
    fn bricks_partial(&self, stage: &Stage) -> BrickForces<W> {
        let nh = self.bulk.len() / self.problem.body.hexes.len().max(1);
        let results: Vec<([[Jet<W>; 3]; 8], Vec<Jet<W>>)> = self
            .problem
            .body
            .hexes
            .par_iter()
            .enumerate()
            .map(|(e, h)| {
                let old = &self.bulk[e * nh..(e + 1) * nh];
                let mut new = old.to_vec();
                let u = crate::state::gather8(&stage.state.u, h);
                let r = hex8::residual::<f64, Jet<W>>(
                    &*self.problem.bulk,
                    &stage.ctx,
                    &self.local.bulk,
                    &stage.system.geometry()[e],
                    &u,
                    old,
                    &mut new,
                );
                (r, new)
            })
            .collect();
        let mut forces = Vec::with_capacity(results.len());
        let mut history = Vec::with_capacity(self.bulk.len());
        for (r, h) in results {
            forces.push(r);
            history.extend(h);
        }
        (forces, history)
    }

    /// Residual jets of the interface elements (in the order of `System::path_dofs`) and history.
    fn path_forces(&self, stage: &Stage, u: &[Jet<W>]) -> (Vec<Vec<Jet<W>>>, Vec<Jet<W>>) {
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

    fn total_u(&self, stage: &Stage, border: &Border, solution: &[f64], d_grip: &[f64; W]) -> Vec<Jet<W>> {
        let n = stage.system.unknowns;
        let mut u = self.mount_jets(&stage.state.u);
        for (dof, &eq) in stage.system.equation.iter().enumerate() {
            for c in 0..self.seeds.len() {
                if eq != NONE {
                    u[dof].eps[c] = solution[c * n + eq] + border.response[eq] * d_grip[c];
                } else if let Some(p) = self.problem.supports[dof] {
                    u[dof].eps[c] += p.grip * d_grip[c];
                }
            }
        }
        u
    }

    /// du_grip, du_actuator and dF per column, from the linearised train and control.
    fn close_border(
        &self,
        stage: &Stage,
        border: &Border,
        solution: &[f64],
    ) -> ([f64; W], [f64; W], [f64; W]) {
        let n = stage.system.unknowns;
        let m = self.problem.multiplicity;
        let force = Jet::<W>::constant(stage.state.force);
        let mut e_jet = Jet::<W>::constant(0.0);
        let (mut slope, mut at) = (0.0, 0);
        for (link, (p, plain)) in
            self.problem.train.iter().zip(self.local.train.iter().zip(&self.plain.train))
        {
            let nh = link.law.history().len();
            let old = &self.train[at..at + nh];
            let mut new = old.to_vec();
            e_jet += Law::<Jet<W>, 1>::respond(&*link.law, &stage.ctx, &[force], p, old, &mut new).force[0];
            let plain_old: Vec<f64> = old.iter().map(|h| h.re).collect();
            let mut plain_new = plain_old.clone();
            slope += constitutive::tangent_by_jets_1(
                &*link.law,
                &stage.ctx,
                &[force.re],
                plain,
                &plain_old,
                &mut plain_new,
            )
            .1[0][0];
            at += nh;
        }
        let s_jet = self.problem.take_up_jets(Jet::constant(stage.state.actuator), &self.local.takeup);
        let (_, s_slope) =
            crate::equilibrium::take_up(&self.problem, &self.plain.takeup, stage.state.actuator);
        let (mut d_grip, mut d_act, mut d_force) = ([0.0; W], [0.0; W], [0.0; W]);
        let opening = |x: &[f64]| -> f64 { stage.system.mean_opening.iter().map(|&(eq, w)| w * x[eq]).sum() };
        for c in 0..self.seeds.len() {
            let y = &solution[c * n..(c + 1) * n];
            let along: f64 = stage.system.grip_column.iter().zip(y).map(|(a, b)| a * b).sum();
            let held = m * (self.force_partial[c] + along); // dF at standing grip
            // (1 + e' k) du_g = s_θ + s' du_a − e_θ − e' F_θ
            let lhs = 1.0 + slope * border.stiffness;
            let rhs = s_jet.eps[c] - e_jet.eps[c] - slope * held;
            (d_grip[c], d_act[c]) = match stage.arc {
                None => (rhs / lhs, 0.0),
                Some([tu, tw]) => {
                    let per_grip = tu * lhs / s_slope + tw * opening(&border.response);
                    let g = (tu * rhs / s_slope - tw * opening(y)) / per_grip;
                    (g, (lhs * g - rhs) / s_slope)
                }
            };
            d_force[c] = held + border.stiffness * d_grip[c];
        }
        (d_grip, d_act, d_force)
    }

    fn carry_train(&mut self, stage: &Stage, d_force: &[f64; W]) {
        let force = Jet::<W> { re: stage.state.force, eps: *d_force };
        let mut at = 0;
        for (link, p) in self.problem.train.iter().zip(&self.local.train) {
            let nh = link.law.history().len();
            let old = self.train[at..at + nh].to_vec();
            Law::<Jet<W>, 1>::respond(
                &*link.law,
                &stage.ctx,
                &[force],
                p,
                &old,
                &mut self.train[at..at + nh],
            );
            at += nh;
        }
    }
}

fn differs<const W: usize>(a: &[Jet<W>], b: &[Jet<W>]) -> bool {
    a.iter().zip(b).any(|(x, y)| x.re.to_bits() != y.re.to_bits())
}

fn lift_geometry<const W: usize>(g: &hex8::Geometry<f64>) -> hex8::Geometry<Jet<W>> {
    hex8::Geometry {
        gradients: g.gradients.map(|p| p.map(|a| a.map(Jet::constant))),
        volumes: g.volumes.map(Jet::constant),
    }
}

impl<const W: usize> Columns for Chunk<W>
where
    dyn PointLaw<9>: Law<Jet<W>, 9>,
    dyn PointLaw<3>: Law<Jet<W>, 3>,
    dyn PointLaw<1>: Law<Jet<W>, 1>,
{
    fn count(&self) -> usize {
        self.seeds.len()
    }

    fn partial(&mut self, stage: &Stage, rhs: &mut Vec<f64>) {
        let n = stage.system.unknowns;
        let start = rhs.len();
        rhs.resize(start + n * self.seeds.len(), 0.0);
        self.force_partial = [0.0; W];
        let mut add = |dof: usize, j: &Jet<W>, force: &mut [f64; W]| match stage.system.equation[dof] {
            NONE => {
                let share = self.problem.supports[dof].map_or(0.0, |p| p.grip);
                for c in 0..self.seeds.len() {
                    force[c] += share * j.eps[c];
                }
            }
            eq => {
                for c in 0..self.seeds.len() {
                    rhs[start + c * n + eq] -= j.eps[c];
                }
            }
        };
        let mut force = [0.0; W];
        self.pending.clear();
        if self.in_shape || self.in_bulk || !self.bulk.is_empty() {
            let (forces, history) = if self.in_shape {
                self.bricks_total(stage, &self.mount_jets(&stage.state.u))
            } else {
                self.bricks_partial(stage)
            };
            for (h, r) in self.problem.body.hexes.iter().zip(&forces) {
                for (a, node) in h.iter().enumerate() {
                    for i in 0..3 {
                        add(3 * node + i, &r[a][i], &mut force);
                    }
                }
            }
            self.pending = history;
        }
        if self.problem.path.is_some() {
            let u: Vec<Jet<W>> = self.mount_jets(&stage.state.u);
            let (forces, _) = self.path_forces(stage, &u);
            for (e, r) in forces.iter().enumerate() {
                for (dof, j) in stage.system.path_dofs(e).iter().zip(r) {
                    add(*dof, j, &mut force);
                }
            }
        }
        self.force_partial = force;
    }

    fn total(&mut self, stage: &Stage, border: &Border, solution: &[f64]) -> (Vec<f64>, StepDerivatives) {
        let (d_grip, d_act, d_force) = self.close_border(stage, border, solution);
        let u = self.total_u(stage, border, solution, &d_grip);
        self.moved = false;
        if !self.path.is_empty() {
            let new = self.path_forces(stage, &u).1;
            self.moved |= differs(&self.path, &new);
            self.path = new;
        }
        if !self.bulk.is_empty() {
            let new = if self.direct_history {
                std::mem::take(&mut self.pending)
            } else if self.in_shape {
                self.bricks_total(stage, &u).1
            } else {
                self.history_total(stage, &u)
            };
            self.moved |= differs(&self.bulk, &new);
            self.bulk = new;
        }
        let train = self.train.clone();
        self.carry_train(stage, &d_force);
        self.moved |= differs(&train, &self.train);
        let count = self.seeds.len();
        let mut du = vec![0.0; u.len() * count];
        for (dof, j) in u.iter().enumerate() {
            du[dof * count..(dof + 1) * count].copy_from_slice(&j.eps[..count]);
        }
        let take = |v: [f64; W]| v[..count].to_vec();
        (
            du,
            StepDerivatives {
                force: take(d_force),
                grip: take(d_grip),
                actuator: take(d_act),
                extra: Vec::new(),
            },
        )
    }

    fn repeatable(&self) -> bool {
        self.repeatable
    }

    fn moved(&self) -> bool {
        self.moved
    }
}

impl Problem {
    /// Take-up over jets.
    fn take_up_jets<const W: usize>(&self, actuator: Jet<W>, params: &[Vec<Jet<W>>]) -> Jet<W>
    where
        dyn PointLaw<1>: Law<Jet<W>, 1>,
    {
        self.take_up(actuator, params)
    }
}

/// Chunks of the standard width for a list of parameters.
pub fn columns_for(
    problem: &Arc<Problem>,
    theta: &[f64],
    seeds: &[usize],
) -> Vec<Chunk<{ constitutive::WIDTH }>> {
    seeds.chunks(constitutive::WIDTH).map(|c| Chunk::new(problem.clone(), theta, c)).collect()
}
