//! All columns of a run's own parameters: chunks of jets that share one tangent of the bulk's history.

use super::chunk::{Closed, Rest};
use super::{Chunk, Columns, Stage, StepDerivatives};
use crate::equilibrium::Border;
use crate::hex8::HistoryTangent;
use crate::problem::Problem;
use crate::state::gather8;
use constitutive::{Jet, WIDTH};
use rayon::prelude::*;
use std::sync::Arc;

/// Bricks whose history is carried on together.
const BLOCK: usize = 16;

/// Columns for a list of parameters, in chunks of [`WIDTH`].
///
/// The history of the bulk after a step varies with parameters and old history at constant displacements, which the
/// partial sweep of each chunk says, and with the displacements through ∂h/∂F̄, which is the same for all of them: it is
/// computed once per point and step.
pub struct Group {
    problem: Arc<Problem>,
    params: Vec<f64>,
    chunks: Vec<Chunk<WIDTH>>,
}

/// What one chunk has of a block of bricks.
struct Part<'a> {
    u: &'a [Jet<WIDTH>],
    history: &'a mut [Jet<WIDTH>],
    /// Whether the history holds the partial derivatives; elsewhere it is constant at constant displacements.
    partial: bool,
}

impl Group {
    /// Columns for the parameters `seeds`, from virgin history.
    pub fn new(problem: &Arc<Problem>, theta: &[f64], seeds: &[usize]) -> Self {
        let chunks = seeds.chunks(WIDTH).map(|c| Chunk::new(problem.clone(), theta, c)).collect();
        Self { problem: problem.clone(), params: problem.local(theta).bulk, chunks }
    }

    /// Continues from the history (values and derivatives) another group of the same tissue ended with.
    pub fn carry_bulk_from(&mut self, other: &Self) {
        self.chunks.iter_mut().zip(&other.chunks).for_each(|(c, o)| c.carry_bulk_from(o));
    }

    /// As [`crate::run_steps`] takes it: nothing where there is no column. Not inlined: what a run calls is compiled here,
    /// not anew in every crate that runs a model.
    #[inline(never)]
    pub fn columns(&mut self) -> Vec<&mut (dyn Columns + 'static)> {
        if self.chunks.is_empty() { Vec::new() } else { vec![self] }
    }

    /// New history of the chunks `of`, whose displacements are `closed`.
    fn carry_jointly(&mut self, stage: &Stage, of: &[usize], closed: &[Closed<WIDTH>]) {
        let Some(&first) = of.first() else { return };
        let bricks = self.problem.body.hexes.len();
        let old: Vec<f64> = self.chunks[first].bulk.iter().map(|j| j.re).collect();
        let nh = old.len() / bricks.max(1);
        let mut histories: Vec<(usize, Vec<Jet<WIDTH>>, bool)> = of
            .iter()
            .map(|&c| {
                let known = std::mem::take(&mut self.chunks[c].pending);
                let partial = !known.is_empty();
                (c, if partial { known } else { vec![Jet::constant(0.0); old.len()] }, partial)
            })
            .collect();
        let mut blocks: Vec<Vec<Part>> = (0..bricks.div_ceil(BLOCK)).map(|_| Vec::new()).collect();
        for (c, history, partial) in &mut histories {
            for (block, history) in blocks.iter_mut().zip(history.chunks_mut(BLOCK * nh)) {
                block.push(Part { u: &closed[*c].u, history, partial: *partial });
            }
        }
        blocks.par_iter_mut().enumerate().for_each_init(HistoryTangent::default, |tangent, (b, parts)| {
            for e in b * BLOCK..bricks.min((b + 1) * BLOCK) {
                self.fill(tangent, stage, e, &old[e * nh..(e + 1) * nh]);
                let at = (e - b * BLOCK) * nh;
                parts.iter_mut().for_each(|p| self.carry(tangent, stage, e, p, at..at + nh));
            }
        });
        for (c, history, _) in histories {
            self.chunks[c].take_bulk(history);
        }
    }

    /// The tangent of brick `e`.
    fn fill(&self, tangent: &mut HistoryTangent, stage: &Stage, e: usize, old: &[f64]) {
        let (law, geo) = (&*self.problem.bulk, &stage.system.geometry()[e]);
        let u = gather8(&stage.state.u, &self.problem.body.hexes[e]);
        tangent.fill(law, &stage.ctx, &self.params, geo, &u, old);
    }

    /// The history of brick `e`, which a chunk has at `at` of its block.
    fn carry(
        &self,
        tangent: &HistoryTangent,
        stage: &Stage,
        e: usize,
        part: &mut Part,
        at: std::ops::Range<usize>,
    ) {
        let history = &mut part.history[at];
        if !part.partial {
            history.iter_mut().zip(tangent.values()).for_each(|(h, &x)| *h = Jet::constant(x));
        }
        let u = self.problem.body.hexes[e].map(|n| [part.u[3 * n], part.u[3 * n + 1], part.u[3 * n + 2]]);
        tangent.carry(&stage.system.geometry()[e], &u, history);
    }
}

impl Columns for Group {
    fn count(&self) -> usize {
        self.chunks.iter().map(Columns::count).sum()
    }

    fn partial(&mut self, stage: &Stage, rhs: &mut Vec<f64>) {
        self.chunks.iter_mut().for_each(|c| c.partial(stage, rhs));
    }

    fn total(&mut self, stage: &Stage, border: &Border, solution: &[f64]) -> (Vec<f64>, StepDerivatives) {
        let n = stage.system.unknowns;
        let (mut closed, mut asks, mut at) = (Vec::new(), Vec::new(), 0);
        for (i, c) in self.chunks.iter_mut().enumerate() {
            let own = at * n..(at + c.count()) * n;
            at += c.count();
            let step = c.close(stage, border, &solution[own]);
            if c.carry_bulk(stage, &step.u) == Rest::Asks {
                asks.push(i);
            }
            closed.push(step);
        }
        self.carry_jointly(stage, &asks, &closed);
        let count = self.count();
        let mut du = vec![0.0; stage.state.u.len() * count];
        let (mut all, mut at) = (StepDerivatives::default(), 0);
        for (c, step) in self.chunks.iter_mut().zip(closed) {
            let (own, step) = c.finish(stage, step);
            let k = c.count();
            for (to, from) in du.chunks_exact_mut(count).zip(own.chunks_exact(k)) {
                to[at..at + k].copy_from_slice(from);
            }
            at += k;
            all.append(step);
        }
        (du, all)
    }

    fn repeatable(&self) -> bool {
        self.chunks.iter().all(Columns::repeatable)
    }

    fn moved(&self) -> bool {
        self.chunks.iter().any(Columns::moved)
    }

    fn save(&mut self) {
        self.chunks.iter_mut().for_each(Columns::save);
    }

    fn restore(&mut self) {
        self.chunks.iter_mut().for_each(Columns::restore);
    }
}
