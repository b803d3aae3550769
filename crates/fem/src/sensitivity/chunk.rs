//! A few columns at a time: jets of `W` derivatives, with the history of all laws propagated.

use super::{Columns, Stage, StepDerivatives};
use crate::equilibrium::Border;
use crate::problem::{LocalParams, Problem};
use crate::system::NONE;
use constitutive::{Jet, Law, PointLaw};
use std::sync::Arc;

/// Columns in chunks of `W` derivatives.
pub struct Chunk<const W: usize> {
    pub(super) problem: Arc<Problem>,
    pub(super) seeds: Vec<usize>,
    pub(super) bulk: Vec<Jet<W>>,
    pub(super) path: Vec<Jet<W>>,
    pub(super) train: Vec<Jet<W>>,
    pub(super) local: LocalParams<Jet<W>>,
    pub(super) plain: LocalParams<f64>,
    /// Which laws the seeds act on directly.
    in_bulk: bool,
    pub(super) in_shape: bool,
    pub(super) force_partial: [f64; W],
    /// Whether no bulk history depends on the seeds so far.
    constant: bool,
    /// Bulk history after the partial sweep, kept when no total sweep is needed.
    pub(super) pending: Vec<Jet<W>>,
    direct_history: bool,
    repeatable: bool,
    moved: bool,
    /// Histories (bulk, path, train) to go back to.
    saved: [Vec<Jet<W>>; 3],
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
            constant: true,
            pending: Vec::new(),
            direct_history: false,
            moved: false,
            repeatable: !problem.rate_dependent(),
            saved: Default::default(),
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
            self.constant = other.constant;
        }
    }

    /// Whether the seeds act on the bulk neither directly nor through what it remembers.
    const fn passes_by(&self) -> bool {
        !self.in_shape && !self.in_bulk && self.constant
    }

    /// The bulk history after a step that passes by it and moves nothing: that of the state, where that is of the
    /// same law.
    fn undisturbed(&self, stage: &Stage, u: &[Jet<W>]) -> Option<Vec<Jet<W>>> {
        let plain = &stage.state.history.bulk;
        let still = self.passes_by() && plain.len() == self.bulk.len();
        (still && u.iter().all(|x| x.eps == [0.0; W]))
            .then(|| plain.iter().map(|&x| Jet::constant(x)).collect())
    }
}

// Not generic and not inlined: what a run calls is compiled here, not anew in every crate that runs a model.
impl Chunk<1> {
    /// As [`crate::run_steps`] takes it.
    #[inline(never)]
    pub fn columns(&mut self) -> &mut (dyn Columns + 'static) {
        self
    }
}

/// What the border, the displacements and the tear path of a step came to.
pub(super) struct Closed<const W: usize> {
    pub u: Vec<Jet<W>>,
    grip: [f64; W],
    actuator: [f64; W],
    force: [f64; W],
    reactions: Vec<[f64; W]>,
}

/// Whether the bulk's history still asks for a sweep that follows the displacements.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Rest {
    Done,
    Asks,
}

impl<const W: usize> Chunk<W>
where
    dyn PointLaw<9>: Law<Jet<W>, 9>,
    dyn PointLaw<3>: Law<Jet<W>, 3>,
    dyn PointLaw<1>: Law<Jet<W>, 1>,
{
    /// Closes the border and carries the history of the tear path on.
    pub(super) fn close(&mut self, stage: &Stage, border: &Border, solution: &[f64]) -> Closed<W> {
        let (grip, actuator, force) = self.close_border(stage, border, solution);
        let u = self.total_u(stage, border, solution, &grip);
        let reactions = self.reactions(stage, &u);
        self.moved = false;
        if !self.path.is_empty() {
            let new = self.path_forces(stage, &u).1;
            self.moved |= differs(&self.path, &new);
            self.path = new;
        }
        Closed { u, grip, actuator, force, reactions }
    }

    /// Carries the bulk's history on where that takes no sweep of its own.
    pub(super) fn carry_bulk(&mut self, stage: &Stage, u: &[Jet<W>]) -> Rest {
        if self.bulk.is_empty() {
            return Rest::Done;
        }
        let undisturbed = self.undisturbed(stage, u);
        self.constant = undisturbed.is_some();
        let new = if let Some(plain) = undisturbed {
            plain
        } else if self.direct_history {
            std::mem::take(&mut self.pending)
        } else if self.in_shape {
            self.bricks_total(stage, u).1
        } else {
            return Rest::Asks;
        };
        self.take_bulk(new);
        Rest::Done
    }

    pub(super) fn take_bulk(&mut self, new: Vec<Jet<W>>) {
        self.moved |= differs(&self.bulk, &new);
        self.bulk = new;
    }

    /// Carries the train on; the derivatives of the displacements and of the step.
    pub(super) fn finish(&mut self, stage: &Stage, closed: Closed<W>) -> (Vec<f64>, StepDerivatives) {
        let train = self.train.clone();
        self.carry_train(stage, &closed.force);
        self.moved |= differs(&train, &self.train);
        let count = self.seeds.len();
        let mut du = vec![0.0; closed.u.len() * count];
        for (to, j) in du.chunks_exact_mut(count).zip(&closed.u) {
            to.copy_from_slice(&j.eps[..count]);
        }
        let take = |v: [f64; W]| v[..count].to_vec();
        let step = StepDerivatives {
            force: take(closed.force),
            grip: take(closed.grip),
            actuator: take(closed.actuator),
            reactions: closed.reactions.into_iter().map(take).collect(),
            extra: Vec::new(),
        };
        (du, step)
    }
}

fn differs<const W: usize>(a: &[Jet<W>], b: &[Jet<W>]) -> bool {
    a.iter().zip(b).any(|(x, y)| x.re.to_bits() != y.re.to_bits())
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
        if !self.passes_by() || self.direct_history && !self.bulk.is_empty() {
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
        let closed = self.close(stage, border, solution);
        if let Rest::Asks = self.carry_bulk(stage, &closed.u) {
            let new = self.history_total(stage, &closed.u);
            self.take_bulk(new);
        }
        self.finish(stage, closed)
    }

    fn repeatable(&self) -> bool {
        self.repeatable
    }

    fn save(&mut self) {
        self.saved = [self.bulk.clone(), self.path.clone(), self.train.clone()];
    }

    fn restore(&mut self) {
        let [bulk, path, train] = &self.saved;
        self.bulk.clone_from(bulk);
        self.path.clone_from(path);
        self.train.clone_from(train);
    }

    fn moved(&self) -> bool {
        self.moved
    }
}
